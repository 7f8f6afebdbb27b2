//! One table entry for each temperature code: the largest, and the fastest.

use super::contract::{Fit, Form};
use super::steps::temperature_index;
use crate::ir::{Builder, Value};

/// A full table of speed factors.
#[derive(Clone, Debug)]
struct FullTable {
    entries: Vec<i64>,
}

/// Most entries that are proposed: 16 KiB of 16-bit entries, half the flash of an ATmega328P.
const MOST: usize = 8192;

/// Name of the form.
pub(super) const NAME: &str = "full_table";

pub(super) fn propose(fit: &Fit<'_>) -> Vec<Box<dyn Form>> {
    if fit.target.len() > MOST {
        return Vec::new();
    }
    let entries = fit
        .target
        .iter()
        .map(|factor| factor.round() as i64)
        .collect();
    vec![Box::new(FullTable { entries })]
}

impl Form for FullTable {
    fn name(&self) -> &'static str {
        NAME
    }

    fn describe(&self) -> String {
        format!(
            "table of {} speed factors, one for each temperature code",
            self.entries.len()
        )
    }

    fn parameters(&self) -> serde_json::Value {
        serde_json::json!({ "entries": self.entries.len() })
    }

    fn floor(&self) -> f64 {
        0.0
    }

    fn build(&self, builder: &mut Builder<'_>) -> Value {
        let index = temperature_index(builder);
        let table = builder.table(
            "speed",
            "speed factor at each temperature code".into(),
            self.entries.clone(),
        );
        builder.load(table, index)
    }

    fn refine(&mut self, _fit: &Fit<'_>) {}

    fn duplicate(&self) -> Box<dyn Form> {
        Box::new(self.clone())
    }
}
