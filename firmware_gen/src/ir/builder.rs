//! Building a program while every node's values are known: exactly for each combination of conditions, as an interval
//! over the echo time. The types of a program follow from these rows.

use super::program::{Node, Operation, Program, Table, TableId, Value};
use crate::device::{Axis, Device};
use crate::types::{IntegerType, Range};

/// Values of one node: an interval for each combination of conditions.
#[derive(Clone, Debug)]
struct Rows {
    low: Vec<i64>,
    high: Vec<i64>,
}

/// A program under construction.
#[derive(Debug)]
pub struct Builder<'a> {
    device: &'a Device,
    /// The combinations of conditions that are followed; the proof checks what follows from them on all.
    picked: Vec<usize>,
    least_bits: u32,
    /// Put before every name, so that two forms can live in one program.
    prefix: &'static str,
    /// The condition that forms of one condition read, and what they give, where it is no speed factor.
    axis: (usize, Option<&'static str>),
    /// What stands for the echo time, if not its code.
    echo: Option<Value>,
    tables: Vec<Table>,
    nodes: Vec<Node>,
    rows: Vec<Rows>,
    overflowed: bool,
}

/// A place in a builder to come back to.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    nodes: usize,
    tables: usize,
    overflowed: bool,
}

impl<'a> Builder<'a> {
    /// An empty program for `device`, its local variables at least `least_bits` wide.
    #[must_use]
    pub fn new(device: &'a Device, least_bits: u32) -> Self {
        Self::over(device, least_bits, (0..device.rows()).collect())
    }

    /// An empty program that follows only the combinations of conditions `picked`: quicker, and good enough to choose
    /// by; what it claims about the others is for the proof to find out.
    #[must_use]
    pub fn over(device: &'a Device, least_bits: u32, picked: Vec<usize>) -> Self {
        Self {
            device,
            picked,
            prefix: "",
            axis: (0, None),
            echo: None,
            least_bits,
            tables: Vec::new(),
            nodes: Vec::new(),
            rows: Vec::new(),
            overflowed: false,
        }
    }

