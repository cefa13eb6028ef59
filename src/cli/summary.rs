//! Text for people: the tables of labelled points, the lists of events and of special points.

use std::fmt::Write;
use std::io::{self, IsTerminal};
use std::path::Path;

use super::sequences;
use crate::affine::mode::AffineSystem;
use crate::affine::system::System;
use crate::curve::{CurvePoint, ParameterPlane, WholeCurve};
use crate::messages::figures;
use crate::orbit::{EventType, Zones};
use crate::output::curve::words;
use crate::output::layout::{BRANCH, EVENTS};
use crate::output::store::{self, StoreError};
use crate::output::waves::separates;
use crate::problem::{Problem, Start};
use crate::table::Table;
use crate::tube::model::{Damping, FrictionLaw, Landing, Model, Parameter, Sectors};
use crate::tube::wave::start::{SlipStickOnset, Which, onset, slip_stick};

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

/// Digits of the points of a curve, and of what stands beside an event, whose errors are not told.
const CURVE_DIGITS: usize = 13;

/// The columns of a branch that its summary shows: the parameter, and a number of the orbit.
struct SummaryColumns<'a> {
    parameter: &'a str,
    symbol: &'a str,
    number: &'a str,
    number_symbol: &'a str,
}

/// The labelled points and the events of a branch, line by line.
fn listed(points: &Table, events: &Table, shown: &SummaryColumns) -> String {
    let number =
        |table: &Table, row: usize, column: &str| table.field(row, column).unwrap_or(f64::NAN);
    // the frequency in hertz where the rotation is known
    let heard = points.has("hertz");
    let asked = (0..points.len()).any(|row| !points.text(row, "stable").is_empty());
    let mut report = String::new();
    // writing to a string does not fail
    let _ = writeln!(
        report,
        "{:>6} {:>5} {:<4} {:>18} {:>18}{} {} {:<}",
        "point",
        "label",
        "type",
        shown.parameter,
        shown.number,
        if heard { "         Hz" } else { "" },
        if asked { "stable     " } else { "" },
        "regimes"
    );
    for row in 0..points.len() {
        let label = points.text(row, "label");
        if !label.is_empty() {
            let _ = writeln!(
                report,
                "{:>6} {label:>5} {:<4} {} {}{} {} {}",
                points.text(row, "point"),
                points.text(row, "type"),
                figure(number(points, row, shown.parameter)),
                figure(number(points, row, shown.number)),
                match points.field::<f64>(row, "hertz") {
                    Some(hertz) => format!(" {hertz:>10.2}"),
                    None => String::new(),
                },
                if asked {
                    stability(points, row)
                } else {
                    String::new()
                },
                sequences::shown(points.text(row, "regimes"))
            );
        }
    }
    let found = |row: &usize| events.field(*row, "type") != Some(EventType::EP);
    let found: Vec<usize> = (0..events.len()).filter(found).collect();
    let _ = writeln!(report, "\n{} points, {} events", points.len(), found.len());
    for row in found {
        report.push_str(&event_line(events, row, shown));
    }
    report
}

/// An event with its uncertainty, what changes there, and what is said of it.
fn event_line(events: &Table, row: usize, shown: &SummaryColumns) -> String {
    let number = |column: &str| events.field(row, column).unwrap_or(f64::NAN);
    let mut report = String::new();
    let _ = write!(
        report,
        "  {} at {} = {}, {} = {}",
        events.text(row, "type"),
        shown.symbol,
        figures::with_error(number(shown.parameter), number("uncertainty")),
        shown.number_symbol,
        figures::significant(number(shown.number), figures::ALL)
    );
    let pair = events
        .field::<f64>(row, "omega")
        .zip(events.field::<usize>(row, "sector"));
    if let Some((omega, sector)) = pair {
        let omega = figures::significant(omega, CURVE_DIGITS);
        let _ = write!(report, ", ω = {omega} in sector {sector}");
    }
    let [before, after] =
        ["regimes_before", "regimes_after"].map(|column| events.text(row, column));
    if before != after {
        let _ = write!(report, ": {}", sequences::changed(before, after));
    }
    if let Some(hertz) = events.field::<f64>(row, "hertz") {
        let _ = write!(report, ", {hertz:.2} Hz");
    }
    let _ = writeln!(report, "; {}", events.text(row, "what"));
    report
}

