//! Columns that are multiples of others: one is made for all.

use super::from_parts::FromParts;
use super::onsets::Onsets;
use super::recipe::Recipe;
use super::table::Columns;

/// Recipes of which none is a multiple of another, and which each column is a multiple of.
#[derive(Clone, Debug, Default)]
pub struct Distinct {
    /// What is made.
    pub recipes: Vec<Recipe>,
    /// How the columns are made of these.
    pub columns: FromParts,
    taken: Vec<Vec<f64>>,
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
            found.columns.of.push(place);
        }
        if columns.groups.is_none() {
            // what an unknown level takes up of a tangent is not zero anywhere
            found.columns.onsets = Onsets::part(&mut found.recipes);
        }
        found.columns.parts = found.recipes.len();
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
}
