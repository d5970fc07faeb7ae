//! Statements of an OBJ file, one by one.

use std::collections::HashMap;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use super::chunks::{Chunk, Count};
use super::keywords::{is_display, is_freeform};
use super::lines::{Words, is_blank, name, shown, split_keyword};
use super::notes::Kind;
use super::number::{float, integer};
use super::part::{Part, PartSpan, UsedMaterial, too_many_vertices};
use super::{Corner, Face, NONE, Smoothing};
use crate::scene::LoadError;
use crate::scene::load::{LibraryRef, MAX_NAME};

/// The first word of a face with a bad index of each kind.
#[derive(Default)]
struct BadWords<'a> {
    v: Option<&'a [u8]>,
    vt: Option<&'a [u8]>,
    vn: Option<&'a [u8]>,
}

/// Reads the statements of a chunk; a `usemtl` or `s` holds until the next.
pub(super) struct Parser<'a> {
    path: &'a Path,
    /// What the file holds before the chunk.
    before: Count,
    part: Part,
    /// Index of the material in force, once a face uses it.
    material: Option<u32>,
    index_of: HashMap<Option<Vec<u8>>, u32>,
}

impl<'a> Parser<'a> {
    /// Reads a chunk of the file at `path`. Only limits that cannot be lifted are errors.
    pub fn read(path: &'a Path, chunk: &Chunk<'_>) -> Result<Part, LoadError> {
        let holds = &chunk.holds;
        let mut parser = Self {
            path,
            before: chunk.before,
            part: Part {
                positions: Vec::with_capacity(holds.positions),
                uvs: Vec::with_capacity(holds.uvs),
                normals: Vec::with_capacity(holds.normals),
                corners: Vec::with_capacity(holds.faces * 3),
                faces: Vec::with_capacity(holds.faces),
                ..Part::default()
            },
            material: None,
            index_of: HashMap::new(),
        };
        let mut lines = chunk.lines();
        while let Some((number, line)) = lines.next() {
            parser.statement(number, line)?;
        }
        Ok(parser.part)
    }