/// Which modes of a system have an exact flow, and which are integrated.
pub(crate) fn flows(system: &System, at: &AffineSystem) -> String {
    // modes that are made when they are asked for are affine
    if at.modes.written().is_empty() {
        return format!(
            "flows: {} modes that contacts make, exact\n",
            at.modes.len()
        );
    }
    let names = |exact: bool| {
        let modes = at.modes.written().iter().enumerate();
        let modes = modes.filter(|(_, mode)| mode.field.is_exact == exact);
        let names = modes.map(|(mode, _)| format!("`{}`", system.mode_name(mode)));
        names.collect::<Vec<_>>().join(", ")
    };
    let parts = [
        (names(true), "exact".to_owned()),
        (
            names(false),
            format!(
                "integrated with the tolerance {:e}",
                system.flow_tolerance()
            ),
        ),
    ];
    let parts = parts.iter().filter(|(names, _)| !names.is_empty());
    let parts = parts.map(|(names, how)| format!("{names} {how}"));
    format!("flows: {}\n", parts.collect::<Vec<_>>().join("; "))
}

/// A branch of orbits or equilibria in a folder, with a column of it and the symbol of that.
pub(crate) fn of_system(
    folder: &Path,
    parameter: &str,
    (number, number_symbol): (&str, &str),
) -> Result<String, StoreError> {
    let points = store::table(&folder.join(BRANCH))?;
    let events = store::table(&folder.join(EVENTS))?;
    let shown = SummaryColumns {
        parameter,
        symbol: parameter,
        number,
        number_symbol,
    };
    Ok(listed(&points, &events, &shown))
}

/// The report of the folder of a run, from its tables: a run that was resumed is reported as a whole.
///
/// `model` is that of the first wave.
pub(crate) fn branch(
    folder: &Path,
    problem: &Problem,
    model: &Model,
) -> Result<String, StoreError> {
    let parameter = problem.parameter();
    let points = store::table(&folder.join(BRANCH))?;
    let events = store::table(&folder.join(EVENTS))?;
    let shown = SummaryColumns {
        parameter: parameter.column(),
        symbol: parameter.symbol(),
        number: "speed",
        number_symbol: "c",
    };
    let mut report = listed(&points, &events, &shown);
    if let Some(section) = &problem.stability {
        let whole_circle = section.sectors == Sectors::All;
        report.push_str(&stable_parts(&points, parameter, whole_circle));
    }
    if let (Some(_), Some(gamma)) = (problem.tube, model.value(Parameter::Gamma)) {
        let (scale, mismatch) = (gamma.sqrt(), model.mismatch);
        let share = mismatch / scale;
        let _ = writeln!(
            report,
            "√γ = {scale:.4e}; the tube has δ = {mismatch:.4e} = {share:.4} √γ"
        );
    }
    if separates(&points) {
        let landing = Landing::of(model, parameter);
        let _ = writeln!(
            report,
            "landings by {}: {}",
            landing.name(),
            landing.remark()
        );
    }
    let changes = |row| events.field(row, "type").is_some_and(EventType::of_regimes);
    if !(0..events.len()).any(changes) {
        report.push_str(&expected(problem, model).unwrap_or_default());
    }
    Ok(report)
}

/// Where a branch without a change of regime would have had the first ones.
fn expected(problem: &Problem, model: &Model) -> Option<String> {
    let which = match problem.wave.start {
        Start::Fast | Start::Hopf => Which::Fast,
        Start::Slow => Which::Slow,
        Start::Restart { .. } | Start::Switch { .. } => return None,
    };
    let damping = Damping {
        stiffness: 0.0,
        ..model.damping
    };
    let law = FrictionLaw::Coulomb;
    let plain = Model {
        damping,
        law,
        ..*model
    };
    let wave = slip_stick(&plain, problem.wave.mode, which).ok()?;
    let SlipStickOnset {
        separation,
        reverse,
    } = onset(&plain, &wave);
    let mut places = Vec::new();
    if reverse > 0.0 {
        places.push(format!("an RV at δ = {reverse:.6e}"));
    }
    // behind an RV it is another wave that separates, at about the same place
    let about = if reverse > separation { "about " } else { "" };
    places.push(format!("a GR at {about}δ = {separation:.6e}"));
    let simpler = match plain == *model {
        true => "",
        false => " without material damping and under Coulomb's law",
    };
    Some(format!(
        "no change of regime in this range; the slip-stick wave has {}{simpler} (closed form)\n",
        places.join(" and ")
    ))
}

/// Eleven characters on the stability of a point: the verdict, and how many eigenvalues grow.
fn stability(points: &Table, row: usize) -> String {
    let growing = match points.text(row, "unstable") {
        "" | "0" => String::new(),
        count => format!(" ({count})"),
    };
    format!("{:<11}", format!("{}{growing}", points.text(row, "stable")))
}

