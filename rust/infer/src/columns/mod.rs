//! What a cause would add to the readings: one column for each linear form of each candidate cause.
//!
//! A column is a derivative of the base simulation, a difference of two simulations, or a basis
//! function of a recorded quantity. It is described by a [`Recipe`] and made a block of rows at a
//! time, where a pass over the rows needs it.

mod distinct;
mod from_parts;
mod legendre;
mod maker;
mod onsets;
mod pass;
mod recipe;
mod table;
mod waves;

pub use distinct::Distinct;
pub use from_parts::FromParts;
pub use recipe::{BasisFunction, Level, Recipe};
pub use table::Columns;
