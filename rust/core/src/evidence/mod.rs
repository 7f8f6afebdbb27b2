//! What diagnosis needs to know about a table, gathered in one pass over its rows.
//!
//! Everything that follows (evidence, alias classes, hold-out) works on these sums and costs the
//! same for a thousand rows and for a million.

mod bounds;
mod cholesky;
mod columns;
mod company;
mod convection;
mod distinct;
mod elementary;
mod following;
mod gram;
mod hypothesis;
mod kernel;
mod ladder;
mod lanes;
mod legendre;
mod maker;
mod memory;
mod mixture;
mod moments;
mod noises;
mod normal;
mod onsets;
mod panels;
mod posterior;
mod prior;
mod products;
mod recipe;
mod ridge;
mod slips;
mod source;
mod spans;
mod stack;
mod system;
mod threaded;
mod waves;
mod weigh;
mod whiten;
mod widths;

pub use columns::{Columns, Numbers};
pub use convection::Convection;
pub use distinct::Distinct;
pub use hypothesis::Variant;
pub use kernel::Kernel;
pub use legendre::legendre_lines;
pub use memory::Memory;
pub use posterior::{Outcome, posterior, weigh};
pub use prior::Prior;
pub use products::{Layout, Products};
pub use recipe::{Level, Recipe, Shape};
pub use ridge::left_over;
pub use slips::{Groups, Slips};
pub use source::{Reader, Source};
pub use spans::gram;
pub use stack::Stack;
pub use waves::wave_means;
pub use weigh::Weighed;
pub use whiten::{Noise, Sums};
