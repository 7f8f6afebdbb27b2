//! Tables as text: the rows of some megabytes, the fields in them, and results behind them.

use echocal_text::columns::{Numbers, Numerals, numbers};
use echocal_text::fields::{Texts, texts};
use echocal_text::lines::{Dialect, Kind, Line, Memory, Scan, scan};
use echocal_text::quotes::Fault;
use echocal_text::results::{Results, appended};
use echocal_text::row::{each, width};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::border::{Column, same_length, within};

/// Bytes of the fields of a column, and where each begins.
type Fields<'py> = (Bound<'py, PyBytes>, Bound<'py, PyArray1<i32>>);

/// Numbers of a column, and whether all are integers.
type Column64<'py> = Option<(Bound<'py, PyArray1<f64>>, bool)>;

/// Places behind a line's text and its end, how many lines it is, its fields, and whether it is cut.
type Record = (usize, usize, u32, Option<Vec<Vec<u8>>>, Option<bool>);

/// What scans a text piece by piece.
#[pyclass(name = "Scanner", module = "echocal._core")]
pub struct CoreScanner {
    dialect: Dialect,
    memory: Memory,
}

#[pymethods]
impl CoreScanner {
    #[new]
    fn new(
        separator: u8,
        width: usize,
        comments: bool,
        braces: bool,
        repeated: Vec<Vec<u8>>,
    ) -> PyResult<Self> {
        if separator == b'"' || !separator.is_ascii() || width == 0 {
            let message = "a separator of ASCII that is no quotation mark, and at least one field";
            return Err(PyValueError::new_err(message));
        }
        let dialect = Dialect {
            separator,
            width,
            comments,
            braces,
            repeated,
        };
        let memory = Memory::default();
        Ok(Self { dialect, memory })
    }

    /// The whole lines at the beginning of some bytes; without the `last` ones, more follow.
    fn scan(&mut self, py: Python<'_>, data: Py<PyBytes>, last: bool) -> PyResult<CoreLines> {
        let bytes = data.as_bytes(py);
        if u32::try_from(bytes.len()).is_err() {
            return Err(PyValueError::new_err("a piece of more than four gigabytes"));
        }
        let scan = py.detach(|| scan(bytes, &self.dialect, &mut self.memory, last));
        let dialect = self.dialect.clone();
        Ok(CoreLines {
            data,
            scan,
            dialect,
        })
    }
}

/// Lines of a table, one behind the other.
#[pyclass(name = "Lines", module = "echocal._core", frozen)]
pub struct CoreLines {
    data: Py<PyBytes>,
    scan: Scan,
    dialect: Dialect,
}

impl CoreLines {
    fn places(&self, places: &[usize]) -> PyResult<()> {
        let fit = places.is_sorted_by(|one, next| one < next)
            && places.last().is_none_or(|&last| last < self.dialect.width);
        let wrong =
            || PyValueError::new_err("places of columns do not ascend, or are beyond the last one");
        fit.then_some(()).ok_or_else(wrong)
    }
}

#[pymethods]
impl CoreLines {
    /// Rows among them.
    fn __len__(&self) -> usize {
        self.scan.rows().count()
    }

    /// Bytes that they take.
    #[getter]
    fn taken(&self) -> usize {
        self.scan.lines.last().map_or(0, |line| line.next as usize)
    }

    /// Lines that they are: a row may have several.
    #[getter]
    fn count(&self) -> usize {
        self.scan.lines.iter().map(|line| line.count as usize).sum()
    }

    /// What is wrong behind them: the fault, the first line of its row, its own and the last one from 0 on, and its
    /// text.
    #[getter]
    fn wrong(&self) -> Option<(&'static str, usize, usize, usize, Vec<u8>)> {
        let wrong = self.scan.wrong.as_ref()?;
        let fault = match wrong.fault {
            Fault::Within => "within",
            Fault::Open => "open",
            Fault::Swallows => "swallows",
            Fault::LongField => "long field",
            Fault::LongLine => "long line",
        };
        Some((
            fault,
            wrong.first,
            wrong.line,
            wrong.last,
            wrong.text.clone(),
        ))
    }

    /// The bytes that they are at the beginning of.
    #[getter]
    fn data(&self, py: Python<'_>) -> Py<PyBytes> {
        self.data.clone_ref(py)
    }

    /// Rows that are not read: place among the rows, line from 0 on, fields that count, whether the row is cut.
    fn unread(&self, py: Python<'_>) -> Vec<(usize, usize, usize, bool)> {
        let data = self.data.as_bytes(py);
        let (mut row, mut number) = (0, 0);
        let mut found = Vec::new();
        for (begin, line) in self.scan.spans() {
            if matches!(line.kind, Kind::Cut | Kind::Wide) {
                let fields = width(&data[begin..line.end as usize], self.dialect.separator);
                found.push((row, number, fields, line.kind == Kind::Cut));
            }
            row += usize::from(line.kind != Kind::Other);
            number += line.count as usize;
        }
        found
    }

