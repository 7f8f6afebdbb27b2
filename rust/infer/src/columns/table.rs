//! A table with the columns that are to be made from it.

use super::recipe::Recipe;
use echocal_core::batch::Numbers;
use echocal_core::{Model, Quantity};

/// A table with the columns that are to be made from it.
pub struct Columns<'a> {
    /// The base simulation.
    pub base: &'a Model,
    /// Reference distance or level of every row \[m\].
    pub distance: &'a [f64],
    /// Recorded quantities, in the order of [`Quantity::ALL`].
    pub recorded: [Numbers<'a>; Quantity::COUNT],
    /// Columns that are there.
    pub stored: Vec<&'a [f64]>,
    /// Group of each row and number of rows of each, where the level of a group is unknown.
    pub groups: Option<(&'a [u32], Vec<f64>)>,
    /// What to make.
    pub recipes: &'a [Recipe],
    /// Part of each tangent that the level of each group takes up, once it is found.
    pub taken: Vec<Vec<f64>>,
}
