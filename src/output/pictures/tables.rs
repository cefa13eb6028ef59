//! The tables of a result folder, read back.
//!
//! A picture can be drawn long after the run, of tables that another version has written or that a
//! killed run has left unfinished: what a picture does not need may be missing, and odd cells are gaps.

use super::names::{own_quantity, quantity};
use crate::output::render::{Point, Quantity, drawable};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

use crate::branch::row::WORD_COLUMNS;
use crate::orbit::EventType;
use crate::output::layout::{BRANCH, EVENTS, SPECTRUM};
use crate::output::store::{self, StoreError, damaged, refused};
use crate::table::Table;
use crate::tube::model::Parameter;

/// Reads a table, which must have these columns.
pub(super) fn read(path: &Path, columns: &[&str]) -> Result<Table, StoreError> {
    let table = read_if_there(path, columns)?;
    table.ok_or_else(|| damaged(path, "it is missing, or has no header"))
}

/// The bytes of a file that a folder must have.
pub(super) fn needed(path: &Path) -> Result<Vec<u8>, StoreError> {
    match path.exists() {
        true => store::bytes(path),
        false => Err(damaged(path, "it is missing")),
    }
}

/// Reads a table if it is there and has a header.
pub(super) fn read_if_there(path: &Path, columns: &[&str]) -> Result<Option<Table>, StoreError> {
    if !path.exists() {
        return Ok(None);
    }
    let table = store::table(path)?;
    if table.columns().all(str::is_empty) {
        return Ok(None);
    }
    match columns.iter().find(|column| !table.has(column)) {
        None => Ok(Some(table)),
        Some(column) => Err(damaged(path, format!("it has no column `{column}`"))),
    }
}

/// A cell as a number; none when it is empty, no number, or too large to draw.
pub(super) fn number(table: &Table, row: usize, column: &str) -> Option<f64> {
    let value = table.field(row, column);
    value.filter(|value| drawable(*value))
}

/// A column of numbers; gaps are not numbers.
pub(super) fn column(table: &Table, name: &str) -> Vec<f64> {
    let value = |row| number(table, row, name).unwrap_or(f64::NAN);
    (0..table.len()).map(value).collect()
}

/// A cell with a list of numbers.
pub(super) fn list(table: &Table, row: usize, column: &str) -> Vec<f64> {
    let mut list = table.list(row, column);
    list.retain(|value| drawable(*value));
    list
}

/// The type of the event in a row.
pub(super) fn kind(table: &Table, row: usize) -> Option<EventType> {
    table.field(row, "type")
}

/// A branch of orbits in which those that never switch are told from those that switch from their only mode to itself.
fn told_apart(branch: &Table) -> Table {
    let rows = || 0..branch.len();
    let switches = |row: usize| !branch.text(row, "switches").is_empty();
    let switching: HashSet<&str> = rows()
        .filter(|row| switches(*row))
        .map(|row| branch.text(row, "regimes"))
        .collect();
    let name = |row: usize| {
        let own = branch.text(row, "regimes");
        match switching.contains(own) && !switches(row) {
            true => format!("{own}{NO_SWITCH}"),
            false => own.to_owned(),
        }
    };
    branch.with("regimes", name)
}

/// What is said of a sequence of one mode that never ends.
pub(super) const NO_SWITCH: &str = ", no switch";

/// The tables of a branch.
pub(super) struct Tables {
    folder: PathBuf,
    /// Column of the parameter in all of them.
    pub parameter: String,
    pub branch: Table,
    /// Special points; empty when the file is missing.
    pub events: Table,
}

/// Special points of one type that follow each other.
pub(super) type Marks = (EventType, Vec<Point>);

impl Tables {
    /// Reads the tables of a folder.
    pub(crate) fn read(folder: &Path, parameter: &str) -> Result<Self, StoreError> {
        let mut branch = read(&folder.join(BRANCH), &[])?;
        if branch.has("period") {
            branch = told_apart(&branch);
        }
        let tables = Tables {
            folder: folder.to_owned(),
            parameter: parameter.to_owned(),
            branch,
            events: read_if_there(&folder.join(EVENTS), &[])?.unwrap_or_default(),
        };
        let [kind, regimes, stable, why] = WORD_COLUMNS;
        tables.check(parameter, &[kind, regimes, stable, why, "switches"])?;
        Ok(tables)
    }

    /// Whether the branch is of waves: a system has other columns.
    fn of_waves(&self) -> bool {
        let columns = ["speed", "min_pressure", "max_gap"];
        columns.into_iter().all(|column| self.branch.has(column))
    }

    /// The parameter of a wave that the branch is followed in.
    pub(crate) fn wave_parameter(&self) -> Option<Parameter> {
        let parameter = Parameter::from_column(&self.parameter);
        parameter.filter(|_| self.of_waves())
    }

