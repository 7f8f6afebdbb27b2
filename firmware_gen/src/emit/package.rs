//! Packagings: which files a firmware comes as, and the template that writes each.

use super::filter;
use super::templates::render;
use crate::device::{Axis, Device};
use crate::error::Error;
use crate::types::IntegerType;

/// One way to ship the function.
#[derive(Clone, Copy, Debug)]
pub struct Package {
    /// Its name on the command line.
    pub name: &'static str,
    /// Shortest and longest echo pulse \[us\] that its files measure.
    pulses: (f64, f64),
    /// Whether an example makes the codes of conditions from values: then they are multiples of a step, of all bits.
    makes_codes: bool,
    /// Its files: path, which may hold `{{ library }}`, and name of the template.
    parts: &'static [(&'static str, &'static str)],
}

const HEADER: &str = "c/echocal_correction.h";
const SOURCE: &str = "c/echocal_correction.c";
const SELFTEST_HEADER: &str = "c/echocal_selftest.h";
const SELFTEST: &str = "c/echocal_selftest.c";
const README: (&str, &str) = ("README.md", "package/README.md");
const LICENSE: (&str, &str) = ("LICENSE", "package/LICENSE");

/// Plain C is given an echo time: it measures none.
const ANY: (f64, f64) = (0.0, f64::INFINITY);
/// 1 s is 170 m: a limit set by hand. Counts of nanoseconds in 32 bits overflow at 4.3 s.
const LONGEST: f64 = 1e6;
const SKETCH: (f64, f64) = (0.0, LONGEST);

/// Finest step of a condition \[degC, 1\] that the sketches make codes of: they count in 1e-6. Set by hand: 1 % of it.
const FINEST: f64 = 1e-4;

/// Packagings whose files name the sensors that they read.
const WITHOUT_FURTHER: [&str; 2] = ["esphome", "micropython"];

