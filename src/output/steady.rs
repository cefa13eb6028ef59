//! The folder of the modes of steady sliding: `steady.csv`, a picture and the problem.

use nalgebra::Complex;

use super::layout::{self, STEADY};
use super::origin::ProblemOrigin;
use super::render::Format;
use super::store::{FolderKind, Store, StoreError};
use crate::affine::mode::AffineMode;
use crate::affine::steady::{Admissibility, Isolation};
use crate::affine::system::{System, SystemError};
use crate::problem::{Problem, SystemProblem};
use crate::table::{line_of, number};

/// Writes the table and what belongs to it, in place of an earlier one.
///
/// # Errors
/// When a file cannot be written.
pub(crate) fn write(store: &Store, problem: &Problem, table: &str) -> Result<(), StoreError> {
    let pictures = layout::pictures(FolderKind::Steady, problem, Format::Svg);
    store.begin(&[STEADY, ProblemOrigin::<Problem>::FILE], pictures, None)?;
    ProblemOrigin::keep(store, problem)?;
    store.replace(STEADY, table.as_bytes())
}

/// Writes the table of a system's equilibria, in place of an earlier one.
///
/// # Errors
/// When a file cannot be written.
pub(crate) fn write_equilibria(
    store: &Store,
    problem: &SystemProblem,
    table: &str,
) -> Result<(), StoreError> {
    let names = [STEADY, ProblemOrigin::<SystemProblem>::FILE];
    store.begin(&names, Vec::new(), None)?;
    ProblemOrigin::keep(store, problem)?;
    store.replace(STEADY, table.as_bytes())
}

/// Columns of the table of equilibria before and after the states.
pub(crate) const BEFORE_STATES: [&str; 2] = ["mode", "equilibrium"];
/// See [`BEFORE_STATES`].
pub(crate) const AFTER_STATES: [&str; 4] = ["stable", "re", "im", "why"];

/// The equilibria of every mode as a table: `equilibrium` is `admissible`, `virtual`, `boundary` or `none`; eigenvalues
/// are separated by blanks, and say `stable` where more than rounding decides it; `why` says what makes an equilibrium
/// virtual or degenerate, or what stands in its place.
///
/// # Errors
/// The system makes no sense at these values of its parameters.
pub(crate) fn equilibria(system: &System, values: &[f64]) -> Result<String, SystemError> {
    /// Modes that contacts make are forgotten after so many: ten frictions have 59 049, of a quarter of a megabyte each.
    const TOGETHER: usize = 500;
    let mut at = system.at(values, &[])?;
    let states = &system.source.states;
    let names = |list: &[&str]| list.iter().map(|name| (*name).to_owned()).collect();
    let header: [Vec<String>; 3] = [names(&BEFORE_STATES), states.clone(), names(&AFTER_STATES)];
    let mut text = line_of(&header.concat());
    for mode in (0..at.modes.len()).filter(|mode| system.is_of_its_name(*mode)) {
        if mode % TOGETHER == TOGETHER - 1 && at.modes.written().is_empty() {
            at = system.at(values, &[])?;
        }
        let name = system.mode_name(mode).into_owned();
        let all = at.equilibria(mode);
        for found in all.iter().flatten() {
            let state = found.state.iter().copied().map(number);
            let parts = |part: fn(&Complex<f64>) -> f64| {
                let numbers = found.eigenvalues.iter().map(|value| number(part(value)));
                numbers.collect::<Vec<_>>().join(" ")
            };
            let stable = match found.stable {
                Some(true) => "yes",
                Some(false) => "no",
                None => "undecided",
            };
            let (kind, lies) = position(system, &at.modes[mode], found.place);
            let isolated = match found.isolation {
                Isolation::Simple => "",
                Isolation::Degenerate => {
                    "the derivatives are singular there: degenerate, or one of a family"
                }
                Isolation::Family => "one of a family: the derivatives are singular at many",
            };
            let why = [lies, isolated.to_owned()];
            let why: Vec<String> = why.into_iter().filter(|words| !words.is_empty()).collect();
            let after = [stable.to_owned(), parts(|z| z.re), parts(|z| z.im)];
            let before = [name.clone(), kind.to_owned()].into_iter();
            let after = after.into_iter().chain([why.join("; ")]);
            let cells = before.chain(state).chain(after);
            text.push_str(&line_of(&cells.collect::<Vec<_>>()));
        }
        if let Err(reason) = all {
            let mut cells = vec![name, "none".to_owned()];
            cells.resize(states.len() + 5, String::new());
            cells.push(reason.to_string());
            text.push_str(&line_of(&cells));
        }
    }
    Ok(text)
}

/// What an equilibrium is by where it lies, and the switch that it lies beyond or on.
fn position(system: &System, mode: &AffineMode, place: Admissibility) -> (&'static str, String) {
    let to = |guard: usize| {
        let exit = mode.guards[guard].exits.last();
        exit.map_or("".into(), |exit| system.mode_name(exit.to))
    };
    match place {
        Admissibility::Admissible => ("admissible", String::new()),
        Admissibility::Virtual { guard, at_times } => {
            let during = match at_times {
                true => " during a part of every period",
                false => "",
            };
            let lies = format!("it lies beyond the switch to {}{during}", to(guard));
            ("virtual", lies)
        }
        Admissibility::Boundary { guard } => {
            let lies = format!("to rounding it lies on the switch to {}", to(guard));
            ("boundary", lies)
        }
    }
}
