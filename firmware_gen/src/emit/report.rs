//! The machine-readable report. Every figure in it was proven or measured; figures that were not measured are null.

use super::reach::Reach;
use crate::design::Design;
use crate::device::Device;
use crate::filter::Filter;
use crate::prove::Worst;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// The origin of the firmware, and the request.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Provenance {
    /// Version of echocal.
    pub version: String,
    /// What files, functions and macros are called: their names begin with it.
    pub name: String,
    /// The command that makes the same files again.
    pub command: String,
    /// The target's name.
    pub target: String,
    /// How it is packed.
    pub package: String,
    /// What the search saved, `size` or `speed`.
    pub prefer: String,
    /// Hash of the model.
    pub model_hash: String,
    /// The model, a line each: law, effects, air.
    pub model: Vec<String>,
    /// The diagnosis that the model comes from, a line each; none where it comes from elsewhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub diagnosis: Vec<String>,
    /// Standard uncertainty \[m\] of a distance \[m\] that the model corrects, at 20 degC; empty if it states none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub standard_uncertainty: Vec<(f64, f64)>,
    /// Each parameter with a known standard uncertainty, a line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fitted: Vec<String>,
    /// Where the accepted codes leave the domain of the law, a line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub outside_domain: Vec<String>,
    /// The median filter that is written beside the function.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub filter: Option<Filter>,
    /// The conditions of which the function drops bits, and what that costs, a line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub resolution: Vec<String>,
    /// The assumed values of conditions that the device does not measure, a line each.
    pub assumptions: Vec<String>,
    /// The effects and conditions behind them: effect, quantity, whether a value is assumed, error left \[m\].
    #[serde(skip)]
    pub omissions: Vec<Value>,
    /// Requested error bound \[m\].
    pub maximum_error: f64,
    /// Distances up to this are bounded \[m\].
    pub maximum_distance: f64,
}

/// The measured cost of the function on one core.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Measurement {
    /// The core that ran it.
    pub core: String,
    /// The compiler, with its version.
    pub compiler: String,
    /// Its options.
    pub options: String,
    /// The simulator, with its version.
    pub simulator: String,
    /// Flash, with what the function takes from the compiler's library \[byte\].
    pub flash_bytes: u64,
    /// Flash of the function and its tables alone \[byte\].
    pub own_flash_bytes: u64,
    /// Variables of static storage duration \[byte\].
    pub ram_bytes: u64,
    /// Stack of a call, with the return address where it is kept there \[byte\].
    pub stack_bytes: u64,
    /// Most cycles of a call, `call` and `ret` included, where the simulator counts them.
    pub cycles: Option<u64>,
    /// Fewest of them; the same where the function takes constant time.
    pub fewest_cycles: Option<u64>,
    /// Most instructions of a call, its return included, where the simulator counts those.
    pub instructions: Option<u64>,
    /// Fewest of them.
    pub fewest_instructions: Option<u64>,
}

/// The uncertainty of a distance that the device gives.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Uncertainty {
    /// What it includes, a line each.
    pub includes: Vec<String>,
    /// Distance \[m\] and expanded uncertainty there \[m\].
    pub expanded: Vec<(f64, f64)>,
    /// A line that is nowhere below it: its value at 0 \[m\].
    pub offset: f64,
    /// The slope of that line \[1\].
    pub slope: f64,
}

/// `report.json`: the keys in alphabetical order, so that equal reports are equal bytes.
pub fn report(
    design: &Design,
    device: &Device,
    provenance: &Provenance,
    (measured, uncertainty): (&[Measurement], &Uncertainty),
    reach: Reach,
) -> String {
    let proof = &design.proof;
    let here = measured
        .iter()
        .find(|found| found.core == provenance.target);
    let report = json!({
        "schema": "echocal.firmware/1",
        "provenance": provenance,
        "model_hash": provenance.model_hash,
        "name": provenance.name,
        "statuses": device.statuses().iter().map(|status| status.words()).collect::<Vec<_>>(),
        "first_time_out_code": device.time_out(),
        "target": provenance.target,
        "assumptions": provenance.assumptions,
        "omissions": provenance.omissions,
        "device": device,
        "form": form(design, device),
        "error_bound_m": provenance.maximum_error,
        "maximum_distance_m": provenance.maximum_distance,
        "error_proven_m": proof.bounded.error * device.output.lsb,
        "expanded_uncertainty": uncertainty,
        "reach_m": reach,
        "worst_input": input(device, proof.bounded),
        "inputs_within": proof.bounded_inputs,
        "error_overall_m": proof.overall.error * device.output.lsb,
        "worst_input_overall": input(device, proof.overall),
        "inputs_checked": proof.inputs,
        "output_hash": format!("{:016x}", proof.hash),
        "overflow_free": true,
        "monotone_in_echo_time": true,
        "table_bytes": design.program.table_bytes(),
        "widest_bits": design.program.widest(),
        "measured": measured,
        "ram_bytes": here.map_or(0, |found| found.ram_bytes), // without a measurement: none is declared
        "flash_bytes": here.map(|found| found.flash_bytes),
        "stack_bytes": here.map(|found| found.stack_bytes),
        "cycles": here.and_then(|found| found.cycles),
        "instructions": here.and_then(|found| found.instructions),
    });
    serde_json::to_string_pretty(&report).map_or_else(|error| error.to_string(), |text| text + "\n")
}

fn form(design: &Design, device: &Device) -> Value {
    let mut form = json!({
        "name": design.form.name(),
        "description": design.describe(device),
        "parameters": design.form.parameters(),
        "tail": design.tail,
    });
    if let Some(shift) = &design.shift {
        form["delay"] = shift.parameters(device);
    }
    if let Some(gain) = &design.gain {
        form["factor"] = gain.parameters(device);
    }
    form
}

/// The codes of an input, and the conditions they stand for.
fn input(device: &Device, worst: Worst) -> Value {
    let mut input = json!({ &device.echo.name: worst.echo });
    for (axis, code) in device.conditions.iter().zip(device.codes(worst.row)) {
        input[&axis.name] = json!(code);
        input[&axis.quantity] = json!(axis.value(code));
    }
    input
}