/// Every packaging. To add one, write its templates and add its lines.
pub const PACKAGES: &[Package] = &[
    Package {
        name: "c",
        pulses: ANY,
        makes_codes: false,
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
        makes_codes: true,
        parts: &[
            README,
            LICENSE,
            ("library.properties", "arduino/library.properties"),
            ("keywords.txt", "arduino/keywords.txt"),
            ("src/{{ library }}.h", "arduino/library.h"),
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
        makes_codes: true,
        parts: &[
            README,
            LICENSE,
            ("platformio.ini", "platformio/platformio.ini"),
            ("src/main.cpp", "platformio/main.cpp"),
            ("lib/{{ library }}/library.json", "platformio/library.json"),
            ("lib/{{ library }}/LICENSE", "package/LICENSE"),
            ("lib/{{ library }}/src/{{ library }}.h", "arduino/library.h"),
            ("lib/{{ library }}/src/echocal_correction.h", HEADER),
            ("lib/{{ library }}/src/echocal_correction.c", SOURCE),
            ("lib/{{ library }}/src/echocal_selftest.h", SELFTEST_HEADER),
            ("lib/{{ library }}/src/echocal_selftest.c", SELFTEST),
            (
                "test/test_selftest/test_selftest.cpp",
                "platformio/test_selftest.cpp",
            ),
        ],
    },
    Package {
        name: "esphome",
        pulses: SKETCH,
        makes_codes: true,
        parts: &[
            README,
            LICENSE,
            ("{{ name }}.yaml", "esphome/echocal.yaml"),
            ("components/{{ name }}/__init__.py", "esphome/init.py"),
            ("components/{{ name }}/sensor.py", "esphome/sensor.py"),
            (
                "components/{{ name }}/echocal_sensor.h",
                "esphome/echocal_sensor.h",
            ),
            (
                "components/{{ name }}/echocal_sensor.cpp",
                "esphome/echocal_sensor.cpp",
            ),
            ("components/{{ name }}/echocal_correction.h", HEADER),
            ("components/{{ name }}/echocal_correction.c", SOURCE),
        ],
    },
    Package {
        name: "micropython",
        pulses: SKETCH,
        makes_codes: true,
        parts: &[
            README,
            LICENSE,
            ("echocal_correction.py", "micropython/echocal_correction.py"),
            ("echocal_selftest.py", "micropython/echocal_selftest.py"),
            ("main.py", "micropython/main.py"),
            ("package.json", "micropython/package.json"),
        ],
    },
    Package {
        name: "esp-idf",
        pulses: ANY,
        makes_codes: false,
        parts: &[
            README,
            LICENSE,
            ("CMakeLists.txt", "esp-idf/CMakeLists.txt"),
            ("idf_component.yml", "esp-idf/idf_component.yml"),
            ("src/echocal_correction.h", HEADER),
            ("src/echocal_correction.c", SOURCE),
            ("src/echocal_selftest.h", SELFTEST_HEADER),
            ("src/echocal_selftest.c", SELFTEST),
        ],
    },
    Package {
        name: "zephyr",
        pulses: ANY,
        makes_codes: false,
        parts: &[
            README,
            LICENSE,
            ("zephyr/module.yml", "zephyr/module.yml"),
            ("zephyr/CMakeLists.txt", "zephyr/CMakeLists.txt"),
            ("zephyr/Kconfig", "zephyr/Kconfig"),
            ("src/echocal_correction.h", HEADER),
            ("src/echocal_correction.c", SOURCE),
            ("src/echocal_selftest.h", SELFTEST_HEADER),
            ("src/echocal_selftest.c", SELFTEST),
        ],
    },
    Package {
        name: "rust",
        pulses: ANY,
        makes_codes: false,
        parts: &[
            README,
            LICENSE,
            ("Cargo.toml", "rust/Cargo.toml"),
            ("src/lib.rs", "rust/lib.rs"),
            ("tests/golden.rs", "rust/golden.rs"),
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
    pub fn check(&self, device: &Device) -> Result<(), Error> {
        let echo = &device.echo;
        self.check_codes(device)?;
        self.check_further(device)?;
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

    fn check_further(&self, device: &Device) -> Result<(), Error> {
        match device.further() {
            Some(place) if WITHOUT_FURTHER.contains(&self.name) => Err(Error::Request(format!(
                "the package {} reads temperature and humidity, and {} is a further input: choose another package",
                self.name, device.conditions[place].name
            ))),
            _ => Ok(()),
        }
    }

    fn check_codes(&self, device: &Device) -> Result<(), Error> {
        if !self.makes_codes {
            return Ok(());
        }
        let name = self.name;
        let further = device.further().map(|place| &device.conditions[place].name);
        // The example makes no codes of a further input: the user does.
        let fine = |axis: &&Axis| {
            axis.lsb.abs() < FINEST && axis.curve.is_none() && Some(&axis.name) != further
        };
        let refused = if device.echo.ty != IntegerType::U16 {
            "a timer of 32 bits".into()
        } else if let Some(axis) = device.conditions.iter().find(|axis| axis.curve.is_some()) {
            format!("{} of a thermistor", axis.name)
        } else if let Some(axis) = device.conditions.iter().find(fine) {
            format!("{} in steps of {}", axis.name, axis.with_unit(axis.lsb))
        } else {
            return Ok(());
        };
        Err(Error::Request(format!(
            "the example of package '{name}' makes no codes for {refused}: choose the package c, esp-idf, zephyr or rust"
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
        with_filter: bool,
    ) -> Result<Vec<(String, String)>, Error> {
        let mut files = render(self.parts, context, name)?;
        if with_filter {
            let parts = filter::parts(self.parts);
            let parts: Vec<_> = parts
                .iter()
                .map(|(path, template)| (&**path, &**template))
                .collect();
            files.extend(render(&parts, context, name)?);
        }
        Ok(files)
    }

    /// Refuse a median filter where it is not written.
    ///
    /// # Errors
    /// If the package holds no C of ours that a program of the user calls.
    pub fn check_filter(&self) -> Result<(), Error> {
        let way_out = match self.name {
            "esphome" => "ESPHome has its own: write 'filters:' with '- median:' below the sensor",
            _ if filter::parts(self.parts).is_empty() => {
                "it is written in C: choose another package"
            }
            _ => return Ok(()),
        };
        Err(Error::Request(format!(
            "the package {} has no median filter; {way_out}",
            self.name
        )))
    }
}
