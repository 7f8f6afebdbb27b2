//! The rows of a text: where each begins and ends, and which lines are none.

use memchr::{memchr, memchr_iter, memchr2};

use crate::quotes::{Fault, MARK, Marks, Wrong, marks, swallowed};
use crate::row::{fits, width};

/// Bytes of a row with all its lines, beyond which it is none.
pub const LONGEST: usize = 1 << 22;

/// What stands in place of a sign within which a text is cut.
const NO_SIGN: &[u8] = "\u{fffd}".as_bytes();

/// How a table is written.
#[derive(Clone, Debug, Default)]
pub struct Dialect {
    /// What is between two fields.
    pub separator: u8,
    /// Fields of the header.
    pub width: usize,
    /// Whether a line that begins with # is a comment.
    pub comments: bool,
    /// Whether a line that begins with a brace is none of the table.
    pub braces: bool,
    /// Lines of the header: a logger that starts again writes them again.
    pub repeated: Vec<Vec<u8>>,
}

impl Dialect {
    fn is_no_row(&self, line: &[u8]) -> bool {
        (self.comments && line.first() == Some(&b'#'))
            || (self.braces && line.trim_ascii_start().first() == Some(&b'{'))
            || self.repeated.iter().any(|own| own == line)
    }

    /// Whether a line has blanks alone, none of which separates fields.
    fn is_blank(&self, line: &[u8]) -> bool {
        line.iter()
            .all(|&byte| matches!(byte, b' ' | b'\t') && byte != self.separator)
    }
}

/// What a line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// No row: blank, a comment, the header again.
    Other,
    /// A row with as many fields as the header, and no quotation mark.
    Plain,
    /// A row with quotation marks, fewer fields, or more that are empty.
    Odd,
    /// A row with more fields than the header.
    Wide,
    /// The last row, which is not whole.
    Cut,
}

/// A row with all its lines, or a line that is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// Place behind its text.
    pub end: u32,
    /// Place behind what ends it.
    pub next: u32,
    /// How many lines it has.
    pub count: u32,
    /// What it is.
    pub kind: Kind,
}

/// What the rows before tell about those that follow.
#[derive(Clone, Debug)]
pub struct Memory {
    /// The last line without quotation marks.
    usual: Vec<u8>,
    /// Whether the last row had as many fields as the header.
    complete: bool,
}

impl Default for Memory {
    fn default() -> Self {
        Self {
            usual: Vec::new(),
            complete: true,
        }
    }
}

/// The lines of a text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Scan {
    /// One behind the other.
    pub lines: Vec<Line>,
    /// What is wrong behind them.
    pub wrong: Option<Wrong>,
}

impl Scan {
    /// Each row: where its text begins and ends, and what it is.
    pub fn rows(&self) -> impl Iterator<Item = (usize, usize, Kind)> {
        self.spans()
            .map(|(begin, line)| (begin, line.end as usize, line.kind))
            .filter(|&(.., kind)| kind != Kind::Other)
    }

    /// Each line, with the place where it begins.
    pub fn spans(&self) -> impl Iterator<Item = (usize, Line)> {
        let mut begin = 0;
        self.lines.iter().map(move |&line| {
            let span = (begin, line);
            begin = line.next as usize;
            span
        })
    }
}

