//! The float model that the integer program must follow, and what it looks like at each combination of conditions.

use crate::device::Device;
use crate::error::Error;
use crate::jet::Jet;

/// The distance that the calibrated model gives.
pub trait Reference: Sync {
    /// Fill `distance` [m] for `time_of_flight` [s] under `conditions`, in the order and units of the device's axes.
    fn distances(&self, conditions: &[f64], time_of_flight: &[f64], distance: &mut [f64]);

    /// What is known of all these distances together.
    fn shape(&self, _conditions: &[f64]) -> Shape<'_> {
        Shape::Unknown
    }
}

/// What is known of the distances at one combination of conditions.
pub enum Shape<'a> {
    /// They are `slope * time + start` [m], with two roundings.
    Line {
        /// [m/s], not negative.
        slope: f64,
        /// [m].
        start: f64,
    },
    /// They are the inverse of an echo time [s], which can be bounded between two distances [m].
    Curve(Box<dyn Fn(Jet) -> Jet + 'a>),
    /// Nothing is known.
    Unknown,
}

/// Any `Fn(conditions, time_of_flight [s]) -> distance [m]` will do.
impl<F: Fn(&[f64], f64) -> f64 + Sync> Reference for F {
    fn distances(&self, conditions: &[f64], time_of_flight: &[f64], distance: &mut [f64]) {
        for (time, distance) in time_of_flight.iter().zip(distance) {
            *distance = self(conditions, *time);
        }
    }
}

/// Most echo codes sampled at either end of a line. Set by hand; the proof checks all.
const MOST_SAMPLES: i64 = 64;

/// The model at one combination of conditions: nearly a straight line in the echo time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// First echo code that is accepted.
    pub first: i64,
    /// Growth of the distance per echo code \[unit\], between `first` and `reach`.
    pub slope: f64,
    /// Where the line through both has echo code 0 \[unit\]: how the model bends before `first` is nobody's concern.
    pub start: f64,
    /// Distance halfway between them \[unit\].
    pub middle: f64,
    /// Last echo code whose distance is within the bounded domain; the one after `first` where none or one is, so that
    /// the form follows the model there, too.
    pub reach: i64,
    /// Whether the distance at `first` is within the bounded domain: no other echo is, otherwise.
    pub bounded: bool,
}

impl Line {
    /// Distance at the end of the reach \[unit\].
    #[must_use]
    pub fn end(&self) -> f64 {
        self.at(self.reach)
    }

    /// Distance of the line at an echo code \[unit\].
    fn at(&self, echo: i64) -> f64 {
        self.slope.mul_add(echo as f64, self.start)
    }

    /// The offset \[unit\] that makes up for a delay \[echo codes\] where the slope is the speed factor.
    #[must_use]
    pub fn wanted(&self, delay: f64) -> f64 {
        (-delay).mul_add(self.slope, -self.start)
    }

    /// Echo codes and distances \[unit\] at the start, halfway, and the last few of the reach, where cut-off bits differ.
    pub fn samples(&self) -> impl Iterator<Item = (i64, f64)> {
        // As many codes as make a step of the output, at either end: somewhere among them it is cut off most.
        let step = (self.slope.recip().ceil() as i64).clamp(1, MOST_SAMPLES);
        let within = self.reach - self.first;
        let first = (1..step.min(within)).map(|on| (self.first + on, self.at(self.first + on)));
        let last = (0..step.max(4).min(within)).map(|back| {
            (
                self.reach - back,
                self.slope.mul_add(-(back as f64), self.end()),
            )
        });
        let ends = [
            (self.first, self.at(self.first)),
            (i64::midpoint(self.first, self.reach), self.middle),
        ];
        ends.into_iter().chain(first).chain(last)
    }
}

