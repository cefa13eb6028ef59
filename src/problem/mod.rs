//! Problem files: what to compute, read from RON and checked before anything is computed.
//!
//! `ron` decides whether a file is well formed. Only when it refuses, or when a value fails the
//! checks of [`parse`], does an outline of the text tell where to point.

pub mod compare;
mod continuation;
mod curve;
mod doubt;
mod error;
mod examples;
mod expectation;
mod explanation;
mod fields;
mod leaf;
mod map;
mod outline;
mod output;
mod rules;
mod scan;
mod system;
mod template;
#[cfg(test)]
mod tests;
mod text;
mod tube;
mod validation;
mod written;

use std::path::{Path, PathBuf};

use ron::extensions::Extensions;
use serde::{Deserialize, Serialize};

pub(crate) use continuation::DEFAULT_MAX_POINTS;
pub use continuation::{Continuation, StopAfter, Toward, UserPoint};
pub use curve::{CurveEvent, CurveSection, SystemCurve, SystemCurveEvent};
pub use doubt::Doubt;
pub use error::ProblemError;
pub use expectation::Expectation;
pub use map::{Map, MapAxis, MapPoints, PlaneAxis, Shares, SystemAxis, SystemMap, WaveStarts};
pub(crate) use output::drawable_columns;
pub use output::{Output, Plot};
pub use scan::{LyapunovCount, SampleSection, Scan, ScanValues, Sweep};
pub use system::{
    BeginningSection, EquilibriumSection, EquilibriumStart, Multipliers, OrbitSection, OrbitStart,
    SystemPlot, SystemProblem, SystemSimulation,
};
#[cfg(feature = "cli")]
pub(crate) use template::{SYSTEM_TEMPLATE, template};
#[cfg(feature = "cli")]
pub(crate) use text::as_written;
pub use text::{STANDARD_INPUT, name_of};
pub use tube::{Rotation, Tube};

use crate::interval::Decimal;
use crate::simulation::task::Simulation;
use crate::tube::flow::method::Method;
use crate::tube::model::{Model, Parameter, Sectors};
use crate::tube::stability::spectrum::SpectrumRequest;
use error::Flaw;
use outline::{Outline, Subject};
use text::text_of;
use tube::place_of;
use written::WrittenProblem;

/// Largest problem file accepted, in bytes.
pub(crate) const MAX_BYTES: usize = 4 << 20;
/// Largest number of waves around the circumference that is accepted.
pub(crate) const MAX_MODE: u32 = 4096;
/// Largest number of profiles that can be asked for.
pub(crate) const MAX_PROFILES: usize = 1000;
/// Most values of [`Continuation::stop_at`].
pub(crate) const MAX_USER_POINTS: usize = 10_000;
/// Longest title or path, in characters.
pub(crate) const MAX_WORDS: usize = 4096;
/// Coarsest accepted [`Continuation::tolerance`].
pub(crate) const MAX_TOLERANCE: f64 = 1e-4;

/// Eigenvalues kept per Bloch sector where no number is given.
pub(crate) const DEFAULT_EIGENVALUES: usize = 6;
/// Largest |Im λ| searched at γ = 1 where none is given, in units of Ω.
const DEFAULT_MAX_FREQUENCY: f64 = 12.0;

/// A problem that has passed every check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Problem {
    /// Title for plots and reports.
    pub title: Option<String>,
    /// The brake.
    pub model: Model,
    /// The same in SI units, where the file has it so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tube: Option<Tube>,
    /// The wave to begin with.
    pub wave: WaveSection,
    /// How the equations of a zone are solved; the cheapest that is exact, or accurate to 1e-12,
    /// for the friction law unless given.
    pub method: Option<Method>,
    /// The branch to follow; see [`Problem::continuation`].
    pub continuation: Option<Continuation>,
    /// Stability analysis; `None` when not asked for.
    pub stability: Option<StabilitySection>,
    /// The plane to map; see [`Problem::map`].
    pub map: Option<Map>,
    /// Simulation in time; see [`Problem::simulation`].
    pub simulation: Option<Simulation>,
    /// The event to follow in two parameters; see [`Problem::curve`].
    pub curve: Option<CurveSection>,
    /// Plots and tables to write.
    #[serde(default)]
    pub output: Output,
    /// Events that a check compares with.
    #[serde(default)]
    pub expect: Vec<Expectation>,
    /// Whether a check proves the special points of the branch.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub certify: bool,
}

