//! The last steps, which every form shares: from echo time and speed factor to the distance.
//!
//! Whatever the effects are, the model at fixed conditions is close to `distance = factor * (echo - delay) - offset`;
//! `delay` and `offset` are fitted to samples of the model. The names of its effects are not read.

use super::contract::Sample;
use super::steps::plus;
use crate::device::Device;
use crate::ir::{Builder, Value};
use crate::reference::Line;
use crate::target::Target;
use crate::types::Range;
use serde::Serialize;

/// `distance = (((echo << time_bits) - delay) * factor + rounding) >> (scale_bits + time_bits) - offset`, where a short
/// delay is made up to 2^`scale_bits` codes, and one `factor` taken off at the end.
///
/// Of a factor of 17 bits whose first bit is always set, this bit is left out (`leading`), as floating point does: the
/// product is one of numbers of 16 bits, and the time itself stands for the bit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tail {
    /// Binary places of the speed factor \[unit per echo code\].
    pub scale_bits: u32,
    /// Binary places of the echo time within this function.
    pub time_bits: u32,
    /// Delay in echo codes, with `time_bits` binary places.
    pub delay: i64,
    /// What is taken off the distance \[unit\].
    pub offset: f64,
    /// Whether the result is rounded to nearest rather than down, and the offset kept to a fraction of the unit.
    pub rounded: bool,
    /// Whether 2^16 is added to the factor.
    pub leading: bool,
}

const BYTE: u32 = 8;
/// The bit that a factor of 17 bits does without.
const LEADING: i64 = 1 << 16;

impl Tail {
    /// The delay and offset that suit `lines` best; no delay at all if `with_delay` is false.
    #[must_use]
    pub fn fit(lines: &[Line], scale_bits: u32, time_bits: u32, with_delay: bool) -> Self {
        let unit = f64::from(time_bits).exp2();
        let delay = if with_delay {
            (fitted_delay(lines) * unit).round() as i64
        } else {
            0
        };
        let (low, high) = rests(lines, delay, time_bits);
        Self {
            scale_bits,
            time_bits,
            delay,
            offset: f64::midpoint(low, high),
            rounded: false,
            leading: false,
        }
    }

    /// The format with a factor of 17 bits, where every one begins with 1 and no time is negative.
    fn with_leading(
        lines: &[Line],
        largest: f64,
        device: &Device,
        with_delay: bool,
    ) -> Option<Self> {
        let scale_bits = (17.0 - (largest * (1.0 + 1e-4)).log2()).floor();
        let tail = Self {
            leading: true,
            ..Self::fit(lines, scale_bits.clamp(0.0, 40.0) as u32, 0, with_delay)
        };
        let least = lines.iter().map(|line| tail.target(line));
        let least = least.fold(f64::INFINITY, f64::min);
        let useful = tail.scale_bits > BYTE && least > 1.0 && (tail.delay != 0) == with_delay;
        (useful && tail.delay <= device.echo.codes.minimum).then_some(tail)
    }

    /// The formats worth trying: a 16-bit factor, a 32-bit product, a 64-bit product, each with and without the delay.
    /// Of a coarse unit, each also rounded to nearest, and one that shifts whole bytes where the core likes that.
    #[must_use]
    pub fn propose(lines: &[Line], device: &Device, target: Target) -> Vec<Self> {
        let largest = lines.iter().map(|line| line.slope).fold(0.0, f64::max);
        let longest = device.echo.codes.maximum as f64;
        let places =
            |bits: f64, factor: f64| (bits - factor.log2()).floor().clamp(0.0, 40.0) as u32;
        let mut tails: Vec<Self> = Vec::new();
        for with_delay in [false, true] {
            // A signed product has one bit less; one code of slack keeps a rounded factor inside.
            let product = if with_delay { 31.0 } else { 32.0 };
            let narrow = places(16.0, largest * (1.0 + 1e-4));
            let word = places(product, largest * longest * (1.0 + 1e-4));
            for scale_bits in widths(narrow.min(word), word, device, target) {
                let plain = Self::fit(lines, scale_bits, 0, with_delay);
                tails.push(plain);
                if device.output.is_coarse() {
                    tails.push(Self {
                        rounded: true,
                        ..plain
                    });
                }
            }
            if target.least_bits < 32 && !device.output.is_coarse() {
                tails.extend(Self::with_leading(lines, largest, device, with_delay));
            }
            for time_bits in if with_delay { 0..2 } else { 0..1 } {
                let wide = Self {
                    rounded: true,
                    ..Self::fit(lines, places(28.0, largest), 4 * time_bits, with_delay)
                };
                tails.push(wide);
            }
        }
        let mut kept: Vec<Self> = Vec::new();
        tails.into_iter().for_each(|tail| {
            if !kept.contains(&tail) {
                kept.push(tail)
            }
        });
        kept
    }

