//! The numbers of some columns of a table.

use crate::bytes::{Needle, word};
use crate::lines::spans;
use crate::number::{leading, of_field, of_word};

/// How the fields of a table are written.
#[derive(Clone, Copy, Debug)]
pub struct Dialect<'a> {
    /// What is between two fields.
    pub separator: u8,
    /// The decimal sign.
    pub decimal: u8,
    /// Fields of each line.
    pub width: usize,
    /// Texts that mean "no value"; none of them is a number.
    pub absent: &'a [Vec<u8>],
}

/// Numbers of the columns at some ascending places, row by row; NaN where a field means "no value".
///
/// None where a line has more fields or fewer, or one of these fields is neither. No field is enclosed in
/// quotation marks. `ends` and `ending` are of [`crate::lines`].
///
/// # Examples
/// ```
/// # use echocal_text::columns::{Dialect, numbers};
/// let absent = [b"".to_vec()];
/// let dialect = Dialect { separator: b',', decimal: b'.', width: 3, absent: &absent };
/// let found = numbers(b"5,a,2.5\n6,b,7\n", &[8, 14], 1, &[0, 2], dialect);
/// assert_eq!(found, Some(vec![vec![5.0, 6.0], vec![2.5, 7.0]]));
/// ```
#[must_use]
pub fn numbers(
    data: &[u8],
    ends: &[u32],
    ending: usize,
    places: &[usize],
    dialect: Dialect<'_>,
) -> Option<Vec<Vec<f64>>> {
    let separator = Needle::new(dialect.separator);
    let decimal = Needle::new(dialect.decimal);
    let mut columns = vec![vec![0.0; ends.len()]; places.len()];
    let mut steps: Vec<(usize, &mut [f64])> = Vec::with_capacity(places.len());
    let mut next = 0;
    for (&place, column) in places.iter().zip(&mut columns) {
        steps.push((place.checked_sub(next)?, column)); // separators before it
        next = place + 1;
    }
    let rest = dialect.width.checked_sub(next)?;
    for (row, (begin, end)) in spans(ends, ending).enumerate() {
        let mut at = begin;
        let mut last = begin; // behind the last field that was read, which has no separator yet
        for (first, (before, column)) in steps.iter_mut().enumerate() {
            at = separator.behind(data, at, end, *before)?;
            if at > end {
                return None;
            }
            (column[row], last) = field(data, at, end, separator, decimal, dialect)?;
            at = last + 1;
            let more = first + 1 < places.len();
            if more && last == end {
                return None; // no separator behind it
            }
        }
        if places.is_empty() {
            at = separator.behind(data, at, end, rest.checked_sub(1)?)?;
        } else if rest == 0 {
            if last != end {
                return None;
            }
            continue;
        } else {
            at = separator.behind(data, last, end, rest)?;
        }
        if at > end || separator.first(data, at, end) != end {
            return None;
        }
    }
    Some(columns)
}

/// Number of the field that begins at a place, and the place behind it.
#[inline]
fn field(
    data: &[u8],
    at: usize,
    end: usize,
    separator: Needle,
    decimal: Needle,
    dialect: Dialect<'_>,
) -> Option<(f64, usize)> {
    if let Some(word) = word(data, at) {
        let behind = separator.hits(word).trailing_zeros() as usize / 8;
        let length = behind.min(end - at);
        if (length < 8 || at + 8 == end || data[at + 8] == dialect.separator)
            && let Some(number) = of_word(word, length, decimal)
        {
            return Some((number, at + length));
        }
    }
    let text = data.get(at..end)?;
    if let Some((number, length)) = leading(text, dialect.decimal)
        && text
            .get(length)
            .is_none_or(|&byte| byte == dialect.separator)
    {
        return Some((number, at + length));
    }
    let last = separator.first(data, at, end);
    let text = &data[at..last];
    let number = match of_field(text, dialect.decimal) {
        Some(number) => number,
        None if dialect.absent.iter().any(|known| known == text) => f64::NAN,
        None => return None,
    };
    Some((number, last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines;
    use proptest::prelude::*;

    fn found(text: &str, width: usize, places: &[usize]) -> Option<Vec<Vec<f64>>> {
        let absent = [b"".to_vec(), b"nan".to_vec()];
        let dialect = Dialect {
            separator: b',',
            decimal: b'.',
            width,
            absent: &absent,
        };
        let ends = lines::ends(text.as_bytes(), false)?;
        numbers(text.as_bytes(), &ends, 1, places, dialect)
    }

    #[test]
    fn rows_that_do_not_fit() {
        for text in [
            "1\n",
            "1,2,3\n",
            "1,2\n3\n4,5\n",
            "1\n2,3\n",
            "1,x\n",
            "1 2,3\n",
        ] {
            assert_eq!(found(text, 2, &[0, 1]), None, "{text:?}");
        }
        for text in ["1\n", "1,2,3\n", "1,2\n3\n4,5\n", "1\n2,3\n"] {
            for places in [&[][..], &[0], &[1]] {
                assert_eq!(found(text, 2, places), None, "{text:?} {places:?}");
            }
        }
        assert_eq!(found("1,2\n", 2, &[1, 0]), None);
        assert_eq!(found("1,2\n", 2, &[2]), None);
        assert_eq!(found("1,2\n", 2, &[]), Some(vec![]));
    }

    #[test]
    fn no_value_is_not_a_number() {
        let columns = found(",nan\n1,\n", 2, &[0, 1]).unwrap();
        assert!(columns[0][0].is_nan() && columns[1][0].is_nan() && columns[1][1].is_nan());
        assert_eq!(columns[0][1].to_bits(), 1.0_f64.to_bits());
    }

    /// Fields that are split by the library, and read one by one.
    fn simply(text: &str, width: usize, places: &[usize]) -> Option<Vec<Vec<u64>>> {
        let mut columns = vec![vec![]; places.len()];
        for line in text.lines() {
            let fields: Vec<_> = line.split(',').collect();
            if fields.len() != width {
                return None;
            }
            for (column, &place) in columns.iter_mut().zip(places) {
                column.push(match fields[place] {
                    "" | "nan" => f64::NAN.to_bits(),
                    field => of_field(field.as_bytes(), b'.')?.to_bits(),
                });
            }
        }
        Some(columns)
    }

    proptest! {
        #[test]
        fn the_same_as_field_by_field(
            rows in prop::collection::vec(
                "(|nan|1|-2\\.5|1e3| 7|x|12345678901234567890),(|3|4\\.25),(5|\\.5|abcdefghijkl)(,6)?(,)?",
                1..6,
            ),
            width in 1_usize..6,
            wanted in prop::collection::btree_set(0_usize..5, 0..4),
        ) {
            let places: Vec<_> = wanted.into_iter().filter(|&place| place < width).collect();
            let text = rows.join("\n") + "\n";
            let bits = |columns: Vec<Vec<f64>>| -> Vec<Vec<u64>> {
                let column = |column: &Vec<f64>| column.iter().map(|number| number.to_bits()).collect();
                columns.iter().map(column).collect()
            };
            prop_assert_eq!(found(&text, width, &places).map(bits), simply(&text, width, &places));
        }

        #[test]
        fn any_bytes_are_read_or_declined(
            data in prop::collection::vec(any::<u8>(), 0..40),
            width in 0_usize..4,
        ) {
            let absent = [vec![]];
            let dialect = Dialect { separator: b',', decimal: b'.', width, absent: &absent };
            let mut data = data;
            data.push(b'\n');
            if let Some(ends) = lines::ends(&data, false) {
                let _ = numbers(&data, &ends, 1, &[0], dialect);
            }
        }
    }
}
