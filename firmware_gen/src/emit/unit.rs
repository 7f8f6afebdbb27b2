//! The files that put the parameters of a single unit before the proven function: block, loading, adjustment in the field.

use super::parameter;
use super::templates::render;
use crate::device::Device;
use crate::error::Error;
use minijinja::context;
use serde_json::Value;

const PARTS: &[(&str, &str)] = &[
    ("echocal_unit.h", "c/echocal_unit.h"),
    ("echocal_unit.c", "c/echocal_unit.c"),
];

/// Path and text of each file. `layout` holds the integers of the correction as JSON, as the templates name them.
///
/// # Errors
/// [`Error::Template`] if a template fails: a layout without what it needs, or a defect of this crate.
pub fn unit_files(
    device: &Device,
    name: &str,
    layout: &str,
) -> Result<Vec<(String, String)>, Error> {
    let layout: Value = serde_json::from_str(layout)
        .map_err(|error| Error::Template(format!("of the unit data: {error}")))?;
    let context = context! {
        parameters => device.axes().map(|axis| parameter(axis, device)).collect::<Vec<_>>(),
        function => format!("{name}_distance_{}", device.output.unit),
        output_unit => device.output.unit,
        time_out => device.time_out(),
        layout,
    };
    render(PARTS, &context, name)
}
