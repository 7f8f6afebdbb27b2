//! Choice of the instruction set for arithmetic on packs.

/// Makes a method of packs run with the widest registers that this machine has.
///
/// Packs have the same arithmetic in the same order whatever the registers, and nothing is fused: the
/// results have the same bits on every instruction set.
macro_rules! on_widest {
    ($(#[$doc:meta])* $name:ident $wide:ident $wider:ident $inner:ident ($($given:ident: $type:ty),*) -> $made:ty) => {
        $(#[$doc])*
        pub fn $name(&mut self, $($given: $type),*) -> $made {
            match echocal_core::simd::active() {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: the instruction set is available.
                echocal_core::simd::InstructionSet::Avx512 => unsafe { self.$wider($($given),*) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                echocal_core::simd::InstructionSet::Avx2 => unsafe { self.$wide($($given),*) },
                _ => self.$inner($($given),*),
            }
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2")]
        unsafe fn $wide(&mut self, $($given: $type),*) -> $made {
            self.$inner($($given),*)
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2")]
        unsafe fn $wider(&mut self, $($given: $type),*) -> $made {
            self.$inner($($given),*)
        }
    };
}

pub(crate) use on_widest;
