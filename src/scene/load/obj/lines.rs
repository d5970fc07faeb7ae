//! Cuts a text file into logical lines and words, whatever wrote it.

/// Logical lines of a text: any of LF, CRLF or CR ends a line, a `\` at the end joins the next one, a
/// leading UTF-8 byte order mark is skipped.
///
/// A line that holds a comment ends where it ends: a path in a comment often closes with `\`.
pub(in crate::scene::load) struct Lines<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
    joined: Vec<u8>,
}

impl<'a> Lines<'a> {
    /// Starts at the beginning of a file's bytes.
    pub fn new(text: &'a [u8]) -> Self {
        Self {
            at: if text.starts_with(b"\xEF\xBB\xBF") {
                3
            } else {
                0
            },
            text,
            line: 0,
            joined: Vec::new(),
        }
    }

    /// Goes on inside a file, where a line begins and this many are before it.
    pub const fn inside(text: &'a [u8], lines_before: usize) -> Self {
        Self {
            at: 0,
            text,
            line: lines_before,
            joined: Vec::new(),
        }
    }

    /// Number of the last line handed out, or of the last of those that it joined.
    pub const fn number(&self) -> usize {
        self.line
    }

    /// The next logical line without its end, and the number (from 1) of the line it starts on.
    pub fn next(&mut self) -> Option<(usize, &[u8])> {
        let mut part = self.physical()?;
        let number = self.line;
        let Some(stripped) = continued(part) else {
            return Some((number, part));
        };
        self.joined.clear();
        self.joined.extend_from_slice(stripped);
        loop {
            self.joined.push(b' ');
            let Some(next) = self.physical() else { break };
            part = next;
            match continued(part) {
                Some(stripped) => self.joined.extend_from_slice(stripped),
                None => {
                    self.joined.extend_from_slice(part);
                    break;
                }
            }
        }
        Some((number, &self.joined))
    }

    fn physical(&mut self) -> Option<&'a [u8]> {
        let rest = self.text.get(self.at..).filter(|r| !r.is_empty())?;
        let length = line_length(rest);
        self.at += length + line_end(&rest[length..]);
        self.line += 1;
        Some(&rest[..length])
    }
}

/// Bytes before the first LF or CR. Eight at a time: every byte of a large file passes here twice.
fn line_length(text: &[u8]) -> usize {
    // The lowest set bit is in the first byte of `x` that is zero (Mycroft's test); higher ones may err.
    const ONES: u64 = u64::from_ne_bytes([1; 8]);
    let zeros = |x: u64| x.wrapping_sub(ONES) & !x & (ONES << 7);
    let (words, rest) = text.as_chunks::<8>();
    for (i, word) in words.iter().enumerate() {
        let word = u64::from_le_bytes(*word);
        let ends =
            zeros(word ^ (ONES * u64::from(b'\n'))) | zeros(word ^ (ONES * u64::from(b'\r')));
        if ends != 0 {
            return 8 * i + ends.trailing_zeros() as usize / 8;
        }
    }
    let is_end = |b: &u8| matches!(b, b'\n' | b'\r');
    8 * words.len() + rest.iter().position(is_end).unwrap_or(rest.len())
}

/// Bytes of the line end with which `text` begins: 0 at the end of the file.
fn line_end(text: &[u8]) -> usize {
    match text {
        [] => 0,
        [b'\r', b'\n', ..] => 2,
        [..] => 1,
    }
}

/// Where the first line begins that starts at `from` or later and surely continues none before it.
pub(in crate::scene::load) fn next_start(text: &[u8], from: usize) -> usize {
    let mut at = from;
    while at < text.len() {
        let end = at + line_length(&text[at..]);
        at = end + line_end(&text[end..]);
        // CR before `from` may be half of a CRLF.
        let line = &text[..end];
        if !line.strip_suffix(b"\r").unwrap_or(line).ends_with(b"\\") {
            break;
        }
    }
    at
}

/// The line without the `\` that joins it to the next one, if it has one.
fn continued(line: &[u8]) -> Option<&[u8]> {
    let stripped = line.strip_suffix(b"\\")?;
    (comment_start(line).is_none()).then_some(stripped)
}

fn comment_start(line: &[u8]) -> Option<usize> {
    (0..line.len()).find(|&i| line[i] == b'#' && (i == 0 || is_blank(line[i - 1])))
}

