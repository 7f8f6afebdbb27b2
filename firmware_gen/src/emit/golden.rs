//! Golden vectors: inputs and bit-exact outputs, for a port that the user writes.

use crate::design::Design;
use crate::device::Device;
use crate::ir::Range;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Steps of an even grid over each axis. Set by hand: 16^3 vectors at most, a file of some 100 kB.
const SPREAD: i64 = 15;

/// Golden vectors as CSV: a column for each input, the distance in the unit of the output, the status. The vectors are a grid
/// over the accepted codes, the codes next to the range outside, and the two inputs with the largest errors.
pub fn golden(design: &Design, device: &Device) -> String {
    let axes: Vec<_> = device.axes().collect();
    let mut inputs: BTreeSet<Vec<i64>> = BTreeSet::from([Vec::new()]);
    for axis in &axes {
        let mut codes = spread(axis.codes, axis.ty.range());
        if axis.quantity == device.echo.quantity {
            codes.extend(
                device
                    .time_out()
                    .into_iter()
                    .flat_map(|first| [first - 1, first]),
            );
        }
        let extended = inputs.iter().flat_map(|input| {
            codes
                .iter()
                .map(move |code| [&input[..], &[*code]].concat())
        });
        inputs = extended.collect();
    }
    for worst in [design.proof.bounded, design.proof.overall] {
        inputs.insert([&[worst.echo][..], &device.codes(worst.row)].concat());
    }
    let names: Vec<&str> = axes.iter().map(|axis| axis.name.as_str()).collect();
    let mut text = format!(
        "{},distance_{},status\n",
        names.join(","),
        device.output.suffix()
    );
    for input in inputs {
        let output = design.output(device, &input);
        for code in &input {
            let _ = write!(text, "{code},");
        }
        let _ = writeln!(text, "{output},{}", device.status(&input) as u8);
    }
    text
}

/// Codes spread over a range, and those next to it that the type still holds.
fn spread(codes: Range, held: Range) -> BTreeSet<i64> {
    let span = codes.maximum - codes.minimum;
    let inside = (0..=SPREAD).map(|k| codes.minimum + span * k / SPREAD);
    let outside = [
        codes.minimum - 1,
        codes.maximum + 1,
        held.minimum,
        held.maximum,
    ];
    inside
        .chain(outside.into_iter().filter(|code| held.contains(*code)))
        .collect()
}
