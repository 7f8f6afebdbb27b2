//! The proof must fail where it should: each promise is broken once.

use echocal_firmware::ir::{Builder, Program, Value};
use echocal_firmware::prove::{Claim, Proof, prove};
use echocal_firmware::reference::Reference;
use echocal_firmware::{Axis, Device, Error, Output};

fn device() -> Device {
    let temperature = Axis::temperature(1.0, 0.0, 20.0, 0.0).unwrap();
    Device {
        echo: Axis::echo(1.0, 0.0, 5000.0).unwrap(),
        conditions: vec![temperature],
        output: Output::MICROMETERS,
    }
}

/// 170 um per echo code, the same at all temperatures.
fn truth(_conditions: &[f64], time: f64) -> f64 {
    170.0 * time
}

fn run(program: &Program, reference: &dyn Reference) -> Result<Proof, Error> {
    let device = device();
    let claim = Claim {
        device: &device,
        reference,
        maximum_distance: 0.5,
        most: f64::INFINITY,
        threads: 3,
    };
    prove(program, claim, &mut |_| true)
}

fn program(build: impl Fn(&mut Builder<'_>, Value, Value) -> Value) -> Program {
    let device = device();
    let mut builder = Builder::new(&device, 16);
    let (echo, temperature) = (builder.echo(), builder.condition(0));
    let result = build(&mut builder, echo, temperature);
    builder.finish(result).unwrap()
}

fn exact() -> Program {
    program(|builder, echo, _| {
        let factor = builder.constant(170);
        builder.multiply(echo, factor)
    })
}

#[test]
fn an_exact_program_has_no_error_anywhere() {
    let proof = run(&exact(), &truth).unwrap();
    assert!(proof.overall.error < 1e-9);
    assert_eq!(proof.inputs, 21 * 5001);
    assert_eq!(
        proof.bounded_inputs,
        21 * 2942,
        "up to echo code 2941, 0.49997 m"
    );
}

#[test]
fn one_wrong_input_among_all_is_the_worst() {
    let spoiled = |conditions: &[f64], time: f64| {
        let here = conditions[0] == 13.0 && (time - 2345e-6).abs() < 1e-9;
        truth(conditions, time) + if here { 7e-6 } else { 0.0 }
    };
    let proof = run(&exact(), &spoiled).unwrap();
    assert!((proof.bounded.error - 7.0).abs() < 1e-6);
    assert_eq!((proof.bounded.row, proof.bounded.echo), (13, 2345));
    let far = |conditions: &[f64], time: f64| {
        truth(conditions, time) * if time > 3e-3 { 1.01 } else { 1.0 }
    };
    let proof = run(&exact(), &far).unwrap();
    assert!(proof.bounded.error < 1e-9 && proof.overall.error > 8000.0);
    assert_eq!(proof.overall.echo, 5000);
}

#[test]
fn an_output_that_falls_is_refused_with_its_place() {
    let folded = program(|builder, echo, temperature| {
        let sum = builder.add(echo, temperature);
        let wrapped = builder.low_bits(sum, 12);
        let factor = builder.constant(170);
        builder.multiply(wrapped, factor)
    });
    let message = run(&folded, &truth).unwrap_err().to_string();
    assert!(
        message.contains("falls as the echo time grows, at echo_us 40"),
        "{message}"
    );
}

#[test]
fn a_claim_that_breaks_is_refused() {
    let mut program = exact();
    let last = program.nodes.len() - 1;
    program.nodes[last].range.maximum -= 1;
    let message = run(&program, &truth).unwrap_err().to_string();
    assert!(message.contains("does not fit"), "{message}");
}

#[test]
fn a_model_without_a_distance_is_refused_with_its_place() {
    let hole = |conditions: &[f64], time: f64| {
        if conditions[0] == 4.0 && time > 4e-3 {
            f64::NAN
        } else {
            170.0 * time
        }
    };
    let message = run(&exact(), &hole).unwrap_err().to_string();
    assert!(
        message.contains("no distance") && message.contains("temperature_code 4"),
        "{message}"
    );
}

#[test]
fn the_hash_tells_any_two_programs_apart_and_threads_do_not_matter() {
    let hash = run(&exact(), &truth).unwrap().hash;
    let other = program(|builder, echo, temperature| {
        // One micrometer more, at the highest temperature and the longest echo only.
        let sum = builder.add(echo, temperature);
        let excess = builder.constant(5020);
        let at_the_corner = builder.subtract(excess, sum);
        let big = builder.constant(1 << 13);
        let test = builder.subtract(big, at_the_corner);
        let one = builder.shift_right(test, 13);
        let factor = builder.constant(170);
        let product = builder.multiply(echo, factor);
        builder.add(product, one)
    });
    assert_ne!(run(&other, &truth).unwrap().hash, hash);
    assert_eq!(run(&exact(), &truth).unwrap().hash, hash);
}

#[test]
fn saying_stop_stops() {
    let device = device();
    let claim = Claim {
        device: &device,
        reference: &truth,
        maximum_distance: 0.5,
        most: f64::INFINITY,
        threads: 1,
    };
    assert!(matches!(
        prove(&exact(), claim, &mut |_| false),
        Err(Error::Stopped)
    ));
}

#[test]
fn what_goes_beyond_the_claim_is_left_early() {
    let device = device();
    let claim = Claim {
        device: &device,
        reference: &truth,
        maximum_distance: 0.5,
        most: 100.0,
        threads: 1,
    };
    let short = program(|builder, echo, _| {
        let factor = builder.constant(160);
        builder.multiply(echo, factor)
    });
    let mut checked = 0;
    let mut listen = |inputs| {
        checked = inputs;
        true
    };
    let Err(Error::Beyond(error)) = prove(&short, claim, &mut listen) else {
        panic!("10 um per echo code are not beyond 100 um");
    };
    assert!((error - 29_410.0).abs() < 1e-6);
    assert!(checked < 21 * 5001, "the first row was enough");
}

#[test]
fn what_is_nearer_than_the_first_echo_is_no_input() {
    let device = Device {
        echo: Axis::echo(1.0, 109.0, 5000.0).unwrap(),
        ..device()
    };
    let mut builder = Builder::new(&device, 16);
    let (echo, delay, factor) = (builder.echo(), builder.constant(100), builder.constant(170));
    let flight = builder.subtract(echo, delay);
    assert_eq!(builder.range(flight).minimum, 9);
    let distance = builder.multiply(flight, factor);
    let program = builder.finish(distance).unwrap();
    // Nearer than that the model has no distance, and nobody asks it.
    let near = |_: &[f64], time: f64| {
        if time < 108.5e-6 {
            f64::NAN
        } else {
            170.0 * (time - 100e-6)
        }
    };
    let claim = Claim {
        device: &device,
        reference: &near,
        maximum_distance: 0.5,
        most: f64::INFINITY,
        threads: 3,
    };
    let proof = prove(&program, claim, &mut |_| true).unwrap();
    assert_eq!(proof.inputs, 21 * (5000 - 109 + 1));
    assert!(proof.overall.error < 1e-9);
}

#[test]
fn echo_times_that_leave_no_two_codes_are_refused() {
    for (shortest, longest) in [(-1.0, 5000.0), (5000.0, 5000.0), (f64::NAN, 5000.0)] {
        let message = Axis::echo(1.0, shortest, longest).unwrap_err().to_string();
        assert!(message.contains("below the echo max"), "{message}");
    }
    let axis = Axis::echo(0.5, 54.75, 12_500.2).unwrap();
    assert_eq!((axis.codes.minimum, axis.codes.maximum), (110, 25_000));
}

/// Distances of 0.85 m at 0 degC and of 1.05 m at 20 degC, from the first echo code on.
fn proof_from_5000_up_to(maximum_distance: f64) -> Result<Proof, Error> {
    let device = Device {
        echo: Axis::echo(1.0, 5000.0, 6000.0).unwrap(),
        ..device()
    };
    let mut builder = Builder::new(&device, 16);
    let (echo, temperature) = (builder.echo(), builder.condition(0));
    let (base, growth) = (builder.constant(170), builder.constant(2));
    let warm = builder.multiply(temperature, growth);
    let factor = builder.add(base, warm);
    let distance = builder.multiply(echo, factor);
    let program = builder.finish(distance).unwrap();
    let longer =
        |conditions: &[f64], time: f64| 2.0f64.mul_add(conditions[0], 170.0).mul_add(time, 3e-6);
    let claim = Claim {
        device: &device,
        reference: &longer,
        maximum_distance,
        most: f64::INFINITY,
        threads: 3,
    };
    prove(&program, claim, &mut |_| true)
}

#[test]
fn a_proof_over_no_inputs_is_none() {
    let error = proof_from_5000_up_to(0.5).unwrap_err();
    assert!(matches!(&error, Error::Request(_)), "{error}");
    assert!(error.to_string().contains("nothing would be proven"));
}

#[test]
fn the_worst_input_is_one_that_is_accepted_where_some_rows_are_empty() {
    // 5000 codes of 170 um and 3 um more: only the coldest rows begin within that.
    let proof = proof_from_5000_up_to(0.870_005).unwrap();
    assert!((proof.bounded.error - 3.0).abs() < 1e-6);
    assert_eq!(proof.bounded_inputs, 118 + 59 + 1, "at 0, 1 and 2 degC");
    assert!(proof.bounded.row < 3, "{:?}", proof.bounded);
    assert!(
        (5000..=5117).contains(&proof.bounded.echo),
        "{:?}",
        proof.bounded
    );
}
