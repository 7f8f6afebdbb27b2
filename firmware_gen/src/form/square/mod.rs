//! A completed square, or the square of one, or of that: `c + (w * w >> 16)`, where `w` is straight in the code, or
//! itself such a square. One constant fewer than Horner's rule of the same degree, and no shift but by whole bytes.

mod constants;
mod fitting;

use super::contract::{Fit, Form};
use super::steps::{plus, temperature_index};
use crate::ir::{Builder, Value};
use constants::{CODE_BITS, SQUARE_BITS, Square};
use fitting::Ideal;

/// Most nested squares: degree 8. Set by hand.
const LAYERS: usize = 3;
/// Names of the inner squares in C.
const NAMES: [&str; LAYERS - 1] = ["square", "fourth_power"];
/// Name of the form.
pub(super) const NAME: &str = "square";

pub(super) fn propose(fit: &Fit<'_>) -> Vec<Box<dyn Form>> {
    if fit.target.len() < 4 {
        return Vec::new();
    }
    let ideals = (1..=LAYERS).filter_map(|layers| Ideal::nested(fit, layers));
    let made = ideals.map(|ideal| ideal.rounded());
    made.map(|form| Box::new(form) as _).collect()
}

/// `constant + sign * value`.
fn signed(builder: &mut Builder<'_>, constant: i64, sign: i64, value: Value) -> Value {
    if sign > 0 {
        plus(builder, value, constant)
    } else {
        let constant = builder.constant(constant);
        builder.subtract(constant, value)
    }
}

impl Form for Square {
    fn name(&self) -> &'static str {
        NAME
    }

    fn describe(&self) -> String {
        match self.layers.len() {
            1 => "completed square in the temperature code".into(),
            2 => "square of a completed square in the temperature code".into(),
            _ => "square of the square of a completed square in the temperature code".into(),
        }
    }

    fn parameters(&self) -> serde_json::Value {
        let layers: Vec<_> = self
            .layers
            .iter()
            .map(|layer| (layer.sign, layer.constant))
            .collect();
        serde_json::json!({
            "start": self.start, "multiplier": self.sign * self.multiplier, "multiplier_bits": CODE_BITS,
            "square_bits": SQUARE_BITS, "layers": layers,
        })
    }

    fn floor(&self) -> f64 {
        self.floor
    }

    fn build(&self, builder: &mut Builder<'_>) -> Value {
        let code = temperature_index(builder);
        let multiplier = builder.constant(self.multiplier);
        let product = builder.multiply(code, multiplier);
        let way = builder.shift_right(product, CODE_BITS);
        let root = signed(builder, self.start, self.sign, way);
        let mut value = builder.name(root, "root", "linear in the temperature index");
        for (index, layer) in self.layers.iter().enumerate() {
            let square = builder.multiply(value, value);
            let high = builder.shift_right(square, SQUARE_BITS);
            value = signed(builder, layer.constant, layer.sign, high);
            if index + 1 < self.layers.len() {
                value = builder.name(
                    value,
                    NAMES[index],
                    "square of the value above [2^-16], and a constant",
                );
            }
        }
        value
    }

    fn refine(&mut self, fit: &Fit<'_>) {
        let ideal = Ideal::nested(fit, self.layers.len());
        if let Some(ideal) = ideal {
            *self = ideal.rounded();
        }
        self.descend(fit);
    }

    fn duplicate(&self) -> Box<dyn Form> {
        Box::new(self.clone())
    }
}
