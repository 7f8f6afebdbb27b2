//! The files that stand before the proven function: the parameters of a single unit with block, loading and adjustment in
//! the field; the air temperature of a thermometer that lags.

use super::parameter;
use super::templates::render;
use crate::device::Device;
use crate::error::Error;
use minijinja::context;
use serde_json::Value;

const AIR: &[(&str, &str)] = &[
    ("echocal_air.h", "c/echocal_air.h"),
    ("echocal_air.c", "c/echocal_air.c"),
];
const PARTS: &[(&str, &str)] = &[
    ("echocal_unit.h", "c/echocal_unit.h"),
    ("echocal_unit.c", "c/echocal_unit.c"),
];

/// Path and text of each file for the parameters of single units. `layout` holds the integers of the correction as JSON, as
/// the templates name them.
///
/// # Errors
/// [`Error::Template`] if a template fails: a layout without what it needs, or a defect of this crate.
pub fn unit_files(
    device: &Device,
    name: &str,
    layout: &str,
) -> Result<Vec<(String, String)>, Error> {
    files(PARTS, device, name, layout)
}

/// The same for the air temperature of a thermometer that lags.
///
/// # Errors
/// As for [`unit_files`].
pub fn air_files(
    device: &Device,
    name: &str,
    layout: &str,
) -> Result<Vec<(String, String)>, Error> {
    files(AIR, device, name, layout)
}

fn files(
    parts: &[(&str, &str)],
    device: &Device,
    name: &str,
    layout: &str,
) -> Result<Vec<(String, String)>, Error> {
    let layout: Value = serde_json::from_str(layout)
        .map_err(|error| Error::Template(format!("of the files beside the function: {error}")))?;
    let context = context! {
        parameters => device.axes().map(|axis| parameter(axis, device)).collect::<Vec<_>>(),
        function => format!("{name}_distance_{}", device.output.unit),
        output_unit => device.output.unit,
        time_out => device.time_out(),
        layout,
    };
    render(parts, &context, name)
}
