//! A table as text, some megabytes of whole lines at a time.
//!
//! From the bottom to the top; each module uses only those before it:
//!
//! - [`number`]: one field as a number;
//! - [`digits`]: one number as the fewest digits that are the number again;
//! - [`quotes`]: which fields quotation marks enclose, and which marks are wrong;
//! - [`row`]: the fields of one row;
//! - [`lines`]: where the rows begin and end, and which lines are none;
//! - [`fields`]: the fields of some columns as texts;
//! - [`columns`]: the numbers of some columns;
//! - [`results`]: the lines again, with results behind each row.
//!
//! Nothing here reads a file or knows of Python.

#![cfg_attr(test, allow(clippy::suboptimal_flops))] // tests state expected values plainly

mod bytes;
pub mod columns;
pub mod digits;
pub mod fields;
pub mod lines;
pub mod number;
pub mod quotes;
pub mod results;
pub mod row;
