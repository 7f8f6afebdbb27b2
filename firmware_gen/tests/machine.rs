//! The twin against an independent reading of the same program: machine arithmetic that wraps in the types that the C
//! text writes out. Where the claims hold, exact and wrapping arithmetic agree on every input.

use echocal_firmware::ir::{Block, Builder, IntegerType, Operation, Program, Value};
use echocal_firmware::{Axis, Device, Output};
use proptest::prelude::*;

/// `value` as a C cast to `ty` leaves it on a machine of two's complement.
fn cast(value: i128, ty: IntegerType) -> i128 {
    let modulus = 1_i128 << ty.bits();
    let low = value.rem_euclid(modulus);
    if ty.is_signed() && low >= modulus / 2 {
        low - modulus
    } else {
        low
    }
}

fn machine(program: &Program, inputs: &[i64]) -> i128 {
    let mut values: Vec<i128> = Vec::new();
    for node in &program.nodes {
        let operand = |value: Value| cast(values[value.index()], node.computed);
        let computed = match node.operation {
            Operation::Input(index) => i128::from(inputs[index]),
            Operation::Constant(constant) => i128::from(constant),
            Operation::Add(a, b) => operand(a) + operand(b),
            Operation::Subtract(a, b) => operand(a) - operand(b),
            Operation::Multiply(a, b) => operand(a) * operand(b),
            Operation::ShiftRight(a, bits) => operand(a) >> bits,
            Operation::LowBits(a, bits) => operand(a) & ((1 << bits) - 1),
            Operation::Load(table, index) => {
                let entry = usize::try_from(values[index.index()]).unwrap();
                cast(
                    i128::from(program.tables[table.index()].entries[entry]),
                    program.tables[table.index()].ty,
                )
            }
        };
        values.push(cast(cast(computed, node.computed), node.held));
    }
    values[program.result.index()]
}

/// One step of a random program: operation, operands counted back from the end, a constant.
type Step = (u8, usize, usize, i64);

/// A program of random steps; a step that would leave 40 bits, or shift what may be negative, is left out.
fn random(device: &Device, steps: &[Step], table: &[i64]) -> Option<Program> {
    let mut builder = Builder::new(device, 16);
    let entries = builder.table("table", String::new(), table.to_vec());
    let mut values = vec![builder.echo(), builder.condition(0)];
    for &(operation, a, b, constant) in steps {
        let (a, b) = (
            values[values.len() - 1 - a % values.len()],
            values[values.len() - 1 - b % values.len()],
        );
        let bits = constant.unsigned_abs() as u32 % 16;
        let mark = builder.mark();
        let natural = builder.range(a).minimum >= 0;
        let value = match operation {
            0 => builder.constant(constant),
            1 => builder.add(a, b),
            2 => builder.subtract(a, b),
            3 => builder.multiply(a, b),
            4 if natural => builder.shift_right(a, bits),
            5 if natural => builder.low_bits(a, bits),
            6 if natural
                && builder.range(a).maximum < table.len() as i64
                && !builder.varies_with_echo(a) =>
            {
                builder.load(entries, a)
            }
            _ => continue,
        };
        let range = builder.range(value);
        if range.minimum < -(1 << 40) || range.maximum > 1 << 40 {
            builder.rewind(mark);
            continue;
        }
        values.push(value);
    }
    builder.finish(values[values.len() - 1])
}

fn device() -> Device {
    let temperature = Axis::temperature(0.5, -3.0, 4.0, 0.0).unwrap();
    Device {
        echo: Axis::echo(1.0, 0.0, 700.0).unwrap(),
        conditions: vec![temperature],
        output: Output::MICROMETERS,
    }
}

proptest! {
    #[test]
    fn twin_machine_and_block_agree(
        steps in prop::collection::vec((0_u8..7, 0_usize..6, 0_usize..6, -70_000_i64..70_000), 1..24),
        table in prop::collection::vec(-300_i64..40_000, 1..20),
    ) {
        let device = device();
        let Some(program) = random(&device, &steps, &table) else { return Ok(()) };
        prop_assert_eq!(program.check_claims(), Ok(()));
        let mut block = Block::new(&program).unwrap();
        for row in 0..device.rows() {
            let codes = device.codes(row);
            block.set_conditions(&codes).unwrap();
            let lanes = *block.evaluate(0, 700).unwrap();
            for echo in (0_i64..512).step_by(37).chain([511, 700]) {
                let inputs = [echo, codes[0]];
                let output = program.evaluate(&inputs).unwrap();
                prop_assert_eq!(i128::from(output), machine(&program, &inputs));
                if let Some(lane) = lanes.get(echo as usize) {
                    prop_assert_eq!(*lane, output);
                }
            }
        }
    }
}

#[test]
fn a_claim_that_is_too_narrow_is_found_by_twin_and_block() {
    let device = device();
    let mut builder = Builder::new(&device, 16);
    let echo = builder.echo();
    let factor = builder.constant(300);
    let product = builder.multiply(echo, factor);
    let mut program = builder.finish(product).unwrap();
    assert_eq!(program.nodes[2].held, IntegerType::U32);
    program.nodes[2].held = IntegerType::U16;
    assert_eq!(program.evaluate(&[218, 0]), Ok(65_400));
    assert!(program.evaluate(&[219, 0]).is_err());
    assert_ne!(
        machine(&program, &[219, 0]),
        65_700,
        "the machine would have wrapped"
    );
    let mut block = Block::new(&program).unwrap();
    block.set_conditions(&[0]).unwrap();
    assert!(block.evaluate(0, 218).is_ok());
    assert!(block.evaluate(0, 700).is_err());
    program.nodes[2].computed = IntegerType::U16;
    program.nodes[1].operation = Operation::Constant(70_000);
    program.nodes[1].range.maximum = 70_000;
    program.nodes[1].held = IntegerType::U32;
    program.nodes[1].computed = IntegerType::U32;
    assert!(
        Block::new(&program).is_err(),
        "an operand that its reader cannot hold"
    );
}
