//! How a reading follows the variables of the chain: derivatives that many columns share.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use crate::batch::staged::{Line, Pass, Reading, TRACKS, is_alone, prepare, tracks_of};
use crate::chain::Stage;
use crate::model::{Model, Term};

/// Derivatives of one block's reading to the variables of the chain, found when they are asked for.
///
/// An effect that does nothing where its derivative is taken leaves what follows as the base has it:
/// the chain rule takes the derivative to the end (Griewank & Walther 2008, section 3.2).
pub(super) struct Following {
    passes: [Pass; 2],
    lines: Box<[Line; TRACKS]>,
    known: [bool; TRACKS],
    prepared: Line,
    /// The effect that this was prepared for.
    of: Option<usize>,
}

impl Following {
    pub(super) fn new() -> Self {
        Self {
            passes: [Pass::new(), Pass::new()],
            lines: Box::new([Line::of(0.0); TRACKS]),
            known: [false; TRACKS],
            prepared: Line::of(0.0),
            of: None,
        }
    }

    /// Begins another block.
    pub(super) fn forget(&mut self) {
        self.known = [false; TRACKS];
        self.of = None;
    }

    /// Derivative of the reading to a parameter of an effect, times a scale; nothing is written, and
    /// `false` told, where an effect of the model shares its stage.
    #[inline(always)]
    pub(super) fn tangent(
        &mut self,
        model: &Model,
        base: &Reading<'_>,
        (term, parameter): (&Term, usize),
        scale: f64,
        into: &mut Line,
    ) -> bool {
        let stage = term.facts().stage;
        if !is_alone(model, stage) {
            return false;
        }
        if self.of != Some(term.index) && prepare(base, term, &mut self.prepared) {
            self.of = Some(term.index);
        }
        let prepared = (self.of == Some(term.index)).then_some(&self.prepared);
        let [pass, through] = &mut self.passes;
        let own = pass.alone(base, term, parameter, prepared);
        into.0.fill(0.0);
        // an effect of the air changes one of its quantities
        let changed = tracks_of(stage).filter(|&track| own.slope(track).iter().any(|&s| s != 0.0));
        for track in changed {
            let follows = &mut self.lines[track];
            if !self.known[track] {
                let end = through.following(model, base, stage, track);
                end.slopes(Stage::Indication, follows);
                self.known[track] = true;
            }
            let rows = into.0.iter_mut().zip(own.slope(track)).zip(&follows.0);
            for ((sum, slope), follows) in rows {
                *sum += scale * slope * follows;
            }
        }
        true
    }
}
