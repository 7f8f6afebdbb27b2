//! The hash of all outputs: a polynomial over the field of 2^61 - 1 elements, whose coefficients are the outputs in order.
//!
//! Two different sequences of equal length have the same hash only if [`BASE`] is a root of their difference. For two
//! wrong outputs, `k` places apart, that is `BASE^k = -second / first` with the two errors. If each error is one flipped
//! bit, the right side is one of 122 numbers, plus or minus a power of two; `BASE^k` is none of them for any `k` up to
//! 1.8e16. So no two flipped bits are ever missed. Other pairs of errors are missed with a probability of 2^-61.

/// The modulus, a Mersenne prime.
pub const PRIME: u64 = (1 << 61) - 1;
/// The number that the hash is multiplied by for each output: the golden ratio's 16 bits, so that an 8-bit core needs four
/// short products. Its 122nd power has the order (2^61 - 2) / 122.
pub const BASE: u64 = 40_503;
/// Outputs that are taken in at once. Set by hand: their powers of the base fit into 2 kB.
const BLOCK: usize = 256;

/// Powers of the base, from the 0th to the one of a block.
const POWERS: [u64; BLOCK + 1] = {
    let mut powers = [1; BLOCK + 1];
    let mut index = 1;
    while index <= BLOCK {
        powers[index] = product(powers[index - 1], BASE);
        index += 1;
    }
    powers
};

const fn reduced(value: u128) -> u64 {
    let once = (value & PRIME as u128) + (value >> 61);
    ((once & PRIME as u128) + (once >> 61)) as u64 % PRIME
}

const fn product(a: u64, b: u64) -> u64 {
    reduced(a as u128 * b as u128)
}

/// An output as a natural number: counted from `INT32_MIN`.
fn natural(output: i32) -> u64 {
    u64::from((output as u32) ^ (1 << 31))
}

/// A sequence of outputs: its hash and its length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hash {
    /// The hash, below [`PRIME`].
    pub value: u64,
    length: u64,
}

impl Hash {
    /// Append outputs.
    pub fn extend(&mut self, outputs: &[i32]) {
        for block in outputs.chunks(BLOCK) {
            let weighted = block.iter().zip(POWERS[..block.len()].iter().rev());
            let sum: u128 = weighted
                .map(|(output, power)| u128::from(natural(*output)) * u128::from(*power))
                .sum();
            let before = u128::from(self.value) * u128::from(POWERS[block.len()]);
            self.value = reduced(before + sum);
            self.length += block.len() as u64;
        }
    }

    /// The hash of the `count` outputs `((start + slope * k) >> bits) + after`, in the time of a few hundred products: the
    /// sequence is a word of two letters, which Euclid's algorithm writes as powers of powers.
    #[must_use]
    pub fn of_line(start: i64, slope: u64, bits: u32, after: i64, count: u64) -> Self {
        let unit = 1_u128 << bits;
        let (low, rest) = (start >> bits, (start & ((1 << bits) - 1)) as u128);
        let first = (i128::from(low) + i128::from(after) + (1 << 31)).rem_euclid(PRIME.into());
        let steps = path(
            u128::from(slope),
            unit,
            rest,
            count.saturating_sub(1).into(),
        );
        let ones = Path::OUTPUT.power(count.into()).ones;
        Self {
            value: (product(first as u64, ones) + steps.sum) % PRIME,
            length: count,
        }
    }

    /// The hash of the outputs of this sequence and, after them, those of another.
    #[must_use]
    pub fn then(self, other: Self) -> Self {
        let moved = product(self.value, power(other.length));
        Self {
            value: (moved + other.value) % PRIME,
            length: self.length + other.length,
        }
    }
}

/// What a part of a line does to a hash. The line is a word of the letters "one unit further" and "output".
#[derive(Clone, Copy)]
struct Path {
    /// The base to the number of outputs.
    scale: u64,
    /// Units.
    units: u64,
    /// The hash of as many outputs of 1.
    ones: u64,
    /// The hash of the outputs, counted from the start of the part.
    sum: u64,
}

impl Path {
    const NOTHING: Self = Self {
        scale: 1,
        units: 0,
        ones: 0,
        sum: 0,
    };
    const UNIT: Self = Self {
        units: 1,
        ..Self::NOTHING
    };
    const OUTPUT: Self = Self {
        scale: BASE,
        ones: 1,
        ..Self::NOTHING
    };

    fn then(self, next: Self) -> Self {
        let wide = |a: u64, b: u64| u128::from(a) * u128::from(b);
        let sum = wide(self.sum, next.scale) + wide(self.units, next.ones) + u128::from(next.sum);
        Self {
            scale: product(self.scale, next.scale),
            units: (self.units + next.units) % PRIME,
            ones: reduced(wide(self.ones, next.scale) + u128::from(next.ones)),
            sum: reduced(sum),
        }
    }

