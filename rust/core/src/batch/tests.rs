use super::*;
use crate::air::Law;
use crate::simd::{InstructionSet, force};
use std::sync::Mutex;

/// The level is a setting of the process, so tests that change it take turns.
static TURN: Mutex<()> = Mutex::new(());

fn spread(seed: f64, low: f64, high: f64, rows: usize) -> Vec<f64> {
    let golden = 0.618_033_988_749_895;
    let at = |row: usize| (row as f64 * golden + seed).fract();
    (0..rows).map(|row| low + (high - low) * at(row)).collect()
}

/// Which quantities a kernel takes: distance or time, temperature, humidity, pressure, CO2, frequency.
type Inputs = &'static [usize];

fn columns(inputs: Inputs, rows: usize) -> Vec<Vec<f64>> {
    const RANGES: [(f64, f64); 6] = [
        (1e-3, 3e-2),
        (-20.0, 60.0),
        (0.0, 1.0),
        (6e4, 1.1e5),
        (3e-4, 2e-3),
        (0.0, 5e4),
    ];
    let pick = |&k: &usize| spread(0.1 * k as f64, RANGES[k].0, RANGES[k].1, rows);
    inputs.iter().map(pick).collect()
}

/// A column to read from.
fn pointer<T>(values: &[T]) -> Column {
    let start = values.as_ptr().cast_mut().cast();
    Column {
        start,
        stride: size_of::<T>().cast_signed(),
    }
}

/// A column to write to.
fn target<T>(values: &mut [T]) -> Column {
    Column {
        start: values.as_mut_ptr().cast(),
        stride: size_of::<T>().cast_signed(),
    }
}

fn run_f64(kernel: &dyn Kernel, inputs: &[Vec<f64>], threads: usize) -> Vec<f64> {
    let rows = inputs[0].len();
    let mut output = vec![0.0; rows];
    let inputs: Vec<_> = inputs.iter().map(|column| pointer(column)).collect();
    // SAFETY: columns of equal length; the output is written through its own pointer only.
    unsafe { kernel.run_f64(&inputs, target(&mut output), rows, threads) };
    output
}

fn run_f32(kernel: &dyn Kernel, inputs: &[Vec<f64>]) -> Vec<f32> {
    let narrow = |column: &Vec<f64>| column.iter().map(|&x| x as f32).collect::<Vec<_>>();
    let columns: Vec<_> = inputs.iter().map(narrow).collect();
    let rows = inputs[0].len();
    let mut output = vec![0.0; rows];
    let inputs: Vec<_> = columns.iter().map(|column| pointer(column)).collect();
    // SAFETY: columns of equal length; the output is written through its own pointer only.
    unsafe { kernel.run_f32(&inputs, target(&mut output), rows, 1) };
    output
}

fn kernels() -> Vec<(Box<dyn Kernel>, Inputs)> {
    let mut all: Vec<(_, Inputs)> = vec![(absorption(), &[1, 2, 3, 5])];
    let fixed = Law::parse("343").unwrap();
    let readings = [
        fixed,
        Law::parse("linear").unwrap(),
        Law::parse("ideal_gas").unwrap(),
    ];
    for law in Law::names()
        .into_iter()
        .map(|name| Law::parse(name).unwrap())
    {
        all.push((speed_of_sound(law, false), &[1, 2, 3, 4]));
        all.push((speed_of_sound(law, true), &[1, 2, 3, 4, 5]));
        let errors = readings.into_iter().map(Output::Error);
        for output in [Output::TimeOfFlight, Output::Distance]
            .into_iter()
            .chain(errors)
        {
            all.push((echo(output, law, false), &[0, 1, 2, 3, 4]));
            all.push((echo(output, law, true), &[0, 1, 2, 3, 4, 5]));
        }
    }
    all
}

fn distance() -> (Box<dyn Kernel>, Inputs) {
    let law = Law::parse("cramer").unwrap();
    (echo(Output::Distance, law, false), &[0, 1, 2, 3, 4])
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let _turn = TURN.lock().unwrap();
    for (kernel, quantities) in kernels() {
        let inputs = columns(quantities, 1_003);
        assert!(force(Some(InstructionSet::Baseline)));
        let (double, single) = (run_f64(&*kernel, &inputs, 1), run_f32(&*kernel, &inputs));
        assert!(double.iter().all(|x| x.is_finite()));
        for set in InstructionSet::ALL
            .into_iter()
            .filter(|set| set.is_available())
        {
            assert!(force(Some(set)));
            assert_eq!(run_f64(&*kernel, &inputs, 1), double, "{}", set.name());
            assert_eq!(run_f32(&*kernel, &inputs), single, "{}", set.name());
        }
        force(None);
    }
}

