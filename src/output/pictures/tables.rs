//! The tables of a result folder, read back as text.
//!
//! A picture can be drawn long after the run, of tables that another version has written or that a
//! killed run has left unfinished: what a picture does not need may be missing, and odd cells are gaps.

use std::collections::HashSet;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use csv::StringRecord;

use super::error::PlotError;
use crate::branch::EventType;
use crate::branch::row::WORD_COLUMNS;
use crate::output::render::Point;
use crate::output::render::axis::drawable;

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
    /// Reads all columns of a table. A last row that a killed run has not finished is left out.
    pub fn read(path: &Path) -> Result<Self, PlotError> {
        Table::columns_of(path, None)
    }

    /// Reads these columns of a table, each of which it must have.
    pub fn select(path: &Path, columns: &[&str]) -> Result<Self, PlotError> {
        Table::columns_of(path, Some(columns))
    }

    /// The table if there is one that has a header.
    pub fn if_there(table: Result<Self, PlotError>) -> Result<Option<Self>, PlotError> {
        match table {
            Err(PlotError::Read { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
                Ok(None)
            }
            Err(PlotError::Empty { .. }) => Ok(None),
            other => other.map(Some),
        }
    }

    fn columns_of(path: &Path, wanted: Option<&[&str]>) -> Result<Self, PlotError> {
        let path_of = || path.to_owned();
        let unread = |source| PlotError::Read {
            path: path_of(),
            source,
        };
        let fault = |source| PlotError::Table {
            path: path_of(),
            source,
        };
        let mut file = File::open(path).map_err(unread)?;
        let ended = line_ended(&mut file).map_err(unread)?;
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(BufReader::new(file));
        let header = reader.byte_headers().map_err(fault)?.clone();
        let header = StringRecord::from_byte_record_lossy(header);
        if header.iter().all(str::is_empty) {
            return Err(PlotError::Empty { path: path_of() });
        }
        let place = |column: &str| header.iter().position(|name| name == column);
        let places: Vec<usize> = match wanted {
            None => (0..header.len()).collect(),
            Some(wanted) => wanted
                .iter()
                .map(|column| {
                    place(column).ok_or_else(|| PlotError::MissingColumn {
                        path: path_of(),
                        column: (*column).to_owned(),
                    })
                })
                .collect::<Result<_, _>>()?,
        };
        let chosen = |record: &StringRecord| -> StringRecord {
            let cell = |index: &usize| record.get(*index).unwrap_or("");
            places.iter().map(cell).collect()
        };
        let mut rows = Vec::new();
        let mut whole = true;
        for record in reader.byte_records() {
            let record = StringRecord::from_byte_record_lossy(record.map_err(fault)?);
            whole = record.len() >= header.len();
            rows.push(chosen(&record));
        }
        // Every finished row ends its line; without that even a full row may lack figures.
        if !(whole && ended) {
            rows.pop();
        }
        Ok(Table {
            path: path_of(),
            columns: chosen(&header).iter().map(str::to_owned).collect(),
            rows,
        })
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// A cell; empty when there is none.
    pub fn text(&self, row: usize, column: &str) -> &str {
        let place = self.columns.iter().position(|name| name == column);
        let cell = |index| self.rows.get(row)?.get(index);
        place.and_then(cell).unwrap_or("")
    }

    /// A cell as a number; none when it is empty, no number, or too large to draw.
    pub fn number(&self, row: usize, column: &str) -> Option<f64> {
        let value: f64 = self.text(row, column).parse().ok()?;
        drawable(value).then_some(value)
    }

    /// A column of numbers; gaps are not numbers.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let number = |row| self.number(row, name).unwrap_or(f64::NAN);
        (0..self.len()).map(number).collect()
    }

    /// A cell as an event type.
    pub fn kind(&self, row: usize) -> Option<EventType> {
        self.text(row, "type").parse().ok()
    }

    /// A cell as numbers separated by blanks.
    pub fn list(&self, row: usize, column: &str) -> Vec<f64> {
        let words = self.text(row, column).split_whitespace();
        let numbers = words.filter_map(|word| word.parse().ok());
        numbers.filter(|value| drawable(*value)).collect()
    }

    /// The row whose cell in `label` reads the same.
    fn row_of_label(&self, label: &str) -> Option<usize> {
        (0..self.len()).find(|row| !label.is_empty() && self.text(*row, "label") == label)
    }
}

