//! The echo: the way out and back at one speed.

use crate::scalar::Scalar;

/// Time of flight \[s\], out and back, over a one-way path \[m\].
#[inline(always)]
pub fn time_of_flight<S: Scalar>(path: S, speed: S) -> S {
    (path + path) / speed
}

/// One-way distance \[m\] of a time of flight \[s\], out and back.
#[inline(always)]
pub fn distance<S: Scalar>(time_of_flight: S, speed: S) -> S {
    S::constant(0.5) * speed * time_of_flight
}