impl Problem {
    /// What the section `stability` asks for; `None` without one.
    pub fn request(&self) -> Option<SpectrumRequest> {
        let section = self.stability.as_ref()?;
        Some(section.request(self.wave.mode))
    }

    /// The parameter of the branch; the mismatch where there is none to follow.
    pub fn parameter(&self) -> Parameter {
        let section = self.continuation.as_ref();
        section.map_or(Parameter::Mismatch, |section| section.parameter)
    }

    /// The `continuation` section, or an error that says how to write one.
    ///
    /// `text` and `name` are the source of the problem and the name of its file, for the message.
    pub fn continuation(&self, text: &str, name: &str) -> Result<&Continuation, ProblemError> {
        let section = self.continuation.as_ref();
        section.ok_or_else(|| {
            missing(
                Subject::Tube,
                "continuation",
                "no branch to follow",
                text,
                name,
            )
        })
    }

    /// The `simulation` section; see [`Problem::continuation`].
    pub fn simulation(&self, text: &str, name: &str) -> Result<&Simulation, ProblemError> {
        let section = self.simulation.as_ref();
        section.ok_or_else(|| {
            missing(
                Subject::Tube,
                "simulation",
                "nothing to simulate",
                text,
                name,
            )
        })
    }

    /// The `map` section; see [`Problem::continuation`].
    pub fn map(&self, text: &str, name: &str) -> Result<&Map, ProblemError> {
        let section = self.map.as_ref();
        section.ok_or_else(|| missing(Subject::Tube, "map", "no plane to map", text, name))
    }

    /// The `curve` section; see [`Problem::continuation`].
    pub fn curve(&self, text: &str, name: &str) -> Result<&CurveSection, ProblemError> {
        let section = self.curve.as_ref();
        section.ok_or_else(|| missing(Subject::Tube, "curve", "no event to follow", text, name))
    }
}

/// The error about a section that is not there.
fn missing(subject: Subject, section: &str, lack: &str, text: &str, name: &str) -> ProblemError {
    let message = format!("missing field `{section}` in the problem: there is {lack}");
    let example = examples::example(subject, "", section).unwrap_or_default();
    refuse_at(text, name, section, message, format!("add `{example},`"))
}

/// The wave a computation begins with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Wave", deny_unknown_fields)]
pub struct WaveSection {
    /// Number of waves k around the circumference, 1 to [`MAX_MODE`].
    pub mode: u32,
    /// The first solution.
    pub start: Start,
}

/// Which solution is the first.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Start {
    /// The fast wave at the parameters of the model.
    Fast,
    /// The slow wave at the parameters of the model.
    Slow,
    /// The waves at the Hopf point of steady sliding, and the slip-stick wave that begins there; the
    /// value of the continuation parameter is that of the Hopf point, whatever the model says.
    Hopf,
    /// A labelled point of an earlier run.
    Restart {
        /// Directory with the results of that run.
        dir: PathBuf,
        /// Label of the point.
        label: usize,
    },
    /// The wave of twice the wavelength that branches off at a `BP` of an earlier run with twice the mode, where an
    /// eigenvalue of the sector half its mode passes zero.
    Switch {
        /// Directory with the results of that run.
        dir: PathBuf,
        /// Label of the `BP`.
        label: usize,
    },
}

impl Start {
    /// The folder of the earlier run that brings the first wave with its model, and its label there.
    pub fn label(&self) -> Option<(&PathBuf, usize)> {
        match self {
            Start::Restart { dir, label } | Start::Switch { dir, label } => Some((dir, *label)),
            Start::Fast | Start::Slow | Start::Hopf => None,
        }
    }
}

/// Stability analysis of the points of the branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StabilitySection {
    /// Bloch sectors to look at.
    pub sectors: Sectors,
    /// Eigenvalues to keep per sector, at least 1.
    pub eigenvalues: usize,
    /// Largest |Im λ| to search, in units of Ω; [`StabilitySection::of`] the model unless the file gives it.
    pub max_frequency: f64,
}

