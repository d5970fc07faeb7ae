//! One map statement of a library: options on either side of a file name that may hold blanks.

use super::lookup::text_from_bytes;
use super::mtl::parse_number;

/// What a map statement is for. Others are known but not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MapKind {
    /// `map_Kd`.
    Albedo,
    /// `map_Bump`, `map_bump`, `bump`: heights in the format, normals in many files.
    Bump,
    /// `norm`: tangent-space normals.
    Norm,
    /// `disp`: displacement heights.
    Disp,
    /// `map_d`: opacity.
    Opacity,
    /// `map_Tr`: one minus opacity.
    Transparency,
}

impl MapKind {
    /// The kind of a keyword in lower case.
    pub(super) fn from_keyword(lower: &[u8]) -> Option<Self> {
        Some(match lower {
            b"map_kd" => Self::Albedo,
            b"map_bump" | b"bump" => Self::Bump,
            b"norm" | b"map_norm" | b"map_kn" => Self::Norm,
            b"disp" | b"map_disp" => Self::Disp,
            b"map_d" => Self::Opacity,
            b"map_tr" => Self::Transparency,
            _ => return None,
        })
    }
}

/// `-imfchan`: the number of a texel that a scalar map reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ImfChannel {
    /// Red, green or blue.
    Color(u8),
    /// `m`: matte, the alpha channel.
    Matte,
    /// `l`: luminance.
    Luma,
}

/// Options that change how a picture is read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MapOptions {
    /// `-bm`, finite.
    pub strength: Option<f32>,
    /// `-clamp on`.
    pub clamp: bool,
    /// `-s`, one where not given; finite.
    pub scale: [f32; 2],
    /// `-o`, zero where not given; finite.
    pub offset: [f32; 2],
    /// First number of `-mm`, finite.
    pub bias: f32,
    /// Second number of `-mm`, finite.
    pub gain: f32,
    /// `-imfchan`.
    pub channel: Option<ImfChannel>,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            strength: None,
            clamp: false,
            scale: [1.0; 2],
            offset: [0.0; 2],
            bias: 0.0,
            gain: 1.0,
            channel: None,
        }
    }
}

/// A picture that a material names.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MapStatement {
    /// From 1.
    pub line: usize,
    /// As written, for notes.
    pub keyword: String,
    /// What it is for.
    pub kind: MapKind,
    /// File name as written, never empty, options taken off.
    pub file: Vec<u8>,
    /// How to read it.
    pub options: MapOptions,
}

/// Reads what follows the keyword, comments already cut off. Also returns remarks on odd options.
///
/// # Errors
/// If there is no file name.
pub(super) fn parse_map(
    line: usize,
    keyword: String,
    kind: MapKind,
    rest: &[u8],
) -> Result<(MapStatement, Vec<String>), String> {
    let mut reader = OptionReader::new(rest);
    let name = reader.split();
    if unquoted(name).is_empty() {
        return Err(format!("{keyword} ignored: it names no file"));
    }
    let remarks = reader.remarks.iter().map(|r| format!("{keyword}: {r}"));
    let remarks = remarks.collect();
    let map = MapStatement {
        line,
        keyword,
        kind,
        file: name.to_vec(),
        options: reader.options,
    };
    Ok((map, remarks))
}

/// A name without one pair of quotes around it.
pub(super) fn unquoted(name: &[u8]) -> &[u8] {
    for quote in [b"\"", b"'"] {
        let inner = name.strip_prefix(quote).and_then(|n| n.strip_suffix(quote));
        if let Some(inner) = inner {
            return inner.trim_ascii();
        }
    }
    name.trim_ascii()
}

/// A blank-separated word by its place in the statement.
#[derive(Clone, Copy)]
struct Word<'a> {
    start: usize,
    text: &'a [u8],
}

struct OptionReader<'a> {
    text: &'a [u8],
    words: Vec<Word<'a>>,
    options: MapOptions,
    remarks: Vec<String>,
}

impl<'a> OptionReader<'a> {
    fn new(text: &'a [u8]) -> Self {
        let mut start = 0;
        let mut words = Vec::new();
        for word in text.split(u8::is_ascii_whitespace) {
            if !word.is_empty() {
                words.push(Word { start, text: word });
            }
            start += word.len() + 1;
        }
        Self {
            text,
            words,
            options: MapOptions::default(),
            remarks: Vec::new(),
        }
    }

