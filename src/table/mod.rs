//! Structures as rows of CSV and back, by serde.
//!
//! A field is a column by its name. A structure or a map within a row has its own columns, and a list
//! stands in one cell, separated by blanks. Numbers carry 17 significant digits, so that reading them
//! back gives the same double; what is not finite, and what is not there, is an empty cell.

mod cells;
mod figures;
#[cfg(test)]
mod tests;

#[cfg(feature = "cli")]
pub(crate) use cells::{columns, header, line, line_of, table};
#[cfg(feature = "cli")]
pub(crate) use figures::number;

use std::borrow::Cow;
use std::str::FromStr;

use csv::StringRecord;
use serde::de::DeserializeOwned;

/// A table that was read: a header, and all rows that are finished.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Table {
    header: Vec<String>,
    /// All cells, without what separates them.
    text: String,
    /// Where each cell ends in the text.
    ends: Vec<usize>,
    /// The number of cells up to the end of each row.
    rows: Vec<usize>,
}

impl Table {
    /// Reads a table. A last line without its end was cut short by a kill and is left out; a row may
    /// have fewer cells than the header, and blanks round them.
    ///
    /// # Errors
    /// When it is no CSV.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Table, csv::Error> {
        let whole = bytes.iter().rposition(|byte| *byte == b'\n');
        let bytes = &bytes[..whole.map_or(0, |last| last + 1)];
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) => String::from_utf8_lossy(bytes),
        };
        let text = text.trim_start_matches('\u{feff}');
        let mut table = Table::default();
        if text.bytes().any(|byte| matches!(byte, b'"' | b'\r')) {
            let mut reader = csv::ReaderBuilder::new()
                .flexible(true)
                .has_headers(false)
                .from_reader(text.as_bytes());
            for record in reader.records() {
                table.push(record?.iter());
            }
        } else {
            table.text.reserve(text.len());
            table.push_plain(text);
        }
        Ok(table)
    }

    /// Adds all lines of a text without quotes; empty ones are none.
    fn push_plain(&mut self, text: &str) {
        let (mut cells, mut from) = (Vec::new(), 0);
        for (place, byte) in text.bytes().enumerate() {
            if !matches!(byte, b',' | b'\n') {
                continue;
            }
            cells.push(&text[from..place]);
            from = place + 1;
            if byte == b'\n' {
                if cells != [""] {
                    self.push(cells.iter().copied());
                }
                cells.clear();
            }
        }
    }

    /// Adds a line: the first one is the header.
    fn push<'a>(&mut self, cells: impl Iterator<Item = &'a str>) {
        if self.header.is_empty() {
            self.header = cells.map(|name| name.trim().to_owned()).collect();
            return;
        }
        for cell in cells {
            self.text.push_str(cell);
            self.ends.push(self.text.len());
        }
        self.rows.push(self.ends.len());
    }

    /// The same table with other cells in a column.
    pub(crate) fn with(&self, column: &str, cell: impl Fn(usize) -> String) -> Table {
        let mut table = Table::default();
        table.push(self.columns());
        for row in 0..self.len() {
            let own = cell(row);
            let cells = self.columns().zip(self.row(row));
            table.push(cells.map(|(name, text)| if name == column { &*own } else { text }));
        }
        table
    }

    /// The cells of a row.
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = &str> {
        let first = row.checked_sub(1).map_or(0, |before| self.rows[before]);
        (first..self.rows[row]).map(|cell| self.cell(cell))
    }

    /// A cell by its number in the table, without blanks round it.
    fn cell(&self, cell: usize) -> &str {
        let from = cell.checked_sub(1).map_or(0, |before| self.ends[before]);
        self.text[from..self.ends[cell]].trim()
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is no row.
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    pub(crate) fn columns(&self) -> impl Iterator<Item = &str> {
        self.header.iter().map(String::as_str)
    }

    /// Whether there is a column of this name.
    pub(crate) fn has(&self, column: &str) -> bool {
        self.columns().any(|name| name == column)
    }

    /// A cell; empty when there is none.
    pub(crate) fn text(&self, row: usize, column: &str) -> &str {
        let place = self.columns().position(|name| name == column);
        place.map_or("", |place| self.text_at(row, place))
    }

    /// A cell by the place of its column; empty when there is none.
    fn text_at(&self, row: usize, place: usize) -> &str {
        let Some(last) = self.rows.get(row) else {
            return "";
        };
        let first = row.checked_sub(1).map_or(0, |before| self.rows[before]);
        match first + place < *last {
            true => self.cell(first + place),
            false => "",
        }
    }

    /// The cells of these columns, row by row; those of a column that is missing are empty.
    pub(crate) fn select<const N: usize>(
        &self,
        columns: [&str; N],
    ) -> impl Iterator<Item = [&str; N]> {
        let places = columns.map(|column| self.columns().position(|name| name == column));
        (0..self.len())
            .map(move |row| places.map(|place| place.map_or("", |place| self.text_at(row, place))))
    }

    /// A cell as a value; none when it is empty or something else.
    pub(crate) fn field<T: FromStr>(&self, row: usize, column: &str) -> Option<T> {
        self.text(row, column).parse().ok()
    }

    /// A cell with a list of numbers.
    pub(crate) fn list(&self, row: usize, column: &str) -> Vec<f64> {
        let words = self.text(row, column).split_whitespace();
        words.filter_map(|word| word.parse().ok()).collect()
    }

    /// The first row that has this in its column `label`.
    pub(crate) fn labelled(&self, label: &str) -> Option<usize> {
        (0..self.len()).find(|row| !label.is_empty() && self.text(*row, "label") == label)
    }

    /// All rows as structures whose fields are columns; other columns do not matter.
    ///
    /// # Errors
    /// When a column is missing, or a cell is not of its type.
    pub(crate) fn rows<T: DeserializeOwned>(&self) -> Result<Vec<T>, csv::Error> {
        let header = StringRecord::from_iter(self.columns());
        let rows = (0..self.len()).map(|row| StringRecord::from_iter(self.row(row)));
        rows.map(|row| row.deserialize(Some(&header))).collect()
    }
}
