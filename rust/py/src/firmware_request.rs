//! Parts of a request for firmware, as Python gives them: codes, uncertainties, measured costs.

use echocal_firmware::device::check_rows;
use echocal_firmware::{Axis, Codes, Error, Measurement, Uncertainty};
use pyo3::prelude::*;

/// LSB, lowest and highest value, the value of code 0, and the bits that the function drops.
pub type Condition = (f64, f64, f64, f64, u32);

/// A further quantity, and its codes.
pub type Further = (String, Condition);

/// The first code, temperatures from it on \[degC\], and words.
pub type Scale = (i64, Vec<f64>, String);

/// The conditions that a device measures.
///
/// # Errors
/// If codes are invalid, or too many together.
pub fn conditions(
    temperature: Condition,
    thermistor: &Option<Scale>,
    humidity: Option<Condition>,
    further: &Option<Further>,
) -> Result<Vec<Axis>, Error> {
    let axis = |quantity: &str, (lsb, low, high, zero, shift): Condition| {
        let codes = Codes {
            lsb,
            low,
            high,
            zero,
            shift,
        };
        Axis::of(quantity, codes)
    };
    let mut axes = vec![match thermistor {
        Some((first, values, words)) => Axis::thermistor(*first, values.clone(), words.clone())?,
        None => axis("temperature", temperature)?,
    }];
    if let Some(humidity) = humidity {
        axes.push(axis("relative_humidity", humidity)?);
    }
    if let Some((quantity, codes)) = further {
        axes.push(axis(quantity, *codes)?);
    }
    check_rows(&axes)?;
    Ok(axes)
}

/// What Python says of the uncertainty of an output.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct StatedUncertainty {
    includes: Vec<String>,
    expanded: Vec<(f64, f64)>,
    offset: f64,
    slope: f64,
}

impl From<StatedUncertainty> for Uncertainty {
    fn from(stated: StatedUncertainty) -> Self {
        Self {
            includes: stated.includes,
            expanded: stated.expanded,
            offset: stated.offset,
            slope: stated.slope,
        }
    }
}

/// What Python measured on one core.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Measured {
    core: String,
    compiler: String,
    options: String,
    simulator: String,
    flash_bytes: u64,
    own_flash_bytes: u64,
    ram_bytes: u64,
    stack_bytes: u64,
    cycles: Option<u64>,
    fewest_cycles: Option<u64>,
    instructions: Option<u64>,
    fewest_instructions: Option<u64>,
}

impl From<Measured> for Measurement {
    fn from(found: Measured) -> Self {
        Self {
            core: found.core,
            compiler: found.compiler,
            options: found.options,
            simulator: found.simulator,
            flash_bytes: found.flash_bytes,
            own_flash_bytes: found.own_flash_bytes,
            ram_bytes: found.ram_bytes,
            stack_bytes: found.stack_bytes,
            cycles: found.cycles,
            fewest_cycles: found.fewest_cycles,
            instructions: found.instructions,
            fewest_instructions: found.fewest_instructions,
        }
    }
}
