//! The distances that the accepted echo codes reach.

use crate::design::Design;
use crate::device::Device;
use serde::Serialize;

/// Nearest and farthest distance \[m\].
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Reach {
    /// Accepted in every combination of conditions.
    pub always: (f64, f64),
    /// Accepted in some.
    pub sometimes: (f64, f64),
}

/// The reach of a design: the outputs at the first and the last echo code, over all rows.
pub(super) fn reach(design: &Design, device: &Device) -> Reach {
    let codes = device.echo.codes;
    let mut found = Reach {
        always: (f64::NEG_INFINITY, f64::INFINITY),
        sometimes: (f64::INFINITY, f64::NEG_INFINITY),
    };
    for row in 0..device.rows() {
        let conditions = device.codes(row);
        let output = |echo: i64| {
            let output = design.output(device, &[&[echo][..], &conditions].concat());
            f64::from(output) * device.output.lsb
        };
        let (near, far) = (output(codes.minimum), output(codes.maximum));
        found.always = (found.always.0.max(near), found.always.1.min(far));
        found.sometimes = (found.sometimes.0.min(near), found.sometimes.1.max(far));
    }
    found
}