    /// Takes the options off both ends and returns what is left between them.
    fn split(&mut self) -> &'a [u8] {
        let mut first = 0;
        while let Some(count) = self.option_length(first, self.words.len()) {
            self.apply(first, count);
            first += count;
        }
        let last = self.trailing_options(first);
        let mut at = last;
        while let Some(count) = self.option_length(at, self.words.len()) {
            self.apply(at, count);
            at += count;
        }
        let start = self.words.get(first).map_or(self.text.len(), |w| w.start);
        let end = self.words.get(last).map_or(self.text.len(), |w| w.start);
        self.text[start..end].trim_ascii()
    }

    /// The first word after the name from which on everything to the end is options.
    fn trailing_options(&self, first: usize) -> usize {
        let end = self.words.len();
        for start in first + 1..end {
            let mut at = start;
            while let Some(count) = self.option_length(at, end) {
                at += count;
            }
            if at == end {
                return start;
            }
        }
        end
    }

    /// Words of the option at `at`, itself included; `None` if there is none.
    fn option_length(&self, at: usize, end: usize) -> Option<usize> {
        let name = self.words.get(at)?.text;
        if name.len() < 2 || name[0] != b'-' || !name[1].is_ascii_alphabetic() {
            return None;
        }
        let argument = |i: usize| self.words[..end].get(at + 1 + i).map(|w| w.text);
        let numbers = |most: usize| {
            (0..most)
                .take_while(|&i| argument(i).is_some_and(|w| parse_number(w).is_some()))
                .count()
        };
        let arguments = match &name.to_ascii_lowercase()[1..] {
            b"o" | b"s" | b"t" => numbers(3),
            b"mm" => numbers(2),
            b"bm" | b"boost" | b"texres" => numbers(1),
            b"clamp" | b"blendu" | b"blendv" | b"cc" => {
                usize::from(argument(0).is_some_and(|w| switch(w).is_some()))
            }
            b"imfchan" => usize::from(argument(0).is_some_and(|w| w.len() == 1)),
            b"type" => usize::from(argument(0).is_some_and(is_projection)),
            // Something newer than this program. A dot makes it the name of a file.
            _ if name.contains(&b'.') || at + 1 == self.words.len() => return None,
            _ => numbers(3).max(usize::from(
                argument(0).is_some_and(|w| switch(w).is_some()),
            )),
        };
        Some(1 + arguments)
    }

    fn apply(&mut self, at: usize, count: usize) {
        let words: Vec<&[u8]> = self.words[at..at + count].iter().map(|w| w.text).collect();
        let name = text_from_bytes(words[0]);
        let arguments = &words[1..];
        let numbers: Vec<f32> = arguments.iter().filter_map(|w| parse_number(w)).collect();
        if numbers.iter().any(|x| !x.is_finite()) {
            self.remarks.push(format!("{name} is not finite, ignored"));
            return;
        }
        let options = &mut self.options;
        match (name.to_ascii_lowercase().as_str(), &numbers[..]) {
            ("-bm", &[x]) => options.strength = Some(x),
            // A scale for u alone leaves v as it is, as the format's defaults say.
            ("-s", &[u, ref more @ ..]) => options.scale = [u, more.first().map_or(1.0, |&v| v)],
            ("-o", &[u, ref more @ ..]) => options.offset = [u, more.first().map_or(0.0, |&v| v)],
            ("-mm", &[bias, gain]) => (options.bias, options.gain) = (bias, gain),
            ("-mm", &[bias]) => options.bias = bias,
            ("-clamp", _) if !arguments.is_empty() => {
                options.clamp = switch(arguments[0]) == Some(true);
            }
            ("-imfchan", _) if !arguments.is_empty() => self.channel(arguments[0]),
            // Filtering and memory hints of old renderers: nothing to tell.
            ("-blendu" | "-blendv" | "-boost" | "-texres" | "-type", _) => {}
            ("-cc", _) if arguments.first().is_some_and(|w| switch(w) == Some(false)) => {}
            ("-t", offsets) if offsets.iter().all(|&x| x == 0.0) && !offsets.is_empty() => {}
            ("-cc" | "-t", _) => self.remarks.push(format!("{name} is not used")),
            (known @ ("-bm" | "-s" | "-o" | "-mm" | "-clamp" | "-imfchan"), _) => {
                self.remarks
                    .push(format!("{known} lacks its value, ignored"));
            }
            _ => self.remarks.push(format!("unknown option {name}, ignored")),
        }
    }

    fn channel(&mut self, word: &[u8]) {
        self.options.channel = match word[0].to_ascii_lowercase() {
            b'r' => Some(ImfChannel::Color(0)),
            b'g' => Some(ImfChannel::Color(1)),
            b'b' => Some(ImfChannel::Color(2)),
            b'm' => Some(ImfChannel::Matte),
            b'l' => Some(ImfChannel::Luma),
            _ => {
                let name = text_from_bytes(word);
                self.remarks
                    .push(format!("-imfchan {name} is not read, luminance instead"));
                Some(ImfChannel::Luma)
            }
        };
    }
}