/// The whole lines at the beginning of a text of less than four gigabytes.
///
/// What is behind them may go on, unless the text is the `last`.
///
/// # Examples
/// ```
/// # use echocal_text::lines::{Dialect, Kind, Memory, scan};
/// let dialect = Dialect { separator: b',', width: 2, comments: true, ..Dialect::default() };
/// let found = scan(b"5,3\r\n#\n6\n7,", &dialect, &mut Memory::default(), false);
/// assert_eq!(found.rows().collect::<Vec<_>>(), [(0, 3, Kind::Plain), (7, 8, Kind::Odd)]);
/// ```
#[must_use]
pub fn scan(data: &[u8], dialect: &Dialect, memory: &mut Memory, last: bool) -> Scan {
    let ends = Ends {
        data,
        returns: memchr(b'\r', data).is_some(),
        last,
    };
    let is_marked = memchr(MARK, data).is_some();
    let (mut found, mut usual) = (Scan::default(), None);
    let (mut begin, mut number) = (0, 0);
    while let Some((end, next)) = ends.from(begin) {
        let text = &data[begin..end];
        let mut line = Line {
            end: place(end),
            next: place(next),
            count: 1,
            kind: Kind::Other,
        };
        if next - begin > LONGEST {
            found.wrong = Some(Wrong::of(Fault::LongLine, &[text], 0).behind(number));
            break;
        }
        let is_row = !dialect.is_no_row(text);
        if is_row && is_marked && memchr(MARK, text).is_some() {
            let before = usual.map_or(&memory.usual[..], |(begin, end)| &data[begin..end]);
            match record(&ends, begin, dialect, before) {
                Ok(Some(own)) => line = own,
                Ok(None) => break,
                Err(wrong) => {
                    found.wrong = Some(wrong.behind(number));
                    break;
                }
            }
        } else if is_row {
            usual = Some((begin, end));
            if !dialect.is_blank(text) {
                line.kind = unmarked(text, dialect);
            }
        }
        if line.kind != Kind::Other {
            let text = &data[begin..line.end as usize];
            let fields = match line.kind {
                Kind::Odd => width(text, dialect.separator),
                Kind::Plain => dialect.width,
                _ => usize::MAX,
            };
            let may_go_on = line.next == line.end && memory.complete && fields < dialect.width;
            if may_go_on || (text.ends_with(NO_SIGN) && line.kind != Kind::Wide) {
                line.kind = Kind::Cut;
            }
            memory.complete = fields == dialect.width;
        }
        begin = line.next as usize;
        number += line.count as usize;
        found.lines.push(line);
    }
    if let Some((begin, end)) = usual {
        memory.usual = data[begin..end].to_vec();
    }
    found
}

/// What a row without quotation marks is.
fn unmarked(text: &[u8], dialect: &Dialect) -> Kind {
    let separators = memchr_iter(dialect.separator, text).count();
    if dialect.separator != b' ' && separators + 1 == dialect.width {
        Kind::Plain
    } else {
        odd(text, dialect)
    }
}

fn odd(text: &[u8], dialect: &Dialect) -> Kind {
    if fits(text, dialect.separator, dialect.width) {
        Kind::Odd
    } else {
        Kind::Wide
    }
}

/// A row that begins with a line with quotation marks; none where it may go on behind the text.
fn record(
    ends: &Ends<'_>,
    begin: usize,
    dialect: &Dialect,
    usual: &[u8],
) -> Result<Option<Line>, Wrong> {
    let mut held: Vec<&[u8]> = Vec::new();
    let (mut behind, mut text) = (begin, &ends.data[begin..begin]);
    let swallowed = |held: &[&[u8]], is_closed| {
        swallowed(held, usual, (dialect.separator, dialect.width, is_closed))
    };
    let mut state = Marks::Open;
    while state == Marks::Open {
        let Some((end, next)) = ends.from(behind) else {
            break;
        };
        let own = &ends.data[behind..end];
        text = &ends.data[begin..end];
        behind = next;
        held.push(own);
        if behind - begin > LONGEST {
            return Err(Wrong::of(Fault::LongField, &held, 0));
        }
        state = marks(own, held.len() > 1, dialect.separator);
    }
    let kind = match state {
        Marks::Wrong => return Err(Wrong::of(Fault::Within, &held, held.len() - 1)),
        Marks::Whole => match swallowed(&held, true) {
            Some(line) => return Err(Wrong::of(Fault::Swallows, &held, line)),
            None => odd(text, dialect),
        },
        Marks::Open if !ends.last => return Ok(None),
        Marks::Open if swallowed(&held, false).is_some() => {
            return Err(Wrong::of(Fault::Open, &held, 0));
        }
        Marks::Open => match odd(text, dialect) {
            Kind::Odd => Kind::Cut,
            kind => kind,
        },
    };
    Ok(Some(Line {
        end: place(begin + text.len()),
        next: place(behind),
        count: place(held.len()),
        kind,
    }))
}

/// Where lines end: with a line feed, a carriage return, or both.
struct Ends<'a> {
    data: &'a [u8],
    returns: bool,
    last: bool,
}