/// Whether a file ends with the end of a line; it stands at its beginning then.
fn line_ended(file: &mut File) -> io::Result<bool> {
    let mut last = [b'\n'];
    if file.seek(SeekFrom::End(0))? > 0 {
        file.seek(SeekFrom::End(-1))?;
        file.read_exact(&mut last)?;
    }
    file.rewind()?;
    Ok(last == [b'\n'])
}

/// The tables of a branch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tables {
    folder: PathBuf,
    /// Column of the parameter in all of them.
    pub parameter: String,
    /// Points of the branch.
    pub branch: Table,
    /// Special points; empty when the file is missing.
    pub events: Table,
}

/// Special points of one type that follow each other.
pub type Marks = (EventType, Vec<Point>);

impl Tables {
    /// Reads the tables of a folder.
    pub fn read(folder: &Path, parameter: &str) -> Result<Self, PlotError> {
        let tables = Tables {
            folder: folder.to_owned(),
            parameter: parameter.to_owned(),
            branch: Table::read(&folder.join("branch.csv"))?,
            events: Table::if_there(Table::read(&folder.join("events.csv")))?.unwrap_or_default(),
        };
        tables.check(parameter, &WORDS)?;
        Ok(tables)
    }

    /// Eigenvalues, where they were asked for.
    pub fn spectrum(&self) -> Result<Option<Table>, PlotError> {
        let columns = ["label", "sector", "re", "im"];
        Table::if_there(Table::select(&self.folder.join("spectrum.csv"), &columns))
    }

    /// Fails unless `name` is a column of `branch.csv` that can be drawn over the parameter.
    pub fn check_column(&self, name: &str) -> Result<(), PlotError> {
        self.check(name, &WORD_COLUMNS)
    }

    fn check(&self, name: &str, refused: &[&str]) -> Result<(), PlotError> {
        let columns = self.branch.columns.iter();
        let known: Vec<String> = columns
            .filter(|column| !refused.contains(&column.as_str()))
            .cloned()
            .collect();
        if known.iter().any(|column| column == name) {
            return Ok(());
        }
        let name = name.to_owned();
        Err(PlotError::UnknownColumn { name, known })
    }

    /// A value at a labelled point, from the branch or else from its events.
    pub fn at_label(&self, label: &str, column: &str) -> Option<f64> {
        let of = |table: &Table| table.number(table.row_of_label(label)?, column);
        of(&self.branch).or_else(|| of(&self.events))
    }

    /// The value of the parameter at a labelled point.
    pub fn parameter_at(&self, label: &str) -> Option<f64> {
        self.at_label(label, &self.parameter)
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
        let row = self.branch.row_of_label(label).unwrap_or(0);
        let place = i64::try_from(row).unwrap_or(i64::MAX);
        match self.branch.text(row, "leg") {
            "2" => -place,
            _ => place,
        }
    }

    /// The special points in a picture of a column over the parameter, the less important ones
    /// first.
    pub fn marks(&self, column: &str) -> Vec<Marks> {
        let of_branch = (0..self.branch.len()).map(|row| (&self.branch, row));
        let of_events = (0..self.events.len()).map(|row| (&self.events, row));
        let mut seen = HashSet::new();
        let mut marks: Vec<(EventType, Point)> = Vec::new();
        for (table, row) in of_branch.chain(of_events) {
            let Some(kind) = table.kind(row) else {
                continue;
            };
            // The same event is usually in both tables.
            let label = table.text(row, "label");
            if !label.is_empty() && !seen.insert((label, kind)) {
                continue;
            }
            let value = |column: &str| {
                let here = table.number(row, column);
                here.or_else(|| self.at_label(label, column))
            };
            if let (Some(x), Some(y)) = (value(&self.parameter), value(column)) {
                marks.push((kind, (x, y)));
            }
        }
        marks.sort_by_key(|(kind, _)| !matches!(kind, EventType::EP | EventType::UZ));
        let groups = marks.chunk_by(|one, other| one.0 == other.0);
        let points = |group: &[(EventType, Point)]| group.iter().map(|mark| mark.1).collect();
        groups.map(|group| (group[0].0, points(group))).collect()
    }
}
