//! Statements of an OBJ file, one by one.

use std::collections::HashMap;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use super::lines::{Words, name, shown, split_keyword};
use super::notes::{Kind, Notes};
use super::number::{float, integer};
use super::{Corner, Face, NONE, Obj, Smoothing, Span};
use crate::scene::LoadError;
use crate::scene::load::LibraryRef;

/// Material indices are `u16`.
const MAX_MATERIALS: usize = u16::MAX as usize;

/// The first word of a face with a bad index of each kind.
#[derive(Default)]
struct BadWords<'a> {
    v: Option<&'a [u8]>,
    vt: Option<&'a [u8]>,
    vn: Option<&'a [u8]>,
}

/// Reads statements into an [`Obj`]; a `usemtl` or `s` holds until the next.
pub(super) struct Parser {
    /// What was read so far, its positive indices unchecked.
    pub obj: Obj,
    /// Name and line of the last `usemtl`; with a comment, as some names hold a `#`.
    current: (Vec<u8>, usize),
    /// Its index, once a face uses it.
    material: Option<u16>,
    smoothing: Smoothing,
    index_of: HashMap<Vec<u8>, u16>,
}

impl Parser {
    /// Nothing read yet of a file with this many bytes.
    pub fn new(path: &Path, bytes: usize) -> Self {
        // Exported text spends about 80 bytes for a vertex with everything that refers to it.
        let vertices = bytes / 80;
        Self {
            obj: Obj {
                path: path.to_owned(),
                positions: Vec::with_capacity(vertices),
                uvs: Vec::new(),
                normals: Vec::new(),
                corners: Vec::with_capacity(vertices * 4),
                faces: Vec::with_capacity(vertices),
                spans: Vec::new(),
                materials: Vec::new(),
                libraries: Vec::new(),
                notes: Notes::new(path),
            },
            current: (Vec::new(), 0),
            material: None,
            smoothing: Smoothing::Unsaid,
            index_of: HashMap::new(),
        }
    }

    /// Reads a logical line. Only limits that cannot be lifted are errors.
    pub fn statement(&mut self, line: usize, text: &[u8]) -> Result<(), LoadError> {
        let (keyword, rest) = split_keyword(text);
        match keyword {
            b"v" => self.vertex(line, rest),
            b"vt" => self.texture_coordinate(line, rest),
            b"vn" => self.normal(line, rest),
            b"f" | b"fo" => self.face(line, rest)?,
            b"s" => self.smoothing(line, rest),
            b"usemtl" => {
                self.current = (rest.to_vec(), line);
                self.material = None;
            }
            b"mtllib" => self.obj.libraries.push(LibraryRef {
                name: rest.to_vec(),
                model: self.obj.path.clone(),
                line,
            }),
            b"l" => self.obj.notes.count(Kind::Line, line),
            b"p" => self.obj.notes.count(Kind::Point, line),
            b"" | b"g" | b"o" => {}
            _ if keyword[0] == b'#' => {}
            _ if is_freeform(keyword) => self.obj.notes.count(Kind::Freeform, line),
            _ if is_display(keyword) => {}
            _ => self.obj.notes.add(Kind::Unknown, line, || {
                format!("unknown statement '{}' skipped", shown(keyword))
            }),
        }
        Ok(())
    }

    /// Up to three numbers; those behind the first bad word stay `None`.
    fn numbers(words: &mut Words<'_>) -> [Option<f64>; 3] {
        let mut numbers = [None; 3];
        for number in &mut numbers {
            let Some(value) = words.next().and_then(float) else {
                break;
            };
            *number = Some(value);
        }
        numbers
    }

    fn bad_number(&mut self, line: usize, rest: &[u8], what: &str) {
        self.obj.notes.add(Kind::Number, line, || {
            format!("{what}, got '{}'", shown(name(rest)))
        });
    }

    fn vertex(&mut self, line: usize, rest: &[u8]) {
        let mut words = Words(rest);
        let position = if let [Some(x), Some(y), Some(z)] = Self::numbers(&mut words) {
            // One more word is a weight, three or four are a colour.
            if !words.0.is_empty() && words.nth(2).is_some() {
                self.obj.notes.count(Kind::VertexColor, line);
            }
            DVec3::new(x, y, z)
        } else {
            self.bad_number(line, rest, "a vertex needs three finite numbers");
            DVec3::NAN
        };
        self.obj.positions.push(position);
    }

    fn texture_coordinate(&mut self, line: usize, rest: &[u8]) {
        let mut words = Words(rest);
        let u = words.next().and_then(float);
        let v = words.next().map_or(Some(0.0), float);
        let uv = u
            .zip(v)
            .map(|(u, v)| Vec2::new(u as f32, v as f32))
            .filter(|uv| uv.is_finite());
        if uv.is_none() {
            self.bad_number(
                line,
                rest,
                "a texture coordinate needs one or two finite numbers",
            );
        }
        self.obj.uvs.push(uv.unwrap_or(Vec2::NAN));
    }

