//! `brakewave steady`.

use std::path::PathBuf;

use clap::Args;

use super::failure::{Usage, VerbExit, VerbFailure};
use super::options::{named, of_tube, once, picture, read_any, set};
use super::progress::ProgressLine;
use super::{print, summary, warn};
use crate::output::render::Format;
use crate::output::steady::{AFTER_STATES, BEFORE_STATES};
use crate::output::store::{Existing, FolderKind, Store};
use crate::output::{self, pictures};
use crate::problem::{Any, MAX_MODE, Problem, SystemProblem};
use crate::table::{self, Table};
use crate::tube::steady::row::ModeRow;
use crate::tube::steady::{self, SteadyMode, SteadySettings, first_to_grow};

/// Most families and radial functions that can be asked for.
const MOST_FAMILIES: u16 = 64;
/// Modes shown at least where no range is given.
const LEAST_MODES: u32 = 12;
/// Relative difference between radial orders above which a warning is due: what is promised.
const PROMISED: f64 = 1e-10;

/// Columns that a terminal shows.
const SHOWN: [&str; 13] = [
    "mode",
    "growth",
    "omega",
    "hertz",
    "speed",
    "hopf_friction",
    "first",
    "full_growth",
    "full_omega",
    "full_hertz",
    "lead_growth",
    "lead_hopf_friction",
    "lead_first",
];

#[derive(Debug, Args)]
pub(crate) struct SteadyArguments {
    /// Problem file; - reads standard input
    problem: PathBuf,
    /// Parameter value by its column instead of that of the file, e.g. stiffness_damping=0.003
    #[arg(long, value_name = "NAME=VALUE", value_parser = named)]
    at: Vec<(String, f64)>,
    /// Modes, e.g. 1..20 or 4 [default: 1 to twice the mode of the file, 12 at least]
    #[arg(long, value_name = "FIRST..LAST", value_parser = modes)]
    modes: Option<(u32, u32)>,
    /// Families of radial modes among which the fastest growth and the least Hopf friction are looked for
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_FAMILIES)))]
    families: u16,
    /// Radial functions per component [default: as many as convergence takes]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=400))]
    order: Option<u16>,
    /// CSV on a terminal too
    #[arg(long)]
    csv: bool,
    /// Write the table and its picture into this folder as well
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an earlier table there
    #[arg(long, requires = "out")]
    force: bool,
    /// Draw growth against the mode: FILE.svg, .png, .pdf or .tex
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

fn modes(text: &str) -> Result<(u32, u32), Usage> {
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    let parse = |part: &str| -> Result<u32, Usage> {
        let part = part.trim_start_matches('=').trim();
        part.parse().map_err(|_| Usage::Waves(part.to_owned()))
    };
    let (first, last) = (parse(first)?, parse(last)?);
    if first < 1 || last > MAX_MODE || first > last {
        return Err(Usage::Modes(first, last));
    }
    Ok((first, last))
}

pub(crate) fn steady(arguments: &SteadyArguments) -> Result<VerbExit, VerbFailure> {
    match read_any(&arguments.problem)?.0 {
        Any::Tube(problem) => sliding(arguments, *problem),
        Any::System(problem) => equilibria(arguments, *problem),
    }
}

/// The equilibria of a system.
fn equilibria(
    arguments: &SteadyArguments,
    problem: SystemProblem,
) -> Result<VerbExit, VerbFailure> {
    for (option, given) in [
        ("--modes", arguments.modes.is_some()),
        ("--order", arguments.order.is_some()),
        ("--plot", arguments.plot.is_some()),
    ] {
        if given {
            return Err(Usage::OfTubes { option }.into());
        }
    }
    let names = &problem.system.source.parameters;
    let mut values = problem.values();
    for (name, value) in &arguments.at {
        let index = names.index(name).ok_or_else(|| Usage::NoParameter {
            name: name.clone(),
            known: names.names().collect::<Vec<_>>().join(", "),
        })?;
        values[index] = *value;
    }
    let text = output::steady::equilibria(&problem.system, &values).map_err(Usage::NoSystem)?;
    if let Some(path) = &arguments.out {
        let existing = Existing::of(false, arguments.force);
        let inputs = [arguments.problem.clone()];
        let store = Store::open(path, FolderKind::Steady, &problem, existing, &inputs)?;
        output::steady::write_equilibria(&store, &problem, &text)?;
    }
    let states = problem.system.source.states.iter().map(String::as_str);
    let shown: Vec<&str> = BEFORE_STATES
        .into_iter()
        .chain(states)
        .chain(AFTER_STATES)
        .collect();
    print(&summary::table(text, arguments.csv, &shown))?;
    Ok(VerbExit::Done)
}