    fn statement(&mut self, line: usize, text: &[u8]) -> Result<(), LoadError> {
        let (keyword, rest) = split_keyword(text);
        match keyword {
            b"v" => self.vertex(line, rest),
            b"vt" => self.texture_coordinate(line, rest),
            b"vn" => self.normal(line, rest),
            b"f" | b"fo" => self.face(line, rest)?,
            b"s" => self.smoothing(line, rest),
            b"usemtl" => {
                let name = &rest[..rest.len().min(MAX_NAME)];
                self.part.usemtl = Some((name.to_vec(), line));
                self.material = None;
            }
            b"mtllib" => self.part.libraries.push(LibraryRef {
                name: rest.to_vec(),
                model: self.path.to_owned(),
                line,
            }),
            b"l" => self.part.notes.count(Kind::Line, line),
            b"p" => self.part.notes.count(Kind::Point, line),
            b"" | b"g" | b"o" => {}
            _ if keyword[0] == b'#' => {}
            _ if is_freeform(keyword) => self.part.notes.count(Kind::Freeform, line),
            _ if is_display(keyword) => {}
            _ => self.part.notes.add(Kind::Unknown, line, || {
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
        self.part.notes.add(Kind::Number, line, || {
            format!("{what}, got '{}'", shown(name(rest)))
        });
    }

    fn vertex(&mut self, line: usize, rest: &[u8]) {
        let mut words = Words(rest);
        let position = if let [Some(x), Some(y), Some(z)] = Self::numbers(&mut words) {
            // One more word is a weight, three or four are a colour.
            if !words.0.is_empty() && words.nth(2).is_some() {
                self.part.notes.count(Kind::VertexColor, line);
            }
            DVec3::new(x, y, z)
        } else {
            self.bad_number(line, rest, "a vertex needs three finite numbers");
            DVec3::NAN
        };
        self.part.positions.push(position);
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
        self.part.uvs.push(uv.unwrap_or(Vec2::NAN));
    }

    fn normal(&mut self, line: usize, rest: &[u8]) {
        let normal = if let [Some(x), Some(y), Some(z)] = Self::numbers(&mut Words(rest)) {
            let unit = DVec3::new(x, y, z).normalize_or_zero().as_vec3();
            if unit == Vec3::ZERO {
                self.part.notes.count(Kind::ZeroNormal, line);
            }
            unit
        } else {
            self.bad_number(line, rest, "a normal needs three finite numbers");
            Vec3::ZERO
        };
        self.part.normals.push(normal);
    }

    fn smoothing(&mut self, line: usize, rest: &[u8]) {
        let word = name(rest);
        let smoothing = match (word, integer(word).map(u32::try_from)) {
            (b"off" | b"OFF" | b"Off", _) | (_, Some(Ok(0))) => Smoothing::Off,
            (b"on" | b"ON" | b"On", _) => Smoothing::Group(1),
            (_, Some(Ok(group))) => Smoothing::Group(group),
            _ => {
                self.bad_number(line, rest, "a smoothing group is a number or 'off'");
                return;
            }
        };
        self.part.smoothing = Some(smoothing);
    }

    fn face(&mut self, line: usize, rest: &[u8]) -> Result<(), LoadError> {
        let start = self.part.corners.len();
        let mut bad = BadWords::default();
        let mut words = Words(rest);
        loop {
            if let Some((corner, behind)) = plain_corner(words.0) {
                self.part.corners.push(corner);
                words.0 = behind;
            } else if let Some(word) = words.next() {
                self.corner(word, &mut bad);
            } else {
                break;
            }
        }
        let notes = &mut self.part.notes;
        let too_few = self.part.corners.len() - start < 3;
        if too_few || bad.v.is_some() {
            self.part.corners.truncate(start);
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
        let (before, part) = (&self.before, &mut self.part);
        let corner = Corner {
            v: next(before.positions + part.positions.len(), &mut bad.v),
            vt: next(before.uvs + part.uvs.len(), &mut bad.vt),
            vn: next(before.normals + part.normals.len(), &mut bad.vn),
        };
        if corner.v == NONE {
            bad.v.get_or_insert(word);
        }
        part.corners.push(corner);
    }

    /// Notes the face whose corners were added, with the state in force.
    fn finish_face(&mut self, line: usize) -> Result<(), LoadError> {
        let material = match self.material {
            Some(index) => index,
            None => self.material_index(line),
        };
        let part = &mut self.part;
        let vertices = self.before.positions + part.positions.len();
        let end = u32::try_from(part.corners.len())
            .ok()
            .filter(|_| vertices < NONE as usize)
            .ok_or_else(|| too_many_vertices(self.path, line))?;
        let span = PartSpan {
            first: part.faces.len(),
            material,
            smoothing: part.smoothing,
        };
        let goes_on =
            |last: &PartSpan| last.material == material && last.smoothing == span.smoothing;
        if !part.spans.last().is_some_and(goes_on) {
            part.spans.push(span);
        }
        part.faces.push(Face {
            end,
            line: u32::try_from(line).unwrap_or(u32::MAX),
        });
        Ok(())
    }

    /// Index of the material in force, new or known.
    fn material_index(&mut self, line: usize) -> u32 {
        let part = &mut self.part;
        let name = part.usemtl.as_ref().map(|(name, _)| name);
        let next = part.materials.len() as u32;
        let index = *self.index_of.entry(name.cloned()).or_insert(next);
        if index == next {
            part.materials.push(UsedMaterial {
                usemtl: part.usemtl.clone(),
                first_face: line,
            });
        }
        self.material = Some(index);
        index
    }
}

/// The corner that comes next, and what is behind it, where it is written as most are: `1`, `1/2`, `1//3` or
/// `1/2/3` with short positive numbers. `None` does not mean that anything is wrong.
#[inline(always)]
fn plain_corner(text: &[u8]) -> Option<(Corner, &[u8])> {
    let blanks = text.iter().take_while(|b| is_blank(**b)).count();
    let (v, rest) = plain_index(&text[blanks..])?;
    let (mut vt, mut vn, mut rest) = (NONE, NONE, rest);
    if let [b'/', behind @ ..] = rest {
        (vt, rest) = plain_index(behind)?;
        if let [b'/', behind @ ..] = rest {
            (vn, rest) = plain_index(behind)?;
        }
    }
    let ends = rest.first().is_none_or(|b| is_blank(*b));
    (v != NONE && ends).then_some((Corner { v, vt, vn }, rest))
}

/// An index from 1 of up to nine digits as one from 0, or [`NONE`] where there is no digit; and what is behind.
#[inline(always)]
fn plain_index(text: &[u8]) -> Option<(u32, &[u8])> {
    let (mut value, mut length) = (0, 0);
    while let Some(digit) = text.get(length).map(|b| b.wrapping_sub(b'0'))
        && digit < 10
    {
        if length == 9 {
            return None;
        }
        value = value * 10 + u32::from(digit);
        length += 1;
    }
    let index = match (length, value) {
        (0, _) => NONE,
        (_, 0) => return None,
        (_, from_one) => from_one - 1,
    };
    Some((index, &text[length..]))
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