impl Default for StabilitySection {
    fn default() -> Self {
        StabilitySection {
            sectors: Sectors::All,
            eigenvalues: DEFAULT_EIGENVALUES,
            max_frequency: DEFAULT_MAX_FREQUENCY,
        }
    }
}

impl StabilitySection {
    /// What is assumed for waves of a model: eigenvalues are proportional to 1/√γ, and so is the largest
    /// frequency. Where γ is the parameter of a branch, its value in the model counts.
    pub fn of(model: &Model) -> StabilitySection {
        let gamma = model.value(Parameter::Gamma).unwrap_or(1.0);
        StabilitySection {
            max_frequency: DEFAULT_MAX_FREQUENCY / gamma.sqrt(),
            ..StabilitySection::default()
        }
    }

    /// What to compute for waves of a mode.
    pub fn request(&self, mode: u32) -> SpectrumRequest {
        SpectrumRequest {
            sectors: self.sectors.list(mode),
            eigenvalues: self.eigenvalues,
            max_frequency: self.max_frequency,
        }
    }
}

/// A problem of either kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Any {
    /// Waves of a tube.
    Tube(Box<Problem>),
    /// Orbits of a system of one's own.
    System(Box<SystemProblem>),
}

impl Any {
    /// That of a tube.
    pub fn tube(self) -> Option<Problem> {
        match self {
            Any::Tube(problem) => Some(*problem),
            Any::System(_) => None,
        }
    }

    /// Title for plots and reports.
    pub fn title(&self) -> Option<&str> {
        match self {
            Any::Tube(problem) => problem.title.as_deref(),
            Any::System(problem) => problem.title.as_deref(),
        }
    }
}

/// Reads and checks a problem file with waves of a tube; returns its text as well.
///
/// # Errors
/// As [`read_any`], and where the problem has a section `system`.
pub fn read(path: &Path) -> Result<(Problem, String), ProblemError> {
    let (name, text) = text_of(path)?;
    Ok((parse(&text, &name)?, text))
}

/// Reads and checks a problem file of either kind; returns its text as well.
///
/// Only regular files are read, for a pipe or a device may have no end, and the standard input as [`STANDARD_INPUT`].
///
/// # Errors
/// A file that cannot be read, and everything that is wrong with it.
pub fn read_any(path: &Path) -> Result<(Any, String), ProblemError> {
    let (name, text) = text_of(path)?;
    Ok((parse_any(&text, &name)?, text))
}

/// Parses and checks the text of a problem file with waves of a tube; `name` is what messages call the file.
///
/// # Errors
/// As [`parse_any`], and where the problem has a section `system`.
pub fn parse(text: &str, name: &str) -> Result<Problem, ProblemError> {
    checked(text, name, |outline| match outline.subject() {
        Subject::Tube => tube_of(outline),
        Subject::System => {
            one_subject(outline)?;
            let mut sections = ["system", "orbit", "equilibrium"].into_iter();
            let section = sections.find(|name| outline.has(name)).unwrap_or_default();
            let message = format!(
                "this problem has a section `{section}`, and what is asked for is for waves of a tube"
            );
            let at = outline.key_of("", section);
            let at = at.unwrap_or_else(|| outline.locate(section));
            let help = "take a problem with `model` and `wave`; `run`, `check`, `steady`, `map`, `scan` and \
                        `simulate` take systems";
            Err(Flaw::new(at, message, help))
        }
    })
}

/// Parses and checks the text of a problem file of either kind; `name` is what messages call the file.
///
/// # Errors
/// The first thing that is wrong, with its place.
pub fn parse_any(text: &str, name: &str) -> Result<Any, ProblemError> {
    checked(text, name, |outline| match outline.subject() {
        Subject::Tube => Ok(Any::Tube(Box::new(tube_of(outline)?))),
        Subject::System => Ok(Any::System(Box::new(system_of(outline)?))),
    })
}

/// Sections of a tube that stand where a system has another one, and those that a system does not have.
const OF_TUBES: [(&str, Option<&str>); 4] = [
    ("model", Some("system")),
    ("tube", Some("system")),
    ("wave", Some("orbit")),
    ("method", None),
];