    /// The device.
    #[must_use]
    pub fn device(&self) -> &'a Device {
        self.device
    }

    /// Put `prefix` before the names of what comes next; returns the one before.
    pub fn set_prefix(&mut self, prefix: &'static str) -> &'static str {
        std::mem::replace(&mut self.prefix, prefix)
    }

    /// The place of the condition that forms of one condition read: the temperature, unless another was set.
    #[must_use]
    pub fn axis(&self) -> usize {
        self.axis.0
    }

    /// Let forms of one condition read the one at a place, and say what they give, where it is no speed factor. Returns
    /// what was before.
    pub fn set_axis(
        &mut self,
        axis: (usize, Option<&'static str>),
    ) -> (usize, Option<&'static str>) {
        std::mem::replace(&mut self.axis, axis)
    }

    /// A comment, in the words of the condition that forms of one condition read.
    fn told(&self, note: String) -> String {
        match self.axis {
            (_, None) => note,
            (place, Some(gives)) => told(&note, &self.device.conditions[place], gives),
        }
    }

    /// Let `echo` stand for the echo time in what comes next.
    pub fn set_echo(&mut self, echo: Value) {
        self.echo = Some(echo);
    }

    /// Every value that `value` takes.
    #[must_use]
    pub fn range(&self, value: Value) -> Range {
        self.nodes[value.0].range
    }

    /// The values of a node that does not depend on the echo time, one for each combination of conditions.
    #[must_use]
    pub fn per_row(&self, value: Value) -> &[i64] {
        debug_assert!(!self.nodes[value.0].per_echo);
        &self.rows[value.0].low
    }

    /// Whether `value` depends on the echo time.
    #[must_use]
    pub fn varies_with_echo(&self, value: Value) -> bool {
        self.nodes[value.0].per_echo
    }

    /// Remember this state.
    #[must_use]
    pub fn mark(&self) -> Mark {
        Mark {
            nodes: self.nodes.len(),
            tables: self.tables.len(),
            overflowed: self.overflowed,
        }
    }

    /// Forget everything since `mark`.
    pub fn rewind(&mut self, mark: Mark) {
        self.nodes.truncate(mark.nodes);
        self.rows.truncate(mark.nodes);
        self.tables.truncate(mark.tables);
        self.overflowed = mark.overflowed;
    }

    /// The echo time: its code, unless another value stands for it.
    pub fn echo(&mut self) -> Value {
        if let Some(echo) = self.echo {
            return echo;
        }
        let codes = self.device.echo.codes;
        let rows = self.picked.len();
        let rows = Rows {
            low: vec![codes.minimum; rows],
            high: vec![codes.maximum; rows],
        };
        self.append(Operation::Input(0), rows, self.device.echo.ty, true)
    }

    /// The code of condition `index`, without the bits that the function drops.
    pub fn condition(&mut self, index: usize) -> Value {
        let axis = &self.device.conditions[index];
        let input = self.known(Operation::Input(index + 1)).unwrap_or_else(|| {
            let code = |row: &usize| self.device.codes(*row)[index];
            let low: Vec<i64> = self.picked.iter().map(code).collect();
            let dropped = (1_i64 << axis.shift) - 1;
            let high = low.iter().map(|code| code + dropped).collect();
            self.append(
                Operation::Input(index + 1),
                Rows { low, high },
                axis.ty,
                false,
            )
        });
        if axis.shift == 0 {
            return input;
        }
        let step = self.shift_right(input, axis.shift);
        let word = axis.word();
        let note = format!("{word} code without its lowest {} bits", axis.shift);
        let prefix = self.set_prefix(""); // all forms in one program share this variable
        let step = self.name(step, &format!("{word}_step"), note);
        self.set_prefix(prefix);
        step
    }

    /// A constant.
    pub fn constant(&mut self, constant: i64) -> Value {
        if let Some(known) = self.known(Operation::Constant(constant)) {
            return known;
        }
        let low = vec![constant; self.picked.len()];
        let rows = Rows {
            high: low.clone(),
            low,
        };
        let ty = IntegerType::holding(
            Range {
                minimum: constant,
                maximum: constant,
            },
            self.least_bits,
        );
        self.append(Operation::Constant(constant), rows, ty, false)
    }

    /// Exact sum.
    pub fn add(&mut self, a: Value, b: Value) -> Value {
        self.combine(Operation::Add(a, b), a, b, |a, b| {
            [a.0.checked_add(b.0), a.1.checked_add(b.1)]
        })
    }

    /// Exact difference.
    pub fn subtract(&mut self, a: Value, b: Value) -> Value {
        self.combine(Operation::Subtract(a, b), a, b, |a, b| {
            [a.0.checked_sub(b.1), a.1.checked_sub(b.0)]
        })
    }

    /// Exact product.
    pub fn multiply(&mut self, a: Value, b: Value) -> Value {
        self.combine(Operation::Multiply(a, b), a, b, |a, b| {
            let corners = [
                a.0.checked_mul(b.0),
                a.0.checked_mul(b.1),
                a.1.checked_mul(b.0),
                a.1.checked_mul(b.1),
            ];
            match corners.iter().all(Option::is_some) {
                true => [
                    corners.into_iter().flatten().min(),
                    corners.into_iter().flatten().max(),
                ],
                false => [None, None],
            }
        })
    }

    /// Quotient by `2^bits`, rounded down; `a` must not be negative.
    pub fn shift_right(&mut self, a: Value, bits: u32) -> Value {
        self.combine(Operation::ShiftRight(a, bits), a, a, |a, _| {
            [
                Some(a.0).filter(|low| *low >= 0).map(|low| low >> bits),
                Some(a.1 >> bits),
            ]
        })
    }

    /// Remainder of `2^bits`; `a` must not be negative.
    pub fn low_bits(&mut self, a: Value, bits: u32) -> Value {
        let mask = (1_i64 << bits) - 1;
        self.combine(Operation::LowBits(a, bits), a, a, |a, _| {
            match (a.0 >= 0, a.0 == a.1) {
                (false, _) => [None, None],
                (true, true) => [Some(a.0 & mask); 2],
                (true, false) => [Some(0), Some(mask.min(a.1))],
            }
        })
    }

    /// A table of constants, its entries as narrow as they can be.
    pub fn table(&mut self, name: &'static str, note: String, entries: Vec<i64>) -> TableId {
        let range = hull(&entries, &entries);
        self.tables.push(Table {
            name: format!("echocal_{}{name}", self.prefix),
            note: self.told(note),
            ty: IntegerType::holding(range, 8),
            entries,
            program_memory: false,
        });
        TableId(self.tables.len() - 1)
    }

    /// Entry `index` of `table`; the index must not depend on the echo time.
    pub fn load(&mut self, table: TableId, index: Value) -> Value {
        let entries = &self.tables[table.0].entries;
        let entry = |index: &i64| {
            usize::try_from(*index)
                .ok()
                .and_then(|index| entries.get(index))
                .copied()
        };
        let found: Option<Vec<i64>> = self.rows[index.0].low.iter().map(entry).collect();
        self.overflowed |= found.is_none() || self.nodes[index.0].per_echo;
        let low = found.unwrap_or_else(|| vec![0; self.picked.len()]);
        let held = self.tables[table.0].ty;
        let held = IntegerType::holding(held.range(), self.least_bits);
        self.append(
            Operation::Load(table, index),
            Rows {
                high: low.clone(),
                low,
            },
            held,
            false,
        )
    }

    /// Give `value` a local variable and a comment.
    pub fn name(&mut self, value: Value, name: &str, note: impl Into<String>) -> Value {
        let note = self.told(note.into());
        self.nodes[value.0].name = Some((format!("{}{name}", self.prefix), note));
        value
    }

    /// The finished program, or nothing if some value fits no type or the result is no distance of the output's type.
    #[must_use]
    pub fn finish(self, result: Value) -> Option<Program> {
        let output = self.device.output;
        let fits = output.distances().covers(self.range(result));
        let inputs = self
            .device
            .axes()
            .map(|axis| (axis.name.clone(), axis.ty))
            .collect();
        (fits && !self.overflowed).then_some(Program {
            inputs,
            tables: self.tables,
            nodes: self.nodes,
            result,
            output: output.ty,
            middle_bytes: false,
        })
    }

    fn combine(
        &mut self,
        operation: Operation,
        a: Value,
        b: Value,
        interval: impl Fn((i64, i64), (i64, i64)) -> [Option<i64>; 2],
    ) -> Value {
        if let Some(known) = self.known(operation) {
            return known;
        }
        let (mut low, mut high) = (
            Vec::with_capacity(self.picked.len()),
            Vec::with_capacity(self.picked.len()),
        );
        let mut overflowed = false;
        let (left, right) = (&self.rows[a.0], &self.rows[b.0]);
        let left = left.low.iter().copied().zip(left.high.iter().copied());
        let right = right.low.iter().copied().zip(right.high.iter().copied());
        for (left, right) in left.zip(right) {
            let [minimum, maximum] = interval(left, right);
            overflowed |= minimum.is_none() || maximum.is_none();
            low.push(minimum.unwrap_or(0));
            high.push(maximum.unwrap_or(0));
        }
        self.overflowed |= overflowed;
        let range = hull(&low, &high);
        let operands = self.range(a).union(self.range(b));
        let computed = IntegerType::holding(range.union(operands), self.least_bits);
        let per_echo = self.nodes[a.0].per_echo || self.nodes[b.0].per_echo;
        let value = self.append(operation, Rows { low, high }, computed, per_echo);
        self.nodes[value.0].held = IntegerType::holding(range, self.least_bits);
        value
    }

    /// The node that does the same already: what two forms need is computed once.
    fn known(&self, operation: Operation) -> Option<Value> {
        let same = |node: &Node| node.operation == operation;
        self.nodes.iter().position(same).map(Value)
    }

    fn append(
        &mut self,
        operation: Operation,
        rows: Rows,
        ty: IntegerType,
        per_echo: bool,
    ) -> Value {
        let range = hull(&rows.low, &rows.high);
        self.nodes.push(Node {
            operation,
            range,
            computed: ty,
            held: ty,
            per_echo,
            name: None,
        });
        self.rows.push(rows);
        Value(self.nodes.len() - 1)
    }
}

/// A text about speed factors of the temperature, as one about what another condition gives.
#[must_use]
pub fn told(text: &str, axis: &Axis, gives: &str) -> String {
    let words = axis.word().replace('_', " ");
    text.replace("speed factor", gives)
        .replace("temperature", &words)
}

fn hull(low: &[i64], high: &[i64]) -> Range {
    Range {
        minimum: low.iter().copied().min().unwrap_or(0),
        maximum: high.iter().copied().max().unwrap_or(0),
    }
}
