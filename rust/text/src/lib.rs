//! Rows of separated text: numbers out of plain lines, and lines with results appended.
//!
//! Only plain blocks are read here: no quotation mark, one kind of line end, as many fields in each line as in
//! the header, and in the wanted columns nothing but numbers and known marks of a missing value. Whoever calls
//! reads any other block with more care.

mod numbers;
mod rows;
mod written;

pub use rows::{Layout, PlainRows, plain_rows};
pub use written::{Results, with_results};