/// The model at the combinations of conditions `rows`.
///
/// # Errors
/// If the model gives no finite distance somewhere, or one that does not grow with the echo time.
pub fn sample(
    reference: &dyn Reference,
    device: &Device,
    rows: &[usize],
    maximum_distance: f64,
) -> Result<Vec<Line>, Error> {
    rows.iter()
        .map(|row| line(reference, device, *row, maximum_distance))
        .collect()
}
fn line(
    reference: &dyn Reference,
    device: &Device,
    row: usize,
    maximum_distance: f64,
) -> Result<Line, Error> {
    let conditions = device.values(row);
    let at = |code: i64| {
        let mut distance = [0.0];
        reference.distances(&conditions, &[device.echo.value(code)], &mut distance);
        distance[0] * device.output.per_meter
    };
    let (first, last) = (device.echo.codes.minimum, device.echo.codes.maximum);
    let (start, end) = (at(first), at(last));
    if !start.is_finite() || !end.is_finite() {
        return Err(Error::Model(format!(
            "the model gives no distance at {}",
            place(device, row, last)
        )));
    }
    if end <= start {
        return Err(Error::Model(format!(
            "the model's distance does not grow with the echo time at {}: {start:.0} {unit} at echo code {first}, {end:.0} {unit} at {last}",
            place(device, row, last),
            unit = device.output.text()
        )));
    }
    let chord = (end - start) / (last - first) as f64;
    let far = maximum_distance * device.output.per_meter;
    let within = ((far - start) / chord).floor() as i64;
    let reach = first + within.clamp(1, last - first);
    let slope = (at(reach) - start) / (reach - first) as f64;
    Ok(Line {
        first,
        slope,
        start: slope.mul_add(-(first as f64), start),
        middle: at(i64::midpoint(first, reach)),
        reach,
        bounded: start <= far,
    })
}

/// Check that some echo is within the bounded domain, the `lines` being those of a part of the rows.
///
/// # Errors
/// [`Error::Request`] if every distance that the function can be asked for is beyond `maximum_distance` \[m\].
pub fn check_bounded(
    reference: &dyn Reference,
    device: &Device,
    lines: &[Line],
    maximum_distance: f64,
) -> Result<(), Error> {
    if lines.iter().any(|line| line.bounded) {
        return Ok(());
    }
    let first = device.echo.codes.minimum;
    let nearest = |row: usize| {
        let mut distance = [0.0];
        reference.distances(
            &device.values(row),
            &[device.echo.value(first)],
            &mut distance,
        );
        (distance[0], row)
    };
    let rows = (0..device.rows()).map(nearest);
    match rows.min_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((distance, row)) if distance > maximum_distance => Err(Error::Request(format!(
            "no distance is left to bound: the shortest echo that is accepted, {shortest} us, is one from {distance} m or \
             more ({place}), and the largest bounded distance is {maximum_distance} m: give a shorter echo min \
             (--echo-min-us, EchoCodes(shortest=...)) or a larger distance (--max-distance-m, max_distance)",
            shortest = (device.echo.value(first) * 1e9).round() / 1e3,
            distance = (distance * 1e3).ceil() / 1e3,
            place = place(device, row, first),
        ))),
        _ => Ok(()),
    }
}

/// Check that the type of the output holds the distances at the ends of the echo codes, at the combinations `rows`.
///
/// # Errors
/// [`Error::Request`] if it does not.
pub fn check_type(reference: &dyn Reference, device: &Device, rows: &[usize]) -> Result<(), Error> {
    let (output, codes) = (device.output, device.echo.codes);
    let held = output.distances();
    for row in rows {
        let mut found = [0.0; 2];
        let times = [codes.minimum, codes.maximum].map(|code| device.echo.value(code));
        reference.distances(&device.values(*row), &times, &mut found);
        for (echo, distance) in [codes.minimum, codes.maximum].into_iter().zip(found) {
            let units = distance * output.per_meter;
            if units < held.minimum as f64 || units > held.maximum as f64 {
                return Err(Error::Request(format!(
                    "the distance is {distance:.4} m at {place}, and {ty} in steps of {unit} holds {least:.4} .. {most:.4} m: \
                     accept shorter echoes (echo max, or largest distance), or choose a coarser output unit{wider}",
                    place = place(device, *row, echo),
                    ty = output.ty.c_name(),
                    unit = if output.text().starts_with(char::is_numeric) {
                        output.text().into()
                    } else {
                        format!("1 {}", output.text())
                    },
                    least = held.minimum as f64 * output.lsb,
                    most = held.maximum as f64 * output.lsb,
                    wider = if output.ty == crate::types::IntegerType::I16 {
                        ", or the output type int32"
                    } else {
                        ""
                    },
                )));
            }
        }
    }
    Ok(())
}

/// "echo_us 4321, temperature_code 16 (1 degC)"
#[must_use]
pub fn place(device: &Device, row: usize, echo: i64) -> String {
    let conditions = device.conditions.iter().zip(device.codes(row));
    let conditions = conditions.map(|(axis, code)| {
        format!(
            ", {} {code} ({})",
            axis.name,
            axis.with_unit(axis.value(code))
        )
    });
    format!(
        "{} {echo}{}",
        device.echo.name,
        conditions.collect::<String>()
    )
}
