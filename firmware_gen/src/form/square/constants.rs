//! The constants of a completed square, and its value in integers.

/// Binary places of the multiplier of the code: one byte, so that the shift moves whole bytes.
pub(super) const CODE_BITS: u32 = 8;
/// Binary places that a square loses: two bytes, so that the shift moves whole bytes.
pub(super) const SQUARE_BITS: u32 = 16;

/// One squaring: `constant + sign * (w * w >> 16)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer {
    pub(super) constant: i64,
    pub(super) sign: i64,
}

/// A square, or a square of a square.
#[derive(Clone, Debug)]
pub(super) struct Square {
    /// The straight start: `start + sign * (code * multiplier >> 8)`.
    pub(super) start: i64,
    pub(super) multiplier: i64,
    pub(super) sign: i64,
    pub(super) layers: Vec<Layer>,
    pub(super) floor: f64,
}

impl Square {
    /// The factor at a code counted from the coldest.
    pub(super) fn at(&self, code: i64) -> i64 {
        let straight = self.start + self.sign * ((code * self.multiplier) >> CODE_BITS);
        self.layers.iter().fold(straight, |w, layer| {
            layer.constant + layer.sign * ((w * w) >> SQUARE_BITS)
        })
    }
}
