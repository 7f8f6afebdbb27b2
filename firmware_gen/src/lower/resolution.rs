//! What is lost where the function drops bits of a code.

use super::Lowered;
use crate::device::Device;
use echocal_core::{Conditions, Quantity};

/// Steps over the range of another condition. Set by hand: the law is smooth.
const STEPS: usize = 16;

impl Lowered {
    /// For each condition of which bits are dropped: how coarse that makes it, and what it costs, a line each. Half a
    /// step is off at most: the function takes the middle of a step for all its codes.
    #[must_use]
    pub fn resolution(&self, device: &Device, distance: f64) -> Vec<String> {
        let dropped = |place: &usize| device.conditions[*place].shift > 0;
        let places = (0..device.conditions.len()).filter(dropped);
        places
            .map(|place| {
                let axis = &device.conditions[place];
                let (fine, coarse) = (axis.lsb.abs(), axis.resolution());
                let lost = self.lost(device, place, distance) * 1e3;
                format!(
                    "{}: the lowest {} bits are dropped. Steps of {} become steps of {}: up to {} mm at {distance} m",
                    axis.name,
                    axis.shift,
                    axis.with_unit(up(fine, 3)),
                    axis.with_unit(up(coarse, 3)),
                    up(lost, 2),
                )
            })
            .collect()
    }

    /// The largest change of a `distance` \[m\] by half a step of the condition at `place`.
    fn lost(&self, device: &Device, place: usize, distance: f64) -> f64 {
        let half = device.conditions[place].resolution() / 2.0;
        let quantity = self.measured[place];
        let mut largest = 0.0_f64;
        for row in grid(device, place) {
            let at = self.at(&row);
            let time = self.time(distance, &at);
            for more in [-half, half] {
                let there = at.with(quantity, at.get(quantity) + more);
                largest = largest.max((self.distance(time, &there) - distance).abs());
            }
        }
        largest
    }

    fn distance(&self, time: f64, at: &Conditions<f64>) -> f64 {
        let mut found = [0.0];
        let values: Vec<f64> = self
            .measured
            .iter()
            .map(|one: &Quantity| at.get(*one))
            .collect();
        crate::reference::Reference::distances(self, &values, &[time], &mut found);
        found[0]
    }
}

/// Values of all conditions: every step of the one at `place`, some of the others.
fn grid(device: &Device, place: usize) -> Vec<Vec<f64>> {
    let mut rows = vec![Vec::new()];
    for (index, axis) in device.conditions.iter().enumerate() {
        let count = if index == place {
            axis.len()
        } else {
            axis.len().min(STEPS + 1)
        };
        let value =
            |step: usize| axis.value(axis.code(step * (axis.len() - 1) / (count - 1).max(1)));
        let values: Vec<f64> = (0..count).map(value).collect();
        rows = rows
            .iter()
            .flat_map(|row: &Vec<f64>| values.iter().map(|value| [&row[..], &[*value]].concat()))
            .collect();
    }
    rows
}

/// A positive number to some digits, rounded up: what is stated must hold.
fn up(value: f64, digits: i32) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    let places = digits - 1 - value.log10().floor() as i32;
    let unit = 10_f64.powi(places);
    let rounded = value.mul_add(unit, -1e-9).ceil();
    format!("{:.*}", places.max(0) as usize, rounded / unit)
        .parse()
        .unwrap_or(value)
}
