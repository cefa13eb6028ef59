//! Arguments that verbs have in common.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::{Usage, VerbFailure};
use super::{print, warn};
use crate::output::render::Format;
use crate::output::store::{Existing, FolderKind, Store, io_error};
use crate::problem::{
    self, Any, CurveEvent, Problem, STANDARD_INPUT, SystemCurveEvent, SystemProblem,
};
use crate::simulation::task::SimulationStart;
use crate::tube::model::Parameter;

/// A problem file, and the folder of its results.
#[derive(Debug, Args)]
pub(crate) struct Task {
    /// Problem file; - reads standard input
    pub problem: PathBuf,
    /// Result folder [default: results/ and the name of the problem file, plus `_VERB`, except for `run`]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Go on with what was interrupted; its files end as if it had not been
    #[arg(long, conflicts_with = "force")]
    pub resume: bool,
    /// Replace earlier results
    #[arg(long)]
    pub force: bool,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

impl Task {
    /// The problem, its text and its name for messages.
    pub(crate) fn read(&self) -> Result<(Problem, String, String), VerbFailure> {
        let (problem, text) = read(&self.problem)?;
        Ok((problem, text, self.name()))
    }

    /// What messages call the problem file.
    pub(crate) fn name(&self) -> String {
        problem::name_of(&self.problem)
    }

    /// Where the results go: by default `results/` and the name of the problem file with an ending, once.
    pub(crate) fn folder(&self, ending: &str) -> PathBuf {
        // the stem of a file `..ron` is the folder above itself
        let stem = self
            .problem
            .file_stem()
            .filter(|stem| *stem != "." && *stem != "..");
        let name = stem.or(self.problem.file_name());
        let mut name = match name {
            Some(given) if given == STANDARD_INPUT => "stdin".into(),
            Some(name) => name.to_owned(),
            None => "problem".into(),
        };
        if !name.to_string_lossy().ends_with(ending) {
            name.push(ending);
        }
        let default = || PathBuf::from("results").join(name);
        self.out.clone().unwrap_or_else(default)
    }

    /// Prints what was found and where it is kept, unless nothing is to be printed.
    pub(crate) fn say(&self, found: &str, kept: &str, folder: &Path) -> Result<(), VerbFailure> {
        match self.quiet {
            true => Ok(()),
            false => print(&format!("{found}{kept} in {}\n", folder.display())),
        }
    }

    /// Takes hold of a folder.
    pub(crate) fn open(
        &self,
        folder: &Path,
        kind: FolderKind,
        problem: &Problem,
    ) -> Result<Store, VerbFailure> {
        let existing = Existing::of(self.resume, self.force);
        let inputs = self.inputs(problem);
        Ok(Store::open(folder, kind, problem, existing, &inputs)?)
    }

    /// The same for a problem with a system.
    pub(crate) fn open_system(
        &self,
        folder: &Path,
        kind: FolderKind,
        problem: &SystemProblem,
    ) -> Result<Store, VerbFailure> {
        let existing = Existing::of(self.resume, self.force);
        let mut inputs = vec![self.problem.clone()];
        inputs.extend(problem.earlier_run().cloned());
        let event = problem.curve.as_ref().map(|curve| &curve.event);
        if let Some(SystemCurveEvent::Label { dir, .. }) = event {
            inputs.push(dir.clone());
        }
        Ok(Store::open(folder, kind, problem, existing, &inputs)?)
    }

