//! Effects that set in somewhere along a quantity: of many beginnings, a row counts for one.
//!
//! From its beginning on a tangent is the same as that of any earlier one. What each has beyond the
//! next is nothing but in the rows between the two, so that nearly all of it is zero in a block and
//! left out of the sums; a tangent is the sum of these parts from its own on, and so are its products.

use super::recipe::{Level, Recipe};
use crate::model::Term;
use std::borrow::Cow;

/// Columns that differ in their beginning alone, the earliest first.
#[derive(Clone, Debug, Default)]
pub(super) struct Onsets(Vec<Vec<usize>>);

impl Onsets {
    /// Makes of each such column what it has beyond the next.
    pub(super) fn part(recipes: &mut [Recipe]) -> Self {
        let mut found: Vec<Vec<usize>> = Vec::new();
        for (at, recipe) in recipes.iter().enumerate() {
            let alike = |others: &&mut Vec<usize>| elsewhere(recipe, &recipes[others[0]]);
            if let Some(others) = found.iter_mut().find(alike) {
                others.push(at);
            } else if onset(recipe).is_some() {
                found.push(vec![at]);
            }
        }
        for columns in &mut found {
            columns.sort_by(|&a, &b| f64::total_cmp(&place(&recipes[a]), &place(&recipes[b])));
            for pair in columns.windows(2) {
                recipes[pair[0]] = beyond(&recipes[pair[0]], &recipes[pair[1]]);
            }
        }
        Self(found)
    }

    /// Products of each two columns from those of their parts.
    pub(super) fn matrix<'a>(&self, parts: &'a [f64], width: usize) -> Cow<'a, [f64]> {
        let mut whole = Cow::Borrowed(parts);
        for pair in self.pairs() {
            let lines = whole.to_mut();
            for other in 0..width {
                lines[pair[0] * width + other] += lines[pair[1] * width + other];
            }
        }
        if let Cow::Owned(lines) = &mut whole {
            lines
                .chunks_exact_mut(width)
                .for_each(|line| self.add(line));
        }
        whole
    }

    /// Products of the columns with one that has no beginning, from those of their parts.
    pub(super) fn line<'a>(&self, parts: &'a [f64]) -> Cow<'a, [f64]> {
        let mut whole = Cow::Borrowed(parts);
        if self.pairs().next().is_some() {
            self.add(whole.to_mut());
        }
        whole
    }

    fn add(&self, line: &mut [f64]) {
        for pair in self.pairs() {
            line[pair[0]] += line[pair[1]];
        }
    }

    /// Each column and the one that begins next, the latest first.
    fn pairs(&self) -> impl Iterator<Item = &[usize]> {
        self.0.iter().flat_map(|columns| columns.windows(2).rev())
    }
}

/// An effect and the position of the parameter that says where it sets in, of its tangent at the base.
fn onset(recipe: &Recipe) -> Option<(&Term, usize)> {
    let Recipe::Tangent(term, Level::OfBase, parameter, _) = recipe else {
        return None;
    };
    let (position, _) = term.facts().divides()?;
    (position != *parameter).then_some((term, position))
}

/// Where the effect of a tangent sets in.
fn place(recipe: &Recipe) -> f64 {
    onset(recipe).map_or(f64::NAN, |(term, position)| term.parameters[position])
}

/// A tangent with its beginning elsewhere.
fn moved(recipe: &Recipe, to: f64) -> Recipe {
    let mut moved = recipe.clone();
    if let (Recipe::Tangent(term, ..), Some((_, position))) = (&mut moved, onset(recipe)) {
        term.parameters[position] = to;
    }
    moved
}

/// Whether two tangents differ in nothing but where their effect sets in.
fn elsewhere(recipe: &Recipe, other: &Recipe) -> bool {
    onset(recipe).is_some() && moved(recipe, place(other)) == *other
}

/// What a tangent has beyond another one.
fn beyond(recipe: &Recipe, later: &Recipe) -> Recipe {
    let (Recipe::Tangent(term, _, parameter, scale), Recipe::Tangent(later, ..)) = (recipe, later)
    else {
        return recipe.clone();
    };
    Recipe::Between(term.clone(), later.clone(), *parameter, *scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditions::Quantity;
    use crate::evidence::{Columns, Distinct, Layout, Numbers, Products};
    use crate::{Law, Model};

    const ROWS: usize = 1500;

    fn recipes() -> Option<Vec<Recipe>> {
        let tangent = |id, parameters: &[(&str, f64)], scale| {
            let term = Term::new(id, parameters).ok()?;
            Some(Recipe::Tangent(term, Level::OfBase, 0, scale))
        };
        let step = |time, scale| tangent("step_change", &[("time", time)], scale);
        [
            Some(Recipe::Slope),
            step(400.0, 0.3),
            step(700.5, 0.3),
            tangent("reference_scale", &[], 0.1),
            step(700.5, 0.5),
            step(20.0, 0.3),
            step(1400.0, 0.3),
        ]
        .into_iter()
        .collect()
    }

    fn assert_alike(found: &Products, expected: &Products) {
        let pairs = |a: &[Vec<f64>; 4], b: &[Vec<f64>; 4]| {
            let both = a.iter().flatten().zip(b.iter().flatten());
            both.map(|(&x, &y)| (x, y)).collect::<Vec<_>>()
        };
        let blocks = pairs(&found.blocks, &expected.blocks);
        for (x, y) in [blocks, pairs(&found.cells, &expected.cells)].concat() {
            assert!((x - y).abs() <= 1e-11 * y.abs().max(1.0), "{x} {y}");
        }
    }

    #[test]
    fn the_sums_are_those_of_the_columns() {
        let (Some(recipes), Ok(law)) = (recipes(), Law::parse("linear")) else {
            unreachable!("effects and law are in the catalog")
        };
        let (base, twenty) = (Model::new(law), 20.0);
        let distance: Vec<f64> = (0..ROWS).map(|row| 1.0 + (row % 7) as f64).collect();
        let ascending: Vec<f64> = (0..ROWS).map(|row| row as f64).collect();
        let shuffled: Vec<f64> = (0..ROWS).map(|row| (row * 701 % ROWS) as f64).collect();
        let starts: Vec<bool> = (0..ROWS).map(|row| row % 600 == 0).collect();
        let labels: Vec<u32> = (0..ROWS).map(|row| u32::from(row > 800)).collect();
        let layout = Layout {
            starts: &starts,
            blocks: &labels,
            cells: &labels,
            distance: &distance,
            block_count: 2,
            cell_count: 2,
        };
        for elapsed in [&ascending, &shuffled] {
            let mut recorded = [Numbers::All(&twenty); Quantity::COUNT];
            recorded[Quantity::ElapsedTime as usize] = Numbers::Each(elapsed);
            let columns = Columns {
                base: &base,
                distance: &distance,
                recorded,
                stored: Vec::new(),
                groups: None,
                recipes: &recipes,
                taken: Vec::new(),
            };
            let distinct = Distinct::of(&columns);
            assert_eq!(distinct.recipes.len(), recipes.len() - 1);
            let memories = [0.0, 0.5, 0.9];
            let parts = Products::gather(&distinct.among(&columns), &layout, &memories, 1);
            let whole = Products::gather(&columns, &layout, &memories, 1);
            for (parts, whole) in parts.iter().zip(&whole) {
                assert_alike(&distinct.spread(parts), whole);
            }
        }
    }
}