/// Refuses sections of a tube in a problem with a system.
fn one_subject(outline: &Outline) -> Result<(), Flaw> {
    for (section, place) in OF_TUBES {
        if !outline.has(section) {
            continue;
        }
        if let Some(place) = place.filter(|place| outline.has(place)) {
            return Err(written::beside(outline, section, place));
        }
        let at = outline.key_of("", section);
        let at = at.unwrap_or_else(|| outline.locate(section));
        let message =
            format!("`{section}` is for waves of a tube, and this is a problem with a system");
        let help = match place {
            Some(place) => format!("write `{place}` in its place"),
            None => "leave it out".to_owned(),
        };
        return Err(Flaw::new(at, message, help));
    }
    Ok(())
}

fn system_of(outline: &Outline) -> Result<SystemProblem, Flaw> {
    let written = options().from_str(outline.text);
    let written = written.map_err(|error| {
        let told = explanation::explain(outline, &error);
        one_subject(outline).err().unwrap_or(told)
    })?;
    one_subject(outline)?;
    SystemProblem::read(written, outline)
}

fn tube_of(outline: &Outline) -> Result<Problem, Flaw> {
    let written = options().from_str(outline.text);
    let written: WrittenProblem = written.map_err(|error| explanation::explain(outline, &error))?;
    rules::lengths(written.continuation.as_ref(), &written.expect, outline)?;
    fields::check(&written, outline)?;
    let mut problem = written.problem(outline)?;
    problem.output.with_profiles(outline, Plot::shows_profiles);
    validation::check(&problem, outline)?;
    if let Some(section) = &mut problem.stability
        && !outline.has("stability.max_frequency")
    {
        section.max_frequency = StabilitySection::of(&problem.model).max_frequency;
    }
    Ok(problem)
}

/// What a text means, if it is one.
fn checked<T>(
    text: &str,
    name: &str,
    read: impl FnOnce(&Outline) -> Result<T, Flaw>,
) -> Result<T, ProblemError> {
    if text.len() > MAX_BYTES {
        return Err(too_large(name));
    }
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
    let refuse = |flaw| ProblemError::in_text(name, text, flaw);
    if let Some((at, found)) = text.char_indices().find(|(_, c)| !is_text(*c)) {
        let message = format!(
            "the control character U+{:04X} is no text",
            u32::from(found)
        );
        let help = "remove it; is the file a problem file in the encoding UTF-8?";
        return Err(refuse(Flaw::new(at..at + found.len_utf8(), message, help)));
    }
    read(&Outline::of(text)).map_err(refuse)
}

/// Whether a character is text, as tables, pictures and reports in XML can hold it.
fn is_text(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r') || !(c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}'))
}

/// Whether the text of a problem says something at a path of the model or of another section.
pub fn says(text: &str, path: &str) -> bool {
    let outline = Outline::of(text);
    outline.has(&place_of(path, &outline))
}

/// The decimal that the text of a problem has at a path.
pub(crate) fn decimal_at(text: &str, path: &str) -> Option<Decimal> {
    let outline = Outline::of(text);
    let path = place_of(path, &outline);
    let there = outline.has(&path).then(|| outline.locate(&path))?;
    Decimal::try_from(text.get(there)?.to_owned()).ok()
}

/// The decimal in a section, or at a path, that reads as a double; the shortest where the text has none.
pub(crate) fn decimal_of(text: &str, path: &str, value: f64) -> Decimal {
    let outline = Outline::of(text);
    let path = place_of(path, &outline);
    let below = outline.below(&path);
    let decimals = below.filter_map(|source| Decimal::try_from(source.to_owned()).ok());
    let mut equal = decimals.filter(|decimal| decimal.nearest() == value);
    equal.next().unwrap_or_else(|| Decimal::of(value))
}

/// A refusal of what the text of a problem says at a path, for reasons that only show later.
pub(crate) fn refuse_at(
    text: &str,
    name: &str,
    path: &str,
    message: impl Into<String>,
    help: impl Into<String>,
) -> ProblemError {
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
    let outline = Outline::of(text);
    let at = outline.locate(&place_of(path, &outline));
    ProblemError::in_text(name, text, Flaw::new(at, message, help))
}

fn too_large(name: &str) -> ProblemError {
    ProblemError::in_file(
        name,
        format!("the file is larger than {} MiB", MAX_BYTES >> 20),
        "a problem file is a page of text; is this another file?",
    )
}

fn options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}
