//! The proof of a row without its every echo code: what bounds the error between two echo codes is computed, and only
//! where it could exceed the largest error found so far does the proof look closer, in the end at each code.
//!
//! At fixed conditions the output is a straight line in the echo code that is cut off: it lies between the line and one
//! unit below, less one step of the cut-off bits. The distance of the line from the model is linear where the model is,
//! too: then the larger one of both ends bounds it. Where the model is a curve, the slopes and the curvature of its echo
//! time, bounded between the two distances, limit how far the curve leaves the chord.

use super::claim::{Claim, Worst};
use super::row::{Fault, Row, truths};
use super::straight::Straight;
use crate::error::Error;
use crate::jet::Jet;
use crate::reference::Shape;
use crate::types::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Added to every bound \[unit\]: the rounding of `f64` at distances of 2^31 units, several times.
const ROUNDING: f64 = 4e-6;
/// Echo codes that are looked at one by one where the model is a straight line, and where it is inverted for each.
/// Set by hand.
const CLOSE: (i64, i64) = (512, 16);

/// The largest errors found so far by all threads \[unit\], as bits: those of natural numbers are in order.
#[derive(Default)]
pub(super) struct Records {
    bounded: AtomicU64,
    overall: AtomicU64,
}

impl Records {
    fn raise(record: &AtomicU64, worst: Worst) {
        record.fetch_max(worst.error.max(0.0).to_bits(), Ordering::Relaxed);
    }

    fn take(&self, row: &Row) {
        Self::raise(&self.bounded, row.bounded);
        Self::raise(&self.overall, row.overall);
    }

    /// The error \[unit\] below which nothing is of interest.
    fn least(&self, inside: bool) -> f64 {
        let of = |record: &AtomicU64| f64::from_bits(record.load(Ordering::Relaxed));
        let overall = of(&self.overall);
        if inside {
            overall.min(of(&self.bounded))
        } else {
            overall
        }
    }
}

/// An echo code, the distance there, and how far the line is from it \[unit\].
#[derive(Clone, Copy)]
struct Point {
    echo: i64,
    truth: f64,
    above: f64,
}

/// One row.
pub(super) struct Quick<'a> {
    pub(super) claim: Claim<'a>,
    pub(super) records: &'a Records,
    pub(super) straight: Straight,
    /// The echo codes that it holds for.
    pub(super) codes: Range,
    pub(super) shape: &'a Shape<'a>,
    pub(super) row: usize,
    pub(super) conditions: &'a [f64],
}

/// Why a row has no result.
enum Stop {
    /// The model could not be bounded.
    Unproven,
    Failed(Error),
}

