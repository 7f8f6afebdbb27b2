//! The distances that the accepted echo codes reach.

use crate::device::Device;
use crate::prove::Proof;
use serde::Serialize;

/// Nearest and farthest distance \[m\].
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Reach {
    /// Accepted in every combination of conditions.
    pub always: (f64, f64),
    /// Accepted in some.
    pub sometimes: (f64, f64),
}

/// The reach of a proven design.
pub(super) fn reach(proof: &Proof, device: &Device) -> Reach {
    let meters = |(near, far): (i64, i64)| {
        let lsb = device.output.lsb;
        (near as f64 * lsb, far as f64 * lsb)
    };
    Reach {
        always: meters(proof.reach.always),
        sometimes: meters(proof.reach.sometimes),
    }
}
