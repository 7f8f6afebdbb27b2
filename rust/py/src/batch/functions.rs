//! The functions themselves: signatures and documentation.

use echocal_core::Quantity;
use pyo3::prelude::*;
use pyo3::types::PyFloat;

use super::absurd::{ANY, range_of};
use super::arguments::{Input, Options, Range, Threads};
use super::cache::{DEFAULT_LAW, Function, entry};
use super::call::call;
use super::documentation::{air, law, options};
use crate::laws::{LawText, speed_text};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Speed of sound in moist air [m/s].
///
/// Parameters
/// ----------
#[doc = air!()]
#[doc = law!()]
#[doc = options!("speed_of_sound : float or array")]
/// References
/// ----------
/// Cramer 1993, J. Acoust. Soc. Am. 93, 2510, doi:10.1121/1.405827 (the default law).
/// Dispersion: IEC 61094-2:2009, annex F.
///
/// Examples
/// --------
/// >>> import echocal
/// >>> round(echocal.speed_of_sound(20.0, 0.5), 3)
/// 343.987
/// >>> echocal.speed_of_sound([0.0, 20.0], law="linear")
/// array([331.4, 343.4])
#[pyfunction]
#[pyo3(
    signature = (temperature, relative_humidity=None, pressure=None, co2_mole_fraction=None,
        *, law=LawText(DEFAULT_LAW), frequency=None, out=None, r#where=None, n_threads=None),
    text_signature = "(temperature, relative_humidity=0.0, pressure=101325.0, \
        co2_mole_fraction=0.0004, *, law='cramer', frequency=0.0, out=None, where=None, n_threads=None)"
)]
#[allow(clippy::too_many_arguments)] // each is a keyword in Python
pub fn speed_of_sound<'py>(
    py: Python<'py>,
    temperature: &Bound<'py, PyAny>,
    relative_humidity: Argument<'_, 'py>,
    pressure: Argument<'_, 'py>,
    co2_mole_fraction: Argument<'_, 'py>,
    law: LawText<'_>,
    frequency: Argument<'_, 'py>,
    out: Argument<'_, 'py>,
    r#where: Argument<'_, 'py>,
    n_threads: Option<Threads>,
) -> PyResult<Bound<'py, PyAny>> {
    let inputs = [
        temperature_of(temperature),
        recorded(Quantity::RelativeHumidity, relative_humidity),
        recorded(Quantity::Pressure, pressure),
        recorded(Quantity::Co2MoleFraction, co2_mole_fraction),
        or("frequency", frequency, 0.0),
    ];
    let options = Options {
        out,
        condition: r#where,
        n_threads,
    };
    of_law(py, Function::SpeedOfSound, law.0, &inputs, &options)
}

/// Time of flight of an echo, out and back [s].
///
/// Parameters
/// ----------
/// distance : array_like
///     One-way distance to the target [m].
#[doc = air!()]
#[doc = law!()]
#[doc = options!("time_of_flight : float or array")]
/// References
/// ----------
/// Of the default law: Cramer 1993, J. Acoust. Soc. Am. 93, 2510, doi:10.1121/1.405827.
///
/// Examples
/// --------
/// >>> import echocal
/// >>> round(1e6 * echocal.time_of_flight(2.0, 20.0), 2)  # microseconds
/// 11649.6
#[pyfunction]
#[pyo3(
    signature = (distance, temperature, relative_humidity=None, pressure=None, co2_mole_fraction=None,
        *, law=LawText(DEFAULT_LAW), frequency=None, out=None, r#where=None, n_threads=None),
    text_signature = "(distance, temperature, relative_humidity=0.0, pressure=101325.0, \
        co2_mole_fraction=0.0004, *, law='cramer', frequency=0.0, out=None, where=None, n_threads=None)"
)]
#[allow(clippy::too_many_arguments)] // each is a keyword in Python
pub fn time_of_flight<'py>(
    py: Python<'py>,
    distance: &Bound<'py, PyAny>,
    temperature: &Bound<'py, PyAny>,
    relative_humidity: Argument<'_, 'py>,
    pressure: Argument<'_, 'py>,
    co2_mole_fraction: Argument<'_, 'py>,
    law: LawText<'_>,
    frequency: Argument<'_, 'py>,
    out: Argument<'_, 'py>,
    r#where: Argument<'_, 'py>,
    n_threads: Option<Threads>,
) -> PyResult<Bound<'py, PyAny>> {
    let inputs = [
        ranged(given("distance", distance)),
        temperature_of(temperature),
        recorded(Quantity::RelativeHumidity, relative_humidity),
        recorded(Quantity::Pressure, pressure),
        recorded(Quantity::Co2MoleFraction, co2_mole_fraction),
        or("frequency", frequency, 0.0),
    ];
    let options = Options {
        out,
        condition: r#where,
        n_threads,
    };
    of_law(py, Function::TimeOfFlight, law.0, &inputs, &options)
}

