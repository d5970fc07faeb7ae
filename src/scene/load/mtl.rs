//! Material libraries, read line by line: a bad line costs only itself.
//!
//! Follows the MTL format of 1995 (Wavefront, *Advanced Visualizer*, appendix B1) and what exporters
//! made of it since. Bytes, not text: old files hold names in any encoding.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::MAX_NAME;
use super::lookup::text_from_bytes;
use super::map_statement::{MapKind, MapStatement, parse_map};

/// Remarks per library before the rest is only counted: a binary file taken for a library would
/// otherwise drown every other warning.
const MAX_NOTES: usize = 100;
/// Materials of all libraries of a model, four times as many as a model may use: no more are kept.
pub(super) const MAX_MATERIALS: usize = 1 << 18;

/// What one library says.
#[derive(Debug, Default)]
pub(super) struct Library {
    /// In file order; names may repeat.
    pub materials: Vec<MtlMaterial>,
    /// Doubtful lines.
    pub notes: Vec<Note>,
}

/// A remark on one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Note {
    /// From 1.
    pub line: usize,
    /// What was found and what was done about it.
    pub message: String,
}

/// One material as its statements give it.
#[derive(Debug, Default)]
pub(super) struct MtlMaterial {
    /// Everything after `newmtl`, without blanks around it. A `#` stays: "Material #25" is a common name.
    pub name: Vec<u8>,
    /// Line of `newmtl`.
    pub line: usize,
    /// `Kd` as written (sRGB-encoded), each channel at least 0.
    pub kd: Option<[f32; 3]>,
    /// `Ks` as written (linear), each channel at least 0.
    pub ks: Option<[f32; 3]>,
    /// `Ns`, finite.
    pub ns: Option<f32>,
    /// `illum`, rounded.
    pub illum: Option<i32>,
    /// Pictures that the program can use, in file order.
    pub maps: Vec<MapStatement>,
    dissolve: Option<f32>,
    transparency: Option<f32>,
}

impl MtlMaterial {
    /// Whether `d`, or `Tr` without a `d`, asks for see-through surfaces.
    fn is_translucent(&self) -> bool {
        match (self.dissolve, self.transparency) {
            (Some(d), _) => d < 1.0,
            (None, Some(tr)) => tr > 0.0,
            (None, None) => false,
        }
    }
}

/// Reads a whole library. Statements before the first `newmtl` belong to nothing and are skipped.
pub(super) fn parse_library(text: &[u8]) -> Library {
    let mut parser = Parser::default();
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    for (line, statement) in logical_lines(text) {
        parser.statement(line, &statement);
    }
    parser.finish()
}

/// A statement that is understood but changes no picture, with how often it came.
struct Unused {
    keyword: String,
    line: usize,
    count: usize,
    reason: &'static str,
}

#[derive(Default)]
struct Parser {
    materials: Vec<MtlMaterial>,
    /// Where each name was defined first.
    lines: HashMap<Vec<u8>, usize>,
    notes: Vec<Note>,
    unused: Vec<Unused>,
    orphans: Option<(usize, usize)>,
    /// The first material beyond [`MAX_MATERIALS`], and how many there are.
    left_out: Option<(usize, usize)>,
    suppressed: usize,
}

impl Parser {
    fn statement(&mut self, line: usize, text: &[u8]) {
        let (keyword, rest) = split_keyword(text);
        if keyword.is_empty() || keyword[0] == b'#' {
            return;
        }
        let lower = keyword.to_ascii_lowercase();
        let is_new = lower == b"newmtl";
        if self.left_out.is_some() || (is_new && self.materials.len() == MAX_MATERIALS) {
            let (_, count) = self.left_out.get_or_insert((line, 0));
            *count += usize::from(is_new);
        } else if is_new {
            self.new_material(line, rest);
        } else if self.materials.is_empty() {
            let (_, count) = self.orphans.get_or_insert((line, 0));
            *count += 1;
        } else {
            self.property(line, keyword, &lower, without_comment(rest));
        }
    }

