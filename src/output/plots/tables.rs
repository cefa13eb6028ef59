//! The tables of a result folder, read back as text.

use std::collections::HashSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use csv::StringRecord;

use super::axis::drawable;
use super::error::PlotError;
use crate::branch::EventType;
use crate::branch::row::WORD_COLUMNS;

/// Columns of `branch.csv` that hold words or lists.
const WORDS: [&str; 4] = ["type", "regimes", "switches", "stable"];

/// A table: the header and the complete rows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    path: PathBuf,
    columns: Vec<String>,
    rows: Vec<StringRecord>,
}

impl Table {
    /// Reads a table. A last row that a killed run has not finished is left out.
    pub fn read(path: &Path) -> Result<Self, PlotError> {
        let bytes = fs::read(path).map_err(|source| PlotError::Read {
            path: path.to_owned(),
            source,
        })?;
        Table::parse(path, &String::from_utf8_lossy(&bytes))
    }

    /// Reads a table that may be missing.
    pub fn read_if_there(path: &Path) -> Result<Option<Self>, PlotError> {
        match Table::read(path) {
            Err(PlotError::Read { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
                Ok(None)
            }
            Err(PlotError::Empty { .. }) => Ok(None),
            other => other.map(Some),
        }
    }

    fn parse(path: &Path, text: &str) -> Result<Self, PlotError> {
        let text = text.trim_start_matches('\u{feff}');
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let fault = |source| PlotError::Table {
            path: path.to_owned(),
            source,
        };
        let columns: Vec<String> = reader
            .headers()
            .map_err(fault)?
            .iter()
            .map(str::to_owned)
            .collect();
        if columns.iter().all(String::is_empty) {
            return Err(PlotError::Empty {
                path: path.to_owned(),
            });
        }
        let mut rows = Vec::new();
        for record in reader.records() {
            rows.push(record.map_err(fault)?);
        }
        // Every finished row ends its line; without that even a full row may lack figures.
        let finished = rows
            .last()
            .is_none_or(|row| row.len() >= columns.len() && text.ends_with('\n'));
        if !finished {
            rows.pop();
        }
        Ok(Table {
            path: path.to_owned(),
            columns,
            rows,
        })
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Names of the columns.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(String::as_str)
    }

    /// Fails when a column is missing.
    pub fn require(&self, columns: &[&str]) -> Result<(), PlotError> {
        match columns
            .iter()
            .find(|wanted| !self.columns().any(|name| name == **wanted))
        {
            Some(column) => Err(PlotError::MissingColumn {
                path: self.path.clone(),
                column: (*column).to_owned(),
            }),
            None => Ok(()),
        }
    }

    /// A cell; empty when there is none.
    pub fn text(&self, row: usize, column: &str) -> &str {
        self.columns()
            .position(|name| name == column)
            .and_then(|index| self.rows.get(row)?.get(index))
            .unwrap_or("")
    }

    /// A cell as a number; none when it is empty, no number, or too large to draw.
    pub fn number(&self, row: usize, column: &str) -> Option<f64> {
        let value: f64 = self.text(row, column).parse().ok()?;
        drawable(value).then_some(value)
    }

    /// A cell as an event type.
    pub fn kind(&self, row: usize) -> Option<EventType> {
        self.text(row, "type").parse().ok()
    }

    /// A cell as numbers separated by blanks.
    pub fn list(&self, row: usize, column: &str) -> Vec<f64> {
        self.text(row, column)
            .split_whitespace()
            .filter_map(|word| word.parse().ok())
            .filter(|value| drawable(*value))
            .collect()
    }

    /// The row whose cell in `label` reads the same.
    pub fn row_of_label(&self, label: &str) -> Option<usize> {
        (0..self.len()).find(|row| !label.is_empty() && self.text(*row, "label") == label)
    }
}

/// The tables of a result folder except the profiles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tables {
    /// Points of the branch.
    pub branch: Table,
    /// Special points; empty when the file is missing.
    pub events: Table,
    /// Eigenvalues, where they were asked for.
    pub spectrum: Option<Table>,
}

/// A special point to be marked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Its type.
    pub kind: EventType,
    /// Value of the parameter.
    pub x: f64,
    /// Value of the column shown.
    pub y: f64,
}

impl Tables {
    /// Reads the tables of a folder.
    pub fn read(folder: &Path) -> Result<Self, PlotError> {
        Ok(Tables {
            branch: Table::read(&folder.join("branch.csv"))?,
            events: Table::read_if_there(&folder.join("events.csv"))?.unwrap_or_default(),
            spectrum: Table::read_if_there(&folder.join("spectrum.csv"))?,
        })
    }

    /// Fails unless `name` is a numeric column of `branch.csv`.
    pub fn check_parameter(&self, name: &str) -> Result<(), PlotError> {
        self.check(name, &WORDS)
    }

    /// Fails unless `name` is a column of `branch.csv` that can be drawn over the parameter.
    pub fn check_column(&self, name: &str) -> Result<(), PlotError> {
        self.check(name, &WORD_COLUMNS)
    }

    fn check(&self, name: &str, refused: &[&str]) -> Result<(), PlotError> {
        let known: Vec<&str> = self
            .branch
            .columns()
            .filter(|column| !refused.contains(column))
            .collect();
        if known.contains(&name) {
            Ok(())
        } else {
            Err(PlotError::UnknownColumn {
                name: name.to_owned(),
                known: known.join(", "),
            })
        }
    }

    /// A value at a labelled point, from the branch or else from its events.
    pub fn at_label(&self, label: &str, column: &str) -> Option<f64> {
        let of = |table: &Table| table.number(table.row_of_label(label)?, column);
        of(&self.branch).or_else(|| of(&self.events))
    }

    /// Whether a label was asked for by the value of its parameter.
    pub fn asked_for(&self, label: &str) -> bool {
        let row = self.events.row_of_label(label);
        row.and_then(|row| self.events.kind(row)) == Some(EventType::UZ)
    }

    /// The numbers in a cell of a labelled point, from the branch or else from its events.
    pub fn list_at_label(&self, label: &str, column: &str) -> Vec<f64> {
        [&self.branch, &self.events]
            .into_iter()
            .filter_map(|table| Some(table.list(table.row_of_label(label)?, column)))
            .find(|list| !list.is_empty())
            .unwrap_or_default()
    }

    /// Place of a labelled point along the branch. A second leg runs from the start of the first
    /// the other way.
    pub fn position(&self, label: &str) -> i64 {
        let Some(row) = self.branch.row_of_label(label) else {
            return 0;
        };
        let place = i64::try_from(row).unwrap_or(i64::MAX);
        if self.branch.text(row, "leg") == "2" {
            -place
        } else {
            place
        }
    }

    /// The special points with their place in a picture of column `y` over column `x`.
    pub fn marks(&self, x: &str, y: &str) -> Vec<Mark> {
        let of_branch = (0..self.branch.len()).map(|row| (&self.branch, row));
        let of_events = (0..self.events.len()).map(|row| (&self.events, row));
        let mut seen = HashSet::new();
        let mut marks = Vec::new();
        for (table, row) in of_branch.chain(of_events) {
            let Some(kind) = table.kind(row) else {
                continue;
            };
            // The same event is usually in both tables.
            let key = (table.text(row, "label"), kind);
            if !key.0.is_empty() && !seen.insert(key) {
                continue;
            }
            let value = |column: &str| {
                table
                    .number(row, column)
                    .or_else(|| self.at_label(key.0, column))
            };
            if let (Some(x), Some(y)) = (value(x), value(y)) {
                marks.push(Mark { kind, x, y });
            }
        }
        marks
    }
}
