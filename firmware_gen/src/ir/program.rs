//! A program as data: values, tables, operations, steps.

use crate::types::{IntegerType, Range};
use serde::Serialize;

/// A value computed by an earlier node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Value(pub(crate) usize);

impl Value {
    /// Which node computes it.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0
    }
}

/// A table of constants in read-only memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TableId(pub(crate) usize);

impl TableId {
    /// Which table it is.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0
    }
}

/// One exact integer operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Operation {
    /// Argument number `0..`, the echo time first.
    Input(usize),
    /// A constant.
    Constant(i64),
    /// Sum.
    Add(Value, Value),
    /// Difference.
    Subtract(Value, Value),
    /// Product.
    Multiply(Value, Value),
    /// Quotient by a power of two, rounded down; the operand is never negative.
    ShiftRight(Value, u32),
    /// Remainder of a power of two; the operand is never negative.
    LowBits(Value, u32),
    /// Entry of a table; the index is never outside.
    Load(TableId, Value),
}

impl Operation {
    /// The values that it reads.
    pub fn operands(self) -> impl Iterator<Item = Value> {
        let (first, second) = match self {
            Self::Input(_) | Self::Constant(_) => (None, None),
            Self::Add(a, b) | Self::Subtract(a, b) | Self::Multiply(a, b) => (Some(a), Some(b)),
            Self::ShiftRight(a, _) | Self::LowBits(a, _) | Self::Load(_, a) => (Some(a), None),
        };
        first.into_iter().chain(second)
    }
}

/// One step of a program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Node {
    /// What is computed.
    pub operation: Operation,
    /// Every value it takes over the inputs that the function accepts.
    pub range: Range,
    /// Type in which the operation is carried out: operands and result fit.
    pub computed: IntegerType,
    /// Type in which the result is kept.
    pub held: IntegerType,
    /// Whether it depends on the echo time.
    pub per_echo: bool,
    /// Local variable in C and the comment that explains it; a node without a name is written inside its reader.
    pub name: Option<(String, String)>,
}

/// A table of constants.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// Its name in C.
    pub name: String,
    /// What an entry is, with its unit.
    pub note: String,
    /// Type of an entry.
    pub ty: IntegerType,
    /// The entries.
    pub entries: Vec<i64>,
    /// Whether C must read it from program memory by name.
    pub program_memory: bool,
}

impl Table {
    /// Bytes of read-only memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.entries.len() * self.ty.bits() as usize / 8
    }
}

/// A function of integer codes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Program {
    /// Parameters, the echo time first: name and type.
    pub inputs: Vec<(String, IntegerType)>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Steps, operands before readers.
    pub nodes: Vec<Node>,
    /// What the function returns, always a distance of the type of the output.
    pub result: Value,
    /// The type of the output.
    pub output: IntegerType,
    /// Whether C names the middle bytes of a product instead of shifting it by a byte.
    pub middle_bytes: bool,
}

impl Program {
    /// Width of the widest integer that it computes with \[bit\].
    #[must_use]
    pub fn widest(&self) -> u32 {
        let bits = |node: &Node| node.computed.bits().max(node.held.bits());
        self.nodes.iter().map(bits).max().unwrap_or(0)
    }

    /// The node that computes `value`.
    #[must_use]
    pub fn node(&self, value: Value) -> &Node {
        &self.nodes[value.0]
    }

    /// The 32-bit product of which only the two middle bytes are wanted, if that is what `value` is as a `wanted`.
    #[must_use]
    pub fn middle_of(&self, value: Value, wanted: IntegerType) -> Option<Value> {
        let node = self.node(value);
        let narrowed = node.computed == IntegerType::U32 && wanted == IntegerType::U16;
        match node.operation {
            Operation::ShiftRight(product, 8) if self.middle_bytes && narrowed => Some(product),
            _ => None,
        }
    }

    /// Bytes of all tables.
    #[must_use]
    pub fn table_bytes(&self) -> usize {
        self.tables.iter().map(Table::bytes).sum()
    }

    /// Whether the result depends on the input of this name.
    #[must_use]
    pub fn reads(&self, input: &str) -> bool {
        let mut needed = vec![false; self.nodes.len()];
        needed[self.result.0] = true;
        for (index, node) in self
            .nodes
            .iter()
            .enumerate()
            .rev()
            .filter(|(index, _)| *index <= self.result.0)
        {
            for operand in node.operation.operands() {
                needed[operand.0] |= needed[index];
            }
        }
        let named = |node: &Node| matches!(node.operation, Operation::Input(index) if self.inputs[index].0 == input);
        self.nodes
            .iter()
            .zip(needed)
            .any(|(node, needed)| needed && named(node))
    }
}