    fn new_material(&mut self, line: usize, name: &[u8]) {
        if name.is_empty() {
            self.note(line, "newmtl without a name".to_owned());
        }
        let name = &name[..name.len().min(MAX_NAME)];
        match self.lines.entry(name.to_vec()) {
            Entry::Vacant(entry) => {
                entry.insert(line);
            }
            Entry::Occupied(first) => {
                let message = format!(
                    "material \"{}\" is defined again; the definition in line {} counts",
                    text_from_bytes(name),
                    first.get()
                );
                self.note(line, message);
            }
        }
        self.materials.push(MtlMaterial {
            name: name.to_vec(),
            line,
            ..MtlMaterial::default()
        });
    }

    fn property(&mut self, line: usize, keyword: &[u8], lower: &[u8], rest: &[u8]) {
        if let Some(kind) = MapKind::from_keyword(lower) {
            self.map(line, keyword, kind, rest);
            return;
        }
        match lower {
            b"kd" => self.color(line, "Kd", rest, |m, c| m.kd = Some(c)),
            b"ks" => self.color(line, "Ks", rest, |m, c| m.ks = Some(c)),
            b"ns" => self.number(line, "Ns", rest, |m, x| m.ns = Some(x)),
            b"illum" => self.number(line, "illum", rest, |m, x| m.illum = Some(x.round() as i32)),
            b"d" => self.number(line, "d", rest, |m, x| m.dissolve = Some(x)),
            b"tr" => self.number(line, "Tr", rest, |m, x| m.transparency = Some(x)),
            // Ambient light has one colour for all surfaces here, and nothing is refracted or filtered.
            b"ka" | b"ni" | b"tf" | b"sharpness" => {}
            b"ke" if !numbers(rest).any(|x| x > 0.0) => {}
            b"ke" => self.unused(line, keyword, "surfaces do not glow here"),
            b"pr" | b"pm" | b"ps" | b"pc" | b"pcr" | b"aniso" | b"anisor" => {
                self.unused(line, keyword, "not part of the Phong model");
            }
            b"refl" | b"decal" => self.unused(line, keyword, "no use is made of this picture"),
            _ if lower.starts_with(b"map_") => {
                self.unused(line, keyword, "no use is made of this picture");
            }
            _ => self.unused(line, keyword, "unknown statement"),
        }
    }

    fn map(&mut self, line: usize, keyword: &[u8], kind: MapKind, rest: &[u8]) {
        let keyword = text_from_bytes(keyword);
        match parse_map(line, keyword, kind, rest) {
            Ok((map, remarks)) => {
                for remark in remarks {
                    self.note(line, remark);
                }
                if let Some(material) = self.materials.last_mut() {
                    material.maps.push(map);
                }
            }
            Err(message) => self.note(line, message),
        }
    }

    fn color(
        &mut self,
        line: usize,
        keyword: &str,
        rest: &[u8],
        set: impl FnOnce(&mut MtlMaterial, [f32; 3]),
    ) {
        match color(rest) {
            Ok(value) => {
                if value.iter().any(|&c| c < 0.0) {
                    self.note(line, format!("{keyword} below 0 is read as 0"));
                }
                if let Some(material) = self.materials.last_mut() {
                    set(material, value.map(|c| c.max(0.0)));
                }
            }
            Err(cause) => self.note(line, format!("{keyword} ignored: {cause}")),
        }
    }

    fn number(
        &mut self,
        line: usize,
        keyword: &str,
        rest: &[u8],
        set: impl FnOnce(&mut MtlMaterial, f32),
    ) {
        // `d -halo 0.4`: the option has no argument of its own.
        let value = numbers(rest).next().filter(|x| x.is_finite());
        match (value, self.materials.last_mut()) {
            (Some(value), Some(material)) => set(material, value),
            _ => self.note(line, format!("{keyword} ignored: no finite number")),
        }
    }

    fn unused(&mut self, line: usize, keyword: &[u8], reason: &'static str) {
        let keyword = text_from_bytes(&keyword[..keyword.len().min(40)]);
        if let Some(known) = self.unused.iter_mut().find(|u| u.keyword == keyword) {
            known.count += 1;
        } else if self.unused.len() < MAX_NOTES {
            self.unused.push(Unused {
                keyword,
                line,
                count: 1,
                reason,
            });
        } else {
            self.suppressed += 1;
        }
    }

