//! Which of several forms represents the same causes.

use super::candidates::{Candidate, Candidates};

/// The position of the form that represents the same causes, of forms of so many log odds and
/// coefficients each, most probable first.
///
/// It is the one with the most coefficients of those that are less than `undecided` behind the first:
/// where the data do not say which value of a parameter is right, the uncertainty of a coefficient says
/// so. Among as many coefficients it is the most probable (docs/method.md, section 5).
pub fn preferred_form(forms: &[(f64, usize)], undecided: f64) -> usize {
    let mut chosen = 0;
    for (place, &(score, freedom)) in forms.iter().enumerate() {
        if freedom > forms[chosen].1 && score > forms[0].0 - undecided {
            chosen = place;
        }
    }
    chosen
}

/// The best hypothesis of each set of causes, most probable first. Among forms of nearly the same
/// probability the one with more coefficients is preferred.
pub(super) fn preferred<'c>(of: &Candidates<'_>, found: &'c [Candidate]) -> Vec<&'c Candidate> {
    let mut sorted: Vec<&Candidate> = found.iter().collect();
    sorted.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut sets: Vec<(Vec<usize>, Vec<&Candidate>)> = Vec::new();
    for candidate in sorted {
        let causes = of.causes_of(candidate);
        match sets.iter_mut().find(|(same, _)| *same == causes) {
            None => sets.push((causes, vec![candidate])),
            Some((_, forms)) => forms.push(candidate),
        }
    }
    let best = |(_, forms): (_, Vec<&'c Candidate>)| {
        let each = forms.iter().map(|form| (form.score, of.freedom(form)));
        forms[preferred_form(&each.collect::<Vec<_>>(), of.options.form_preference)]
    };
    sets.into_iter().map(best).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_coefficients_of_forms_that_are_as_good() {
        let forms = [(0.0, 1), (-1.0, 2), (-1.4, 2), (-1.6, 3)];
        assert_eq!(preferred_form(&forms, 1.5), 1);
        assert_eq!(preferred_form(&forms, 2.0), 3);
        assert_eq!(preferred_form(&forms, 0.5), 0);
    }
}
