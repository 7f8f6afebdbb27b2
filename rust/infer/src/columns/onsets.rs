//! Effects that set in somewhere along a quantity: of many beginnings, a row counts for one.
//!
//! From its beginning on a tangent is the same as that of any earlier one. What each has beyond the
//! next is nothing but in the rows between the two, so that nearly all of it is zero in a block and
//! left out of the sums; a tangent is the sum of these parts from its own on, and so are its products.

use super::recipe::{Level, Recipe};
use echocal_core::model::Term;

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

    /// Makes products of each two columns of those of their parts.
    pub(super) fn add_up(&self, products: &mut [f64], width: usize) {
        for pair in self.pairs() {
            for other in 0..width {
                products[pair[0] * width + other] += products[pair[1] * width + other];
            }
        }
        for line in products.chunks_exact_mut(width.max(1)) {
            for pair in self.pairs() {
                line[pair[0]] += line[pair[1]];
            }
        }
    }

    /// Each column and the one that begins next, the latest first.
    pub(super) fn pairs(&self) -> impl Iterator<Item = &[usize]> {
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

    fn step(time: f64) -> Recipe {
        let term = Term::new("step_change", &[("time", time)]);
        let term = term.unwrap_or_else(|_| unreachable!("the effect is in the catalogue"));
        Recipe::Tangent(term, Level::OfBase, 0, 1.0)
    }

    #[test]
    fn products_of_sums_from_products_of_parts() {
        // tangents a and b are 1 from their beginnings on, b later; the parts are a - b and b
        let mut recipes = vec![step(5.0), Recipe::Slope, step(9.0)];
        let onsets = Onsets::part(&mut recipes);
        assert!(matches!(recipes[0], Recipe::Between(..)) && recipes[2] == step(9.0));
        let rows = [[1.0, 0.7, 0.0], [1.0, -0.2, 0.0], [0.0, 0.4, 1.0]]; // parts and a slope
        let whole = rows.map(|[part, slope, later]| [part + later, slope, later]);
        let products = |rows: &[[f64; 3]]| -> Vec<f64> {
            let pairs = (0..9).map(|at| (at / 3, at % 3));
            let product = |(i, j): (usize, usize)| rows.iter().map(|r| r[i] * r[j]).sum();
            pairs.map(product).collect()
        };
        let mut found = products(&rows);
        onsets.add_up(&mut found, 3);
        for (found, right) in found.iter().zip(products(&whole)) {
            assert!((found - right).abs() < 1e-15);
        }
    }
}