    fn note(&mut self, line: usize, message: String) {
        if self.notes.len() < MAX_NOTES {
            self.notes.push(Note { line, message });
        } else {
            self.suppressed += 1;
        }
    }

    fn finish(mut self) -> Library {
        let mut notes = std::mem::take(&mut self.notes);
        let mut say = |line, message| notes.push(Note { line, message });
        if let Some((line, count)) = self.left_out {
            let message = format!("beyond {MAX_MATERIALS} materials {count} are left out");
            say(line, message);
        }
        if let Some((line, count)) = self.orphans {
            let message = format!("{count} statement(s) before the first newmtl are ignored");
            say(line, message);
        }
        for Unused {
            keyword,
            line,
            count,
            reason,
        } in self.unused
        {
            let keyword = keyword.escape_debug();
            let times = match count {
                1 => String::new(),
                n => format!(" ({n} times)"),
            };
            say(line, format!("{keyword} is not used{times}: {reason}"));
        }
        let mut translucent = self.materials.iter().filter(|m| m.is_translucent());
        if let Some(first) = translucent.next() {
            let count = 1 + translucent.count();
            let message = format!(
                "d or Tr asks {count} material(s), first \"{}\", to be translucent; they are shown opaque",
                text_from_bytes(&first.name)
            );
            say(first.line, message);
        }
        if self.suppressed > 0 {
            let message = format!("{} more remarks are left out", self.suppressed);
            say(notes_end(&self.materials), message);
        }
        notes.sort_by_key(|note| note.line);
        Library {
            materials: self.materials,
            notes,
        }
    }
}

/// The line that the closing remark points to: where the last material begins.
fn notes_end(materials: &[MtlMaterial]) -> usize {
    materials.last().map_or(1, |m| m.line)
}

/// Three channels of `Kd` or `Ks`. One number means grey, as the format says.
fn color(rest: &[u8]) -> Result<[f32; 3], String> {
    let first = split_keyword(rest).0.to_ascii_lowercase();
    if first == b"spectral" || first == b"xyz" {
        let form = text_from_bytes(&first);
        return Err(format!("the {form} form is not read"));
    }
    let channels: Vec<f32> = numbers(rest).take(3).collect();
    let [r, g, b] = match channels[..] {
        [] => return Err("no number".to_owned()),
        [r] => [r, r, r],
        [r, g] => [r, g, r],
        [r, g, b, ..] => [r, g, b],
    };
    if [r, g, b].iter().all(|c| c.is_finite()) {
        Ok([r, g, b])
    } else {
        Err("not finite".to_owned())
    }
}

/// The words that are numbers, in order; others are skipped.
fn numbers(rest: &[u8]) -> impl Iterator<Item = f32> {
    rest.split(u8::is_ascii_whitespace).filter_map(parse_number)
}

/// One word as a number; may be infinite or NaN, as `f32`'s parser allows.
pub(super) fn parse_number(word: &[u8]) -> Option<f32> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// First word and the rest of a line, both without blanks around.
fn split_keyword(text: &[u8]) -> (&[u8], &[u8]) {
    let text = text.trim_ascii();
    let end = text
        .iter()
        .position(u8::is_ascii_whitespace)
        .unwrap_or(text.len());
    (&text[..end], text[end..].trim_ascii())
}

/// Cuts a comment off: a `#` at the start or after a blank, outside double quotes.
pub(super) fn without_comment(text: &[u8]) -> &[u8] {
    let mut quoted = false;
    for (i, &byte) in text.iter().enumerate() {
        match byte {
            b'"' => quoted = !quoted && text[i + 1..].contains(&b'"'),
            b'#' if !quoted && (i == 0 || text[i - 1].is_ascii_whitespace()) => {
                return text[..i].trim_ascii_end();
            }
            _ => {}
        }
    }
    text.trim_ascii_end()
}