    fn normal(&mut self, line: usize, rest: &[u8]) {
        let normal = if let [Some(x), Some(y), Some(z)] = Self::numbers(&mut Words(rest)) {
            let unit = DVec3::new(x, y, z).normalize_or_zero().as_vec3();
            if unit == Vec3::ZERO {
                self.obj.notes.count(Kind::ZeroNormal, line);
            }
            unit
        } else {
            self.bad_number(line, rest, "a normal needs three finite numbers");
            Vec3::ZERO
        };
        self.obj.normals.push(normal);
    }

    fn smoothing(&mut self, line: usize, rest: &[u8]) {
        let word = name(rest);
        self.smoothing = match (word, integer(word).map(u32::try_from)) {
            (b"off" | b"OFF" | b"Off", _) | (_, Some(Ok(0))) => Smoothing::Off,
            (b"on" | b"ON" | b"On", _) => Smoothing::Group(1),
            (_, Some(Ok(group))) => Smoothing::Group(group),
            _ => {
                self.bad_number(line, rest, "a smoothing group is a number or 'off'");
                return;
            }
        };
    }

    fn face(&mut self, line: usize, rest: &[u8]) -> Result<(), LoadError> {
        let start = self.obj.corners.len();
        let mut bad = BadWords::default();
        for word in Words(rest) {
            self.corner(word, &mut bad);
        }
        let notes = &mut self.obj.notes;
        let too_few = self.obj.corners.len() - start < 3;
        if too_few || bad.v.is_some() {
            self.obj.corners.truncate(start);
            notes.add(Kind::FaceDropped, line, || match bad.v {
                Some(word) => format!("face dropped: bad vertex index in '{}'", shown(word)),
                None => format!(
                    "face dropped: fewer than three corners in '{}'",
                    shown(rest)
                ),
            });
            return Ok(());
        }
        if let Some(word) = bad.vt {
            notes.add(Kind::UvDropped, line, || {
                format!(
                    "face without texture coordinates: bad index in '{}'",
                    shown(word)
                )
            });
        }
        if let Some(word) = bad.vn {
            notes.add(Kind::NormalsDropped, line, || {
                format!("face without its normals: bad index in '{}'", shown(word))
            });
        }
        self.finish_face(line)
    }

    /// Adds a corner, or what is wrong with it.
    fn corner<'w>(&mut self, word: &'w [u8], bad: &mut BadWords<'w>) {
        let mut parts = word.splitn(3, |&b| b == b'/');
        let mut next = |so_far: usize, bad: &mut Option<&'w [u8]>| {
            index(parts.next(), so_far).unwrap_or_else(|| {
                bad.get_or_insert(word);
                NONE
            })
        };
        let corner = Corner {
            v: next(self.obj.positions.len(), &mut bad.v),
            vt: next(self.obj.uvs.len(), &mut bad.vt),
            vn: next(self.obj.normals.len(), &mut bad.vn),
        };
        if corner.v == NONE {
            bad.v.get_or_insert(word);
        }
        self.obj.corners.push(corner);
    }

    /// Notes the face whose corners were added, with the state in force.
    fn finish_face(&mut self, line: usize) -> Result<(), LoadError> {
        let material = match self.material {
            Some(index) => Some(index),
            None => self.material_index(),
        };
        let too_many = |what: &str| LoadError::Invalid {
            path: self.obj.path.clone(),
            line: Some(line),
            message: format!("too many {what}"),
        };
        let material = material.ok_or_else(|| too_many("materials: 65,535 are the limit"))?;
        let end = u32::try_from(self.obj.corners.len())
            .ok()
            .filter(|_| self.obj.positions.len() < NONE as usize)
            .ok_or_else(|| too_many("vertices: 32-bit indices end here"))?;
        let span = Span {
            first: self.obj.faces.len() as u32,
            material,
            smoothing: self.smoothing,
        };
        let goes_on = |last: &Span| last.material == material && last.smoothing == span.smoothing;
        if !self.obj.spans.last().is_some_and(goes_on) {
            self.obj.spans.push(span);
        }
        self.obj.faces.push(Face {
            end,
            line: u32::try_from(line).unwrap_or(u32::MAX),
        });
        Ok(())
    }

    /// Index of the current material, new or known; `None` beyond the limit.
    fn material_index(&mut self) -> Option<u16> {
        let index = match self.index_of.get(&self.current.0) {
            Some(&index) => index,
            None => {
                let count = self.obj.materials.len();
                let index = u16::try_from(count)
                    .ok()
                    .filter(|_| count < MAX_MATERIALS)?;
                self.obj.materials.push(self.current.clone());
                self.index_of.insert(self.current.0.clone(), index);
                index
            }
        };
        self.material = Some(index);
        Some(index)
    }
}

/// An index of a corner: [`NONE`] where absent or empty, `None` where not usable. Positive ones may point
/// forward in the file and are checked at its end.
fn index(word: Option<&[u8]>, so_far: usize) -> Option<u32> {
    let Some(word) = word.filter(|w| !w.is_empty()) else {
        return Some(NONE);
    };
    let from_zero = match integer(word)? {
        0 => return None,
        i @ 1.. => i - 1,
        i => i + i64::try_from(so_far).ok()?,
    };
    u32::try_from(from_zero).ok().filter(|&i| i != NONE)
}

fn is_freeform(keyword: &[u8]) -> bool {
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
fn is_display(keyword: &[u8]) -> bool {
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