impl Ends<'_> {
    /// Places behind the text of the line that begins at a place, and behind what ends it.
    fn from(&self, begin: usize) -> Option<(usize, usize)> {
        let rest = &self.data[begin..];
        let found = if self.returns {
            memchr2(b'\n', b'\r', rest)
        } else {
            memchr(b'\n', rest)
        };
        let Some(end) = found.map(|length| begin + length) else {
            let whole = self.last && !rest.is_empty();
            return whole.then_some((self.data.len(), self.data.len()));
        };
        match (self.data[end], self.data.get(end + 1)) {
            (b'\r', Some(b'\n')) => Some((end, end + 2)),
            (b'\r', None) if !self.last => None, // a line feed may follow
            _ => Some((end, end + 1)),
        }
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "texts are shorter than four gigabytes"
)]
const fn place(at: usize) -> u32 {
    at as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn dialect(width: usize) -> Dialect {
        Dialect {
            separator: b',',
            width,
            comments: true,
            braces: true,
            repeated: vec![b"a,b".to_vec()],
        }
    }

    fn kinds(text: &str) -> Vec<Kind> {
        let found = scan(text.as_bytes(), &dialect(2), &mut Memory::default(), true);
        assert_eq!(found.wrong, None, "{text:?}");
        found.lines.iter().map(|line| line.kind).collect()
    }

    #[test]
    fn what_lines_are() {
        use Kind::{Cut, Odd, Other, Plain, Wide};
        let text = "1,2\n\n# 5,6\n {\na,b\n \t\n\"1\",2\n1\n1,2,\n1,2,3\n1,\"a\nb\"\n,\n";
        let wanted = [
            Plain, Other, Other, Other, Other, Other, Odd, Odd, Odd, Wide, Odd, Plain,
        ];
        assert_eq!(kinds(text), wanted);
        assert_eq!(kinds("1,2\r3,4\r\n5,6\n"), [Plain; 3]);
        assert_eq!(kinds("1,2\n3"), [Plain, Cut]);
        assert_eq!(kinds("1\n3"), [Odd, Odd]);
        assert_eq!(kinds("1,2\nx,\"a\nb"), [Plain, Cut]);
        assert_eq!(kinds("1,2\n3,\u{fffd}"), [Plain, Cut]);
    }

    #[test]
    fn marks_that_are_wrong() {
        let known = [
            ("1,2\n3,\"a\"b\n", Fault::Within, [1, 1, 1], "3,\"a\"b"),
            ("1,2\n\n3,\"a\nb\"c\n", Fault::Within, [2, 3, 3], "b\"c"),
            ("1,2\n3,\"a\n5,6\n", Fault::Open, [1, 1, 2], "3,\"a"),
            ("1,\"a\n5,6\n7,8\"\n", Fault::Swallows, [0, 1, 2], "5,6"),
        ];
        for (text, fault, [first, line, last], shown) in known {
            let found = scan(text.as_bytes(), &dialect(2), &mut Memory::default(), true);
            let wanted = Wrong {
                fault,
                first,
                line,
                last,
                text: shown.into(),
            };
            assert_eq!(found.wrong, Some(wanted), "{text:?}");
        }
    }

    proptest! {
        #[test]
        fn pieces_are_the_whole(
            lines in prop::collection::vec("[a-c1,# ]{0,6}|a,b|1,\"x\"|x,\"y\nz\"|1,2", 0..9),
            ends in prop::collection::vec("\n|\r\n|\r", 9),
            cuts in prop::collection::vec(0_usize..60, 0..6),
        ) {
            let text: String = lines.iter().zip(&ends).flat_map(|(line, end)| [line.as_str(), end]).collect();
            let data = text.as_bytes();
            let whole = scan(data, &dialect(2), &mut Memory::default(), true);
            let (mut memory, mut begin, mut found) = (Memory::default(), 0, vec![]);
            let mut places: Vec<_> = cuts.iter().map(|&cut| cut.min(data.len())).collect();
            places.sort_unstable();
            places.push(data.len());
            for (number, &end) in places.iter().enumerate() {
                if end < begin {
                    continue;
                }
                let part = scan(&data[begin..end], &dialect(2), &mut memory, number + 1 == places.len());
                found.extend(part.spans().map(|(at, line)| (begin + at, line.count, line.kind)));
                begin += part.lines.last().map_or(0, |line| line.next as usize);
                if part.wrong.is_some() {
                    break;
                }
            }
            let wanted: Vec<_> = whole.spans().map(|(at, line)| (at, line.count, line.kind)).collect();
            prop_assert_eq!(found, wanted);
        }
    }
}