fn switch(word: &[u8]) -> Option<bool> {
    match &word.to_ascii_lowercase()[..] {
        b"on" => Some(true),
        b"off" => Some(false),
        _ => None,
    }
}

fn is_projection(word: &[u8]) -> bool {
    let lower = word.to_ascii_lowercase();
    lower == b"sphere" || lower == b"matte" || lower.starts_with(b"cube_")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(rest: &str) -> (String, MapOptions, Vec<String>) {
        let (map, remarks) =
            parse_map(1, "map_Kd".to_owned(), MapKind::Albedo, rest.as_bytes()).expect("a name");
        (text_from_bytes(&map.file), map.options, remarks)
    }

    #[test]
    fn options_on_either_side() {
        let expected = MapOptions {
            strength: Some(0.3),
            clamp: true,
            ..MapOptions::default()
        };
        for text in [
            "-bm 0.3 -clamp on my tex.png",
            "my tex.png -bm 0.3 -clamp on",
            "-clamp on my tex.png -bm 0.3",
        ] {
            let (name, options, remarks) = parsed(text);
            assert_eq!(name, "my tex.png", "{text}");
            assert_eq!(options, expected, "{text}");
            assert_eq!(remarks, [""; 0], "{text}");
        }
    }

    #[test]
    fn every_option_of_the_format() {
        let (name, options, remarks) = parsed(
            "-blendu on -blendv off -boost 2 -cc off -mm 0.1 0.9 -o 0.5 0.25 0 -s 2 3 1 -t 0 0 0 -texres 512 -imfchan m ../a.png",
        );
        assert_eq!(name, "../a.png");
        assert_eq!(remarks, [""; 0]);
        let expected = MapOptions {
            scale: [2.0, 3.0],
            offset: [0.5, 0.25],
            bias: 0.1,
            gain: 0.9,
            channel: Some(ImfChannel::Matte),
            ..MapOptions::default()
        };
        assert_eq!(options, expected);
    }

    #[test]
    fn numbers_that_are_left_out() {
        let (name, options, _) = parsed("-s 2 -o .5 a.png");
        assert_eq!(name, "a.png");
        assert_eq!(options.scale, [2.0, 1.0]);
        assert_eq!(options.offset, [0.5, 0.0]);
    }

    #[test]
    fn odd_names_and_options() {
        assert_eq!(parsed("wood - old.png").0, "wood - old.png");
        assert_eq!(parsed("-tex.png").0, "-tex.png");
        assert_eq!(parsed("\"a  b.png\"").0, "\"a  b.png\"");
        assert_eq!(parsed("C:\\x y\\a.png").0, "C:\\x y\\a.png");
        let (name, options, remarks) = parsed("-bm a.png");
        assert_eq!((name.as_str(), options.strength), ("a.png", None));
        assert_eq!(remarks.len(), 1);
        let (name, _, remarks) = parsed("-future 3 a.png");
        assert_eq!((name.as_str(), remarks.len()), ("a.png", 1));
        let (_, options, remarks) = parsed("-bm nan a.png");
        assert_eq!((options.strength, remarks.len()), (None, 1));
    }

    #[test]
    fn no_name_is_an_error() {
        for text in ["", "  ", "-bm 2", "\"\""] {
            let result = parse_map(1, "bump".to_owned(), MapKind::Bump, text.as_bytes());
            assert!(result.is_err(), "{text:?}");
        }
    }
}
