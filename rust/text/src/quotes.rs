//! Quotation marks: a stray one must not swallow the rows that follow.
//!
//! Within quotation marks a field may legally span lines: a spreadsheet writes remarks so. A stray mark opens a
//! field in the same way, and the field ends at whichever mark comes next. The text of the lines shows which of
//! the two it is: swallowed lines are rows of the table.

use memchr::memchr;

/// What encloses a field.
pub const MARK: u8 = b'"';

/// The quotation marks of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marks {
    /// Each closes what it opens.
    Whole,
    /// The line ends within a quoted field.
    Open,
    /// One is within a field.
    Wrong,
}

/// What is wrong with a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// It is within a field.
    Within,
    /// Nothing closes it.
    Open,
    /// Its field would have a line that looks like a row.
    Swallows,
    /// Its field goes on over more bytes than any.
    LongField,
    /// Nothing, but its line is longer than any.
    LongLine,
}

/// A line that is none of a table, with numbers of lines from 0 on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wrong {
    /// Why.
    pub fault: Fault,
    /// Where the row begins that it would belong to.
    pub first: usize,
    /// Its number.
    pub line: usize,
    /// Where that row ends.
    pub last: usize,
    /// Its text.
    pub text: Vec<u8>,
}

impl Wrong {
    /// A fault of one of the lines of a row.
    pub(crate) fn of(fault: Fault, row: &[&[u8]], line: usize) -> Self {
        Self {
            fault,
            first: 0,
            line,
            last: row.len() - 1,
            text: row[line].to_vec(),
        }
    }

    /// The same behind some lines.
    pub(crate) const fn behind(mut self, lines: usize) -> Self {
        self.first += lines;
        self.line += lines;
        self.last += lines;
        self
    }
}

/// Those of a line that begins within a quoted field or not.
#[must_use]
pub fn marks(line: &[u8], mut inside: bool, separator: u8) -> Marks {
    let mut at = 0;
    loop {
        if !inside {
            at = behind_blanks(line, at);
        }
        if inside || line.get(at) == Some(&MARK) {
            at += usize::from(!inside);
            inside = false;
            loop {
                let Some(length) = memchr(MARK, &line[at..]) else {
                    return Marks::Open;
                };
                at += length + 1;
                if line.get(at) != Some(&MARK) {
                    break;
                }
                at += 1;
            }
            if separator != b' ' {
                at = behind_blanks(line, at);
            }
            if line.get(at).is_some_and(|&byte| byte != separator) {
                return Marks::Wrong;
            }
        } else {
            at = memchr(separator, &line[at..]).map_or(line.len(), |length| at + length);
        }
        if at == line.len() {
            return Marks::Whole;
        }
        at += 1;
    }
}

/// Place behind the blanks at a place.
pub(crate) fn behind_blanks(line: &[u8], at: usize) -> usize {
    at + line[at..].iter().take_while(|&&byte| byte == b' ').count()
}

/// Place of the first line of a record that looks like a row of its own.
///
/// A row has a number wherever the record's first line has one; if that has none, wherever the usual row has one.
/// The last line of a closed record is not compared with the usual row: it ends with the record's own fields.
/// Where no row tells, the number of fields makes a row of a line of an open record. `table` is the separator, the
/// number of fields, and whether the record is closed.
#[must_use]
pub fn swallowed(record: &[&[u8]], usual: &[u8], table: (u8, usize, bool)) -> Option<usize> {
    let (separator, width, closed) = table;
    let numeric = |line: &[u8]| -> Vec<usize> {
        let fields = line.split(|&byte| byte == separator).enumerate();
        let numbers = fields.filter(|(_, field)| is_number(field));
        numbers.map(|(place, _)| place).collect()
    };
    if record.len() < 2 {
        return None;
    }
    let (own, others) = (numeric(record[0]), numeric(usual));
    (1..record.len()).find(|&place| {
        let usual_tells = place + 1 < record.len() || !closed;
        let places = match (own.is_empty(), usual_tells) {
            (false, _) => &own[..],
            (true, true) => &others[..],
            (true, false) => &[],
        };
        let fields: Vec<&[u8]> = record[place].split(|&byte| byte == separator).collect();
        let fit = |&at: &usize| match fields.get(at) {
            Some(field) => field.trim_ascii().is_empty() || is_number(field),
            None => true,
        };
        let tells = !places.is_empty() || (!closed && usual.is_empty());
        tells && fields.len() == width && places.iter().all(fit)
    })
}

/// Whether a field is meant as a number, with any decimal sign and quotation marks around it.
fn is_number(field: &[u8]) -> bool {
    let around = |byte: &u8| byte.is_ascii_whitespace() || *byte == MARK;
    let Some(begin) = field.iter().position(|byte| !around(byte)) else {
        return false;
    };
    let end = field
        .iter()
        .rposition(|byte| !around(byte))
        .map_or(begin, |at| at + 1);
    let text = &field[begin..end];
    let text = text
        .strip_prefix(b"-")
        .or_else(|| text.strip_prefix(b"+"))
        .unwrap_or(text);
    let size = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'.' | b',');
    let length = text.iter().take_while(|byte| size(byte)).count();
    let (mantissa, rest) = text.split_at(length);
    let exponent = match rest {
        [] => true,
        [b'e' | b'E', b'+' | b'-', digits @ ..] | [b'e' | b'E', digits @ ..] => {
            !digits.is_empty() && digits.iter().all(u8::is_ascii_digit)
        }
        _ => false,
    };
    exponent && mantissa.iter().any(u8::is_ascii_digit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_lines() {
        let known = [
            ("5,3", Marks::Whole),
            ("\"a, \"\"b\"\"\" , 5\" pipe", Marks::Whole),
            ("\"\"", Marks::Whole),
            ("1, \"a", Marks::Open),
            ("\"a\"\"", Marks::Open),
            ("\"a\"b,1", Marks::Wrong),
            ("", Marks::Whole),
        ];
        for (line, found) in known {
            assert_eq!(marks(line.as_bytes(), false, b','), found, "{line}");
        }
        assert_eq!(marks(b"b\",1", true, b','), Marks::Whole);
        assert_eq!(marks(b"1,2", true, b','), Marks::Open);
        assert_eq!(marks(b"\"1\",2", true, b','), Marks::Wrong);
    }

    #[test]
    fn numbers_with_any_sign() {
        for text in ["5", " \"-2,5\"", "1.000,5", "+.5e-3", "5E7 "] {
            assert!(is_number(text.as_bytes()), "{text}");
        }
        for text in ["", "\"\"", ".", "5e", "5e+", "a5", "5 5", "5e5.5"] {
            assert!(!is_number(text.as_bytes()), "{text}");
        }
    }

    #[test]
    fn rows_in_a_field() {
        let closed = (b',', 2, true);
        assert_eq!(swallowed(&[b"5,\"a", b"6,b", b"c\""], b"", closed), Some(1));
        assert_eq!(swallowed(&[b"5,\"a", b"x,b", b"c\""], b"", closed), None);
        assert_eq!(
            swallowed(&[b"a,\"a", b"6,b", b"c\""], b"5,x", closed),
            Some(1)
        );
        assert_eq!(swallowed(&[b"a,\"a", b"6,b\""], b"5,x", closed), None);
        assert_eq!(
            swallowed(&[b"a,\"a", b"6,b"], b"", (b',', 2, false)),
            Some(1)
        );
    }
}
