//! A program as Python text, for MicroPython and CircuitPython. Integers are exact there, but those outside of 31 bits are
//! objects on the heap, also on the way to a small result: they are kept as parts of 14 bits, each in a variable.

use super::parts::{
    BELOW, PART, Parts, SMALL, Term, bare, bounds, constant_parts, constant_term, fully, joined,
    number_of_parts, shifted, split, term,
};
use super::text::{Local, named};
use crate::ir::{Operation, Program, Range, Table, Value};
use serde::Serialize;

/// A table as Python reads it: entries that are small, or those of one part.
#[derive(Serialize)]
pub struct TableText<'a> {
    name: String,
    note: &'a str,
    entries: Vec<i64>,
}

struct Writer<'a> {
    program: &'a Program,
    locals: Vec<Local>,
    values: Vec<Parts>,
    /// Whether some value is written whole although it is not small.
    heap: bool,
}

/// The statements of a program: its locals, what it returns, and whether a call needs memory on the heap.
#[must_use]
pub fn statements(program: &Program) -> (Vec<Local>, String, bool) {
    let mut writer = Writer {
        program,
        locals: Vec::new(),
        values: Vec::new(),
        heap: false,
    };
    for index in 0..program.nodes.len() {
        let parts = writer.node(index);
        writer.values.push(parts);
    }
    let result = joined(&writer.values[program.result.index()], 0);
    let heap = writer.heap || !SMALL.covers(program.node(program.result).range);
    (writer.locals, result, heap)
}

/// The tables, whose names begin with `own`; one with entries that are not small is written as one table for each part.
#[must_use]
pub fn tables<'a>(program: &'a Program, own: &str) -> Vec<TableText<'a>> {
    let parts = |table: &Table| number_of_parts(entries(table)) as u32;
    let text = |table: &'_ Table, part: u32| {
        let last = part + 1 == parts(table);
        let entry = |entry: &i64| {
            let rest = entry >> (PART * part);
            if last { rest } else { rest & BELOW.maximum }
        };
        (
            named(&table_part(table, part as usize), own),
            table.entries.iter().map(entry).collect(),
        )
    };
    let mut found = Vec::new();
    for table in &program.tables {
        for part in 0..parts(table) {
            let (name, entries) = text(table, part);
            let note = &table.note;
            found.push(TableText {
                name,
                note,
                entries,
            });
        }
    }
    found
}

fn table_part(table: &Table, part: usize) -> String {
    match part {
        0 => table.name.clone(),
        part => format!("{}_{part}", table.name),
    }
}

fn entries(table: &Table) -> Range {
    let ends = (table.entries.iter().min(), table.entries.iter().max());
    let (minimum, maximum) = (*ends.0.unwrap_or(&0), *ends.1.unwrap_or(&0));
    Range { minimum, maximum }
}