    /// Each line: places behind its text and behind its end, how many lines it is; where it is a row as many fields
    /// as the header has, and where it is not read whether it is cut. A row that is too wide is one field.
    fn records(&self, py: Python<'_>) -> Vec<Record> {
        let data = self.data.as_bytes(py);
        let fields = |text: &[u8], kind: Kind| {
            let mut fields = Vec::with_capacity(self.dialect.width);
            if kind == Kind::Wide {
                fields.push(text.to_vec());
            } else {
                each(text, self.dialect.separator, |_, field| {
                    fields.push(field.to_vec())
                });
            }
            fields.resize(self.dialect.width, Vec::new());
            fields
        };
        let record = |(begin, line): (usize, Line)| {
            let (end, next) = (line.end as usize, line.next as usize);
            let own = (line.kind != Kind::Other).then(|| fields(&data[begin..end], line.kind));
            let is_unread = matches!(line.kind, Kind::Cut | Kind::Wide);
            (
                end,
                next,
                line.count,
                own,
                is_unread.then_some(line.kind == Kind::Cut),
            )
        };
        self.scan.spans().map(record).collect()
    }

    /// Rows with fewer fields than the header, and how many they have; none that is too wide.
    fn short(&self, py: Python<'_>) -> Vec<(usize, usize)> {
        let data = self.data.as_bytes(py);
        let rows = self.scan.rows().enumerate();
        rows.filter_map(|(row, (begin, end, kind))| {
            let count = match kind {
                Kind::Odd => width(&data[begin..end], self.dialect.separator),
                Kind::Wide => 0,
                Kind::Cut => width(&data[begin..end], self.dialect.separator) - 1,
                _ => self.dialect.width,
            };
            (count < self.dialect.width).then_some((row, count))
        })
        .collect()
    }

    /// Numbers of the columns at some ascending places; None for a column with a field that is none.
    fn numbers<'py>(
        &self,
        py: Python<'py>,
        places: Vec<usize>,
        decimal: u8,
        absent: Vec<Vec<u8>>,
    ) -> PyResult<Vec<Column64<'py>>> {
        self.places(&places)?;
        let data = self.data.as_bytes(py);
        let absent = &absent;
        let numerals = Numerals { decimal, absent };
        let found = py.detach(|| numbers(data, &self.scan, &self.dialect, &places, numerals));
        let plain = |own: Numbers| (PyArray1::from_vec(py, own.values), own.are_whole);
        Ok(found.into_iter().map(|own| own.map(plain)).collect())
    }

    /// Fields of the columns at some ascending places: their bytes, where each begins, and where the last one
    /// ends.
    fn texts<'py>(&self, py: Python<'py>, places: Vec<usize>) -> PyResult<Vec<Fields<'py>>> {
        self.places(&places)?;
        let data = self.data.as_bytes(py);
        let found = py.detach(|| texts(data, &self.scan, &self.dialect, &places));
        let found =
            found.ok_or_else(|| PyValueError::new_err("a column of more than two gigabytes"))?;
        let plain = |own: Texts| {
            let bounds = PyArray1::from_vec(py, own.bounds);
            (PyBytes::new(py, &own.data), bounds)
        };
        Ok(found.into_iter().map(plain).collect())
    }

    /// The lines with the results of each row, as bytes.
    fn with_results<'py>(
        &self,
        py: Python<'py>,
        distance: Column<'py, f64>,
        uncertainty: Column<'py, f32>,
        codes: Column<'py, i16>,
        status: Vec<Vec<u8>>,
        decimal: u8,
    ) -> PyResult<Bound<'py, PyArray1<u8>>> {
        let (distance, uncertainty, codes) = (&*distance, &*uncertainty, &*codes);
        same_length(&[
            ("the text", self.__len__()),
            ("distance", distance.len()),
            ("uncertainty", uncertainty.len()),
            ("codes", codes.len()),
        ])?;
        let place = |&code: &i16| usize::try_from(code).unwrap_or(usize::MAX);
        within("status", codes.iter().map(place), status.len())?;
        let data = self.data.as_bytes(py);
        let results = Results {
            distance,
            uncertainty,
            codes,
            status: &status,
        };
        let written = py.detach(|| appended(data, &self.scan, &self.dialect, results, decimal));
        Ok(PyArray1::from_vec(py, written))
    }
}
