//! What a program is made of, counted: the steps that the cost of a target is a weighted sum of.

use crate::ir::{Node, Operation, Program, Value};

/// Kinds of step, in the order of the weights. A kind that is "once" counts a function of the compiler's library.
pub const FEATURES: [&str; 24] = [
    "inputs",
    "constants below 256",
    "constants below 2048",
    "constants below 65536",
    "larger constants",
    "sums of 8 or 16 bits",
    "sums of 32 bits",
    "sums of 64 bits",
    "products of 8 or 16 bits",
    "products of 16 bits in 32",
    "products of 32 bits",
    "products of 32 bits by a constant below 2048",
    "products of 64 bits",
    "doublings",
    "shifts by whole words",
    "middle bytes of a product",
    "shifts by whole bytes",
    "other shifts",
    "places of other shifts",
    "shifts of 64 bits",
    "remainders",
    "loads",
    "products of 16 bits in 32, once",
    "products of 32 or 64 bits, once",
];

/// How often each of [`FEATURES`] occurs.
pub type Features = [u32; FEATURES.len()];

/// The index of a kind, known when this is compiled.
const fn kind(name: &str) -> usize {
    let mut index = 0;
    while index < FEATURES.len() {
        if same(FEATURES[index], name) {
            return index;
        }
        index += 1;
    }
    panic!("no such kind of step")
}

const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut equal = a.len() == b.len();
    let mut index = 0;
    while equal && index < a.len() {
        equal = a[index] == b[index];
        index += 1;
    }
    equal
}

/// Count the steps of a program.
#[must_use]
pub fn features(program: &Program) -> Features {
    let mut counts = [0; FEATURES.len()];
    counts[const { kind("inputs") }] = program.inputs.len() as u32;
    for node in &program.nodes {
        count(program, node, &mut counts);
    }
    let once = [
        (
            const { kind("products of 16 bits in 32") },
            const { kind("products of 16 bits in 32, once") },
        ),
        (
            const { kind("products of 32 bits") },
            const { kind("products of 32 or 64 bits, once") },
        ),
        (
            const { kind("products of 64 bits") },
            const { kind("products of 32 or 64 bits, once") },
        ),
    ];
    for (each, whole) in once {
        counts[whole] |= counts[each].min(1);
    }
    counts
}

fn count(program: &Program, node: &Node, counts: &mut Features) {
    let bits = node.computed.bits();
    let mut add = |kind: usize, times: u32| counts[kind] += times;
    match node.operation {
        Operation::Input(_) => {}
        Operation::Constant(constant) => add(size(constant), 1),
        Operation::Add(..) | Operation::Subtract(..) => add(
            match bits {
                ..=16 => const { kind("sums of 8 or 16 bits") },
                17..=32 => const { kind("sums of 32 bits") },
                _ => const { kind("sums of 64 bits") },
            },
            1,
        ),
        Operation::Multiply(a, b) => match doublings(program, a, b) {
            Some(times) if times > 0 && times % 8 == 0 => {
                add(const { kind("shifts by whole bytes") }, 1)
            }
            Some(times) => add(const { kind("doublings") }, times),
            None => add(product(program, a, b, bits), 1),
        },
        Operation::ShiftRight(..) if bits > 32 => add(const { kind("shifts of 64 bits") }, 1),
        Operation::ShiftRight(_, places) => match places {
            _ if places % 16 == 0 => add(const { kind("shifts by whole words") }, 1),
            8 if bits == 32 && node.held.bits() == 16 => {
                add(const { kind("middle bytes of a product") }, 1);
            }
            _ if places % 8 == 0 => add(const { kind("shifts by whole bytes") }, 1),
            _ => {
                add(const { kind("other shifts") }, 1);
                add(const { kind("places of other shifts") }, places);
            }
        },
        Operation::LowBits(..) => add(const { kind("remainders") }, 1),
        Operation::Load(..) => add(const { kind("loads") }, 1),
    }
}

fn size(constant: i64) -> usize {
    match constant.unsigned_abs() {
        0..256 => const { kind("constants below 256") },
        256..2048 => const { kind("constants below 2048") },
        2048..65_536 => const { kind("constants below 65536") },
        _ => const { kind("larger constants") },
    }
}

fn product(program: &Program, a: Value, b: Value, bits: u32) -> usize {
    let narrow = |value: &Value| {
        let range = program.node(*value).range;
        range.minimum >= -(1 << 15) && range.maximum < 1 << 16
    };
    let small = |value: &Value| constant(program, *value).is_some_and(|c| c.abs() < 2048);
    match bits {
        ..=16 => const { kind("products of 8 or 16 bits") },
        17..=32 if [a, b].iter().all(narrow) => const { kind("products of 16 bits in 32") },
        17..=32 if [a, b].iter().any(small) => {
            const { kind("products of 32 bits by a constant below 2048") }
        }
        17..=32 => const { kind("products of 32 bits") },
        _ => const { kind("products of 64 bits") },
    }
}

/// The constant that a value is, if it is one.
fn constant(program: &Program, value: Value) -> Option<i64> {
    match program.node(value).operation {
        Operation::Constant(constant) => Some(constant),
        _ => None,
    }
}

/// The power of two that one factor is.
fn doublings(program: &Program, a: Value, b: Value) -> Option<u32> {
    let factor = constant(program, b).or_else(|| constant(program, a))?;
    (factor.count_ones() == 1).then(|| factor.trailing_zeros())
}
