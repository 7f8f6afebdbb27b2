//! Packagings: which files a firmware comes as, and the template that writes each.

use super::text::named;
use crate::device::Axis;
use crate::error::Error;
use minijinja::{AutoEscape, Environment, UndefinedBehavior};

/// One way to ship the function.
#[derive(Clone, Copy, Debug)]
pub struct Package {
    /// Its name on the command line.
    pub name: &'static str,
    /// Shortest and longest echo pulse \[us\] that its files measure.
    pulses: (f64, f64),
    /// Its files: path, and name of the template.
    parts: &'static [(&'static str, &'static str)],
}

/// Name and text of templates.
macro_rules! templates {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../templates/", $name, ".j2")))),*]
    };
}

const TEMPLATES: &[(&str, &str)] = templates![
    "c/echocal_correction.h",
    "c/echocal_correction.c",
    "c/echocal_selftest.h",
    "c/echocal_selftest.c",
    "c/echocal_selftest_main.c",
    "c/program_memory",
    "c/middle",
    "arduino/sketch",
    "arduino/library.properties",
    "arduino/keywords.txt",
    "arduino/HcSr04.ino",
    "arduino/SelfTest.ino",
    "platformio/platformio.ini",
    "platformio/library.json",
    "platformio/main.cpp",
    "platformio/test_selftest.cpp",
    "esphome/echocal.yaml",
    "micropython/echocal_correction.py",
    "micropython/echocal_selftest.py",
    "micropython/main.py",
];

const HEADER: &str = "c/echocal_correction.h";
const SOURCE: &str = "c/echocal_correction.c";
const SELFTEST_HEADER: &str = "c/echocal_selftest.h";
const SELFTEST: &str = "c/echocal_selftest.c";

/// Plain C is given an echo time: it measures none.
const ANY: (f64, f64) = (0.0, f64::INFINITY);
/// 1 s is 170 m: a limit set by hand. Counts of nanoseconds in 32 bits overflow at 4.3 s, and ESPHome measures each second.
const LONGEST: f64 = 1e6;
const SKETCH: (f64, f64) = (0.0, LONGEST);
/// To ESPHome's component `ultrasonic` an edge within 50 us of the one before is noise, its `DEBOUNCE_US`.
const DEBOUNCED: (f64, f64) = (51.0, LONGEST);

/// Every packaging. To add one, write its templates and add its lines.
pub const PACKAGES: &[Package] = &[
    Package {
        name: "c",
        pulses: ANY,
        parts: &[
            ("echocal_correction.h", HEADER),
            ("echocal_correction.c", SOURCE),
            ("selftest/echocal_selftest.h", SELFTEST_HEADER),
            ("selftest/echocal_selftest.c", SELFTEST),
            (
                "selftest/echocal_selftest_main.c",
                "c/echocal_selftest_main.c",
            ),
        ],
    },
    Package {
        name: "arduino",
        pulses: SKETCH,
        parts: &[
            ("library.properties", "arduino/library.properties"),
            ("keywords.txt", "arduino/keywords.txt"),
            ("src/echocal_correction.h", HEADER),
            ("src/echocal_correction.c", SOURCE),
            ("src/echocal_selftest.h", SELFTEST_HEADER),
            ("src/echocal_selftest.c", SELFTEST),
            ("examples/HcSr04/HcSr04.ino", "arduino/HcSr04.ino"),
            ("examples/SelfTest/SelfTest.ino", "arduino/SelfTest.ino"),
        ],
    },
    Package {
        name: "platformio",
        pulses: SKETCH,
        parts: &[
            ("platformio.ini", "platformio/platformio.ini"),
            ("src/main.cpp", "platformio/main.cpp"),
            (
                "lib/EchocalCorrection/library.json",
                "platformio/library.json",
            ),
            ("lib/EchocalCorrection/src/echocal_correction.h", HEADER),
            ("lib/EchocalCorrection/src/echocal_correction.c", SOURCE),
            (
                "lib/EchocalCorrection/src/echocal_selftest.h",
                SELFTEST_HEADER,
            ),
            ("lib/EchocalCorrection/src/echocal_selftest.c", SELFTEST),
            (
                "test/test_selftest/test_selftest.cpp",
                "platformio/test_selftest.cpp",
            ),
        ],
    },
    Package {
        name: "esphome",
        pulses: DEBOUNCED,
        parts: &[
            ("echocal.yaml", "esphome/echocal.yaml"),
            ("echocal_correction.h", HEADER),
            ("echocal_correction.c", SOURCE),
        ],
    },
    Package {
        name: "micropython",
        pulses: SKETCH,
        parts: &[
            ("echocal_correction.py", "micropython/echocal_correction.py"),
            ("echocal_selftest.py", "micropython/echocal_selftest.py"),
            ("main.py", "micropython/main.py"),
        ],
    },
];

