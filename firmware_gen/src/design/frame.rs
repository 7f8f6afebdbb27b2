//! What forms must follow: the model at each combination of conditions that they read, beside a delay that is taken off
//! before.

use super::request::Request;
use crate::device::Device;
use crate::error::Error;
use crate::form::{Choice, Delays, Gain, Shift, Tail};
use crate::reference::{Line, sample};

/// Columns of the second condition that the search samples. Set by hand; the proof checks all.
const COLUMNS: usize = 17;
/// Codes of each other condition at which a delay is sampled. Set by hand; the proof checks all.
const OTHERS: usize = 9;
/// Share of the bound from which a change matters. Set by hand, as for a bend.
const MATTERS: f64 = 0.1;
/// Formats with a delay of this many are tried beside one condition that sets it. Set by hand: it bounds the search time.
const ALLOWED: usize = 2;

/// The conditions that a form reads, and the lines that it must follow there.
#[derive(Debug)]
pub(super) struct Frame {
    /// The device, without a further input that only delays the echo.
    pub(super) device: Device,
    /// Rows of that device that stand for all until the proof.
    pub(super) picked: Vec<usize>,
    pub(super) lines: Vec<Line>,
    /// What is taken off the echo code before.
    pub(super) shift: Option<Shift>,
    /// What the speed factor is multiplied by after.
    pub(super) gain: Option<Gain>,
}

/// Rows of the device that stand for all, and the model there.
pub(super) fn rows(request: &Request<'_>) -> Result<(Vec<usize>, Vec<Line>), Error> {
    let picked = request.device.thinned(COLUMNS);
    let lines = sample(
        request.reference,
        request.device,
        &picked,
        request.maximum_distance,
    )?;
    Ok((picked, lines))
}

/// What forms can follow for a request, whose `picked` rows have these `lines`.
///
/// # Errors
/// If the model fails somewhere, or if a further input changes more than can be followed.
pub(super) fn frames(
    request: &Request<'_>,
    picked: &[usize],
    lines: &[Line],
) -> Result<Vec<Frame>, Error> {
    let device = request.device;
    let bound = request.maximum_error * device.output.per_meter;
    let plain = Frame {
        device: device.clone(),
        picked: picked.to_vec(),
        lines: lines.to_vec(),
        shift: None,
        gain: None,
    };
    let Some(place) = device.further() else {
        let tails = Tail::propose(lines, device, request.target);
        let least = tails.iter().map(|tail| tail.rest(lines));
        if least.fold(f64::INFINITY, f64::min) <= bound {
            return Ok(vec![plain]);
        }
        // One delay for all temperatures cannot meet the bound: the temperature sets it.
        let delays = Delays::of(0, &sampled(request, 0)?);
        let shifts = shifts(&delays, choice(request, bound));
        let steps = |row: &usize| row / (device.rows() / device.conditions[0].len());
        let shifted = shifts
            .into_iter()
            .map(|shift| plain.shifted(shift, picked.iter().map(steps)));
        return Ok(shifted.chain([plain.copy()]).collect());
    };
    let delays = Delays::of(place, &sampled(request, place)?);
    let (late, grows) = (
        delays.change() > MATTERS * bound,
        delays.growth() > MATTERS * bound,
    );
    check_left(request, place, &delays, (grows, bound))?;
    let choice = choice(request, bound);
    let base = if grows && place == 1 {
        plain
    } else {
        reduced(request, place)?.scaled(Gain::of(&delays, choice).filter(|_| grows))
    };
    if !late {
        return Ok(vec![base]);
    }
    let columns = device.conditions[place].len();
    let whole = base.device.conditions.len() == device.conditions.len();
    let step = |row: &usize| if whole { row % columns } else { columns / 2 };
    let steps: Vec<usize> = base.picked.iter().map(step).collect();
    let shifts = shifts(&delays, choice);
    Ok(shifts
        .into_iter()
        .map(|shift| base.shifted(shift, steps.iter().copied()))
        .collect())
}

