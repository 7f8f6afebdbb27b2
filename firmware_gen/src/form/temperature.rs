//! The forms of the temperature alone. One form, one file.

use super::contract::Propose;
use super::{adapted, factored, full_table, interpolated_table, polynomial, segments, square};

/// Every form of the temperature, with its name. To add one, write its file and add its line.
pub const FORMS: &[(&str, Propose)] = &[
    (polynomial::NAME, polynomial::propose),
    (interpolated_table::NAME, interpolated_table::propose),
    (segments::NAME, segments::propose),
    (square::NAME, square::propose),
    (factored::NAME, factored::propose),
    (adapted::NAME, adapted::propose),
    (full_table::NAME, full_table::propose),
];