#[test]
fn a_batch_is_the_scalar_loop() {
    let _turn = TURN.lock().unwrap();
    for (kernel, quantities) in kernels() {
        let inputs = columns(quantities, 507);
        let output = run_f64(&*kernel, &inputs, 1);
        for (row, value) in output.into_iter().enumerate() {
            let inputs: Vec<_> = inputs.iter().map(|column| column[row]).collect();
            assert_eq!(kernel.evaluate(&inputs), value);
        }
    }
}

#[test]
fn threads_give_the_same_bits() {
    let (kernel, quantities) = distance();
    let inputs = columns(quantities, 250_007);
    assert_eq!(run_f64(&*kernel, &inputs, 1), run_f64(&*kernel, &inputs, 4));
}

#[test]
fn strides_constants_and_output_in_place() {
    let (kernel, quantities) = distance();
    let mut inputs = columns(quantities, 1_001);
    inputs[2] = vec![0.4; 1_001];
    let expected = run_f64(&*kernel, &inputs, 1);
    let mut every_third = vec![f64::NAN; 3_003];
    for (row, &value) in inputs[0].iter().enumerate() {
        every_third[3 * row] = value;
    }
    let constant = [0.4];
    let mut views: Vec<_> = inputs.iter().map(|column| pointer(column)).collect();
    views[0] = Column {
        stride: 24,
        ..target(&mut every_third)
    };
    views[2] = Column {
        stride: 0,
        ..pointer(&constant)
    };
    // SAFETY: 1001 rows lie within each column; the output overlaps its input row by row.
    unsafe { kernel.run_f64(&views, views[0], 1_001, 1) };
    for (row, value) in expected.into_iter().enumerate() {
        assert_eq!(every_third[3 * row], value);
        assert!(every_third[3 * row + 1].is_nan() && every_third[3 * row + 2].is_nan());
    }
}

/// Runs with the output so many rows behind the first input, in one memory, on one thread.
fn run_behind<T: Copy + Default>(
    run: impl Fn(&[Column], Column),
    inputs: &[Vec<T>],
    behind: usize,
    turned: bool,
) -> Vec<T> {
    let rows = inputs[0].len();
    let mut memory = vec![T::default(); behind];
    memory.extend(&inputs[0]);
    if turned {
        memory.reverse();
    }
    let size = size_of::<T>().cast_signed();
    let start: *mut T = memory.as_mut_ptr();
    let from = |place: usize| Column {
        start: start
            .wrapping_add(if turned {
                rows + behind - 1 - place
            } else {
                place
            })
            .cast(),
        stride: if turned { -size } else { size },
    };
    let mut columns: Vec<_> = inputs.iter().map(|column| pointer(column)).collect();
    columns[0] = from(behind);
    run(&columns, from(0));
    if turned {
        memory.reverse();
    }
    memory.truncate(rows);
    memory
}

#[test]
fn one_thread_reads_rows_before_it_writes_there() {
    let _turn = TURN.lock().unwrap();
    let model = crate::Model::new(Law::parse("linear").unwrap())
        .with("fixed_delay", &[("delay", 31e-6)])
        .and_then(|m| m.with("temperature_gain", &[]))
        .unwrap();
    let inverse = of_model(model.clone(), ModelOutput::Correction);
    let (formula, quantities) = distance();
    let cases = [
        (formula, columns(quantities, 1_007)),
        (
            of_model(model, ModelOutput::Indication),
            model_columns(1_007),
        ),
        (inverse, model_columns(1_007)),
    ];
    let sets = InstructionSet::ALL.into_iter();
    for set in sets.filter(|set| set.is_available()) {
        assert!(force(Some(set)));
        for (kernel, inputs) in &cases {
            let (double, single) = (run_f64(&**kernel, inputs, 1), run_f32(&**kernel, inputs));
            let narrow = |column: &Vec<f64>| column.iter().map(|&x| x as f32).collect::<Vec<_>>();
            let narrow: Vec<_> = inputs.iter().map(narrow).collect();
            for behind in [1, 7, 8, 24, 240, 1_000] {
                for turned in [false, true] {
                    let found = run_behind(
                        // SAFETY: 1007 rows of each column; the input lies ahead of the output.
                        |columns, output| unsafe { kernel.run_f64(columns, output, 1_007, 1) },
                        inputs,
                        behind,
                        turned,
                    );
                    assert_eq!(found, double, "{behind} {turned} {}", set.name());
                    let found = run_behind(
                        // SAFETY: as above.
                        |columns, output| unsafe { kernel.run_f32(columns, output, 1_007, 1) },
                        &narrow,
                        behind,
                        turned,
                    );
                    assert_eq!(found, single, "{behind} {turned} {}", set.name());
                }
            }
        }
    }
    force(None);
}

#[test]
fn not_a_number_stays_in_its_row() {
    let (kernel, quantities) = distance();
    let mut inputs = columns(quantities, 100);
    for column in 0..5 {
        inputs[column][10 * column + 3] = f64::NAN;
    }
    let output = run_f64(&*kernel, &inputs, 1);
    for (row, value) in output.into_iter().enumerate() {
        assert_eq!(value.is_nan(), row % 10 == 3 && row < 50, "{row}");
    }
}

