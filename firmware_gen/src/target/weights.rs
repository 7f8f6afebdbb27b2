//! What the steps of a function cost on each target, in tenths: fitted by `benches/costs.py`; on AVR, scaled.
//!
//! Each line is one of `FEATURES`: tenths of a byte, and of a cycle (AVR) or an instruction.

use super::features::FEATURES;

/// Size in tenths of a byte, and time in tenths of a cycle or an instruction, for each of [`FEATURES`].
pub(super) type Weights = [(u64, u64); FEATURES.len()];

pub(super) const C99: Weights = [
    (180, 29),  // inputs
    (33, 0),    // constants below 256
    (109, 36),  // constants below 2048
    (90, 62),   // constants below 65536
    (82, 40),   // larger constants
    (2, 5),     // sums of 8 or 16 bits
    (13, 17),   // sums of 32 bits
    (833, 302), // sums of 64 bits
    (18, 38),   // products of 8 or 16 bits
    (35, 106),  // products of 16 bits in 32
    (134, 267), // products of 32 bits
    (20, 10),   // products of 32 bits by a constant below 2048
    (264, 900), // products of 64 bits
    (0, 0),     // doublings
    (62, 0),    // shifts by whole words
    (0, 0),     // middle bytes of a product
    (32, 11),   // shifts by whole bytes
    (51, 1),    // other shifts
    (4, 21),    // places of other shifts
    (191, 237), // shifts of 64 bits
    (88, 7),    // remainders
    (176, 98),  // loads
    (21, 8),    // products of 16 bits in 32, once
    (55, 0),    // products of 32 or 64 bits, once
];

pub(super) const AVR: Weights = [
    (213, 127),   // inputs
    (10, 5),      // constants below 256
    (10, 4),      // constants below 2048
    (10, 5),      // constants below 65536
    (24, 11),     // larger constants
    (39, 17),     // sums of 8 or 16 bits
    (102, 51),    // sums of 32 bits
    (263, 83),    // sums of 64 bits
    (69, 61),     // products of 8 or 16 bits
    (77, 247),    // products of 16 bits in 32
    (274, 729),   // products of 32 bits
    (220, 400),   // products of 32 bits by a constant below 2048
    (1051, 3283), // products of 64 bits
    (12, 40),     // doublings
    (10, 10),     // shifts by whole words
    (43, 23),     // middle bytes of a product
    (58, 32),     // shifts by whole bytes
    (65, 31),     // other shifts
    (11, 36),     // places of other shifts
    (141, 303),   // shifts of 64 bits
    (37, 18),     // remainders
    (93, 59),     // loads
    (221, 5),     // products of 16 bits in 32, once
    (917, 5),     // products of 32 or 64 bits, once
];

pub(super) const CORTEX_M0: Weights = [
    (127, 40),  // inputs
    (0, 0),     // constants below 256
    (92, 24),   // constants below 2048
    (86, 22),   // constants below 65536
    (80, 25),   // larger constants
    (20, 10),   // sums of 8 or 16 bits
    (0, 0),     // sums of 32 bits
    (791, 6),   // sums of 64 bits
    (20, 10),   // products of 8 or 16 bits
    (0, 8),     // products of 16 bits in 32
    (21, 9),    // products of 32 bits
    (20, 10),   // products of 32 bits by a constant below 2048
    (197, 389), // products of 64 bits
    (0, 0),     // doublings
    (62, 16),   // shifts by whole words
    (20, 10),   // middle bytes of a product
    (0, 0),     // shifts by whole bytes
    (0, 4),     // other shifts
    (1, 0),     // places of other shifts
    (137, 111), // shifts of 64 bits
    (112, 58),  // remainders
    (109, 40),  // loads
    (36, 8),    // products of 16 bits in 32, once
    (0, 0),     // products of 32 or 64 bits, once
];