impl Package {
    /// The packaging of this name.
    ///
    /// # Errors
    /// If there is none.
    pub fn parse(name: &str) -> Result<Self, Error> {
        let found = PACKAGES.iter().find(|package| package.name == name);
        found.copied().ok_or_else(|| {
            let known: Vec<_> = PACKAGES.iter().map(|package| package.name).collect();
            let known = known.join(", ");
            Error::Request(format!(
                "unknown package '{name}'; this version has {known}"
            ))
        })
    }

    /// Refuse echo times that the function accepts and the files cannot measure: they would be lost without a word.
    ///
    /// # Errors
    /// If there are any.
    pub fn check(&self, echo: &Axis) -> Result<(), Error> {
        let (shortest, longest) = self.pulses;
        let [first, last] = [echo.codes.minimum, echo.codes.maximum].map(|code| echo.us(code));
        if first >= shortest && last <= longest {
            return Ok(());
        }
        Err(Error::Request(format!(
            "the files of package '{}' measure echo times of {shortest} .. {longest} us, and {first} .. {last} us are to be accepted: give an echo min and an echo max within these limits, or the package c",
            self.name
        )))
    }

    /// Path and text of each file. In both, `name` takes the place of `echocal` in identifiers.
    ///
    /// # Errors
    /// [`Error::Template`] if a template fails, a defect of this crate.
    pub fn render(
        &self,
        context: &minijinja::Value,
        name: &str,
    ) -> Result<Vec<(String, String)>, Error> {
        let environment = environment(name)?;
        let render = |(path, template): &(&str, &str)| {
            let text = environment.get_template(template)?.render(context)?;
            Ok((
                named(path, name).replace("echocal.", &format!("{name}.")),
                text,
            ))
        };
        let files: Result<_, minijinja::Error> = self.parts.iter().map(render).collect();
        files.map_err(|error| failed(&error))
    }
}

fn environment(own: &str) -> Result<Environment<'static>, Error> {
    let mut environment = Environment::new();
    environment.set_trim_blocks(true);
    environment.set_lstrip_blocks(true);
    environment.set_keep_trailing_newline(true);
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_auto_escape_callback(|_| AutoEscape::None);
    environment.add_filter("comment", comment);
    environment.add_filter("docstring", docstring);
    environment.add_filter("micro", |value: f64| (value * 1e6).round() as i64);
    environment.add_filter("pico", |value: f64| (value * 1e12).round() as i64);
    // Up to whole centimeters, as the component `ultrasonic` of ESPHome converts an echo time [us].
    environment.add_filter("esphome_meters", |us: f64| {
        format!("{:.2}", (us * 1e-6 * 343.0 / 2.0 * 100.0).ceil() / 100.0)
    });
    for (name, text) in TEMPLATES {
        environment
            .add_template_owned(*name, named(text, own))
            .map_err(|error| failed(&error))?;
    }
    Ok(environment)
}

/// Text from outside, made safe inside a docstring of Python.
fn docstring(text: String) -> String {
    text.replace('\\', "\\\\").replace("\"\"\"", "'''")
}

/// Text from outside, made safe inside a comment of C: a file may be called `*/`.
fn comment(text: String) -> String {
    let visible = |letter: char| if letter.is_control() { ' ' } else { letter };
    let text: String = text.chars().map(visible).collect();
    text.replace("*/", "* /")
        .replace("/*", "/ *")
        .replace("??/", "?? /")
}

fn failed(error: &minijinja::Error) -> Error {
    Error::Template(format!("{error:#}"))
}
