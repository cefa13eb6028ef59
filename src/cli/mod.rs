//! The command line: verbs, messages, exit codes.

mod accuracy;
mod check;
mod curve;
mod map;
mod plot;
mod progress;
mod report;
mod run;
mod simulate;
mod spectrum;
mod steady;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand, ValueEnum};

use crate::branch::run::RunError;
use crate::curve::start::NoCurve;
use crate::output::pictures::PlotError;
use crate::output::render::{Format, RenderError};
use crate::output::store::{StoreError, io_error};
use crate::problem::{self, CurveEvent, Problem, ProblemError, Start};
use crate::simulation::task::SimulationStart;
use crate::steady::radial;
use crate::wave::hopf::NoHopf;

/// Continuation and bifurcation of friction-driven travelling waves (brake squeal).
#[derive(Debug, Parser)]
#[command(version, about, after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 an expectation of `check` is not met; 2 bad input \
or usage; 3 numerical failure (no start, or the branch ended before its range); 4 input or output failed \
(full disk, no permission, damaged folder)";

#[derive(Debug, Subcommand)]
enum Verb {
    /// Follow the branch of a problem file and write tables, restart file and pictures
    Run(run::RunArguments),
    /// Run problem files and compare with their `expect` lists
    Check(check::CheckArguments),
    /// Draw the pictures of a result folder again
    Plot(plot::PlotArguments),
    /// The wave at one parameter value and its eigenvalues, as CSV on standard output
    Spectrum(spectrum::SpectrumArguments),
    /// Error against run time of every method on a problem file
    Accuracy(accuracy::AccuracyArguments),
    /// Follow an event of the branch in two parameters
    Curve(curve::CurveArguments),
    /// Which waves exist where in a plane of two parameters, and which of them are stable
    Map(map::MapArguments),
    /// Stability of steady sliding, mode by mode, in the reduced model and in the tube itself, as CSV
    /// on standard output
    Steady(steady::SteadyArguments),
    /// Simulate the motion in time as the section `simulation` of a problem file says
    Simulate(simulate::SimulateArguments),
    /// Print a commented problem file
    New,
}

/// Picture formats on the command line.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum FormatArgument {
    Svg,
    Png,
    Pdf,
}

impl From<FormatArgument> for Format {
    fn from(format: FormatArgument) -> Format {
        match format {
            FormatArgument::Svg => Format::Svg,
            FormatArgument::Png => Format::Png,
            FormatArgument::Pdf => Format::Pdf,
        }
    }
}

