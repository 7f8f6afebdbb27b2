//! The function that says why codes are refused.

use super::outside;
use crate::device::{Device, Status};
use serde::Serialize;

/// A status, and the codes that have it.
#[derive(Serialize)]
pub(super) struct StatusText {
    name: String,
    words: &'static str,
    /// Conditions in C, any of which gives this status if none before does; none for [`Status::Ok`].
    tests: Vec<String>,
}

/// Every status, in the order of its number.
pub(super) fn statuses(device: &Device) -> Vec<StatusText> {
    let text = |status: Status| StatusText {
        name: status.identifier(),
        words: status.words(),
        tests: tests(device, status),
    };
    device.statuses().iter().copied().map(text).collect()
}

fn tests(device: &Device, status: Status) -> Vec<String> {
    let echo = &device.echo;
    let (name, codes) = (&echo.name, echo.codes);
    let time_out = device.time_out();
    let condition = |quantity: &str| {
        let axes = device.conditions.iter();
        axes.filter(|axis| axis.quantity == quantity)
            .flat_map(outside)
            .collect()
    };
    let when = |is: bool, test: String| is.then_some(test);
    let tests = match status {
        Status::Ok => vec![],
        Status::NoEcho => vec![
            when(codes.minimum > 0, format!("({name} == 0U)")),
            time_out.map(|first| format!("({name} >= {first}U)")),
        ],
        Status::TooNear => vec![when(
            codes.minimum > 1,
            format!("({name} < {}U)", codes.minimum),
        )],
        Status::TooFar => vec![when(
            codes.maximum + 1 < time_out.unwrap_or(echo.ty.range().maximum + 1),
            format!("({name} > {}U)", codes.maximum),
        )],
        Status::TemperatureOutOfRange => return condition("temperature"),
        Status::HumidityOutOfRange => return condition("relative_humidity"),
        Status::FurtherOutOfRange => {
            let axis = device.further().map(|place| &device.conditions[place]);
            return axis.into_iter().flat_map(outside).collect();
        }
    };
    tests.into_iter().flatten().collect()
}
