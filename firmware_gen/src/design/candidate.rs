//! One form in one format.

use super::frame::Frame;
use super::request::Design;
use crate::form::{Fit, Form, Tail};
use crate::ir::Program;
use crate::prove::Proof;
use crate::target::Cost;
use std::rc::Rc;

/// Share of a part's own error that remains in the whole form; joint rounding may save the rest. Set by hand.
const SURE: f64 = 0.9;

/// One form in one format.
pub(super) struct Candidate<'a> {
    /// What the form must follow.
    pub(super) fit: Rc<Fit<'a>>,
    pub(super) form: Box<dyn Form>,
    pub(super) tail: Tail,
    /// What is taken off the echo code before, and multiplied by after.
    pub(super) frame: &'a Frame,
    /// Error that the tail leaves whatever the form does \[unit\].
    pub(super) rest: f64,
    /// Error that rounding to a whole unit adds in any case \[unit\].
    pub(super) rounding: f64,
    /// Error found at a few echo times of every row \[unit\]; infinite until refined.
    pub(super) screened: f64,
    pub(super) cost: Cost,
}

impl Candidate<'_> {
    /// The error that it cannot undercut \[unit\].
    pub(super) fn floor(&self) -> f64 {
        self.form.floor().max(self.rest) + self.rounding
    }

    /// The error that it can hardly undercut, from what its parts reach as they are rounded \[unit\].
    pub(super) fn least(&self) -> f64 {
        SURE.mul_add(self.form.least(&self.fit).max(self.rest), self.rounding)
    }

    /// The error that it probably has \[unit\].
    pub(super) fn likely(&self) -> f64 {
        self.form.likely(&self.fit).max(self.rest) + self.rounding
    }

    /// What its program is made of.
    pub(super) fn parts(&self) -> (&dyn Form, &Tail, &Frame) {
        (self.form.as_ref(), &self.tail, self.frame)
    }

    pub(super) fn proven(self, program: Program, proof: Proof) -> Design {
        Design {
            form: self.form,
            shift: self.frame.shift.clone(),
            gain: self.frame.gain.clone(),
            tail: self.tail,
            program,
            proof,
        }
    }
}
