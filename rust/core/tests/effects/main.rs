//! What every effect of the registry must keep, proven by looping over it.

#![allow(clippy::suboptimal_flops)] // tests state expected values plainly

mod derivatives;
mod draws;
mod facts;
mod neutral;
mod reads;
mod round_trip;
mod stages;
mod straight;
