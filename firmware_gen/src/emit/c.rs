//! A program as C text. Every conversion is written out, so that the text means the same on any width of `int`.

use super::text::Local;
use crate::ir::{IntegerType, Node, Operation, Program, Value};

/// The function in C that names the two middle bytes of a product.
pub const MIDDLE: &str = "echocal_middle";

/// The statements of a program: its locals, and what it returns.
#[must_use]
pub fn statements(program: &Program) -> (Vec<Local>, String) {
    let text = Text {
        program,
        spelled: spelled(program),
    };
    let mut locals = Vec::new();
    for (index, node) in program.nodes.iter().enumerate() {
        if let Some(name) = &text.spelled[index] {
            locals.push(Local {
                ty: node.computed.c_name(),
                name: name.clone(),
                expression: text.expression(Value(index)),
                note: "intermediate value, before a type conversion".into(),
            });
        }
        if let Some((name, note)) = &node.name {
            locals.push(Local {
                ty: node.held.c_name(),
                name: name.clone(),
                expression: text.kept(Value(index)),
                note: note.clone(),
            });
        }
    }
    (locals, text.read(program.result, program.output))
}

/// Names for the values that need a variable only because of their next conversion: MISRA C:2012, rule 10.8, wants no
/// composite expression widened or made signed.
fn spelled(program: &Program) -> Vec<Option<String>> {
    let mut needed = vec![false; program.nodes.len()];
    let mut converted = |value: Value, wanted: IntegerType| {
        let node = program.node(value);
        needed[value.0] |= node.name.is_none() && composite(node) && apart(node.computed, wanted);
    };
    for node in &program.nodes {
        let wanted = if node.name.is_some() && modular(node) {
            node.held
        } else {
            node.computed
        };
        if !matches!(node.operation, Operation::Load(..)) {
            node.operation
                .operands()
                .for_each(|value| converted(value, wanted));
        }
    }
    converted(program.result, program.output);
    for (index, node) in program.nodes.iter().enumerate() {
        needed[index] |= node.name.is_some()
            && composite(node)
            && !modular(node)
            && apart(node.computed, node.held);
    }
    let mut count = 0;
    let name = |needed: &bool| {
        needed.then(|| {
            count += 1;
            if count == 1 {
                "exact".into()
            } else {
                format!("exact_{count}")
            }
        })
    };
    needed.iter().map(name).collect()
}

/// Whether C writes the node as an expression of several operands.
fn composite(node: &Node) -> bool {
    !matches!(
        node.operation,
        Operation::Input(_) | Operation::Constant(_) | Operation::Load(..)
    )
}

/// Whether a conversion between these types changes the sign or widens.
fn apart(from: IntegerType, to: IntegerType) -> bool {
    from.is_signed() != to.is_signed() || from.bits() < to.bits()
}

fn modular(node: &Node) -> bool {
    let exact = matches!(node.operation, Operation::Add(..) | Operation::Subtract(..));
    exact && node.computed.is_signed() && !node.held.is_signed()
}

/// A program, and the names of what is spelled out.
struct Text<'a> {
    program: &'a Program,
    spelled: Vec<Option<String>>,
}