/// Distance of an echo's target [m]: the compensation of air.
///
/// Parameters
/// ----------
/// time_of_flight : array_like
///     Time of flight, out and back [s].
#[doc = air!()]
#[doc = law!()]
#[doc = options!("distance : float or array")]
/// References
/// ----------
/// Of the default law: Cramer 1993, J. Acoust. Soc. Am. 93, 2510, doi:10.1121/1.405827.
///
/// Examples
/// --------
/// >>> import echocal
/// >>> round(echocal.distance(0.01, 20.0, 0.5), 6)
/// 1.719934
/// >>> import numpy as np
/// >>> echocal.distance(np.float32([0.01, np.nan]), 20.0).dtype
/// dtype('float32')
#[pyfunction]
#[pyo3(
    signature = (time_of_flight, temperature, relative_humidity=None, pressure=None, co2_mole_fraction=None,
        *, law=LawText(DEFAULT_LAW), frequency=None, out=None, r#where=None, n_threads=None),
    text_signature = "(time_of_flight, temperature, relative_humidity=0.0, pressure=101325.0, \
        co2_mole_fraction=0.0004, *, law='cramer', frequency=0.0, out=None, where=None, n_threads=None)"
)]
#[allow(clippy::too_many_arguments)] // each is a keyword in Python
pub fn distance<'py>(
    py: Python<'py>,
    time_of_flight: &Bound<'py, PyAny>,
    temperature: &Bound<'py, PyAny>,
    relative_humidity: Argument<'_, 'py>,
    pressure: Argument<'_, 'py>,
    co2_mole_fraction: Argument<'_, 'py>,
    law: LawText<'_>,
    frequency: Argument<'_, 'py>,
    out: Argument<'_, 'py>,
    r#where: Argument<'_, 'py>,
    n_threads: Option<Threads>,
) -> PyResult<Bound<'py, PyAny>> {
    let inputs = [
        ranged(given("time_of_flight", time_of_flight)),
        temperature_of(temperature),
        recorded(Quantity::RelativeHumidity, relative_humidity),
        recorded(Quantity::Pressure, pressure),
        recorded(Quantity::Co2MoleFraction, co2_mole_fraction),
        or("frequency", frequency, 0.0),
    ];
    let options = Options {
        out,
        condition: r#where,
        n_threads,
    };
    of_law(py, Function::Distance, law.0, &inputs, &options)
}

/// Error of indication [m] of a device that converts echo times with a formula of its own.
///
/// Parameters
/// ----------
/// distance : array_like
///     One-way distance to the target [m].
#[doc = air!()]
/// reading_speed : str or float, default "linear"
///     Speed that the device converts with: a constant [m/s], or a law as for `law`.
#[doc = law!()]
#[doc = options!("error : float or array")]
/// References
/// ----------
/// Of the default law: Cramer 1993, J. Acoust. Soc. Am. 93, 2510, doi:10.1121/1.405827.
///
/// Examples
/// --------
/// >>> import echocal
/// >>> round(1e3 * echocal.error(2.0, 0.0, 0.5, reading_speed=343), 1)  # millimeters
/// 68.7
#[pyfunction]
#[pyo3(
    signature = (distance, temperature, relative_humidity=None, pressure=None,
        co2_mole_fraction=None, *, reading_speed=None, law=LawText(DEFAULT_LAW), frequency=None, out=None,
        r#where=None, n_threads=None),
    text_signature = "(distance, temperature, relative_humidity=0.0, pressure=101325.0, \
        co2_mole_fraction=0.0004, *, reading_speed='linear', law='cramer', frequency=0.0, \
        out=None, where=None, n_threads=None)"
)]
#[allow(clippy::too_many_arguments)] // each is a keyword in Python
pub fn error<'py>(
    py: Python<'py>,
    distance: &Bound<'py, PyAny>,
    temperature: &Bound<'py, PyAny>,
    relative_humidity: Argument<'_, 'py>,
    pressure: Argument<'_, 'py>,
    co2_mole_fraction: Argument<'_, 'py>,
    reading_speed: Argument<'_, 'py>,
    law: LawText<'_>,
    frequency: Argument<'_, 'py>,
    out: Argument<'_, 'py>,
    r#where: Argument<'_, 'py>,
    n_threads: Option<Threads>,
) -> PyResult<Bound<'py, PyAny>> {
    let inputs = [
        ranged(given("distance", distance)),
        temperature_of(temperature),
        recorded(Quantity::RelativeHumidity, relative_humidity),
        recorded(Quantity::Pressure, pressure),
        recorded(Quantity::Co2MoleFraction, co2_mole_fraction),
        or("frequency", frequency, 0.0),
    ];
    let options = Options {
        out,
        condition: r#where,
        n_threads,
    };
    let reading = reading_speed.map_or_else(|| Ok("linear".to_owned()), speed_text)?;
    of_law(
        py,
        Function::Error,
        &format!("{reading}|{}", law.0),
        &inputs,
        &options,
    )
}