/// Refuse a further input that changes more than a delay and a factor follow, before a search that must fail.
fn check_left(
    request: &Request<'_>,
    place: usize,
    delays: &Delays,
    (grows, bound): (bool, f64),
) -> Result<(), Error> {
    let left = delays.left(grows && place > 1);
    if left <= bound {
        return Ok(());
    }
    let axis = &request.device.conditions[place];
    let (words, millimeters) = (axis.word().replace('_', " "), |length: f64| {
        (length * request.device.output.lsb * 1e7).ceil() / 1e4
    });
    let way_out = if place > 1 {
        "leave out the humidity, accept a smaller range, or ask for a larger error"
    } else {
        "accept a smaller range, or ask for a larger error"
    };
    Err(Error::Request(format!(
        "a delay and a factor of the speed for each {words} leave up to {:.4} mm over the other conditions, and {:.4} mm are \
         asked for: {way_out}",
        millimeters(left),
        millimeters(bound),
    )))
}

fn choice<'a>(request: &Request<'a>, bound: f64) -> Choice<'a> {
    Choice {
        device: request.device,
        bound,
        maximum_table: request.maximum_table,
        core: request.target,
        prefer: request.prefer,
    }
}

fn shifts(delays: &Delays, choice: Choice<'_>) -> Vec<Shift> {
    let mut found = Shift::propose(delays, choice);
    found.truncate(ALLOWED);
    found
}

/// The device without its further input, which is the last, at the middle code of it.
fn reduced(request: &Request<'_>, place: usize) -> Result<Frame, Error> {
    let mut device = request.device.clone();
    let columns = device.conditions[place].len();
    device.conditions.truncate(place);
    let picked = device.thinned(COLUMNS);
    let rows: Vec<usize> = picked
        .iter()
        .map(|row| row * columns + columns / 2)
        .collect();
    let lines = sample(
        request.reference,
        request.device,
        &rows,
        request.maximum_distance,
    )?;
    Ok(Frame {
        device,
        picked,
        lines,
        shift: None,
        gain: None,
    })
}

/// The lines at every step of the condition at `place`, each at the same steps of the others.
fn sampled(request: &Request<'_>, place: usize) -> Result<Vec<Vec<Line>>, Error> {
    let mut others = vec![Vec::new()];
    for (index, axis) in request.device.conditions.iter().enumerate() {
        let count = if index == place {
            1
        } else {
            axis.len().min(OTHERS)
        };
        let step = |k: usize| k * (axis.len() - 1) / (count - 1).max(1);
        others = others
            .iter()
            .flat_map(|one: &Vec<usize>| (0..count).map(move |k| [&one[..], &[step(k)]].concat()))
            .collect();
    }
    let at = |step: usize| {
        let row = |other: &Vec<usize>| {
            let mut steps = other.clone();
            steps[place] = step;
            request.device.row(&steps)
        };
        let rows: Vec<usize> = others.iter().map(row).collect();
        sample(
            request.reference,
            request.device,
            &rows,
            request.maximum_distance,
        )
    };
    (0..request.device.conditions[place].len())
        .map(at)
        .collect()
}

impl Frame {
    /// The same, a delay taken off before; `steps` are those of its condition at the picked rows.
    fn shifted(&self, shift: Shift, steps: impl Iterator<Item = usize>) -> Self {
        let lines = self.lines.iter().zip(steps);
        let lines = lines.map(|(line, step)| shift.line(line, step)).collect();
        let mut device = self.device.clone();
        device.echo = shift.echo(&device.echo);
        Self {
            device,
            picked: self.picked.clone(),
            lines,
            shift: Some(shift),
            gain: self.gain.clone(),
        }
    }

    /// The same, a factor of the speed taken after.
    fn scaled(self, gain: Option<Gain>) -> Self {
        let Some(gain) = gain else { return self };
        Self {
            lines: self.lines.iter().map(|line| gain.line(line)).collect(),
            gain: Some(gain),
            ..self
        }
    }

    fn copy(&self) -> Self {
        Self {
            device: self.device.clone(),
            picked: self.picked.clone(),
            lines: self.lines.clone(),
            shift: self.shift.clone(),
            gain: self.gain.clone(),
        }
    }

    /// The error that delay and factor leave \[unit\].
    pub(super) fn rest(&self) -> f64 {
        self.shift.as_ref().map_or(0.0, Shift::rest) + self.gain.as_ref().map_or(0.0, Gain::rest)
    }
}
