//! Codes of a firmware, as Python gives them.

use echocal_firmware::device::check_rows;
use echocal_firmware::{Axis, Codes, Error};

/// LSB, lowest and highest value, the value of code 0, and the bits that the function drops.
pub type Condition = (f64, f64, f64, f64, u32);

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
    check_rows(&axes)?;
    Ok(axes)
}