/// Attenuation of a pure tone by moist air [dB/m].
///
/// Parameters
/// ----------
/// temperature : array_like
///     Air temperature [degC].
/// relative_humidity : array_like
///     Relative humidity over liquid water [1], 0 to 1.
/// pressure : array_like
///     Air pressure [Pa].
/// frequency : array_like
///     Frequency of the sound [Hz].
#[doc = options!("absorption : float or array")]
/// References
/// ----------
/// ISO 9613-1:1993, equations (3) to (5); valid for -20..50 degC.
///
/// Examples
/// --------
/// >>> import echocal
/// >>> round(echocal.absorption(20.0, 0.5, 101325.0, 40e3), 2)
/// 1.32
#[pyfunction]
#[pyo3(
    signature = (temperature, relative_humidity, pressure, frequency, *, out=None, r#where=None,
        n_threads=None),
    text_signature = "(temperature, relative_humidity, pressure, frequency, *, out=None, \
        where=None, n_threads=None)"
)]
#[allow(clippy::too_many_arguments)] // each is a keyword in Python
pub fn absorption<'py>(
    py: Python<'py>,
    temperature: &Bound<'py, PyAny>,
    relative_humidity: &Bound<'py, PyAny>,
    pressure: &Bound<'py, PyAny>,
    frequency: &Bound<'py, PyAny>,
    out: Argument<'_, 'py>,
    r#where: Argument<'_, 'py>,
    n_threads: Option<Threads>,
) -> PyResult<Bound<'py, PyAny>> {
    let inputs = [
        temperature_of(temperature),
        ranged(given("relative_humidity", relative_humidity)),
        ranged(given("pressure", pressure)),
        given("frequency", frequency),
    ];
    let options = Options {
        out,
        condition: r#where,
        n_threads,
    };
    let function = Function::Absorption;
    let entry = entry(py, function, "", false)?;
    call(py, &entry, function.label(), &inputs, &options)
}

fn given<'a, 'py>(name: &'static str, value: &'a Bound<'py, PyAny>) -> Input<'a, 'py> {
    or(name, Some(value), f64::NAN)
}

/// A quantity of the air, by default as everywhere.
fn recorded<'a, 'py>(quantity: Quantity, given: Argument<'a, 'py>) -> Input<'a, 'py> {
    let facts = quantity.facts();
    ranged(or(facts.name, given, facts.default.unwrap_or(f64::NAN)))
}

fn temperature_of<'a, 'py>(value: &'a Bound<'py, PyAny>) -> Input<'a, 'py> {
    const RANGE: Range = range_of("temperature");
    Input {
        range: RANGE,
        ..given("temperature", value)
    }
}

/// With the range beyond which another unit is meant.
fn ranged<'a, 'py>(input: Input<'a, 'py>) -> Input<'a, 'py> {
    let range = input.given.map_or(ANY, |_| range_of(input.name));
    Input { range, ..input }
}

fn or<'a, 'py>(name: &'static str, given: Argument<'a, 'py>, default: f64) -> Input<'a, 'py> {
    Input {
        name,
        given,
        default,
        range: ANY,
        depth: 1,
    }
}

/// A function with a law; the last input is the frequency, which is left out where plainly zero.
fn of_law<'py>(
    py: Python<'py>,
    function: Function,
    laws: &str,
    inputs: &[Input<'_, 'py>],
    options: &Options<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let (frequency, others) = inputs.split_last().expect("a function has inputs");
    let zero = |f: &Bound<'py, PyAny>| {
        f.is_exact_instance_of::<PyFloat>() && f.extract().is_ok_and(|f: f64| f == 0.0)
    };
    let plain = frequency.given.is_none_or(zero);
    let inputs = if plain { others } else { inputs };
    let entry = entry(py, function, laws, !plain)?;
    call(py, &entry, function.label(), inputs, options)
}
