//! Text for people: the table of labelled points and the list of events.

use std::fmt::Write;

use crate::branch::{Event, EventType};
use crate::problem::Parameter;
use crate::run::Item;

/// Collects what the report needs while a branch grows.
#[derive(Debug)]
pub struct Report {
    parameter: Parameter,
    table: String,
    events: String,
    points: usize,
    found: usize,
}

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

impl Report {
    /// An empty report of a branch in a parameter.
    pub fn new(parameter: Parameter) -> Report {
        let mut table = String::new();
        let _ = writeln!(
            table,
            "{:>6} {:>5} {:<4} {:>18} {:>18}  {:<}",
            "point",
            "label",
            "type",
            parameter.column(),
            "speed",
            "regimes"
        );
        Report {
            parameter,
            table,
            events: String::new(),
            points: 0,
            found: 0,
        }
    }

    /// Takes note of a point.
    pub fn add(&mut self, item: &Item) {
        self.points += 1;
        let point = &item.point;
        let Some(label) = point.label else { return };
        let kind = point.kind.map_or_else(String::new, |kind| kind.to_string());
        let value = item
            .saved
            .as_ref()
            .and_then(|saved| saved.model.value(self.parameter))
            .unwrap_or(f64::NAN);
        let _ = writeln!(
            self.table,
            "{:>6} {label:>5} {kind:<4} {} {}  {}",
            point.point,
            figure(value),
            figure(point.speed),
            point.regimes
        );
        if let Some(event) = &item.event
            && !matches!(event.kind, EventType::EP)
        {
            self.found += 1;
            let _ = writeln!(self.events, "{}", event_line(event, self.parameter, value));
        }
    }

    /// The report as text.
    pub fn text(&self) -> String {
        let mut text = self.table.clone();
        let _ = writeln!(text, "\n{} points, {} events", self.points, self.found);
        text.push_str(&self.events);
        text
    }
}

fn event_line(event: &Event, parameter: Parameter, value: f64) -> String {
    let mut line = format!(
        "  {} at {} = {value:.15} ± {:.0e}, c = {:.15}",
        event.kind,
        parameter.symbol(),
        event.uncertainty,
        event.speed
    );
    if event.regimes_before != event.regimes_after {
        let _ = write!(line, ": {} → {}", event.regimes_before, event.regimes_after);
    }
    let _ = write!(line, "; {}", event.what);
    line
}
