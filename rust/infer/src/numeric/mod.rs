//! Arithmetic: functions of one number, packs of several, and small linear systems.

mod elementary;
mod normal;
mod pack;
pub(crate) mod pack_cholesky;
mod widest;

pub(crate) use elementary::{exp, tail};
pub(crate) use normal::between;
pub(crate) use pack::{PACK, Pack};
pub(crate) use widest::on_widest;
