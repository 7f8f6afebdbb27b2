//! Forms: how the speed factor of each combination of conditions is stored or computed. One form, one file.
//!
//! A form proposes candidates for a [`Fit`], each of which builds the same steps into any
//! [`Builder`](crate::ir::Builder). A new form is a new file and one line: in [`TEMPERATURE_FORMS`], or in
//! [`TWO_CONDITION_FORMS`], or [`BENT_FORMS`].

mod adapted;
mod additive;
mod bent;
mod contract;
mod delays;
mod factored;
mod full_table;
mod grid;
mod interpolated_table;
mod plane;
mod polynomial;
mod segments;
mod shift;
mod square;
mod steps;
mod tail;
mod temperature;

pub use contract::{Fit, Form, Propose, Sample, factors};
pub use delays::Delays;
pub use shift::{Choice, Gain, Shift};
pub use tail::Tail;
pub use temperature::FORMS as TEMPERATURE_FORMS;

/// Every form of temperature and humidity, with its name. To add one, write its file and add its line.
pub const TWO_CONDITION_FORMS: &[(&str, Propose)] = &[
    (additive::NAME, additive::propose),
    (grid::NAME, grid::propose),
];

/// Every form of the temperature and the echo time, for distances that bend, with its name.
pub const BENT_FORMS: &[(&str, Propose)] = &[(bent::NAME, bent::propose)];

/// Every form with its name.
pub fn all() -> impl Iterator<Item = &'static (&'static str, Propose)> {
    let forms = [TEMPERATURE_FORMS, TWO_CONDITION_FORMS, BENT_FORMS];
    forms.into_iter().flatten()
}

/// Whether the form of this name is for distances that bend.
#[must_use]
pub fn is_bent(name: &str) -> bool {
    BENT_FORMS.iter().any(|(form, _)| *form == name)
}

/// Whether the form of this name reads two conditions.
#[must_use]
pub fn reads_two(name: &str) -> bool {
    TWO_CONDITION_FORMS.iter().any(|(form, _)| *form == name)
}