/// Where along a branch the wave is stable, in a sentence. A part ends at the event that ends it.
fn stable_parts(points: &Table, parameter: Parameter, whole_circle: bool) -> String {
    let stable = |row: &usize| points.text(*row, "stable") == "yes";
    let value = |row: usize| points.field(row, parameter.column()).unwrap_or(f64::NAN);
    let special = |row: &usize| *row < points.len() && !points.text(*row, "type").is_empty();
    let mut parts = Vec::new();
    let mut row = 0;
    while row < points.len() {
        let length = (row..points.len()).take_while(stable).count();
        if length > 0 {
            let first = row.checked_sub(1).filter(special).unwrap_or(row);
            let last = Some(row + length)
                .filter(special)
                .unwrap_or(row + length - 1);
            let (one, other) = (value(first), value(last));
            parts.push((one.min(other), one.max(other)));
        }
        row += length + 1;
    }
    let circle = if whole_circle {
        "on the whole circle"
    } else {
        "in the sectors asked for"
    };
    if parts.is_empty() {
        return format!("no point is stable {circle}\n");
    }
    let symbol = parameter.symbol();
    let parts = parts
        .iter()
        .map(|(low, high)| format!("{low:.9} < {symbol} < {high:.9}"));
    format!(
        "stable {circle} for {}\n",
        parts.collect::<Vec<_>>().join(", ")
    )
}

/// A table of results: CSV, or with `chosen` columns in line for reading on a terminal.
pub(crate) fn table(csv: String, always_csv: bool, chosen: &[&str]) -> String {
    if always_csv || !io::stdout().is_terminal() {
        return csv;
    }
    match Table::parse(csv.as_bytes()) {
        Ok(table) => aligned(&table, chosen),
        Err(_) => csv,
    }
}

/// Columns of a table in line, with seven digits; those without content are left out.
fn aligned(table: &Table, chosen: &[&str]) -> String {
    let rows = 0..table.len();
    let filled = |column: &&&str| rows.clone().any(|row| !table.text(row, column).is_empty());
    let mut lines = vec![String::new(); table.len() + 1];
    for column in chosen.iter().filter(filled) {
        let cell = |row: usize| {
            let text = table.text(row, column);
            let number: Option<f64> = text.parse().ok().filter(|_| text.contains('.'));
            number.map_or(text.to_owned(), |number| match number.abs() {
                size if size == 0.0 || (1e-3..1e6).contains(&size) => {
                    let before = size.max(1.0).log10() as usize;
                    format!("{number:.*}", 6 - before)
                }
                _ => format!("{number:.3e}"),
            })
        };
        let cells: Vec<String> = std::iter::once(column.to_string())
            .chain(rows.clone().map(cell))
            .collect();
        let width = cells
            .iter()
            .map(|cell| cell.chars().count())
            .max()
            .unwrap_or(0);
        for (line, cell) in lines.iter_mut().zip(cells) {
            let _ = write!(line, "{cell:>width$}  ");
        }
    }
    let lines = lines.iter().map(|line| line.trim_end());
    lines.map(|line| format!("{line}\n")).collect()
}

/// The special points of a curve, a line each.
pub(crate) fn curve<P: ParameterPlane>(curve: &WholeCurve<P>) -> String {
    let mut text = String::new();
    let [first, second] = curve.parameters.each_ref().map(P::Orbit::column);
    let measure = P::MEASURE.map_or_else(String::new, |measure| format!(", {measure}"));
    let _ = writeln!(
        text,
        "{} points; event, {first}, {second}{measure}",
        curve.points.len(),
    );
    let last = curve.points.len().saturating_sub(1);
    for (index, point) in curve.points.iter().enumerate() {
        let end = index == 0 || index == last;
        let CurvePoint {
            kind: Some(kind), ..
        } = point
        else {
            if end {
                let _ = writeln!(text, "  end: {}", words(curve, index));
            }
            continue;
        };
        let [one, other] = point.parameters;
        let shown = |value: f64| figures::significant(value, CURVE_DIGITS);
        let _ = write!(text, "  {kind:<6} {}  {}", shown(one), shown(other));
        if P::MEASURE.is_some() {
            let _ = write!(text, "  {}", shown(point.measure));
        }
        if let Some(angular) = point.angular {
            let _ = write!(text, "  {} {}", P::SYMBOL, shown(angular));
        }
        let _ = writeln!(text, "  {}", words(curve, index));
    }
    text
}
