//! Fixed-width integer types of C99, and the closed ranges that they hold.

use serde::Serialize;

/// A closed range of integers, `minimum <= value <= maximum`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Range {
    /// Smallest value.
    pub minimum: i64,
    /// Largest value.
    pub maximum: i64,
}

impl Range {
    /// The range that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            minimum: self.minimum.min(other.minimum),
            maximum: self.maximum.max(other.maximum),
        }
    }

    /// Whether `value` lies inside.
    #[must_use]
    pub fn contains(self, value: i64) -> bool {
        (self.minimum..=self.maximum).contains(&value)
    }

    /// Whether the whole of `other` lies inside.
    #[must_use]
    pub fn covers(self, other: Self) -> bool {
        self.contains(other.minimum) && self.contains(other.maximum)
    }
}

/// An exact-width integer type of `stdint.h`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs)]
pub enum IntegerType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
}

impl IntegerType {
    /// Every type, the narrow ones first, unsigned before signed of the same width.
    pub const ALL: [Self; 8] = [
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
    ];

    /// Width in bits.
    #[must_use]
    pub const fn bits(self) -> u32 {
        match self {
            Self::U8 | Self::I8 => 8,
            Self::U16 | Self::I16 => 16,
            Self::U32 | Self::I32 => 32,
            Self::U64 | Self::I64 => 64,
        }
    }

    /// Whether negative values can be held.
    #[must_use]
    pub const fn is_signed(self) -> bool {
        matches!(self, Self::I8 | Self::I16 | Self::I32 | Self::I64)
    }

    /// Values that the twin lets the type hold. The twin computes in `i64`, so the upper half of `uint64_t` is given away.
    #[must_use]
    pub const fn range(self) -> Range {
        let bits = self.bits();
        match (self.is_signed(), bits) {
            (true, 64) => Range {
                minimum: i64::MIN,
                maximum: i64::MAX,
            },
            (false, 64) => Range {
                minimum: 0,
                maximum: i64::MAX,
            },
            (true, _) => Range {
                minimum: -(1 << (bits - 1)),
                maximum: (1 << (bits - 1)) - 1,
            },
            (false, _) => Range {
                minimum: 0,
                maximum: (1 << bits) - 1,
            },
        }
    }

    /// The narrowest type of at least `least_bits` that holds `range`, unsigned where it can be.
    #[must_use]
    pub fn holding(range: Range, least_bits: u32) -> Self {
        let fits = |ty: &&Self| ty.bits() >= least_bits && ty.range().covers(range);
        Self::ALL.iter().find(fits).copied().unwrap_or(Self::I64)
    }

    /// Its name in C.
    #[must_use]
    pub const fn c_name(self) -> &'static str {
        match self {
            Self::U8 => "uint8_t",
            Self::I8 => "int8_t",
            Self::U16 => "uint16_t",
            Self::I16 => "int16_t",
            Self::U32 => "uint32_t",
            Self::I32 => "int32_t",
            Self::U64 => "uint64_t",
            Self::I64 => "int64_t",
        }
    }
}
