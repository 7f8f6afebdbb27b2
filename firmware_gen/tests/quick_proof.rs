//! The quick proof gives what brute force gives, over random designs.

use echocal_core::{Conditions, Law, Model, Quantity};
use echocal_firmware::lower::{Lowered, lower};
use echocal_firmware::prove::{Claim, Proof, prove, prove_one_by_one};
use echocal_firmware::{Axis, Design, Device, Output, Prefer, Request, Target, design};

/// Pseudo-random numbers (Knuth's MMIX generator), so that every run takes the same designs.
struct Draw(u64);

impl Draw {
    fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        (high - low).mul_add(self.unit(), low)
    }

    fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[(self.unit() * of.len() as f64) as usize]
    }
}

struct Drawn {
    device: Device,
    model: Lowered,
    distance: f64,
    bound: f64,
    target: &'static str,
    prefer: &'static str,
    form: Option<&'static str>,
}

/// A model, straight or bent, and a device with few enough inputs for brute force.
fn drawn(draw: &mut Draw, bent: bool) -> Drawn {
    let law = draw.one(&["cramer", "linear"]);
    let mut model = Model::new(Law::parse(law).unwrap());
    if draw.unit() < 0.5 {
        let delay = draw.between(-20e-6, 199e-6);
        model = model.with("fixed_delay", &[("delay", delay)]).unwrap();
    }
    if draw.unit() < 0.5 {
        let offset = draw.between(-5e-3, 5e-3);
        model = model.with("zero_error", &[("offset", offset)]).unwrap();
    }
    if bent {
        let walk = [
            ("delay", draw.between(1e-6, 60e-6)),
            ("threshold", draw.between(0.05, 0.8)),
            ("order", draw.between(1.0, 2.0)),
        ];
        model = model.with("amplitude_walk", &walk).unwrap();
    }
    let humid = bent || draw.unit() < 0.5;
    let low = draw.between(-30.0, 20.0);
    let temperature = Axis::temperature(1.0, low, low + draw.between(8.0, 40.0), 0.0).unwrap();
    let mut conditions = vec![temperature];
    if humid {
        let least = draw.between(0.0, 0.5);
        conditions.push(Axis::humidity(0.1, least, draw.between(least + 0.1, 1.0), 0.0).unwrap());
    }
    let distance = draw.between(0.5, 4.0);
    let tick = draw.one(&[1.0, 4.0, 0.9]);
    let shortest = draw.between(450.0, 900.0);
    let longest = shortest + draw.between(2000.0, if bent { 6000.0 } else { 20_000.0 });
    let device = Device {
        echo: Axis::echo(tick, shortest, longest).unwrap(),
        conditions,
        output: Output::parse(draw.one(&["um", "um", "um", "mm"])).unwrap(),
    };
    let at = Conditions::at(20.0).with(Quantity::RelativeHumidity, 0.5);
    let lowered = lower(&model, &device, &at, &["humidity".into()], distance).unwrap();
    Drawn {
        device,
        model: lowered,
        distance,
        bound: draw.one(&[0.02e-3, 0.1e-3, 0.5e-3, 3e-3]),
        target: draw.one(&["avr", "cortex-m0"]),
        prefer: draw.one(&["size", "speed"]),
        form: None,
    }
}

/// A model that bends down or up, for a form that takes the high bits of the echo code.
fn drawn_for_bent(draw: &mut Draw) -> Drawn {
    let mut model = Model::new(Law::parse("cramer").unwrap());
    if draw.unit() < 0.5 {
        let walk = [("delay", draw.between(80e-6, 300e-6))];
        model = model.with("amplitude_walk", &walk).unwrap();
    } else {
        let gradient = draw.between(3.0, 8.0) * draw.one(&[-1.0, 1.0]);
        let gradient = [("gradient", gradient)];
        model = model.with("temperature_gradient", &gradient).unwrap();
    }
    let low = draw.between(-30.0, 20.0);
    let temperature = Axis::temperature(1.0, low, low + draw.between(8.0, 40.0), 0.0).unwrap();
    let shortest = draw.between(150.0, 900.0);
    let longest = shortest + draw.between(9000.0, 16_000.0);
    let device = Device {
        echo: Axis::echo(draw.one(&[1.0, 0.9]), shortest, longest).unwrap(),
        conditions: vec![temperature],
        output: Output::MICROMETERS,
    };
    let at = Conditions::at(20.0).with(Quantity::RelativeHumidity, 0.5);
    let distance = draw.between(1.5, 3.0);
    Drawn {
        model: lower(&model, &device, &at, &[], distance).unwrap(),
        device,
        distance,
        bound: 0.5e-3,
        target: draw.one(&["avr", "c99", "cortex-m0"]),
        prefer: draw.one(&["size", "speed"]),
        form: Some("bent"),
    }
}

impl Drawn {
    fn design(&self) -> Design {
        let request = Request {
            reference: &self.model,
            device: &self.device,
            maximum_error: self.bound,
            maximum_distance: self.distance,
            maximum_table: 1024,
            widest: 64,
            target: Target::parse(self.target).unwrap(),
            form: self.form,
            prefer: Prefer::parse(self.prefer).unwrap(),
            threads: 2,
        };
        design(request, &mut |_| true).unwrap_or_else(|failure| *failure.best.unwrap())
    }

    fn proofs(&self, design: &Design) -> [Proof; 2] {
        let claim = Claim {
            device: &self.device,
            reference: &self.model,
            maximum_distance: self.distance,
            most: f64::INFINITY,
            threads: 2,
        };
        [prove, prove_one_by_one].map(|prove| prove(&design.program, claim, &mut |_| true).unwrap())
    }
}

#[test]
fn thirty_random_designs_on_straight_models_have_the_proof_of_brute_force() {
    let mut draw = Draw(33);
    for number in 0..30 {
        let drawn = drawn(&mut draw, false);
        let design = drawn.design();
        let [quick, brute] = drawn.proofs(&design);
        assert_eq!(quick, brute, "design {number}: {:?}", design.form);
    }
}

#[test]
fn ten_random_designs_on_bent_models_have_the_proof_of_brute_force() {
    let mut draw = Draw(34);
    compare((0..10).map(|_| drawn(&mut draw, true)));
}

#[test]
fn ten_random_designs_with_the_high_bits_of_the_echo_have_the_proof_of_brute_force() {
    let mut draw = Draw(35);
    compare((0..10).map(|_| drawn_for_bent(&mut draw)));
}

fn compare(designs: impl Iterator<Item = Drawn>) {
    for (number, drawn) in designs.enumerate() {
        let design = drawn.design();
        let [quick, brute] = drawn.proofs(&design);
        assert_eq!(
            (quick.hash, quick.inputs, quick.bounded_inputs),
            (brute.hash, brute.inputs, brute.bounded_inputs),
            "design {number}"
        );
        // Both invert the model by Newton's method, from different starts.
        for (a, b) in [
            (quick.bounded, brute.bounded),
            (quick.overall, brute.overall),
        ] {
            let same = (a.error - b.error).abs() < 1e-6 && (a.row, a.echo) == (b.row, b.echo);
            assert!(same, "design {number}: {a:?} {b:?}");
        }
    }
}