impl Text<'_> {
    /// The value of a node, converted to the type that it is kept in.
    fn kept(&self, value: Value) -> String {
        let node = self.program.node(value);
        match node.operation {
            // A variable that is only another name for a constant or a code.
            Operation::Constant(constant) => literal(constant, node.held),
            _ if self.spelled[value.0].is_some() => self.spelled_as(value, node.held),
            _ if node.computed == node.held => self.expression(value),
            _ if self.program.middle_of(value, node.held).is_some() => {
                self.middle(value, node.held)
            }
            // What is known to end up natural is computed modulo its type from the start: compilers then know it for natural.
            // GCC 12 warns of a sign that changes where the right operand is a converted `int16_t`: no sign does.
            Operation::Add(a, b) if modular(node) && self.is_short_and_signed(b) => {
                self.modulo(node, b, "+", a)
            }
            Operation::Add(a, b) if modular(node) => self.modulo(node, a, "+", b),
            Operation::Subtract(a, b) if modular(node) => self.modulo(node, a, "-", b),
            _ => format!("({})({})", node.held.c_name(), self.expression(value)),
        }
    }

    fn is_zero(&self, value: Value) -> bool {
        self.program.node(value).operation == Operation::Constant(0)
    }

    fn modulo(&self, node: &Node, a: Value, sign: &str, b: Value) -> String {
        let operand = |value| self.read(value, node.held);
        format!(
            "({})({} {sign} {})",
            node.held.c_name(),
            operand(a),
            operand(b)
        )
    }

    /// Whether a value has a variable of its own whose type is signed and shorter than `int32_t`.
    fn is_short_and_signed(&self, value: Value) -> bool {
        let node = self.program.node(value);
        let ty = match node.name {
            Some(_) => node.held,
            None if self.spelled[value.0].is_some() => node.computed,
            None => return false,
        };
        ty.is_signed() && ty.bits() < 32
    }

    /// The value of a node as an operand of type `wanted`.
    fn read(&self, value: Value, wanted: IntegerType) -> String {
        let node = self.program.node(value);
        if node.name.is_none() && self.spelled[value.0].is_some() {
            return self.spelled_as(value, wanted);
        }
        let (text, given) = match (&node.name, node.operation) {
            (Some((name, _)), _) => (name.clone(), node.held),
            (None, Operation::Constant(constant)) => return literal(constant, wanted),
            (None, Operation::Input(index)) => (
                self.program.inputs[index].0.clone(),
                self.program.inputs[index].1,
            ),
            (None, Operation::Load(table, _)) => {
                (self.expression(value), self.program.tables[table.0].ty)
            }
            (None, _) if self.program.middle_of(value, wanted).is_some() => {
                return self.middle(value, wanted);
            }
            (None, _) => (format!("({})", self.expression(value)), node.computed),
        };
        if given == wanted {
            text
        } else {
            format!("({}){text}", wanted.c_name())
        }
    }

    /// The two middle bytes of a product, named.
    fn middle(&self, value: Value, wanted: IntegerType) -> String {
        let product = self.program.middle_of(value, wanted);
        let product = product.map(|product| match self.program.node(product).name {
            None if self.spelled[product.0].is_none() => self.expression(product),
            _ => self.read(product, IntegerType::U32),
        });
        format!("{MIDDLE}({})", product.unwrap_or_default())
    }

    /// A value that has a variable of its own, as an operand of type `wanted`.
    fn spelled_as(&self, value: Value, wanted: IntegerType) -> String {
        let name = self.spelled[value.0].as_deref().unwrap_or_default();
        if self.program.node(value).computed == wanted {
            name.to_owned()
        } else {
            format!("({}){name}", wanted.c_name())
        }
    }

    /// The operation of a node, in the type that it is computed in.
    fn expression(&self, value: Value) -> String {
        let node = self.program.node(value);
        let operand = |value| self.read(value, node.computed);
        let text = match node.operation {
            Operation::Input(index) => return self.program.inputs[index].0.clone(),
            Operation::Constant(constant) => return literal(constant, node.computed),
            Operation::Load(table, index) => {
                let given = index_type(self.program.node(index));
                let table = &self.program.tables[table.0];
                let entry = format!("{}[{}]", table.name, self.read(index, given));
                return match (table.program_memory, table.ty.bits()) {
                    (false, _) => entry,
                    (true, 8) => from_program_memory("byte", &entry, table.ty),
                    (true, 16) => from_program_memory("word", &entry, table.ty),
                    (true, _) => from_program_memory("dword", &entry, table.ty),
                };
            }
            Operation::Add(a, b) => format!("{} + {}", operand(a), operand(b)),
            // MISRA C:2012, rule 2.2, takes a literal 0 for an operation without effect.
            Operation::Subtract(a, b) if node.computed.is_signed() && self.is_zero(a) => {
                format!("-{}", operand(b))
            }
            // avr-gcc warns of a sign that changes where the right operand is a converted `uint8_t`: no sign does.
            Operation::Subtract(a, b) if node.computed == IntegerType::U8 => {
                let operand = |value| self.read(value, IntegerType::U16);
                format!("{} - {}", operand(a), operand(b))
            }
            Operation::Subtract(a, b) => format!("{} - {}", operand(a), operand(b)),
            Operation::Multiply(a, b) => format!("{} * {}", operand(a), operand(b)),
            Operation::ShiftRight(a, bits) => format!("{} >> {bits}", operand(a)),
            Operation::LowBits(a, bits) => format!("{} & {}U", operand(a), (1_u64 << bits) - 1),
        };
        // Below 32 bits C computes in `int`: the value is the same, its type is not.
        if node.computed.bits() < 32 {
            format!("({})({text})", node.computed.c_name())
        } else {
            text
        }
    }
}

/// An entry read with what `avr/pgmspace.h` has for its width, which is unsigned.
fn from_program_memory(width: &str, entry: &str, ty: IntegerType) -> String {
    let read = format!("pgm_read_{width}(&{entry})");
    if ty.is_signed() {
        format!("(({}){read})", ty.c_name())
    } else {
        read
    }
}

fn index_type(node: &Node) -> IntegerType {
    if node.name.is_some() {
        node.held
    } else {
        node.computed
    }
}

/// A constant; C gives it the first type that holds it.
fn literal(constant: i64, ty: IntegerType) -> String {
    if ty.is_signed() {
        constant.to_string()
    } else {
        format!("{constant}U")
    }
}
