//! Texts of the templates, the filters that they use, and the files that they make.

use super::text::named;
use crate::error::Error;
use minijinja::{AutoEscape, Environment, UndefinedBehavior};

/// Name and text of templates.
macro_rules! templates {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../templates/", $name, ".j2")))),*]
    };
}

const TEMPLATES: &[(&str, &str)] = templates![
    "c/echocal_correction.h",
    "c/echocal_correction.c",
    "c/echocal_filter.h",
    "c/echocal_filter.c",
    "c/echocal_selftest.h",
    "c/echocal_selftest.c",
    "c/echocal_selftest_main.c",
    "c/program_memory",
    "c/middle",
    "c/echocal_air.h",
    "c/echocal_air.c",
    "c/echocal_unit.h",
    "c/echocal_unit.c",
    "arduino/sketch",
    "arduino/library.h",
    "arduino/library.properties",
    "arduino/keywords.txt",
    "arduino/HcSr04.ino",
    "arduino/SelfTest.ino",
    "arduino/usage.md",
    "arduino/tested.md",
    "platformio/platformio.ini",
    "platformio/library.json",
    "platformio/main.cpp",
    "platformio/test_selftest.cpp",
    "platformio/usage.md",
    "platformio/tested.md",
    "esphome/echocal.yaml",
    "esphome/init.py",
    "esphome/sensor.py",
    "esphome/echocal_sensor.h",
    "esphome/echocal_sensor.cpp",
    "esphome/usage.md",
    "esphome/tested.md",
    "micropython/echocal_correction.py",
    "micropython/echocal_selftest.py",
    "micropython/main.py",
    "micropython/package.json",
    "micropython/usage.md",
    "micropython/tested.md",
    "esp-idf/CMakeLists.txt",
    "esp-idf/idf_component.yml",
    "esp-idf/usage.md",
    "esp-idf/tested.md",
    "zephyr/module.yml",
    "zephyr/CMakeLists.txt",
    "zephyr/Kconfig",
    "zephyr/usage.md",
    "zephyr/tested.md",
    "rust/Cargo.toml",
    "rust/lib.rs",
    "rust/golden.rs",
    "rust/usage.md",
    "rust/tested.md",
    "package/README.md",
    "package/LICENSE",
];

/// The license text of this project.
const MIT: &str = include_str!("../../../LICENSE-MIT");

/// Path and text of each file. A path is a template, too: it may hold the name of a library. In both, `name` takes the
/// place of `echocal` in identifiers.
///
/// # Errors
/// [`Error::Template`] if a template fails, a defect of this crate.
pub(super) fn render(
    parts: &[(&str, &str)],
    context: &minijinja::Value,
    name: &str,
) -> Result<Vec<(String, String)>, Error> {
    let environment = environment(name)?;
    let file = |(path, template): &(&str, &str)| {
        let text = environment.get_template(template)?.render(context)?;
        let path = environment.render_str(&named(path, name), context)?;
        Ok((path, text))
    };
    let files: Result<_, minijinja::Error> = parts.iter().map(file).collect();
    files.map_err(|error| failed(&error))
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
    // Lengths [m]: in mm, up to three places; in m, down and up to whole millimeters.
    environment.add_filter("mm_up", |length: f64| {
        length.mul_add(1e6, -1e-6).ceil() / 1e3
    });
    environment.add_filter("m_down", |length: f64| {
        length.mul_add(1e3, 1e-6).floor() / 1e3
    });
    environment.add_filter("m_up", |length: f64| {
        length.mul_add(1e3, -1e-6).ceil() / 1e3
    });
    environment.add_filter("micro", |value: f64| (value * 1e6).round() as i64);
    environment.add_filter("pico", |value: f64| (value * 1e12).round() as i64);
    for (name, text) in TEMPLATES.iter().chain(&[("package/MIT", MIT)]) {
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
