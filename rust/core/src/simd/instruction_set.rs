//! Which registers this processor has, and which are used.

use core::sync::atomic::{AtomicU8, Ordering};

/// A level of SIMD support.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum InstructionSet {
    /// What every processor of the architecture has (on aarch64 that includes NEON and fused
    /// multiply-add; on x86-64 fused operations are emulated, exactly and slowly).
    Baseline = 1,
    /// AVX2 with FMA: 256 bits.
    Avx2 = 2,
    /// AVX-512 (F, DQ, VL): 512 bits.
    Avx512 = 3,
}

/// The choice; 0 stands for "not made yet".
static CHOSEN: AtomicU8 = AtomicU8::new(0);

impl InstructionSet {
    /// All levels, from the narrowest.
    pub const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// Name in Python.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether this processor has it.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }
}

/// The level in use: the widest available unless one was forced.
#[inline]
pub fn active() -> InstructionSet {
    match CHOSEN.load(Ordering::Relaxed) {
        1 => InstructionSet::Baseline,
        2 => InstructionSet::Avx2,
        3 => InstructionSet::Avx512,
        _ => choose(),
    }
}

#[cold]
fn choose() -> InstructionSet {
    let available = InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available());
    let widest = available.max().unwrap_or(InstructionSet::Baseline);
    CHOSEN.store(widest as u8, Ordering::Relaxed);
    widest
}

/// Uses this level from now on, in the whole process; `None`: the widest available.
///
/// For tests and benches: results of the physics do not depend on it; the sums of products in
/// `echocal-infer` differ by rounding, because they are fused on vectors alone. Returns whether the level is available;
/// nothing changes where it is not.
pub fn force(set: Option<InstructionSet>) -> bool {
    let available = set.is_none_or(InstructionSet::is_available);
    if available {
        CHOSEN.store(set.map_or(0, |set| set as u8), Ordering::Relaxed);
    }
    available
}
