//! The fields of some columns as texts, without the quotation marks around them.

use memchr::memchr;

use crate::lines::spans;
use crate::number::of_field;

const MARK: u8 = b'"';

/// The fields of one column, one behind the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Texts {
    /// Their bytes.
    pub data: Vec<u8>,
    /// Where each begins, and where the last one ends.
    pub bounds: Vec<i32>,
}

impl Texts {
    fn close(&mut self) -> Option<()> {
        self.bounds.push(i32::try_from(self.data.len()).ok()?);
        Some(())
    }

    /// Numbers; NaN where a field means "no value", and none at all where one is neither.
    #[must_use]
    pub fn numbers(&self, decimal: u8, absent: &[Vec<u8>]) -> Option<Vec<f64>> {
        let fields = self.bounds.windows(2).map(|pair| {
            let [begin, end] = [pair[0], pair[1]].map(|place| usize::try_from(place).unwrap_or(0));
            &self.data[begin..end]
        });
        let number = |field: &[u8]| match of_field(field, decimal) {
            None if absent.iter().any(|known| known == field) => Some(f64::NAN),
            found => found,
        };
        fields.map(number).collect()
    }
}

/// Fields of the columns at some ascending places.
///
/// Blanks before a field are no part of it. None where a line has more fields or fewer than `width`, or a
/// quoted field does not end with its mark. `ends` and `ending` are of [`crate::lines`].
///
/// # Examples
/// ```
/// # use echocal_text::fields::texts;
/// let found = texts(b"5,\"a, \"\"b\"\"\"\n6, c\n", &[13, 18], 1, &[1], b',', 2).unwrap();
/// assert_eq!(found[0].data, b"a, \"b\"c");
/// assert_eq!(found[0].bounds, [0, 6, 7]);
/// ```
#[must_use]
pub fn texts(
    data: &[u8],
    ends: &[u32],
    ending: usize,
    places: &[usize],
    separator: u8,
    width: usize,
) -> Option<Vec<Texts>> {
    let fit = places.is_sorted_by(|one, next| one < next)
        && places.last().is_none_or(|&last| last < width);
    if !fit || separator == b' ' || separator == MARK {
        return None;
    }
    let empty = Texts {
        data: Vec::new(),
        bounds: vec![0],
    };
    let mut columns = vec![empty; places.len()];
    for (begin, end) in spans(ends, ending) {
        let line = &data[begin..end];
        let (mut at, mut place) = (0, 0);
        let mut wanted = places.iter().copied().zip(&mut columns).peekable();
        loop {
            let own = wanted.next_if(|&(own, _)| own == place);
            at = field(line, at, separator, own.map(|(_, column)| column))?;
            place += 1;
            if at == line.len() {
                break;
            }
            at += 1;
        }
        if place != width {
            return None;
        }
    }
    Some(columns)
}

/// Append the field that begins at a place; the place behind it.
fn field(line: &[u8], at: usize, separator: u8, mut column: Option<&mut Texts>) -> Option<usize> {
    let mut keep = |part: &[u8]| {
        if let Some(own) = &mut column {
            own.data.extend_from_slice(part);
        }
    };
    let mut at = at + line[at..].iter().take_while(|&&byte| byte == b' ').count();
    if line.get(at) == Some(&MARK) {
        loop {
            at += 1;
            let mark = at + memchr(MARK, &line[at..])?;
            keep(&line[at..mark]);
            at = mark + 1;
            if line.get(at) != Some(&MARK) {
                break;
            }
            keep(&[MARK]);
        }
        if at < line.len() && line[at] != separator {
            return None;
        }
    } else {
        let end = memchr(separator, &line[at..]).map_or(line.len(), |length| at + length);
        keep(&line[at..end]);
        at = end;
    }
    if let Some(own) = column {
        own.close()?;
    }
    Some(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::{Dialect, numbers};
    use crate::lines;
    use proptest::prelude::*;

    fn found(text: &str, width: usize, places: &[usize]) -> Option<Vec<Vec<String>>> {
        let ends = lines::ends(text.as_bytes(), false)?;
        let columns = texts(text.as_bytes(), &ends, 1, places, b',', width)?;
        let plain = |own: &Texts| {
            let cut = |pair: &[i32]| own.data[pair[0] as usize..pair[1] as usize].to_vec();
            own.bounds
                .windows(2)
                .map(|pair| String::from_utf8(cut(pair)).unwrap())
                .collect()
        };
        Some(columns.iter().map(plain).collect())
    }

    #[test]
    fn fields_with_marks() {
        let text = "\"5\", \"a,b\",\n\"\"\"\",\"\", 7 \n";
        let wanted = [["5", "\""], ["a,b", ""], ["", "7 "]];
        assert_eq!(
            found(text, 3, &[0, 1, 2]).unwrap(),
            wanted.map(|own| own.map(String::from).to_vec())
        );
        assert_eq!(
            found("5\" pipe,1\n", 2, &[0]).unwrap(),
            [["5\" pipe".to_owned()]]
        );
    }

    #[test]
    fn lines_that_do_not_fit() {
        for text in [
            "1\n",
            "1,2,3\n",
            "1,2\n3\n",
            "\"1,2\n",
            "\"1\" ,2\n",
            "\"1\"2,3\n",
        ] {
            assert_eq!(found(text, 2, &[0]), None, "{text:?}");
            assert_eq!(found(text, 2, &[]), None, "{text:?}");
        }
        assert_eq!(found("1,2\n", 2, &[2]), None);
        assert_eq!(found("1,2\n", 2, &[1, 0]), None);
    }

    proptest! {
        #[test]
        fn numbers_are_those_of_the_scan_by_words(
            rows in prop::collection::vec("(|nan|1|-2\\.5|1e3|12345678901234567890|x),(|3|4\\.25)(,6)?", 1..6),
            width in 1_usize..4,
        ) {
            let text = rows.join("\n") + "\n";
            let absent = [b"".to_vec(), b"nan".to_vec()];
            let ends = lines::ends(text.as_bytes(), false).unwrap();
            let dialect = Dialect { separator: b',', decimal: b'.', width, absent: &absent };
            let places: Vec<_> = (0..width.min(2)).collect();
            let quick = numbers(text.as_bytes(), &ends, 1, &places, dialect);
            let slow = texts(text.as_bytes(), &ends, 1, &places, b',', width).and_then(|columns| {
                columns.iter().map(|own| own.numbers(b'.', &absent)).collect::<Option<Vec<_>>>()
            });
            let bits = |columns: Vec<Vec<f64>>| -> Vec<Vec<u64>> {
                columns.into_iter().map(|own| own.into_iter().map(f64::to_bits).collect()).collect()
            };
            prop_assert_eq!(quick.map(bits), slow.map(bits));
        }

        #[test]
        fn marks_around_a_field_are_taken_away(fields in prop::collection::vec("[a\", ]{0,4}", 1..5)) {
            let quoted: Vec<_> = fields.iter().map(|own| format!("\"{}\"", own.replace('"', "\"\""))).collect();
            let places: Vec<_> = (0..fields.len()).collect();
            let text = quoted.join(",") + "\n";
            let wanted: Vec<_> = fields.iter().map(|own| vec![own.clone()]).collect();
            prop_assert_eq!(found(&text, fields.len(), &places), Some(wanted));
        }

        #[test]
        fn any_bytes_are_read_or_declined(data in prop::collection::vec(any::<u8>(), 0..40), width in 0_usize..4) {
            let mut data = data;
            data.push(b'\n');
            if let Some(ends) = lines::ends(&data, false) {
                let _ = texts(&data, &ends, 1, &[0], b',', width);
            }
        }
    }
}
