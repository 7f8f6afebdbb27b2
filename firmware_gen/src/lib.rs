//! Fixed-point C from a calibrated model, proven over every input.