impl Quick<'_> {
    /// The row; `None` if the model could not be bounded there.
    pub(super) fn check(&self) -> Result<Option<Row>, Error> {
        if matches!(self.shape, Shape::Unknown) {
            return Ok(None);
        }
        match self.bounded() {
            Ok(row) => Ok(Some(row)),
            Err(Stop::Unproven) => Ok(None),
            Err(Stop::Failed(error)) => Err(error),
        }
    }

    fn bounded(&self) -> Result<Row, Stop> {
        let codes = self.codes;
        let mut result = Row::new(self.row, self.claim);
        let ends = (self.point(codes.minimum)?, self.point(codes.maximum)?);
        result.within = self.within(ends, result.far)?;
        let beyond = codes.minimum + result.within as i64;
        for (first, last) in [(codes.minimum, beyond - 1), (beyond, codes.maximum)] {
            if first <= last {
                let inside = last < beyond;
                let (near, far) = (self.point(first)?, self.point(last)?);
                for point in [near, far] {
                    self.look(point.echo, point.echo, &mut result)?;
                }
                self.descend(near, far, inside, &mut result)?;
            }
        }
        Ok(result)
    }

    fn truths(&self, from: i64, truth: &mut [f64]) {
        if let Shape::Line { slope, start } = *self.shape {
            let per_meter = self.claim.device.output.per_meter;
            for (echo, truth) in (from..).zip(truth) {
                let time = self.claim.device.echo.value(echo);
                // Rounded as the reference rounds it.
                #[allow(clippy::suboptimal_flops)]
                let distance = slope * time + start;
                *truth = distance * per_meter;
            }
        } else {
            truths(self.claim, self.conditions, from, truth);
        }
    }

    fn point(&self, echo: i64) -> Result<Point, Stop> {
        let mut truth = [0.0];
        self.truths(echo, &mut truth);
        let [truth] = truth;
        if !truth.is_finite() {
            return Err(Stop::Failed(self.fault().no_distance(echo)));
        }
        let above = self.straight.line_at(echo) - truth;
        Ok(Point { echo, truth, above })
    }

    fn fault(&self) -> Fault<'_> {
        Fault {
            device: self.claim.device,
            row: self.row,
        }
    }

    /// How many echo codes have a distance of at most `far` \[unit\], the distance rising.
    fn within(&self, (first, last): (Point, Point), far: f64) -> Result<u64, Stop> {
        let (mut below, mut above) = (first.echo - 1, last.echo + 1);
        let inside = |echo: i64| Ok(self.point(echo)?.truth <= far);
        // Near the chord first, then halves.
        let chord = (last.truth - first.truth) / (last.echo - first.echo) as f64;
        let mut next = first.echo + ((far - first.truth) / chord) as i64;
        let mut width = 2;
        while above - below > 1 {
            let here = next.clamp(below + 1, above - 1);
            if inside(here)? {
                below = here;
                next = here + width;
            } else {
                above = here;
                next = here - width;
            }
            width *= 4;
            if below >= first.echo && above <= last.echo {
                next = i64::midpoint(below, above);
            }
        }
        Ok((below + 1 - first.echo) as u64)
    }

    /// What the error between two echo codes cannot exceed \[unit\]; `None` where the model may fall.
    fn most(&self, near: Point, far: Point) -> Option<f64> {
        let sag = match self.shape {
            Shape::Curve(time) => self.sag(time, near, far)?,
            _ => 0.0,
        };
        let high = near.above.max(far.above) + sag;
        let low = near.above.min(far.above) - sag - self.straight.cut_off();
        Some(high.max(-low) + ROUNDING)
    }

    /// How far the model leaves the chord between two echo codes \[unit\].
    fn sag(&self, time: &dyn Fn(Jet) -> Jet, near: Point, far: Point) -> Option<f64> {
        let device = self.claim.device;
        let unit = device.output.per_meter;
        let bounds = time(Jet::between(near.truth / unit, far.truth / unit));
        let slope = bounds.slope;
        // The line's growth with the echo time [unit/s], and the width [m].
        let growth = self.straight.growth() / device.echo.lsb;
        let width = (far.truth - near.truth) / unit;
        let bent = growth * bounds.bend.magnitude() * width * width / 8.0;
        let turned = growth * (slope.high - slope.low) * width / 4.0;
        // One of them can be infinite, and none is not a number then.
        let sag = if bent < turned { bent } else { turned };
        (slope.low > 0.0 && sag.is_finite()).then_some(sag)
    }

    fn descend(&self, near: Point, far: Point, inside: bool, row: &mut Row) -> Result<(), Stop> {
        let width = far.echo - near.echo;
        let bound = self.most(near, far);
        if bound.is_some_and(|most| most < self.records.least(inside)) {
            return Ok(());
        }
        let close = match self.shape {
            Shape::Line { .. } => CLOSE.0,
            _ => CLOSE.1,
        };
        if width <= close {
            if bound.is_none() {
                return Err(Stop::Unproven);
            }
            return self.look(near.echo, far.echo, row);
        }
        let middle = self.point(i64::midpoint(near.echo, far.echo))?;
        self.descend(near, middle, inside, row)?;
        self.descend(middle, far, inside, row)
    }

    /// Look at each echo code.
    fn look(&self, first: i64, last: i64, row: &mut Row) -> Result<(), Stop> {
        let count = (last - first + 1) as usize;
        let mut truth = vec![0.0; count];
        self.truths(first, &mut truth);
        let outputs: Vec<i32> = (first..=last)
            .map(|echo| self.straight.output(echo))
            .collect();
        if !row.take(&outputs, &truth, first) {
            return Err(Stop::Failed(self.fault().no_distance(first)));
        }
        self.records.take(row);
        Ok(())
    }
}
