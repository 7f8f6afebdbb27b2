//! The air: laws against published tables, independent formulations, derivatives, properties.

mod derivatives;
mod properties;
mod published;
mod reference;
mod table;
