//! Where the lines of a text end.

use memchr::{memchr, memchr_iter};

/// Places behind the ends of the lines of a text, which ends with the last of them.
///
/// None where lines do not all end alike, one is blank, or the text is beyond four gigabytes.
///
/// # Examples
/// ```
/// # use echocal_text::lines::ends;
/// assert_eq!(ends(b"5,3\n6,1\n", false), Some(vec![4, 8]));
/// assert_eq!(ends(b"5,3\r\n6,1\n", true), None);
/// ```
#[must_use]
pub fn ends(data: &[u8], with_return: bool) -> Option<Vec<u32>> {
    u32::try_from(data.len()).ok()?;
    if !with_return && memchr(b'\r', data).is_some() {
        return None;
    }
    let mut found: Vec<u32> = Vec::with_capacity(1 + data.len() / 16);
    let ending = ending(with_return);
    let mut begin = 0;
    for feed in memchr_iter(b'\n', data) {
        let end = feed + 1;
        if end - begin <= ending || (with_return && data[feed - 1] != b'\r') {
            return None;
        }
        #[allow(
            clippy::cast_possible_truncation,
            reason = "the length of the text fits"
        )]
        found.push(end as u32);
        begin = end;
    }
    let returns = || memchr_iter(b'\r', data).count();
    let alike = begin == data.len() && (!with_return || returns() == found.len());
    alike.then_some(found)
}

/// Bytes that end a line.
#[must_use]
pub const fn ending(with_return: bool) -> usize {
    if with_return { 2 } else { 1 }
}

/// Each line without its end: where it begins, and where it ends.
pub fn spans(ends: &[u32], ending: usize) -> impl Iterator<Item = (usize, usize)> {
    let mut begin = 0;
    ends.iter().map(move |&end| {
        let end = end as usize;
        let span = (begin, end.saturating_sub(ending));
        begin = end;
        span
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn lines_that_are_not_plain() {
        assert_eq!(ends(b"", false), Some(vec![]));
        assert_eq!(ends(b"5", false), None);
        assert_eq!(ends(b"5\n\n6\n", false), None);
        assert_eq!(ends(b"\n5\n", false), None);
        assert_eq!(ends(b"5\r\n6\r\n", true), Some(vec![3, 6]));
        assert_eq!(ends(b"5\r\n6\r\n", false), None);
        assert_eq!(ends(b"5\r6\r\n", true), None);
        assert_eq!(ends(b"5\r\r\n", true), None);
        assert_eq!(ends(b"5\r\n\r\n", true), None);
    }

    proptest! {
        #[test]
        fn lines_are_those_of_the_library(text in "([a,;]{1,20}\n){0,9}") {
            let found = ends(text.as_bytes(), false).unwrap();
            let lines: Vec<_> = spans(&found, 1).map(|(begin, end)| &text[begin..end]).collect();
            prop_assert_eq!(lines, text.lines().collect::<Vec<_>>());
        }
    }
}
