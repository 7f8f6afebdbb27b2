//! Columns that are multiples of others: one is made for all.

use super::onsets::Onsets;
use super::recipe::Recipe;
use super::table::Columns;
use crate::gram::LagProducts;

/// Recipes of which none is a multiple of another, and which each column is a multiple of.
#[derive(Clone, Debug, Default)]
pub struct Distinct {
    /// What is made.
    pub recipes: Vec<Recipe>,
    /// Position among these and factor, of each column.
    pub of: Vec<(usize, f64)>,
    taken: Vec<Vec<f64>>,
    onsets: Onsets,
}

impl Distinct {
    /// Tangents that differ in scale alone, as those of a prior's bulk and tail, are multiples.
    #[must_use]
    pub fn of(columns: &Columns<'_>) -> Self {
        let mut found = Self::default();
        for (k, recipe) in columns.recipes.iter().enumerate() {
            let same = |made: &Recipe| multiple(recipe, made);
            let known = found.recipes.iter().enumerate();
            let mut known = known.filter_map(|(at, made)| Some((at, same(made)?)));
            let place = known.next_back().unwrap_or_else(|| {
                found.recipes.push(recipe.clone());
                found.taken.extend(columns.taken.get(k).cloned());
                (found.recipes.len() - 1, 1.0)
            });
            found.of.push(place);
        }
        if columns.groups.is_none() {
            // what an unknown level takes up of a tangent is not zero anywhere
            found.onsets = Onsets::part(&mut found.recipes);
        }
        found
    }

    /// The table with the distinct columns alone.
    #[must_use]
    pub fn among<'a>(&'a self, columns: &Columns<'a>) -> Columns<'a> {
        Columns {
            recipes: &self.recipes,
            stored: columns.stored.clone(),
            groups: columns.groups.clone(),
            taken: self.taken.clone(),
            ..*columns
        }
    }

    /// The sums of all columns from those of the distinct ones.
    #[must_use]
    pub fn spread(&self, sums: &LagProducts) -> LagProducts {
        let (width, all) = (self.recipes.len().max(1), self.of.len());
        let own = self.of.first().map_or(1.0, |&(_, factor)| factor);
        let blocks = |values: &Vec<f64>| {
            let matrices = values.chunks_exact(width * width);
            let mut found = Vec::with_capacity(matrices.len() * all * all);
            matrices.for_each(|matrix| self.spread_matrix(matrix, width, &mut found));
            found
        };
        let cells = |values: &Vec<f64>| {
            let lines = values.chunks_exact(width);
            let mut found = Vec::with_capacity(lines.len() * all);
            lines.for_each(|line| self.spread_line(&self.onsets.line(line), own, &mut found));
            found
        };
        LagProducts {
            blocks: sums.blocks.each_ref().map(blocks),
            cells: sums.cells.each_ref().map(cells),
            log_variance: sums.log_variance.clone(),
        }
    }

    fn spread_matrix(&self, matrix: &[f64], width: usize, into: &mut Vec<f64>) {
        let matrix = self.onsets.matrix(matrix, width);
        for &(at, factor) in &self.of {
            self.spread_line(&matrix[at * width..(at + 1) * width], factor, into);
        }
    }

    fn spread_line(&self, line: &[f64], factor: f64, into: &mut Vec<f64>) {
        into.extend(self.of.iter().map(|&(at, own)| factor * own * line[at]));
    }
}

/// How many times one column another is, where the recipes tell.
fn multiple(recipe: &Recipe, made: &Recipe) -> Option<f64> {
    let (Recipe::Tangent(term, level, at, scale), Recipe::Tangent(other, beside, place, unit)) =
        (recipe, made)
    else {
        return None;
    };
    let same = at == place && term == other && level == beside && *unit != 0.0;
    same.then(|| scale / unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::recipe::Level;
    use echocal_core::model::Term;

    fn tangent(id: &str, scale: f64) -> Option<Recipe> {
        let term = Term::new(id, &[]).ok()?;
        Some(Recipe::Tangent(term, Level::OfBase, 0, scale))
    }

    #[test]
    fn a_tail_is_a_multiple_of_its_bulk() {
        let (Some(bulk), Some(tail), Some(other)) = (
            tangent("zero_error", 0.5),
            tangent("zero_error", 4.0),
            tangent("fixed_delay", 0.5),
        ) else {
            unreachable!("both are in the catalogue")
        };
        assert_eq!(multiple(&tail, &bulk), Some(8.0));
        assert_eq!(multiple(&tail, &other), None);
        assert_eq!(multiple(&Recipe::Slope, &Recipe::Slope), None);
    }

    #[test]
    fn sums_are_multiples_too() {
        let found = Distinct {
            recipes: vec![Recipe::Slope, Recipe::Stored(0)],
            of: vec![(0, 1.0), (1, 1.0), (1, 4.0)],
            ..Distinct::default()
        };
        let sums = LagProducts {
            blocks: [(); 4].map(|()| vec![1.0, 2.0, 2.0, 5.0]),
            cells: [(); 4].map(|()| vec![1.0, 2.0, 3.0, 6.0]),
            log_variance: vec![0.5],
        };
        let spread = found.spread(&sums);
        assert_eq!(
            spread.blocks[1],
            [1.0, 2.0, 8.0, 2.0, 5.0, 20.0, 8.0, 20.0, 80.0]
        );
        assert_eq!(spread.cells[3], [1.0, 2.0, 8.0, 3.0, 6.0, 24.0]);
        assert_eq!(spread.log_variance, [0.5]);
    }
}
