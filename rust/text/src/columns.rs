//! The numbers of some columns of a table.

use crate::bytes::{Needle, word};
use crate::fields::wanted;
use crate::lines::{Dialect, Kind, Scan};
use crate::number::{leading, of_field, of_word, trimmed};

/// How numbers are written.
#[derive(Clone, Copy, Debug)]
pub struct Numerals<'a> {
    /// The decimal sign.
    pub decimal: u8,
    /// Texts that mean "no value".
    pub absent: &'a [Vec<u8>],
}

impl Numerals<'_> {
    /// Number of a field; NaN where it means "no value", and none where it is neither.
    #[must_use]
    pub fn of(&self, field: &[u8]) -> Option<f64> {
        let text = trimmed(field);
        let is_absent = |text: &[u8]| self.absent.iter().any(|known| known == text);
        of_field(text, self.decimal)
            .filter(|_| !is_absent(text))
            .or_else(|| is_absent(text).then_some(f64::NAN))
    }
}

/// Numbers of a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// Row by row; NaN where a field means "no value".
    pub values: Vec<f64>,
    /// Whether each is an integer without a decimal sign.
    pub are_whole: bool,
}

impl Numbers {
    fn push(&mut self, number: f64, text: &[u8]) {
        self.values.push(number);
        self.are_whole = self.are_whole && is_integer(text);
    }
}

/// Numbers of the columns at some ascending places; none of a column with a field that is neither a number nor
/// means "no value".
///
/// # Examples
/// ```
/// # use echocal_text::{columns::{Numerals, numbers}, lines::{Dialect, Memory, scan}};
/// let dialect = Dialect { separator: b',', width: 3, ..Dialect::default() };
/// let text = b"5,a,2.5\n6,b,7\n";
/// let lines = scan(text, &dialect, &mut Memory::default(), true);
/// let found = numbers(text, &lines, &dialect, &[0, 1], Numerals { decimal: b'.', absent: &[] });
/// assert_eq!(found[0].as_ref().unwrap().values, [5.0, 6.0]);
/// assert_eq!(found[1], None);
/// ```
#[must_use]
pub fn numbers(
    data: &[u8],
    lines: &Scan,
    dialect: &Dialect,
    places: &[usize],
    numerals: Numerals<'_>,
) -> Vec<Option<Numbers>> {
    let separator = Needle::new(dialect.separator);
    let decimal = Needle::new(numerals.decimal);
    let rows = lines.rows().count();
    let empty = || Numbers {
        values: Vec::with_capacity(rows),
        are_whole: true,
    };
    let mut columns: Vec<_> = places.iter().map(|_| Some(empty())).collect();
    for (row, (begin, end, kind)) in lines.rows().enumerate() {
        if kind == Kind::Plain {
            let (mut at, mut before) = (begin, 0);
            for (&place, column) in places.iter().zip(&mut columns) {
                at = separator
                    .behind(data, at, end, place - before)
                    .unwrap_or(end);
                before = place;
                if let Some(own) = column {
                    match field(data, at, end, separator, decimal, numerals) {
                        Some((number, last)) => {
                            own.push(number, &data[at..last]);
                            at = last;
                        }
                        None => *column = None,
                    }
                }
            }
        } else {
            let text = &data[begin..end];
            wanted(text, kind, dialect.separator, places, |number, field| {
                let column = &mut columns[number];
                match (column.as_mut(), numerals.of(field)) {
                    (Some(own), Some(number)) => own.push(number, field),
                    _ => *column = None,
                }
            });
            for own in columns.iter_mut().flatten() {
                if own.values.len() == row {
                    own.push(f64::NAN, b"");
                }
            }
        }
    }
    columns
}

