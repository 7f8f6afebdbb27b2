//! Tables of published values: first line the source, second the column names.

use std::collections::HashMap;
use std::path::Path;

use echocal_core::air::Air;

/// Reads `tests/published/<name>.csv` of the repository; each row by column name, cells as text.
pub fn published(name: &str) -> Vec<HashMap<String, String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/published")
        .join(format!("{name}.csv"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut lines = text.lines();
    let source = lines.next().unwrap_or_default();
    assert!(source.starts_with("# source: "), "{name}: no source");
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| -> HashMap<String, String> {
        let cells = line.split(',').map(str::to_owned);
        let names = header.iter().map(|&column| column.to_owned());
        names.zip(cells).collect()
    };
    let rows: Vec<_> = lines.map(row).collect();
    assert!(!rows.is_empty(), "{name}: no rows");
    rows
}

/// A cell as a number.
pub fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap()
}

/// Half a unit of the last printed digit.
pub fn half_digit(printed: &str) -> f64 {
    let decimals = printed.split_once('.').map_or(0, |(_, tail)| tail.len());
    0.5 * 10_f64.powi(-i32::try_from(decimals).unwrap())
}

/// The air of a row; columns that are absent take the standard atmosphere with 400 ppm CO2.
pub fn air(row: &HashMap<String, String>) -> Air<f64> {
    let or = |column: &str, default| {
        row.get(column)
            .map_or(default, |cell| cell.parse().unwrap())
    };
    Air {
        temperature: number(row, "temperature_C"),
        relative_humidity: or("relative_humidity", 0.0),
        pressure: or("pressure_Pa", 101_325.0),
        co2_mole_fraction: or("co2_mole_fraction", 4e-4),
    }
}