    /// The error that this delay leaves at the first or the last echo of some line \[unit\], whatever the factors and
    /// the offset: a bound from below, but for the rounding of the distance.
    ///
    /// With the slope of a line for its factor, the error is the same at all its echoes: what the line wants for an
    /// offset, less the offset. Another factor turns the error about the delay. Where `first` is before the delay, that
    /// makes the error larger at one end. Where both ends are behind it, `a` and `b` echo codes, the least that the
    /// larger of the two errors can be is where they are opposite: `(b - a) / (b + a)` of the one they had.
    #[must_use]
    pub fn rest(&self, lines: &[Line]) -> f64 {
        let delay = self.codes();
        let share = |line: &Line| {
            let (near, far) = (
                (line.first as f64 - delay).max(0.0),
                line.reach as f64 - delay,
            );
            if far <= 0.0 {
                0.0
            } else {
                (far - near) / (far + near)
            }
        };
        let wanted = lines
            .iter()
            .filter(|line| line.bounded)
            .map(|line| (line.wanted(delay), share(line)));
        apart(&wanted.collect::<Vec<_>>())
    }

    /// The delay in echo codes.
    fn codes(&self) -> f64 {
        self.delay as f64 / f64::from(self.time_bits).exp2()
    }

    /// The factor \[unit per echo code\] that brings `line` to its distance at the end of its reach.
    #[must_use]
    pub fn factor(&self, line: &Line) -> f64 {
        // Rounding down takes half a unit off on average; the factor gives it back at the far end.
        let cut_off = if self.rounded { 0.0 } else { 0.5 };
        (line.end() + self.offset + cut_off) / self.lever(line)
    }

    /// The factor, in units of the last binary place, that brings an echo code to its distance \[unit\], and the error
    /// there per such unit \[unit\]; less the bit that is left out.
    #[must_use]
    pub fn sample(&self, echo: i64, distance: f64) -> Sample {
        let unit = f64::from(self.scale_bits).exp2();
        let cut_off = if self.rounded { 0.0 } else { 0.5 };
        let lever = (echo as f64 - self.codes()).max(1.0);
        let leading = if self.leading { LEADING as f64 } else { 0.0 };
        Sample {
            echo,
            factor: ((distance + self.offset + cut_off) / lever).mul_add(unit, -leading),
            weight: lever / unit,
        }
    }

    /// What a form must give for `line`: its factor in units of the last binary place, less the bit that is left out.
    #[must_use]
    pub fn target(&self, line: &Line) -> f64 {
        let leading = if self.leading { LEADING as f64 } else { 0.0 };
        self.factor(line)
            .mul_add(f64::from(self.scale_bits).exp2(), -leading)
    }

    /// Echo codes between the delay and the end of the reach.
    #[must_use]
    pub fn lever(&self, line: &Line) -> f64 {
        (line.reach as f64 - self.codes()).max(1.0)
    }

    /// Add the steps from the speed `factor` to the distance \[unit\].
    pub fn build(&self, builder: &mut Builder<'_>, factor: Value) -> Value {
        let unit = builder.device().output.text();
        let less = if self.leading { " less 2^16" } else { "" };
        let note = format!(
            "half the speed of sound{less} [2^-{} {unit} per echo code]",
            self.scale_bits
        );
        let factor = builder.name(factor, "speed", note);
        let echo = builder.echo();
        let turned = self.is_turned(builder.range(echo));
        let time = self.flight(builder, echo, turned);
        let mut product = builder.multiply(time, factor);
        let mut bits = self.scale_bits + self.time_bits;
        if self.leading {
            // The product and the time move by whole bytes; one or few places are left for the sum.
            let high = builder.shift_right(product, BYTE);
            let unit = builder.constant(LEADING >> BYTE);
            let whole = builder.multiply(time, unit);
            product = builder.add(high, whole);
            bits -= BYTE;
        }
        let whole = self.offset.round() as i64;
        let lowest = builder.range(product).minimum;
        // A negative product is lifted before the shift and lowered after it: only natural numbers are shifted.
        let lift = if lowest < 0 { 1 + (-lowest >> bits) } else { 0 };
        let fraction = if self.rounded {
            0.5 + self.offset.round() - self.offset
        } else {
            0.0
        };
        let fraction = (fraction * (1_i64 << bits) as f64).round() as i64;
        let lifted = plus(builder, product, (lift << bits) + fraction);
        let distance = builder.shift_right(lifted, bits);
        let distance = builder.name(distance, "distance", excess(unit, lift + whole, turned));
        let distance = if turned {
            builder.subtract(distance, factor)
        } else {
            distance
        };
        plus(builder, distance, -(lift + whole))
    }