/// Whether a byte separates words.
pub(in crate::scene::load) const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0x0b | 0x0c | 0)
}

/// Without blanks at either end.
pub(in crate::scene::load) fn trim(mut text: &[u8]) -> &[u8] {
    while let [first, rest @ ..] = text
        && is_blank(*first)
    {
        text = rest;
    }
    while let [rest @ .., last] = text
        && is_blank(*last)
    {
        text = rest;
    }
    text
}

/// The statement's keyword and what follows it, both without blanks around them.
pub(in crate::scene::load) fn split_keyword(line: &[u8]) -> (&[u8], &[u8]) {
    let line = trim(line);
    let end = line.iter().position(|&b| is_blank(b)).unwrap_or(line.len());
    (&line[..end], trim(&line[end..]))
}

/// A name: everything up to a `#` that follows a blank. Names may hold spaces and any byte.
pub(in crate::scene::load) fn name(rest: &[u8]) -> &[u8] {
    trim(&rest[..comment_start(rest).unwrap_or(rest.len())])
}

/// Words of a statement that holds numbers only, up to any `#`.
pub(in crate::scene::load) struct Words<'a>(pub &'a [u8]);

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        while let [first, rest @ ..] = self.0
            && is_blank(*first)
        {
            self.0 = rest;
        }
        let end = self
            .0
            .iter()
            .position(|&b| is_blank(b) || b == b'#')
            .unwrap_or(self.0.len());
        let (word, rest) = self.0.split_at(end);
        self.0 = rest;
        (!word.is_empty()).then_some(word)
    }
}

/// Bytes as shown in a message: invalid UTF-8 replaced, control characters too, cut after 40 characters.
pub(in crate::scene::load) fn shown(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]);
    let mut short: String = text
        .chars()
        .take(40)
        .map(|c| if c.is_control() { '\u{FFFD}' } else { c })
        .collect();
    if text.chars().nth(40).is_some() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> Vec<(usize, String)> {
        let mut lines = Lines::new(text);
        let mut all = Vec::new();
        while let Some((number, line)) = lines.next() {
            all.push((number, String::from_utf8_lossy(line).into_owned()));
        }
        all
    }

    #[test]
    fn every_line_end_counts_once() {
        let expected = vec![(1, "a".into()), (2, String::new()), (3, "b".into())];
        for text in ["a\n\nb", "a\r\n\r\nb\r\n", "a\r\rb\r", "\u{FEFF}a\n\nb\n"] {
            assert_eq!(lines(text.as_bytes()), expected, "{text:?}");
        }
    }

    #[test]
    fn continuations_join_and_keep_the_first_number() {
        let got = lines(b"f 1 \\\r\n2 \\\n3\nv\\");
        assert_eq!(got, vec![(1, "f 1  2  3".into()), (4, "v ".into())]);
        // A path in a comment does not swallow the next line.
        assert_eq!(lines(b"# C:\\models\\\nv 1").len(), 2);
    }

    #[test]
    fn ends_are_found_wherever_they_are_in_a_word() {
        for length in 0..40 {
            // 0x0b and 0x8a differ from the line ends by one bit.
            let mut text: Vec<u8> = [0x0b, 0x8a, b'x']
                .into_iter()
                .cycle()
                .take(length)
                .collect();
            assert_eq!(line_length(&text), length);
            text.extend_from_slice(b"\nxxxx\r\nxxxx\n");
            assert_eq!(line_length(&text), length);
        }
    }

    #[test]
    fn a_start_is_never_inside_a_continued_line() {
        let text = b"a\\\r\nb\\\nc\nd\r\n";
        let starts: Vec<_> = (0..text.len()).map(|from| next_start(text, from)).collect();
        assert_eq!(&starts[..9], [9; 9]);
        assert_eq!(&starts[9..], [12; 3]);
    }

    #[test]
    fn words_stop_at_comments_and_names_keep_hashes_inside_words() {
        assert_eq!(Words(b"\t1  2\t3#x").count(), 3);
        assert_eq!(name(b"red#2 wall # note"), b"red#2 wall");
        assert_eq!(split_keyword(b"  f\t1 2 "), (&b"f"[..], &b"1 2"[..]));
    }
}
