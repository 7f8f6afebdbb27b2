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
                at += 1;
                let mark = memchr(MARK, &row[at..]).map_or(row.len(), |length| at + length);
                bare.extend_from_slice(&row[at..mark]);
                at = row.len().min(mark + 1);
                if row.get(at) != Some(&MARK) {
                    break;
                }
                bare.push(MARK);
            }
            let last = end(at);
            bare.extend_from_slice(&row[at..last]);
            take(place, &bare);
            at = last;
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

/// Number of fields of a row.
#[must_use]
pub fn width(row: &[u8], separator: u8) -> usize {
    let mut count = 0;
    each(row, separator, |place, _| count = place + 1);
    count
}

/// Whether no field of a row beyond a number of fields has a value.
#[must_use]
pub fn fits(row: &[u8], separator: u8, width: usize) -> bool {
    let mut fits = true;
    let is_blank = |field: &[u8]| str::from_utf8(field).is_ok_and(|text| text.trim().is_empty());
    each(row, separator, |place, field| {
        fits &= place < width || is_blank(field);
    });
    fits
}
