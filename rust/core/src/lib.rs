//! Ultrasonic time of flight in moist air.
//!
//! Laws (speed of sound, absorption), effects (what makes a real sensor deviate from its
//! simulation), models composed of both, their exact derivatives and their inverse. Every formula
//! is written once, generic over [`scalar::Scalar`].
//!
//! Units: distance m, time s, temperature degC, relative humidity 0..1, pressure Pa, CO2 mole
//! fraction 1, speed m/s, angle rad.

#![cfg_attr(test, allow(clippy::suboptimal_flops))] // tests state expected values plainly

pub mod air;
pub mod batch;
pub mod chain;
pub mod conditions;
pub mod dual;
pub mod echo;
pub mod effects;
pub mod error;
pub mod model;
pub mod scalar;
pub mod simd;

pub use air::Law;
pub use conditions::{Conditions, Quantity};
pub use error::Error;
pub use model::Model;
