//! The fields of one row, without the quotation marks around them.

use memchr::memchr;

use crate::quotes::{MARK, behind_blanks};

/// Take each field of a row, with its place.
pub fn each(row: &[u8], separator: u8, mut take: impl FnMut(usize, &[u8])) {
    let (mut at, mut place) = (0, 0);
    let mut bare = Vec::new();
    loop {
        at = behind_blanks(row, at);
        let end = |at: usize| memchr(separator, &row[at..]).map_or(row.len(), |length| at + length);
        if row.get(at) == Some(&MARK) {
            bare.clear();
            loop {
                let begin = at + 1;
                let mark = memchr(MARK, &row[begin..]).map_or(row.len(), |length| begin + length);
                at = row.len().min(mark + 1);
                let next = row.get(at);
                if bare.is_empty() && next.is_none_or(|&byte| byte == separator) {
                    take(place, &row[begin..mark]);
                    break;
                }
                bare.extend_from_slice(&row[begin..mark]);
                if next != Some(&MARK) {
                    let last = end(at);
                    bare.extend_from_slice(&row[at..last]);
                    take(place, &bare);
                    at = last;
                    break;
                }
                bare.push(MARK);
            }
        } else {
            let last = end(at);
            take(place, &row[at..last]);
            at = last;
        }
        if at == row.len() {
            return;
        }
        at += 1;
        place += 1;
    }
}

/// Number of fields of a row, and whether none beyond a number of them has a value.
#[must_use]
pub fn fit(row: &[u8], separator: u8, width: usize) -> (usize, bool) {
    let (mut count, mut fits) = (0, true);
    let is_blank = |field: &[u8]| str::from_utf8(field).is_ok_and(|text| text.trim().is_empty());
    each(row, separator, |place, field| {
        count = place + 1;
        fits &= place < width || is_blank(field);
    });
    (count, fits)
}