    /// The quantity in a column of the branch.
    pub(crate) fn quantity(&self, column: &str) -> Quantity {
        match self.of_waves() {
            true => quantity(column),
            false => own_quantity(column),
        }
    }

    /// Eigenvalues, where they were asked for.
    pub(crate) fn spectrum(&self) -> Result<Option<Table>, StoreError> {
        let columns = ["label", "sector", "re", "im"];
        read_if_there(&self.folder.join(SPECTRUM), &columns)
    }

    /// Fails unless `name` is a column of `branch.csv` that can be drawn over the parameter.
    pub(crate) fn check_column(&self, name: &str) -> Result<(), StoreError> {
        self.check(name, &WORD_COLUMNS)
    }

    fn check(&self, name: &str, words: &[&str]) -> Result<(), StoreError> {
        let columns = self.branch.columns();
        let known: Vec<&str> = columns.filter(|column| !words.contains(column)).collect();
        if known.contains(&name) {
            return Ok(());
        }
        let known = known.join(", ");
        let reason = format!("it has no numeric column `{name}`; it has {known}");
        Err(refused(&self.folder.join(BRANCH), reason))
    }

    /// What the branch, or else its events, tell of a labelled point.
    fn labelled<T>(&self, label: &str, of: impl Fn(&Table, usize) -> Option<T>) -> Option<T> {
        let tables = [&self.branch, &self.events];
        tables
            .into_iter()
            .find_map(|table| of(table, table.labelled(label)?))
    }

    /// A value at a labelled point.
    pub(crate) fn at_label(&self, label: &str, column: &str) -> Option<f64> {
        self.labelled(label, |table, row| number(table, row, column))
    }

    /// The value of the parameter at a labelled point.
    pub(crate) fn parameter_at(&self, label: &str) -> Option<f64> {
        self.at_label(label, &self.parameter)
    }

    /// Sequence of the regimes at a labelled point.
    pub(crate) fn regimes_at(&self, label: &str) -> String {
        let row = self.branch.labelled(label);
        row.map_or_else(String::new, |row| {
            self.branch.text(row, "regimes").to_owned()
        })
    }

    /// Length of a labelled wave: where its last zone ends.
    pub(crate) fn length_at(&self, label: &str) -> Option<f64> {
        self.labelled(label, |table, row| {
            list(table, row, "switches").last().copied()
        })
    }

    /// Whether a label was asked for by the value of its parameter.
    pub(crate) fn asked_for(&self, label: &str) -> bool {
        let row = self.events.labelled(label);
        row.and_then(|row| kind(&self.events, row)) == Some(EventType::UZ)
    }

    /// Place of a labelled point along the branch. A second leg runs from the start of the first
    /// the other way.
    pub(crate) fn position(&self, label: &str) -> i64 {
        let row = self.branch.labelled(label).unwrap_or(0);
        let place = i64::try_from(row).unwrap_or(i64::MAX);
        match self.branch.text(row, "leg") {
            "2" => -place,
            _ => place,
        }
    }

    /// Labels of the point that the branch leaves both ways: it is no end.
    pub(crate) fn begun(&self) -> Vec<&str> {
        let leg = |row: usize| self.branch.text(row, "leg");
        let rows = 0..self.branch.len();
        let first = rows.filter(|row| *row == 0 || leg(row - 1) != leg(*row));
        let first: Vec<&str> = first.map(|row| self.branch.text(row, "label")).collect();
        if first.len() > 1 { first } else { Vec::new() }
    }

    /// The special points in a picture of a column over the parameter, the less important ones
    /// first.
    pub(crate) fn marks(&self, column: &str) -> Vec<Marks> {
        let rows = |table| (0..Table::len(table)).map(move |row| (table, row));
        let mut seen = HashSet::new();
        let mut marks: Vec<(EventType, Point)> = Vec::new();
        let begun = self.begun();
        for (table, row) in rows(&self.branch).chain(rows(&self.events)) {
            let Some(kind) = kind(table, row) else {
                continue;
            };
            let label = table.text(row, "label");
            if kind == EventType::EP && !label.is_empty() && begun.contains(&label) {
                continue;
            }
            // The same event is usually in both tables.
            if !label.is_empty() && !seen.insert((label, kind)) {
                continue;
            }
            let value = |column: &str| {
                let here = number(table, row, column);
                here.or_else(|| self.at_label(label, column))
            };
            if let (Some(x), Some(y)) = (value(&self.parameter), value(column)) {
                marks.push((kind, (x, y)));
            }
        }
        let less = |kind| matches!(kind, EventType::EP | EventType::UZ | EventType::HB);
        marks.sort_by_key(|(kind, _)| !less(*kind));
        let groups = marks.chunk_by(|one, other| one.0 == other.0);
        let points = |group: &[(EventType, Point)]| group.iter().map(|mark| mark.1).collect();
        groups.map(|group| (group[0].0, points(group))).collect()
    }
}
