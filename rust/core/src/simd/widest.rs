//! Work on vectors of doubles, with the widest registers that this machine has.

#[cfg(target_arch = "x86_64")]
use super::x86::{F64x4, F64x8};
use super::{InstructionSet, Vector, active};

/// Work that is written once for every width of vectors.
///
/// [`OnVectors::run`] must be `#[inline(always)]`: only then is it compiled for the instruction set
/// that its vectors need.
pub trait OnVectors {
    /// What the work gives.
    type Output;

    /// Does the work with vectors of one width.
    fn run<V: Vector<Element = f64>>(self) -> Self::Output;
}

/// Does some work with the widest vectors of this machine, or with those that were forced.
#[inline]
pub fn on_vectors<W: OnVectors>(work: W) -> W::Output {
    match active() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the instruction set is available.
        InstructionSet::Avx512 => unsafe { with_avx512(work) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        InstructionSet::Avx2 => unsafe { with_avx2(work) },
        _ => work.run::<f64>(),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
unsafe fn with_avx512<W: OnVectors>(work: W) -> W::Output {
    work.run::<F64x8>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn with_avx2<W: OnVectors>(work: W) -> W::Output {
    work.run::<F64x4>()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Doubled<'a>(&'a mut [f64; 8]);

    impl OnVectors for Doubled<'_> {
        type Output = usize;

        #[inline(always)]
        fn run<V: Vector<Element = f64>>(self) -> usize {
            for place in (0..8).step_by(V::WIDTH) {
                // SAFETY: the width divides the length.
                unsafe {
                    let at = self.0.as_mut_ptr().add(place);
                    let value = V::load(at);
                    (value + value).store(at);
                }
            }
            V::WIDTH
        }
    }

    #[test]
    fn every_number_is_worked_on() {
        let mut numbers = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        let width = on_vectors(Doubled(&mut numbers));
        assert!([1, 4, 8].contains(&width));
        assert_eq!(numbers, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0]);
    }
}
