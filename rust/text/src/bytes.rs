//! Search for one byte, eight bytes at a time.

/// One in each byte.
pub const ONES: u64 = u64::from_le_bytes([1; 8]);
const LOW: u64 = 0x7f * ONES;

/// One byte that is searched for.
#[derive(Clone, Copy, Debug)]
pub struct Needle {
    /// The byte.
    pub byte: u8,
    pattern: u64,
}

impl Needle {
    /// The search for this byte.
    pub const fn new(byte: u8) -> Self {
        Self {
            byte,
            pattern: byte as u64 * ONES,
        }
    }

    /// The highest bit of each byte of a word that is the needle, and no other bit.
    pub const fn hits(self, word: u64) -> u64 {
        let other = word ^ self.pattern;
        !(((other & LOW) + LOW) | other | LOW)
    }

    /// Place behind the needle that comes as the `count`th from `at` on; one behind `end` or none where there
    /// are fewer before it.
    #[inline]
    pub fn behind(self, data: &[u8], mut at: usize, end: usize, mut count: usize) -> Option<usize> {
        while count > 0 {
            if at >= end {
                return None;
            }
            let Some(word) = word(data, at) else {
                return self.behind_last(data, at, end, count);
            };
            let mut hits = self.hits(word);
            while hits != 0 {
                count -= 1;
                if count == 0 {
                    return Some(at + hits.trailing_zeros() as usize / 8 + 1);
                }
                hits &= hits - 1;
            }
            at += 8;
        }
        Some(at)
    }

    /// The same among the last bytes, which make no word.
    fn behind_last(self, data: &[u8], at: usize, end: usize, count: usize) -> Option<usize> {
        let places = (at..end).filter(|&place| data[place] == self.byte);
        places.map(|place| place + 1).nth(count - 1)
    }

    /// Place of the first needle from `at` on; `end` where there is none before it.
    pub fn first(self, data: &[u8], at: usize, end: usize) -> usize {
        match self.behind(data, at, end, 1) {
            Some(behind) if behind <= end => behind - 1,
            _ => end,
        }
    }
}

/// Eight bytes, the first in the lowest places; none where fewer are left.
#[inline]
pub fn word(data: &[u8], at: usize) -> Option<u64> {
    let bytes = data.get(at..at + 8)?;
    Some(u64::from_le_bytes(bytes.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_same_as_byte_by_byte(
            data in prop::collection::vec(0x2b_u8..0x2e, 0..60),
            cut in 0_usize..60,
            count in 1_usize..9,
        ) {
            let end = cut.min(data.len());
            let needle = Needle::new(b',');
            for at in 0..=end {
                let places: Vec<_> = (at..end).filter(|&place| data[place] == b',').collect();
                let found = needle.behind(&data, at, end, count).filter(|&place| place <= end);
                prop_assert_eq!(found, places.get(count - 1).map(|place| place + 1));
                prop_assert_eq!(needle.first(&data, at, end), places.first().copied().unwrap_or(end));
            }
        }
    }
}
