//! The mutator: a few changes of the kinds that break readers.

use reliefscope::measure::stability::Random;

use super::corpus::Entry;

/// Numbers at the ends of their types, in text.
const NUMBERS: [&str; 22] = [
    "0",
    "-0",
    "-1",
    "1",
    "nan",
    "inf",
    "-inf",
    "1e38",
    "1e39",
    "-1e308",
    "1e999",
    "1e-45",
    "1e-400",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "99999999999999999999",
    "0.1e",
    "1/1/1/1",
];

/// Words that mean something somewhere.
const WORDS: [&str; 24] = [
    "f",
    "v",
    "vt",
    "vn",
    "usemtl",
    "mtllib",
    "s",
    "newmtl",
    "map_Bump",
    "map_Kd",
    "norm",
    "-bm",
    "-s",
    "-o",
    "-mm",
    "-clamp",
    "map.png",
    "\\\n",
    "#",
    "\r",
    "\"",
    "[[light]]",
    "[camera]",
    "true",
];

/// No case grows beyond this.
const MAX_BYTES: usize = 1 << 16;

/// One to six changes of a sound file.
pub fn mutate(entry: &Entry, corpus: &[Entry], random: &mut Random) -> Vec<u8> {
    let mut bytes = entry.bytes.clone();
    for _ in 0..1 + random.below(6) {
        if entry.format.is_text() && random.below(2) == 0 {
            change_words(&mut bytes, random);
        } else {
            change_bytes(&mut bytes, corpus, random);
        }
        bytes.truncate(MAX_BYTES);
    }
    bytes
}

/// A place in the file, more often near its start, where headers are.
fn place(len: usize, random: &mut Random) -> usize {
    let end = if random.below(2) == 0 {
        len.min(64)
    } else {
        len
    };
    random.below(end.max(1)).min(len)
}

fn change_bytes(bytes: &mut Vec<u8>, corpus: &[Entry], random: &mut Random) {
    let at = place(bytes.len(), random);
    let rest = bytes.len() - at;
    let some = (1 + random.below(32)).min(rest);
    match random.below(8) {
        0 => bytes.truncate(at),
        1 => {
            bytes.drain(at..at + some);
        }
        2 => {
            let copy = bytes[at..at + some].to_vec();
            let copies = copy.repeat(1 + random.below(64));
            bytes.splice(at..at, copies);
        }
        3 => {
            let other = &corpus[random.below(corpus.len())].bytes;
            let from = place(other.len(), random);
            bytes.splice(at.., other[from..].iter().copied());
        }
        4 => {
            let noise: Vec<u8> = (0..some).map(|_| random.bits() as u8).collect();
            bytes.splice(at..at + some, noise);
        }
        5 => {
            // A length or an offset, in either order of bytes.
            let value = random.pick(&[0_u32, 1, 0x7f, 0xff, 0x7fff, 0xffff, 0x7fff_ffff, u32::MAX]);
            let (little, size) = (random.below(2) == 0, random.pick(&[1, 2, 4]));
            let mut raw = if little {
                value.to_le_bytes()
            } else {
                value.to_be_bytes()
            }
            .to_vec();
            if little {
                raw.truncate(size);
            } else {
                raw.drain(..4 - size);
            }
            let end = (at + size).min(bytes.len());
            bytes.splice(at..end, raw);
        }
        _ => {
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << random.below(8);
            }
        }
    }
}

/// Replaces, adds or doubles a word.
fn change_words(bytes: &mut Vec<u8>, random: &mut Random) {
    let is_blank =
        |b: &u8| b.is_ascii_whitespace() || matches!(b, b'/' | b',' | b'[' | b']' | b'=');
    let at = random.below(bytes.len().max(1)).min(bytes.len());
    let start = bytes[..at].iter().rposition(is_blank).map_or(0, |i| i + 1);
    let end = bytes[at..]
        .iter()
        .position(is_blank)
        .map_or(bytes.len(), |i| at + i);
    let new = match random.below(3) {
        0 => random.pick(&WORDS),
        _ => random.pick(&NUMBERS),
    };
    match random.below(4) {
        0 => {
            let added = [b" ", new.as_bytes(), b" "].concat();
            bytes.splice(at..at, added);
        }
        1 => {
            let line = bytes[at..]
                .iter()
                .position(|b| *b == b'\n')
                .map_or(bytes.len(), |i| at + i);
            let copy = bytes[start..line].repeat(1 + random.below(200));
            bytes.splice(line..line, copy);
        }
        _ => {
            bytes.splice(start..end.max(start), new.bytes());
        }
    }
}