/// Number of the field that begins at a place, and the place behind it.
#[inline]
fn field(
    data: &[u8],
    at: usize,
    end: usize,
    separator: Needle,
    decimal: Needle,
    numerals: Numerals<'_>,
) -> Option<(f64, usize)> {
    if let Some(word) = word(data, at) {
        let behind = separator.hits(word).trailing_zeros() as usize / 8;
        let length = behind.min(end - at);
        if (length < 8 || at + 8 == end || data[at + 8] == separator.byte)
            && let Some(number) = of_word(word, length, decimal)
        {
            return Some((number, at + length));
        }
    }
    let text = &data[at..end];
    if let Some((number, length)) = leading(text, numerals.decimal)
        && text.get(length).is_none_or(|&byte| byte == separator.byte)
    {
        return Some((number, at + length));
    }
    let last = separator.first(data, at, end);
    Some((numerals.of(&data[at..last])?, last))
}

fn is_integer(field: &[u8]) -> bool {
    let text = trimmed(field);
    let digits = text.strip_prefix(b"-").or_else(|| text.strip_prefix(b"+"));
    let digits = digits.unwrap_or(text);
    !digits.is_empty() && digits.iter().all(u8::is_ascii_digit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::{Memory, scan};
    use proptest::prelude::*;

    fn found(text: &str, width: usize, places: &[usize]) -> Vec<Option<Vec<u64>>> {
        let absent = [b"".to_vec(), b"-".to_vec()];
        let numerals = Numerals {
            decimal: b'.',
            absent: &absent,
        };
        let dialect = Dialect {
            separator: b',',
            width,
            ..Dialect::default()
        };
        let lines = scan(text.as_bytes(), &dialect, &mut Memory::default(), true);
        let columns = numbers(text.as_bytes(), &lines, &dialect, places, numerals);
        let bits = |own: Numbers| own.values.into_iter().map(f64::to_bits).collect();
        columns.into_iter().map(|own| own.map(bits)).collect()
    }

    #[test]
    fn columns_that_are_integers() {
        let text = b"1,2.0,3,a\n-4, 5,,6\n";
        let dialect = Dialect {
            separator: b',',
            width: 4,
            ..Dialect::default()
        };
        let lines = scan(text, &dialect, &mut Memory::default(), true);
        let absent = [b"".to_vec()];
        let numerals = Numerals {
            decimal: b'.',
            absent: &absent,
        };
        let columns = numbers(text, &lines, &dialect, &[0, 1, 2, 3], numerals);
        let whole: Vec<_> = columns
            .iter()
            .map(|own| own.as_ref().map(|own| own.are_whole))
            .collect();
        assert_eq!(whole, [Some(true), Some(false), Some(false), None]);
    }

    /// Fields that are split by the library, and read one by one.
    fn simply(text: &str, width: usize, places: &[usize]) -> Vec<Option<Vec<u64>>> {
        let number = |field: &str| match field {
            "" | "-" => Some(f64::NAN.to_bits()),
            field => of_field(field.as_bytes(), b'.').map(f64::to_bits),
        };
        let rows: Vec<Vec<_>> = text.lines().map(|line| line.split(',').collect()).collect();
        places
            .iter()
            .map(|&place| {
                let fields = rows.iter().map(|row| {
                    let is_wide = row.iter().skip(width).any(|field| !field.is_empty());
                    number(row.get(place).filter(|_| !is_wide).unwrap_or(&""))
                });
                fields.collect()
            })
            .collect()
    }

    proptest! {
        #[test]
        fn the_same_as_field_by_field(
            rows in prop::collection::vec(
                "(-|nan|1|-2\\.5|1e3| 7|x|12345678901234567890),(|3|4\\.25),(5|\\.5|abcdefghijkl)(,6)?(,)?",
                1..6,
            ),
            width in 1_usize..6,
            wanted in prop::collection::btree_set(0_usize..5, 0..4),
        ) {
            let places: Vec<_> = wanted.into_iter().filter(|&place| place < width).collect();
            let text = rows.join("\n") + "\n";
            prop_assert_eq!(found(&text, width, &places), simply(&text, width, &places));
        }

        #[test]
        fn any_bytes_are_read_or_declined(
            data in prop::collection::vec(any::<u8>(), 0..40),
            width in 1_usize..4,
        ) {
            let text = String::from_utf8_lossy(&data);
            let _ = found(&text, width, &[0]);
        }
    }
}
