//! One pass over the rows of a table: sums of products of all columns.
//!
//! Everything that follows works on these sums, and costs the same for a thousand rows and for a
//! million.

mod classes;
mod filter;
mod layout;
mod matrices;
mod panels;
mod products;
mod source;
mod tiles;

pub(crate) use classes::{Class, ClassLists, ClassSums, join};
pub(crate) use filter::{FilterStep, beginning, forget};
pub use layout::RowLayout;
pub(crate) use matrices::{add, mirrored, narrow, triangles};
pub(crate) use panels::Panels;
pub use products::{Edge, LagProducts};
pub use source::{Reader, Source, Stored};
pub(crate) use tiles::{GROUP, add_products};
