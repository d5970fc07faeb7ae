//! Keywords of statements that are skipped without being unknown.

/// Curves and surfaces, which only other programs read.
pub(super) fn is_freeform(keyword: &[u8]) -> bool {
    matches!(
        keyword,
        b"vp"
            | b"cstype"
            | b"deg"
            | b"bmat"
            | b"step"
            | b"curv"
            | b"curv2"
            | b"surf"
            | b"parm"
            | b"trim"
            | b"hole"
            | b"scrv"
            | b"sp"
            | b"end"
            | b"con"
            | b"mg"
            | b"bsp"
            | b"bzp"
            | b"cdc"
            | b"cdp"
            | b"res"
    )
}

/// Statements about display in other programs, which change no surface.
pub(super) fn is_display(keyword: &[u8]) -> bool {
    matches!(
        keyword,
        b"bevel"
            | b"c_interp"
            | b"d_interp"
            | b"lod"
            | b"maplib"
            | b"usemap"
            | b"shadow_obj"
            | b"trace_obj"
            | b"ctech"
            | b"stech"
            | b"call"
            | b"csh"
    )
}
