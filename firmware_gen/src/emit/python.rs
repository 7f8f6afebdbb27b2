//! A program as Python text, for MicroPython and CircuitPython. Integers are exact there, but those outside of 31 bits are
//! objects on the heap, also on the way to a small result: they are kept as parts of 14 bits, each in a variable.

use super::text::Local;
use crate::ir::{Operation, Program, Range, Table, Value};
use serde::Serialize;

/// Bits of a part. The product of a part and of 16 bits, with a carry, fits 31 bits with its sign.
const PART: u32 = 14;
const BELOW: Range = Range {
    minimum: 0,
    maximum: (1 << PART) - 1,
};
/// What an integer without an object holds where a word has 32 bits.
const SMALL: Range = Range {
    minimum: -(1 << 30),
    maximum: (1 << 30) - 1,
};

/// A table as Python reads it: entries that are small, or those of one part.
#[derive(Serialize)]
pub struct TableText<'a> {
    name: String,
    note: &'a str,
    entries: Vec<i64>,
}

/// A text and the values that it takes.
#[derive(Clone)]
struct Term {
    text: String,
    range: Range,
}

/// A value: its parts, the lowest first; only the highest may be negative or have more bits.
type Parts = Vec<Term>;

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

/// The tables; one with entries that are not small is written as one table for each part.
#[must_use]
pub fn tables(program: &Program) -> Vec<TableText<'_>> {
    let parts = |table: &Table| number_of_parts(entries(table)) as u32;
    let text = |table: &'_ Table, part: u32| {
        let last = part + 1 == parts(table);
        let entry = |entry: &i64| {
            let rest = entry >> (PART * part);
            if last { rest } else { rest & BELOW.maximum }
        };
        (
            table_part(table, part as usize),
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

/// How many parts hold these values, so that the highest is small.
fn number_of_parts(range: Range) -> usize {
    let mut rest = range;
    let mut count = 1;
    while !SMALL.covers(rest) {
        rest = shifted(rest, PART);
        count += 1;
    }
    count
}

fn shifted(range: Range, bits: u32) -> Range {
    Range {
        minimum: range.minimum >> bits,
        maximum: range.maximum >> bits,
    }
}

/// Sum of the parts from bit `bits` on, as one expression.
fn joined(parts: &[Term], bits: u32) -> String {
    let skipped = (bits / PART) as usize;
    let rest = bits % PART;
    let place = |(index, part): (usize, &Term)| {
        let up = PART * index as u32;
        match up.cmp(&rest) {
            std::cmp::Ordering::Equal => part.text.clone(),
            std::cmp::Ordering::Less => format!("({} >> {rest})", part.text),
            std::cmp::Ordering::Greater => format!("({} << {})", part.text, up - rest),
        }
    };
    let terms: Vec<_> = parts
        .iter()
        .skip(skipped)
        .enumerate()
        .map(place)
        .rev()
        .collect();
    let sum = if terms.is_empty() {
        "0".to_owned()
    } else {
        terms.join(" + ")
    };
    bare(&sum)
}

/// Without brackets around the whole.
fn bare(text: &str) -> String {
    let inner = text
        .strip_prefix('(')
        .and_then(|rest| rest.strip_suffix(')'));
    // Brackets that close before others open belong to two parts: `(a) + (b)`.
    let mut depth = 0;
    let around = inner.is_some_and(|inner| {
        inner.chars().all(|letter| {
            depth += i32::from(letter == '(') - i32::from(letter == ')');
            depth >= 0
        })
    });
    inner.filter(|_| around).unwrap_or(text).to_owned()
}

/// Exact bounds of a sum of products.
fn bounds(products: &[(&Term, &Term)], carry: Range) -> Range {
    let mut sum = carry;
    for (a, b) in products {
        let corners = [
            a.range.minimum * b.range.minimum,
            a.range.minimum * b.range.maximum,
            a.range.maximum * b.range.minimum,
            a.range.maximum * b.range.maximum,
        ];
        sum.minimum += corners.into_iter().fold(i64::MAX, i64::min);
        sum.maximum += corners.into_iter().fold(i64::MIN, i64::max);
    }
    sum
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

fn term(text: String, range: Range) -> Term {
    Term { text, range }
}

fn constant_term(value: i64) -> Term {
    term(
        value.to_string(),
        Range {
            minimum: value,
            maximum: value,
        },
    )
}

fn constant_parts(constant: i64) -> Parts {
    let range = Range {
        minimum: constant,
        maximum: constant,
    };
    let count = number_of_parts(range) as u32;
    let part = |part: u32| {
        let rest = constant >> (PART * part);
        constant_term(if part + 1 == count {
            rest
        } else {
            rest & BELOW.maximum
        })
    };
    (0..count).map(part).collect()
}

/// The same value in `count` parts or more.
fn split(parts: &[Term], count: usize) -> Parts {
    let mut found = parts.to_vec();
    while found.len() < count {
        let Some(top) = found.pop() else { break };
        match top.text.parse::<i64>() {
            Ok(constant) => {
                found.push(constant_term(constant & BELOW.maximum));
                found.push(constant_term(constant >> PART));
            }
            Err(_) => {
                found.push(term(format!("({} & {})", top.text, BELOW.maximum), BELOW));
                found.push(term(
                    format!("({} >> {PART})", top.text),
                    shifted(top.range, PART),
                ));
            }
        }
    }
    found
}

/// The same value in parts of which the highest, too, has 14 bits and a sign.
fn fully(parts: &[Term]) -> Parts {
    let mut found = parts.to_vec();
    let short = Range {
        minimum: -BELOW.maximum - 1,
        maximum: BELOW.maximum,
    };
    while found.last().is_some_and(|top| !short.covers(top.range)) {
        found = split(&found, found.len() + 1);
    }
    found
}