/// The modes of steady sliding of a tube.
fn sliding(arguments: &SteadyArguments, mut problem: Problem) -> Result<VerbExit, VerbFailure> {
    let inputs = [arguments.problem.clone()];
    let picture = picture(arguments.plot.as_deref(), &inputs)?;
    let at = arguments.at.iter();
    let at = at.map(|(name, value)| Ok((of_tube(name)?, *value)));
    let at = at.collect::<Result<Vec<_>, Usage>>()?;
    once(&at)?;
    for (parameter, value) in at {
        set(&mut problem, parameter, value)?;
    }
    let existing = Existing::of(false, arguments.force);
    let open = |path: &PathBuf| Store::open(path, FolderKind::Steady, &problem, existing, &inputs);
    let store = arguments.out.as_ref().map(open).transpose()?;
    let model = problem.model;
    let geometry = model.source.geometry();
    let coefficients = model.constants().coefficients;
    let (first, last) = arguments
        .modes
        .unwrap_or((1, (2 * problem.wave.mode).clamp(LEAST_MODES, MAX_MODE)));
    let settings = SteadySettings {
        friction: model.friction,
        law: model.law,
        mismatch: model.mismatch,
        damping: model.damping,
        families: usize::from(arguments.families),
        order: arguments.order.map(usize::from),
    };
    let mut modes = Vec::<SteadyMode>::new();
    let progress = ProgressLine::new(false);
    for mode in first..=last {
        let (done, all) = (modes.len(), last + 1 - first);
        let part = done as f64 / f64::from(all);
        progress.show(part, format!("{done} of {all} modes"));
        let geometry = geometry.as_ref();
        modes.push(steady::mode(&coefficients, geometry, mode, &settings)?);
    }
    drop(progress);
    let [reduced, full] = first_to_grow(&modes);
    let hertz = |omega| problem.output.hertz(omega);
    let rows = modes.iter().enumerate().map(|(index, mode)| {
        ModeRow::new(mode, reduced == Some(index), full == Some(index), hertz)
    });
    let text = table::table(rows);
    if let Some(store) = &store {
        output::steady::write(store, &problem, &text)?;
        pictures::draw(store, Some(&problem), Format::Svg)?;
    }
    if let Some(file) = picture {
        let table = Table::parse(text.as_bytes()).unwrap_or_default();
        let drawn = pictures::steady::picture(&table, Some(&problem));
        pictures::save(file, &problem, drawn)?;
    }
    print(&summary::table(text, arguments.csv, &SHOWN))?;
    warn_of(&modes, [reduced, full], last);
    Ok(VerbExit::Done)
}

/// Warns of a mode asked for last that goes first, and of radial problems that are not converged.
fn warn_of(modes: &[SteadyMode], [reduced, full]: [Option<usize>; 2], last: u32) {
    for (found, what) in [(reduced, "in the reduced model"), (full, "of the tube")] {
        if found.is_some_and(|index| index + 1 == modes.len() && modes.len() > 1) {
            warn(&format!(
                "the mode that goes first {what} is the last one asked for, {last}: \
                 a higher one may go earlier"
            ));
        }
    }
    let coarse = |mode: &&SteadyMode| mode.full.as_ref().is_some_and(|full| full.error > PROMISED);
    let unconverged: Vec<String> = modes
        .iter()
        .filter(coarse)
        .map(|mode| mode.mode.to_string())
        .collect();
    if !unconverged.is_empty() {
        warn(&format!(
            "the radial problem is not converged to {PROMISED:e} for mode {}: see radial_error, \
             and raise --order",
            unconverged.join(", ")
        ));
    }
}