/// Inputs of a model: a distance, then every influence quantity within reason.
fn model_columns(rows: usize) -> Vec<Vec<f64>> {
    let mut all = columns(&[0, 1, 2, 3, 4], rows);
    all[0].iter_mut().for_each(|distance| *distance *= 100.0);
    while all.len() < 1 + crate::Quantity::COUNT {
        all.push(spread(all.len() as f64, 0.0, 1.0, rows));
    }
    all
}

/// Models that take every way through the stages: with and without effects of the air, of the speed, of the
/// firmware, and with one that depends on the distance.
fn models() -> Vec<crate::Model> {
    let of = |law: &str, effects: &[(&str, &[(&str, f64)])]| {
        let base = crate::Model::new(Law::parse(law).unwrap());
        let extended = effects.iter().try_fold(base, |m, (id, of)| m.with(id, of));
        extended.unwrap()
    };
    let delay: (&str, &[(&str, f64)]) = ("fixed_delay", &[("delay", 31e-6)]);
    let zero: (&str, &[(&str, f64)]) = ("zero_error", &[("offset", -4e-3)]);
    let gain: (&str, &[(&str, f64)]) = ("temperature_gain", &[("gain", 0.01)]);
    let fixed: (&str, &[(&str, f64)]) = ("fixed_speed", &[("weight", 0.3), ("speed", 343.0)]);
    vec![
        of("virial", &[delay, ("clock_error", &[]), gain, zero]),
        of("cramer", &[delay, zero]),
        of(
            "cramer",
            &[("speed_intercept", &[("intercept", 0.4)]), fixed, delay],
        ),
        of(
            "ideal_gas",
            &[gain, ("speed_slope", &[("slope", 0.01)]), fixed],
        ),
        of("linear", &[("humidity", &[]), gain, delay, zero]),
        of(
            "linear",
            &[("temperature_gradient", &[("gradient", 0.5)]), fixed, zero],
        ),
    ]
}

#[test]
fn models_have_the_same_bits_as_row_by_row() {
    let _turn = TURN.lock().unwrap();
    let inputs = model_columns(505);
    let outputs = [
        ModelOutput::Indication,
        ModelOutput::SpeedOfSound,
        ModelOutput::TimeOfFlight,
        ModelOutput::Correction,
        ModelOutput::Distance,
    ];
    for (place, model) in models().into_iter().enumerate() {
        for output in outputs {
            let kernel = of_model(model.clone(), output);
            for set in InstructionSet::ALL
                .into_iter()
                .filter(|set| set.is_available())
            {
                assert!(force(Some(set)));
                let batch = run_f64(&*kernel, &inputs, 1);
                for (row, value) in batch.into_iter().enumerate() {
                    let inputs: Vec<_> = inputs.iter().map(|column| column[row]).collect();
                    let alone = kernel.evaluate(&inputs);
                    let name = set.name();
                    assert_eq!(alone, value, "model {place}, {output:?}, {name}, row {row}");
                }
            }
            force(None);
        }
    }
}

/// A column that a law does not read may lie nowhere: whoever fetched it would be stopped by the system.
#[test]
fn a_law_fetches_only_what_it_reads() {
    let _turn = TURN.lock().unwrap();
    let nowhere = Column {
        start: core::ptr::null_mut(),
        stride: 8,
    };
    let kernel = echo(Output::Distance, Law::parse("linear").unwrap(), false);
    let inputs = columns(&[0, 1, 2, 3, 4], 1_003);
    let expected = run_f64(&*kernel, &inputs, 1);
    let mut views: Vec<_> = inputs.iter().map(|column| pointer(column)).collect();
    views[2..].fill(nowhere);
    for set in InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available())
    {
        assert!(force(Some(set)));
        let mut found = vec![0.0; 1_003];
        // SAFETY: the columns that the law reads, and the output, have the rows.
        unsafe { kernel.run_f64(&views, target(&mut found), 1_003, 1) };
        assert_eq!(found, expected, "{}", set.name());
    }
    force(None);
}

#[test]
fn a_row_without_a_distance_leaves_its_neighbors_alone() {
    let straight = crate::Model::new(Law::parse("linear").unwrap());
    let bent = straight
        .clone()
        .with("transducer_spacing", &[("square", 1e-3)]);
    for model in [straight, bent.unwrap()] {
        let kernel = of_model(model, ModelOutput::Correction);
        let mut inputs = model_columns(48);
        let expected = run_f64(&*kernel, &inputs, 1);
        inputs[0][5] = f64::INFINITY;
        inputs[1][7] = f64::NAN;
        let output = run_f64(&*kernel, &inputs, 1);
        for (row, value) in output.into_iter().enumerate() {
            assert!(if row == 5 || row == 7 {
                value.is_nan()
            } else {
                value == expected[row]
            });
        }
    }
}