/// Everything that can end a verb early, with its exit code.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error("{0}")]
    Problem(#[from] ProblemError),
    /// What cannot be computed, with the line of the problem file it is about, and the exit code.
    #[error("{0}")]
    Placed(ProblemError, u8),
    #[error("{0}")]
    Store(#[from] StoreError),
    #[error("{0}")]
    Plot(#[from] PlotError),
    #[error("{0}")]
    Render(#[from] RenderError),
    #[error("{0}")]
    Run(#[from] RunError),
    #[error("{0}")]
    Curve(#[from] NoCurve),
    #[error("{0}")]
    Radial(#[from] radial::Error),
    #[error("{0}")]
    Usage(String),
    #[error("{0}")]
    Output(io::Error),
}

impl Failure {
    fn code(&self) -> u8 {
        match self {
            Failure::Placed(_, code) => *code,
            Failure::Run(RunError::NoHopf(NoHopf::Parameter)) => BAD_INPUT,
            Failure::Run(RunError::NoStart(_) | RunError::NoHopf(_)) | Failure::Radial(_) => {
                NUMERICAL
            }
            Failure::Curve(
                NoCurve::Run(RunError::Asked(_)) | NoCurve::Outside { .. } | NoCurve::Kind { .. },
            ) => BAD_INPUT,
            Failure::Curve(_) => NUMERICAL,
            Failure::Store(error) | Failure::Plot(PlotError::Store(error)) => {
                if error.is_usage() {
                    BAD_INPUT
                } else {
                    INPUT_OUTPUT
                }
            }
            Failure::Plot(
                PlotError::Read(_) | PlotError::Empty { .. } | PlotError::MissingColumn { .. },
            )
            | Failure::Output(_) => INPUT_OUTPUT,
            _ => BAD_INPUT,
        }
    }
}

const UNMET: u8 = 1;
const BAD_INPUT: u8 = 2;
const NUMERICAL: u8 = 3;
const INPUT_OUTPUT: u8 = 4;

/// Runs the command line of this process and returns its exit code.
pub fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let result = match arguments.verb {
        Verb::Run(arguments) => run::run(&arguments),
        Verb::Check(arguments) => check::check(&arguments),
        Verb::Plot(arguments) => plot::plot(&arguments),
        Verb::Spectrum(arguments) => spectrum::spectrum(&arguments),
        Verb::Accuracy(arguments) => accuracy::accuracy(&arguments),
        Verb::Curve(arguments) => curve::curve(&arguments),
        Verb::Map(arguments) => map::map(&arguments),
        Verb::Steady(arguments) => steady::steady(&arguments),
        Verb::Simulate(arguments) => simulate::simulate(&arguments),
        Verb::New => print(problem::TEMPLATE).map(|()| 0),
    };
    match result {
        Ok(code) => ExitCode::from(code),
        Err(failure) => {
            let _ = writeln!(io::stderr(), "error: {failure}");
            ExitCode::from(failure.code())
        }
    }
}

/// Writes to standard output.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        // a reader that has seen enough is no error; files and exit code are due all the same
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::Output(error)),
        _ => Ok(()),
    }
}

/// Writes a warning to standard error.
fn warn(text: &str) {
    let _ = writeln!(io::stderr(), "warning: {text}");
}

/// Where results go by default: `results/` and the name of the problem file.
fn default_folder(problem: &Path) -> PathBuf {
    let stem = problem
        .file_stem()
        .map_or_else(|| "problem".into(), |stem| stem.to_owned());
    PathBuf::from("results").join(stem)
}

/// What the results of a problem file are computed from: itself, and what it names.
fn inputs(path: &Path, problem: &Problem) -> Vec<PathBuf> {
    let mut inputs = vec![path.to_path_buf()];
    if let Start::Restart { dir, .. } = &problem.wave.start {
        inputs.push(dir.clone());
    }
    if let Some(CurveEvent::Label { dir, .. }) = problem.curve.as_ref().map(|curve| &curve.event) {
        inputs.push(dir.clone());
    }
    match problem.simulation.as_ref().map(|section| &section.start) {
        Some(SimulationStart::Wave { dir, .. }) => inputs.push(dir.clone()),
        Some(SimulationStart::Profile { file, .. }) => inputs.push(file.clone()),
        _ => {}
    }
    inputs
}

/// Refuses a file for output that is read as well, or that cannot be: before the computation.
fn spare(path: &Path, inputs: &[PathBuf]) -> Result<(), Failure> {
    let canonical = |path: &Path| fs::canonicalize(path).ok();
    let there = canonical(path);
    if there.is_some() && inputs.iter().any(|input| canonical(input) == there) {
        return Err(Failure::Usage(format!(
            "{}: it would be replaced, and is read as well; take another name",
            path.display()
        )));
    }
    if let Some(folder) = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
    {
        fs::read_dir(folder).map_err(io_error("write into it", folder))?;
    }
    Ok(())
}

/// Writes a file that the user has named.
fn write(path: &Path, text: &str) -> Result<(), Failure> {
    Ok(fs::write(path, text).map_err(io_error("write it", path))?)
}

/// File and format of a picture asked for.
fn picture<'a>(
    path: Option<&'a Path>,
    inputs: &[PathBuf],
) -> Result<Option<(&'a Path, Format)>, Failure> {
    let Some(path) = path else {
        return Ok(None);
    };
    let Some(format) = Format::of(path) else {
        return Err(Failure::Usage(format!(
            "{}: give the picture a name that ends in .svg, .png or .pdf",
            path.display()
        )));
    };
    spare(path, inputs)?;
    Ok(Some((path, format.available()?)))
}