    /// Whether 2^`scale_bits` codes are added to the echo time, and taken off again as one speed factor, which is
    /// exact: the time less its delay is then never negative, and its product one of natural numbers of 16 bits. Of no
    /// use where every echo that is accepted is longer than the delay.
    fn is_turned(&self, echo: Range) -> bool {
        let turn = 1_i64 << self.scale_bits;
        let longest = echo.maximum + turn - self.delay;
        let short = echo.minimum < self.delay && self.delay <= turn;
        self.time_bits == 0 && short && longest < 1 << 16
    }

    fn flight(&self, builder: &mut Builder<'_>, echo: Value, turned: bool) -> Value {
        let scale = 1_i64 << self.time_bits;
        let time = if scale == 1 {
            echo
        } else {
            let scale = builder.constant(scale);
            builder.multiply(echo, scale)
        };
        if self.delay == 0 {
            return time;
        }
        let long = i64::from(turned) << self.scale_bits;
        let time = plus(builder, time, long - self.delay);
        let unit = if self.time_bits == 0 {
            "[echo codes]".into()
        } else {
            format!("[2^-{} echo codes]", self.time_bits)
        };
        let note = if long > 0 {
            format!("echo time minus the delay, plus {long} {unit}")
        } else {
            format!("echo time minus the delay {unit}")
        };
        builder.name(time, "flight", note)
    }
}

/// What a distance is before its last steps, in words.
fn excess(unit: &str, long: i64, turned: bool) -> String {
    let sign = if long < 0 { "-" } else { "+" };
    match (long, turned) {
        (0, false) => format!("distance [{unit}]"),
        (1.., false) => format!("distance [{unit}], too large by {long}"),
        (..0, false) => format!("distance [{unit}], too small by {}", long.abs()),
        (0, true) => format!("distance [{unit}], too large by speed"),
        (long, true) => format!(
            "distance [{unit}], too large by speed {sign} {}",
            long.abs()
        ),
    }
}

/// Binary places of a factor of 16 bits and of a product of 32.
fn widths(narrow: u32, word: u32, device: &Device, target: Target) -> Vec<u32> {
    let bytes = device.output.is_coarse() && target.byte_shifts;
    let whole = bytes.then_some(narrow / 8 * 8);
    [narrow, word].into_iter().chain(whole).collect()
}

/// The delay \[echo codes\] and the offset \[unit\] that suit `lines` best.
pub(super) fn delay_and_offset(lines: &[Line]) -> (f64, f64) {
    let delay = fitted_delay(lines);
    let (low, high) = ends(lines.iter().map(|line| line.wanted(delay)));
    (delay, f64::midpoint(low, high))
}

/// The least and the largest offset \[unit\] that single lines would want beside this delay.
fn rests(lines: &[Line], delay: i64, time_bits: u32) -> (f64, f64) {
    let delay = delay as f64 / f64::from(time_bits).exp2();
    ends(lines.iter().map(|line| line.wanted(delay)))
}

pub(super) fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (value.min(low), value.max(high))
    })
}

/// Most iterations of [`apart`]. Each one gives a lower bound, so stopping early is safe. Set by hand: the proptest below
/// holds the result against a search over 1,000 offsets.
const PAIRS: usize = 12;

/// The least that the largest error can be where one offset serves all lines: each `wanted` another, and what is left
/// of the difference between the two is a `share` of it.
fn apart(wanted: &[(f64, f64)]) -> f64 {
    let (low, high) = ends(wanted.iter().map(|(want, _)| *want));
    let (mut offset, mut bound) = (f64::midpoint(low, high), 0.0);
    for _ in 0..PAIRS {
        let worst = |sign: f64| {
            let error = |(want, share): &(f64, f64)| sign * (want - offset) * share;
            wanted
                .iter()
                .copied()
                .max_by(|a, b| error(a).total_cmp(&error(b)))
        };
        let (Some((high, p)), Some((low, q))) = (worst(1.0), worst(-1.0)) else {
            break;
        };
        // With two lines alone, the best offset is where their errors are opposite.
        let pair = p * q * (high - low) / (p + q);
        if pair.is_nan() || pair <= bound {
            break;
        }
        bound = pair;
        offset = p.mul_add(high, q * low) / (p + q);
    }
    bound
}

/// How the start of the lines falls with their slope: the delay in echo codes, by least squares.
fn fitted_delay(lines: &[Line]) -> f64 {
    let count = lines.len() as f64;
    let mean = |of: fn(&Line) -> f64| lines.iter().map(of).sum::<f64>() / count;
    let (slope, start) = (mean(|line| line.slope), mean(|line| line.start));
    let (mut product, mut square) = (0.0, 0.0);
    for line in lines {
        let deviation = line.slope - slope;
        product = deviation.mul_add(line.start - start, product);
        square = deviation.mul_add(deviation, square);
    }
    // One speed at all temperatures cannot tell a delay from an offset: the offset takes it.
    if square <= count * (1e-9 * slope).powi(2) {
        0.0
    } else {
        -product / square
    }
}

#[cfg(test)]
mod tests;