impl Writer<'_> {
    /// The parts of a node. What a reader shares, or is told of by name, becomes a local.
    fn node(&mut self, index: usize) -> Parts {
        let node = &self.program.nodes[index];
        let value = Value(index);
        let range = node.range;
        let small = number_of_parts(range) == 1;
        let (name, note) = node.name.clone().unzip();
        let parts = match node.operation {
            Operation::Input(input) => vec![term(self.program.inputs[input].0.clone(), range)],
            Operation::Constant(constant) => return constant_parts(constant),
            Operation::Add(a, b) => self.sum(value, a, b, 1),
            Operation::Subtract(a, b) => self.sum(value, a, b, -1),
            Operation::Multiply(a, b) => self.product(value, a, b),
            Operation::ShiftRight(a, bits) => self.shift(a, bits, range),
            Operation::LowBits(a, bits) => self.low_bits(a, bits, range),
            Operation::Load(table, at) => {
                let at = joined(&self.values[at.index()], 0);
                let table = &self.program.tables[table.index()];
                let whole = entries(table);
                let count = number_of_parts(whole);
                let part = |part| {
                    let text = format!("_{}[{at}]", table_part(table, part));
                    let range = if part + 1 == count {
                        shifted(whole, PART * part as u32)
                    } else {
                        BELOW
                    };
                    Term { text, range }
                };
                (0..count).map(part).collect()
            }
        };
        match name {
            Some(name) if parts.len() == 1 && small => {
                let expression = bare(&parts[0].text);
                self.local(&name, expression, note.unwrap_or_default());
                vec![term(name, range)]
            }
            _ => parts,
        }
    }

    fn local(&mut self, name: &str, expression: String, note: String) {
        self.locals.push(Local {
            ty: "",
            name: name.to_owned(),
            expression,
            note,
        });
    }

    /// The parts of a sum or a difference.
    fn sum(&mut self, value: Value, a: Value, b: Value, sign: i64) -> Parts {
        let operator = if sign > 0 { "+" } else { "-" };
        let (left, right) = (self.parts(a), self.parts(b));
        let range = self.program.node(value).range;
        if left.len() == 1 && right.len() == 1 && SMALL.covers(range) {
            return vec![term(
                format!("({} {operator} {})", left[0].text, right[0].text),
                range,
            )];
        }
        let count = left.len().max(right.len()).max(number_of_parts(range));
        let (left, right) = (split(&left, count), split(&right, count));
        let one = constant_term(sign);
        let unit = constant_term(1);
        let column = |place: usize| vec![(&left[place], &unit), (&right[place], &one)];
        let text = |place: usize| format!("{} {operator} {}", left[place].text, right[place].text);
        let columns: Vec<_> = (0..count)
            .map(|place| (text(place), column(place)))
            .collect();
        let parts = self.carried(value, &columns);
        parts.unwrap_or_else(|| self.whole(&left, operator, &right, range))
    }

    /// A value of any size in one variable.
    fn whole(&mut self, left: &[Term], operator: &str, right: &[Term], range: Range) -> Parts {
        self.heap = true;
        let text = format!("({} {operator} {})", joined(left, 0), joined(right, 0));
        vec![term(text, range)]
    }

    /// The parts of a product: of a short factor and of parts of the other, or of parts of both.
    fn product(&mut self, value: Value, a: Value, b: Value) -> Parts {
        let (left, right) = (self.parts(a), self.parts(b));
        let range = self.program.node(value).range;
        if left.len() == 1 && right.len() == 1 && SMALL.covers(range) {
            return vec![term(
                format!("({} * {})", left[0].text, right[0].text),
                range,
            )];
        }
        for (left, right) in [
            (left.clone(), fully(&right)),
            (fully(&left), right.clone()),
            (fully(&left), fully(&right)),
        ] {
            let count = left.len() + right.len() - 1;
            let pairs = |place: usize| -> Vec<(&Term, &Term)> {
                (0..left.len())
                    .filter(|at| *at <= place && place - at < right.len())
                    .map(|at| (&left[at], &right[place - at]))
                    .collect()
            };
            let text = |pairs: &[(&Term, &Term)]| {
                let products: Vec<_> = pairs
                    .iter()
                    .map(|(a, b)| format!("{} * {}", a.text, b.text))
                    .collect();
                products.join(" + ")
            };
            let columns: Vec<_> = (0..count)
                .map(|place| (text(&pairs(place)), pairs(place)))
                .collect();
            if let Some(parts) = self.carried(value, &columns) {
                return parts;
            }
        }
        self.whole(&left, "*", &right, range)
    }

    /// Parts from the sums of columns, with the carry of each added to the next; none if one of them is not small.
    fn carried(
        &mut self,
        value: Value,
        columns: &[(String, Vec<(&Term, &Term)>)],
    ) -> Option<Parts> {
        let whole = self.program.node(value).range;
        let mut carry = constant_term(0).range;
        for (_, products) in columns {
            let sum = bounds(products, carry);
            if !SMALL.covers(sum) {
                return None;
            }
            carry = shifted(sum, PART);
        }
        let (name, note) = match &self.program.node(value).name {
            Some((name, note)) => (name.clone(), note.clone()),
            None => (
                format!("wide{}", value.index()),
                "an intermediate value".to_owned(),
            ),
        };
        let mut parts = Vec::new();
        for (place, (text, _)) in columns.iter().enumerate() {
            let last = place + 1 == columns.len();
            let own = format!("{name}_{place}");
            let sum = match place {
                0 => text.clone(),
                _ => format!("{text} + ({name}_{} >> {PART})", place - 1),
            };
            let remark = if place == 0 {
                format!("{note}, in parts of {PART} bits")
            } else {
                String::new()
            };
            self.local(&own, sum, remark);
            parts.push(if last {
                term(own, shifted(whole, PART * place as u32))
            } else {
                term(format!("({own} & {})", BELOW.maximum), BELOW)
            });
        }
        Some(parts)
    }

    fn shift(&self, a: Value, bits: u32, range: Range) -> Parts {
        let parts = self.parts(a);
        if SMALL.covers(range) {
            let text = if parts.len() == 1 {
                format!("{} >> {bits}", parts[0].text)
            } else {
                joined(&parts, bits)
            };
            return vec![term(format!("({text})"), range)];
        }
        let (skipped, rest) = ((bits / PART) as usize, bits % PART);
        let kept = fully(&parts[skipped..]);
        let count = number_of_parts(range);
        let part = |place: usize| {
            let above = kept.get(place + 1).filter(|_| place + 1 < count);
            let low = format!("({} >> {rest})", kept[place].text);
            match above {
                Some(above) => term(
                    format!(
                        "({low} + (({} << {}) & {}))",
                        above.text,
                        PART - rest,
                        BELOW.maximum
                    ),
                    BELOW,
                ),
                None => term(
                    joined(&kept[place..], rest),
                    shifted(range, PART * place as u32),
                ),
            }
        };
        (0..count).map(part).collect()
    }

    fn low_bits(&self, a: Value, bits: u32, range: Range) -> Parts {
        let parts = self.parts(a);
        let mask = |bits: u32| (1_i64 << bits) - 1;
        if parts.len() == 1 || bits <= PART {
            return vec![term(format!("({} & {})", parts[0].text, mask(bits)), range)];
        }
        let kept = split(&parts, (bits.div_ceil(PART)) as usize);
        let top = kept.len() - 1;
        let mut low: Parts = kept[..top].to_vec();
        let left = bits - PART * top as u32;
        low.push(term(
            format!("({} & {})", kept[top].text, mask(left)),
            Range {
                minimum: 0,
                maximum: mask(left),
            },
        ));
        if SMALL.covers(range) {
            return vec![term(format!("({})", joined(&low, 0)), range)];
        }
        low
    }

    fn parts(&self, value: Value) -> Parts {
        self.values[value.index()].clone()
    }
}
