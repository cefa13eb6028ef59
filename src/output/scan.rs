//! The table of a scan: a row for every sample, and one with a reason where there are fewer than asked for.

use super::layout::{SCAN, SCAN_ORIGIN};
use super::rows::{RowFiles, Rowed};
use super::store::FolderKind;
use crate::affine::motion::Moment;
use crate::affine::system::System;
use crate::hybrid::exponents::Exponent;
use crate::hybrid::scan::{ScannedMotion, Scanner};
use crate::messages::lack;
use crate::problem::{Scan, SystemProblem};
use crate::table::{Table, line_of, number};

impl Rowed for SystemProblem {
    const FILES: RowFiles = RowFiles {
        kind: FolderKind::Scan,
        shard: FolderKind::ScanShard,
        origin: SCAN_ORIGIN,
        table: SCAN,
        parquet: None,
    };

    fn rows(&self) -> usize {
        let scan = self.scan.as_ref();
        scan.map_or(0, |scan| {
            scan.sweeps().iter().map(|sweep| sweep.len()).sum()
        })
    }

    fn first(&self, row: usize) -> Option<f64> {
        let (_, values) = self.scan.as_ref()?.piece(row);
        values.first().map(|(_, value)| *value)
    }

    fn header(&self) -> String {
        let own = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        let exponents = self.scan.as_ref().map(Scan::exponent_columns);
        let columns: [Vec<String>; 5] = [
            own(&["value", "sweep", "sample"]),
            self.system.source.states.clone(),
            own(&["phase", "mode"]),
            exponents.unwrap_or_default(),
            own(&["why"]),
        ];
        line_of(&columns.concat())
    }
}

/// An exponent with its standard error. −∞ is no number that is missing, and has none.
fn exponent(exponent: Exponent) -> [String; 2] {
    match exponent {
        Exponent::Finite { value, error } => [number(value), error.map(number).unwrap_or_default()],
        Exponent::Lost => ["-inf".to_owned(), String::new()],
        Exponent::Unknown => [String::new(), String::new()],
    }
}

/// The rows of some values.
pub(crate) fn lines(system: &System, settled: &[ScannedMotion]) -> String {
    let mut text = String::new();
    for one in settled {
        let row = |sample: String, place: Option<&Moment>, why: String| {
            let states = 0..system.source.states.len();
            let states = states.map(|state| place.map(|place| number(place.state[state])));
            let mode = place.map(|place| system.mode_name(place.mode).into_owned());
            let phase = place.map(|place| number(place.phase));
            let cells = states.chain([phase, mode]).map(Option::unwrap_or_default);
            let first = [number(one.value), one.sweep.to_owned(), sample];
            line_of(
                &first
                    .into_iter()
                    .chain(cells)
                    .chain(one.exponents.iter().copied().flat_map(exponent))
                    .chain([why])
                    .collect::<Vec<_>>(),
            )
        };
        for (sample, place) in one.samples.iter().enumerate() {
            text.push_str(&row(sample.to_string(), Some(place), String::new()));
        }
        if let Some(reason) = &one.lacks {
            text.push_str(&row(String::new(), None, lack(system, reason)));
        }
    }
    text
}

/// Where the last sample of the last value of a piece was taken, if it has one.
pub(crate) fn last(problem: &SystemProblem, scanner: &Scanner, rows: &str) -> Option<Moment> {
    let text = problem.header() + rows;
    let table = Table::parse(text.as_bytes()).ok()?;
    let value = |row: usize| table.text(row, "value").to_owned();
    let end = table.len().checked_sub(1)?;
    let of_last = (0..table.len())
        .rev()
        .take_while(|row| value(*row) == value(end));
    let row = of_last
        .into_iter()
        .find(|row| !table.text(*row, "sample").is_empty())?;
    let states = problem.system.source.states.iter();
    let state = states.map(|name| table.field(row, name));
    Some(Moment {
        time: 0.0,
        phase: table.field(row, "phase")?,
        mode: scanner.system.mode(table.text(row, "mode"))?,
        state: state.collect::<Option<_>>()?,
    })
}