    fn power(self, mut exponent: u128) -> Self {
        let (mut result, mut square) = (Self::NOTHING, self);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = result.then(square);
            }
            exponent >>= 1;
            if exponent > 0 {
                square = square.then(square);
            }
        }
        result
    }
}

/// The word of `(slope * k + rest) / unit`, rounded down, for `k` from 1 to `count`; `rest` is below `unit`.
fn path(slope: u128, unit: u128, rest: u128, count: u128) -> Path {
    euclid(slope, unit, rest, count, Path::UNIT, Path::OUTPUT)
}

fn euclid(slope: u128, unit: u128, rest: u128, count: u128, up: Path, out: Path) -> Path {
    if slope >= unit {
        let out = up.power(slope / unit).then(out);
        return euclid(slope % unit, unit, rest, count, up, out);
    }
    let height = (slope * count + rest) / unit;
    if height == 0 {
        return out.power(count);
    }
    let before = (unit - rest - 1) / slope;
    let behind = count - (unit * height - rest - 1) / slope;
    // The same line with its axes exchanged.
    let inner = euclid(unit, slope, (unit - rest - 1) % slope, height - 1, out, up);
    let start = out.power(before).then(up);
    start.then(inner).then(out.power(behind))
}

/// The base to a power, by squares.
fn power(exponent: u64) -> u64 {
    Path::OUTPUT.power(exponent.into()).scale
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One output after the other, as the self-test in C does it.
    fn slowly(outputs: &[i32]) -> u64 {
        let step = |hash, output: &i32| (product(hash, BASE) + natural(*output)) % PRIME;
        outputs.iter().fold(0, step)
    }

    fn some(count: usize) -> Vec<i32> {
        let mix = |index: usize| (index as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        (0..count).map(|index| (mix(index) >> 31) as i32).collect()
    }

    #[test]
    fn blocks_and_rows_give_the_hash_of_the_whole_sequence() {
        for count in [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK + 77] {
            let outputs = some(count);
            let mut whole = Hash::default();
            whole.extend(&outputs);
            assert_eq!(whole.value, slowly(&outputs));
            for cut in [0, count / 3, count] {
                let (mut first, mut second) = (Hash::default(), Hash::default());
                first.extend(&outputs[..cut]);
                second.extend(&outputs[cut..]);
                assert_eq!(first.then(second), whole);
            }
        }
    }

    /// Lines of every slope, of negative starts and outputs, of fine and of coarse units.
    #[test]
    fn a_line_has_the_hash_of_its_outputs() {
        let mut state = 1_u64;
        let mut draw = |below: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 20) % below
        };
        for _ in 0..2_000 {
            let (bits, count) = (draw(33) as u32, draw(400));
            let slope = draw((1 << bits) * 400 / 2 + 1);
            let start = draw(1 << 40) as i64 - (1 << 39);
            let after = draw(1 << 20) as i64 - (1 << 19) - (start >> bits);
            let output = |k: u64| ((start + (slope * k) as i64) >> bits) + after;
            let outputs: Vec<i32> = (0..count).map(|k| output(k) as i32).collect();
            let mut whole = Hash::default();
            whole.extend(&outputs);
            assert_eq!(Hash::of_line(start, slope, bits, after, count), whole);
        }
    }

    /// What the module says of two flipped bits: 122 divides the order of the group, and the order of `BASE^122`, the first
    /// `k` for which `BASE^k` is plus or minus a power of two, is what remains.
    #[test]
    fn no_two_flipped_bits_are_missed() {
        let group = PRIME - 1;
        let primes = [2, 3, 5, 7, 11, 13, 31, 41, 61, 151, 331, 1321];
        let rest = primes.iter().fold(group, |mut rest, prime| {
            while rest % prime == 0 {
                rest /= prime;
            }
            rest
        });
        assert_eq!(rest, 1, "every prime of the group's order is listed");
        let to = |mut base: u64, mut exponent: u64| {
            let mut result = 1;
            while exponent > 0 {
                if exponent % 2 == 1 {
                    result = product(result, base);
                }
                base = product(base, base);
                exponent /= 2;
            }
            result
        };
        let base = to(BASE, 122);
        let order = group / 122;
        assert_eq!(to(base, order), 1);
        let smaller = primes.iter().filter(|prime| order.is_multiple_of(**prime));
        for prime in smaller {
            assert_ne!(to(base, order / prime), 1);
        }
        assert_eq!(to(2, 61), 1, "there are 61 powers of two");
        assert!(order > 1 << 54, "more outputs than any function has");
    }
}
