//! Text for people: the tables of labelled points, the lists of events and of special points.

use std::fmt::Write;
use std::path::Path;

use crate::curve::{Curve, Point};
use crate::model::EventType;
use crate::model::Parameter;
use crate::output::curve::words;
use crate::output::run::{BRANCH, EVENTS};
use crate::output::store::{self, StoreError};
use crate::table::Table;

/// A number for a table: 12 significant digits, in a width of 18.
fn figure(value: f64) -> String {
    if value != 0.0 && (value.abs() < 1e-3 || value.abs() >= 1e6) {
        format!("{value:>18.11e}")
    } else {
        let before = if value.abs() < 1.0 {
            0
        } else {
            value.abs().log10().floor() as usize
        };
        format!("{value:>18.*}", 12 - before.min(11))
    }
}

/// The report of a result folder, from its tables: a run that was resumed is reported as a whole.
pub(crate) fn branch(folder: &Path, parameter: Parameter) -> Result<String, StoreError> {
    let points = store::table(&folder.join(BRANCH))?;
    let events = store::table(&folder.join(EVENTS))?;
    let number =
        |table: &Table, row: usize, column: &str| table.field(row, column).unwrap_or(f64::NAN);
    let text = |table: &Table, row: usize, column: &str| -> String {
        table.field(row, column).unwrap_or_default()
    };
    let mut report = String::new();
    // writing to a string does not fail
    let _ = writeln!(
        report,
        "{:>6} {:>5} {:<4} {:>18} {:>18}  {:<}",
        "point",
        "label",
        "type",
        parameter.column(),
        "speed",
        "regimes"
    );
    for row in 0..points.len() {
        let label = text(&points, row, "label");
        if !label.is_empty() {
            let _ = writeln!(
                report,
                "{:>6} {label:>5} {:<4} {} {}  {}",
                text(&points, row, "point"),
                text(&points, row, "type"),
                figure(number(&points, row, parameter.column())),
                figure(number(&points, row, "speed")),
                text(&points, row, "regimes")
            );
        }
    }
    let found = |row: &usize| events.field(*row, "type") != Some(EventType::EP);
    let found: Vec<usize> = (0..events.len()).filter(found).collect();
    let _ = writeln!(report, "\n{} points, {} events", points.len(), found.len());
    for row in found {
        let _ = write!(
            report,
            "  {} at {} = {:.15} ± {:.0e}, c = {:.15}",
            text(&events, row, "type"),
            parameter.symbol(),
            number(&events, row, parameter.column()),
            number(&events, row, "uncertainty"),
            number(&events, row, "speed")
        );
        let [before, after] =
            ["regimes_before", "regimes_after"].map(|column| text(&events, row, column));
        if before != after {
            let _ = write!(report, ": {before} → {after}");
        }
        let _ = writeln!(report, "; {}", text(&events, row, "what"));
    }
    Ok(report)
}

/// The special points of a curve, a line each.
pub(crate) fn curve(curve: &Curve) -> String {
    let mut text = String::new();
    let [first, second] = curve.parameters.map(|parameter| parameter.column());
    let _ = writeln!(
        text,
        "{} points; event, {first}, {second}, speed",
        curve.points.len()
    );
    let last = curve.points.len().saturating_sub(1);
    for (index, point) in curve.points.iter().enumerate() {
        let end = index == 0 || index == last;
        let Point {
            kind: Some(kind), ..
        } = point
        else {
            if end {
                let _ = writeln!(text, "  end: {}", words(curve, index));
            }
            continue;
        };
        let [one, other] = point.parameters;
        let _ = write!(
            text,
            "  {kind:<6} {one:.12}  {other:.12}  {:.12}",
            point.speed
        );
        if let Some(omega) = point.omega {
            let _ = write!(text, "  ω {omega:.12}");
        }
        let _ = writeln!(text, "  {}", words(curve, index));
    }
    text
}