    /// What the results are computed from: the problem file, and what it names.
    pub(crate) fn inputs(&self, problem: &Problem) -> Vec<PathBuf> {
        let mut inputs = vec![self.problem.clone()];
        inputs.extend(problem.wave.start.label().map(|(dir, _)| dir.clone()));
        let event = problem.curve.as_ref().map(|curve| &curve.event);
        if let Some(CurveEvent::Label { dir, .. }) = event {
            inputs.push(dir.clone());
        }
        match problem.simulation.as_ref().map(|section| &section.start) {
            Some(SimulationStart::Wave { dir, .. }) => inputs.push(dir.clone()),
            Some(SimulationStart::Profile { file, .. }) => inputs.push(file.clone()),
            _ => {}
        }
        inputs
    }
}

/// Reads a problem file with waves of a tube, with a warning of what no real tube has.
pub(crate) fn read(path: &Path) -> Result<(Problem, String), VerbFailure> {
    let (problem, text) = problem::read(path)?;
    doubt(path, &problem);
    Ok((problem, text))
}

/// Reads a problem file of either kind, with a warning of what no real tube has.
pub(crate) fn read_any(path: &Path) -> Result<(Any, String), VerbFailure> {
    let (problem, text) = problem::read_any(path)?;
    if let Any::Tube(problem) = &problem {
        doubt(path, problem);
    }
    Ok((problem, text))
}

fn doubt(path: &Path, problem: &Problem) {
    for doubt in problem.doubts() {
        warn(&format!("{}: {doubt}", path.display()));
    }
}

/// Refuses a result folder that is not there.
pub(crate) fn there(folder: &Path) -> Result<(), Usage> {
    match folder.is_dir() {
        true => Ok(()),
        false => Err(Usage::NoFolder(folder.to_owned())),
    }
}

/// How many threads.
#[derive(Debug, Args)]
pub(crate) struct Threads {
    /// Threads [default: one per core; for `run`, where they only draw, one]; the results do not depend
    /// on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
}

impl Threads {
    /// Does work with as many threads as asked for, not more than `most`: they would only wait.
    pub(crate) fn install<T: Send>(
        &self,
        default: usize,
        most: usize,
        work: impl FnOnce() -> Result<T, VerbFailure> + Send,
    ) -> Result<T, VerbFailure> {
        let threads = self.threads.map_or(default, usize::from).min(most).max(1);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        // a single thread is this one, unless another pool has it already
        let pool = match threads == 1 && rayon::current_thread_index().is_none() {
            true => pool.use_current_thread(),
            false => pool,
        };
        pool.build().map_err(Usage::Threads)?.install(work)
    }
}

/// Threads that this machine can run at a time.
pub(crate) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// A picture format on the command line.
pub(crate) fn format(text: &str) -> Result<Format, Usage> {
    Format::named(text).ok_or_else(|| Usage::Format(text.to_owned()))
}

/// A positive number on the command line.
pub(crate) fn positive(text: &str) -> Result<f64, Usage> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err(Usage::NotPositive),
    }
}

/// NAME=VALUE on the command line, where the name is that of a parameter of a tube.
pub(crate) fn assignment(text: &str) -> Result<(Parameter, f64), Usage> {
    let (name, number) = named(text)?;
    Ok((of_tube(&name)?, number))
}

/// NAME=VALUE on the command line.
pub(crate) fn named(text: &str) -> Result<(String, f64), Usage> {
    let (name, value) = text.split_once('=').ok_or(Usage::Assignment)?;
    let (name, value) = (name.trim(), value.trim());
    let number: f64 = value.parse().map_err(|_| Usage::Number(value.to_owned()))?;
    if !number.is_finite() {
        return Err(Usage::NotFinite(number));
    }
    Ok((name.to_owned(), number))
}

/// The parameter of a tube with this name.
pub(crate) fn of_tube(name: &str) -> Result<Parameter, Usage> {
    Parameter::from_column(name).ok_or_else(|| {
        let known = Parameter::ALL.map(|parameter| parameter.column());
        Usage::Parameter {
            name: name.to_owned(),
            known: known.join(", "),
        }
    })
}

/// Refuses a parameter that is given two values.
pub(crate) fn once(assignments: &[(Parameter, f64)]) -> Result<(), Usage> {
    let twice = assignments.iter().enumerate().find(|(index, (one, _))| {
        let mut before = assignments[..*index].iter();
        before.any(|(other, _)| other == one)
    });
    twice.map_or(Ok(()), |(_, (parameter, _))| Err(Usage::Twice(*parameter)))
}

/// Replaces a parameter of the model, under the rules of a problem file.
pub(crate) fn set(problem: &mut Problem, parameter: Parameter, value: f64) -> Result<(), Usage> {
    let rule = match problem.model.value(parameter) {
        None => "the model has no such parameter".to_owned(),
        Some(_) if parameter.admits(value) && value.is_finite() => {
            problem.model = problem.model.with(parameter, value);
            return Ok(());
        }
        Some(_) => parameter.rule(),
    };
    Err(Usage::NotAdmitted {
        parameter,
        value,
        rule,
    })
}

/// Refuses a file for output that is read as well, or that cannot be: before the computation.
pub(crate) fn spare(path: &Path, inputs: &[PathBuf]) -> Result<(), VerbFailure> {
    let canonical = |path: &Path| fs::canonicalize(path).ok();
    let there = canonical(path);
    if there.is_some() && inputs.iter().any(|input| canonical(input) == there) {
        return Err(Usage::Replaced(path.to_owned()).into());
    }
    let folder = path.parent();
    if let Some(folder) = folder.filter(|folder| !folder.as_os_str().is_empty()) {
        fs::read_dir(folder).map_err(io_error("write into it", folder))?;
    }
    Ok(())
}

/// Writes a file that the user has named.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), VerbFailure> {
    Ok(fs::write(path, text).map_err(io_error("write it", path))?)
}

/// File and format of a picture asked for.
pub(crate) fn picture<'a>(
    path: Option<&'a Path>,
    inputs: &[PathBuf],
) -> Result<Option<(&'a Path, Format)>, VerbFailure> {
    let Some(path) = path else {
        return Ok(None);
    };
    let format = Format::of(path).ok_or_else(|| Usage::PictureName(path.to_owned()))?;
    spare(path, inputs)?;
    Ok(Some((path, format.available()?)))
}