/// Lines with their numbers from 1. LF, CR LF and lone CR end a line; a backslash at the end joins the
/// next one, but not in a comment, where paths end so. In a map statement a backslash straight after a word
/// ends a folder's name, so there it joins only after a blank.
fn logical_lines(text: &[u8]) -> Vec<(usize, Vec<u8>)> {
    let mut lines: Vec<(usize, Vec<u8>)> = Vec::new();
    let mut joining = false;
    for (i, physical) in physical_lines(text).enumerate() {
        let trimmed = physical.trim_ascii_end();
        let (content, continues) = match trimmed.split_last() {
            Some((b'\\', head)) if joins(head) => (head, true),
            _ => (trimmed, false),
        };
        match lines.last_mut() {
            Some((_, open)) if joining => {
                open.push(b' ');
                open.extend_from_slice(content);
            }
            _ => lines.push((i + 1, content.to_vec())),
        }
        joining = continues;
    }
    lines
}

/// Whether a backslash behind `head` joins the next line.
fn joins(head: &[u8]) -> bool {
    let (keyword, _) = split_keyword(head);
    let keyword = keyword.to_ascii_lowercase();
    let is_map = MapKind::from_keyword(&keyword).is_some() || keyword.starts_with(b"map_");
    let is_folder = is_map && !head.last().is_none_or(u8::is_ascii_whitespace);
    let has_comment = without_comment(head) != head.trim_ascii_end();
    !is_folder && !has_comment
}

fn physical_lines(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let text = rest?;
        let Some(end) = text.iter().position(|&b| b == b'\n' || b == b'\r') else {
            rest = None;
            return Some(text);
        };
        let skip = if text[end..].starts_with(b"\r\n") {
            2
        } else {
            1
        };
        rest = Some(&text[end + skip..]);
        Some(&text[..end])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn notes(library: &Library) -> Vec<(usize, &str)> {
        library
            .notes
            .iter()
            .map(|n| (n.line, n.message.as_str()))
            .collect()
    }

    #[test]
    fn line_ends_continuations_and_a_byte_order_mark() {
        let text = b"\xEF\xBB\xBFnewmtl a\rKd 1 \\\r\n 0 0.5\nmap_Kd tex\\\nNs 3\n";
        let library = parse_library(text);
        let material = &library.materials[0];
        assert_eq!(material.name, b"a");
        assert_eq!(material.kd, Some([1.0, 0.0, 0.5]));
        assert_eq!(material.maps[0].file, b"tex\\");
        assert_eq!(material.ns, Some(3.0));
        assert_eq!(library.notes, []);
    }

    #[test]
    fn a_bad_line_costs_only_itself() {
        let text =
            b"newmtl m\nKd x\nKs 0.1 nan 0.3\nNs\nillum 2.0\nKd 0.5\n\xFF\xFE \x00\nd 1e999\n";
        let library = parse_library(text);
        let material = &library.materials[0];
        assert_eq!(material.kd, Some([0.5; 3]));
        assert_eq!(material.ks, None);
        assert_eq!(material.illum, Some(2));
        let lines: Vec<usize> = notes(&library).iter().map(|n| n.0).collect();
        assert_eq!(lines, [2, 3, 4, 7, 8]);
    }

    #[test]
    fn orphans_duplicates_and_translucency_are_noted() {
        let text =
            b"Kd 1 0 0\nnewmtl a\nd -halo 0.4\nnewmtl a\nTr 0\nnewmtl Material #25\nd 1\nTr 1\n";
        let library = parse_library(text);
        assert_eq!(library.materials.len(), 3);
        assert_eq!(library.materials[2].name, b"Material #25");
        let notes = notes(&library);
        assert_eq!(notes.len(), 3, "{notes:?}");
        assert!(notes[0].0 == 1 && notes[0].1.contains("before the first newmtl"));
        assert!(notes[1].0 == 2 && notes[1].1.contains("asks 1 material(s)"));
        assert!(notes[2].0 == 4 && notes[2].1.contains("line 2"));
    }

    #[test]
    fn garbage_does_not_flood() {
        let mut text = b"newmtl m\n".to_vec();
        for i in 0..5000 {
            text.extend_from_slice(format!("word{i} 1\nKd bad\n").as_bytes());
        }
        let library = parse_library(&text);
        assert!(library.notes.len() <= 2 * MAX_NOTES + 3);
        assert!(
            library
                .notes
                .iter()
                .any(|n| n.message.contains("9800 more"))
        );
    }
}