pub(super) const CORTEX_M3: Weights = [
    (110, 34), // inputs
    (16, 15),  // constants below 256
    (72, 16),  // constants below 2048
    (74, 23),  // constants below 65536
    (85, 18),  // larger constants
    (20, 10),  // sums of 8 or 16 bits
    (0, 0),    // sums of 32 bits
    (17, 0),   // sums of 64 bits
    (20, 10),  // products of 8 or 16 bits
    (0, 2),    // products of 16 bits in 32
    (10, 7),   // products of 32 bits
    (20, 10),  // products of 32 bits by a constant below 2048
    (60, 18),  // products of 64 bits
    (0, 0),    // doublings
    (47, 14),  // shifts by whole words
    (20, 10),  // middle bytes of a product
    (8, 4),    // shifts by whole bytes
    (9, 0),    // other shifts
    (1, 0),    // places of other shifts
    (56, 16),  // shifts of 64 bits
    (64, 22),  // remainders
    (112, 32), // loads
    (18, 2),   // products of 16 bits in 32, once
    (0, 0),    // products of 32 or 64 bits, once
];

pub(super) const CORTEX_M4F: Weights = [
    (111, 33), // inputs
    (14, 14),  // constants below 256
    (74, 17),  // constants below 2048
    (71, 20),  // constants below 65536
    (83, 18),  // larger constants
    (20, 10),  // sums of 8 or 16 bits
    (0, 0),    // sums of 32 bits
    (17, 0),   // sums of 64 bits
    (20, 10),  // products of 8 or 16 bits
    (0, 3),    // products of 16 bits in 32
    (10, 8),   // products of 32 bits
    (20, 10),  // products of 32 bits by a constant below 2048
    (62, 19),  // products of 64 bits
    (0, 0),    // doublings
    (54, 12),  // shifts by whole words
    (20, 10),  // middle bytes of a product
    (10, 3),   // shifts by whole bytes
    (12, 0),   // other shifts
    (1, 0),    // places of other shifts
    (57, 17),  // shifts of 64 bits
    (62, 21),  // remainders
    (110, 32), // loads
    (20, 3),   // products of 16 bits in 32, once
    (0, 0),    // products of 32 or 64 bits, once
];

pub(super) const RV32: Weights = [
    (214, 58), // inputs
    (23, 12),  // constants below 256
    (43, 10),  // constants below 2048
    (106, 37), // constants below 65536
    (120, 32), // larger constants
    (20, 10),  // sums of 8 or 16 bits
    (0, 0),    // sums of 32 bits
    (15, 14),  // sums of 64 bits
    (20, 10),  // products of 8 or 16 bits
    (23, 8),   // products of 16 bits in 32
    (0, 4),    // products of 32 bits
    (20, 10),  // products of 32 bits by a constant below 2048
    (118, 44), // products of 64 bits
    (0, 1),    // doublings
    (11, 6),   // shifts by whole words
    (20, 10),  // middle bytes of a product
    (0, 0),    // shifts by whole bytes
    (11, 5),   // other shifts
    (0, 0),    // places of other shifts
    (0, 0),    // shifts of 64 bits
    (149, 40), // remainders
    (91, 37),  // loads
    (8, 1),    // products of 16 bits in 32, once
    (0, 0),    // products of 32 or 64 bits, once
];

pub(super) const RV32E: Weights = [
    (423, 335), // inputs
    (16, 83),   // constants below 256
    (48, 99),   // constants below 2048
    (90, 118),  // constants below 65536
    (114, 293), // larger constants
    (20, 10),   // sums of 8 or 16 bits
    (0, 0),     // sums of 32 bits
    (1630, 0),  // sums of 64 bits
    (20, 10),   // products of 8 or 16 bits
    (13, 0),    // products of 16 bits in 32
    (2, 91),    // products of 32 bits
    (20, 10),   // products of 32 bits by a constant below 2048
    (22, 1314), // products of 64 bits
    (0, 0),     // doublings
    (73, 574),  // shifts by whole words
    (20, 10),   // middle bytes of a product
    (20, 328),  // shifts by whole bytes
    (0, 0),     // other shifts
    (3, 23),    // places of other shifts
    (126, 312), // shifts of 64 bits
    (211, 0),   // remainders
    (74, 32),   // loads
    (70, 0),    // products of 16 bits in 32, once
    (0, 0),     // products of 32 or 64 bits, once
];
