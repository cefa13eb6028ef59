//! How a verb ends: exit codes, and what can end it early.

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use crate::branch::run::RunError;
use crate::curve::start::NoCurve;
use crate::discretised;
use crate::output::pictures::PlotError;
use crate::output::render::RenderError;
use crate::output::store::{Offers, StoreError};
use crate::problem::ProblemError;
use crate::simulation::course::NoCourse;
use crate::simulation::profile::ProfileError;
use crate::tube::model::Parameter;
use crate::tube::steady::radial;
use crate::tube::wave::hopf::NoHopf;

/// How a verb has ended; the number is the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum VerbExit {
    /// All that was asked for is done.
    Done = 0,
    /// An expectation of `check` is not met.
    Unmet = 1,
    /// The user asked for the wrong thing.
    BadInput = 2,
    /// There is no start, or the branch ended before its range.
    Numerical = 3,
    /// Files could not be read or written.
    InputOutput = 4,
}

impl From<VerbExit> for ExitCode {
    fn from(exit: VerbExit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}

/// The exit codes for the help text.
pub(crate) const EXIT_CODES: &str = "Exit codes: 0 done; 1 an expectation of `check` is not met, or a point to be certified is not proven; 2 bad input \
or usage; 3 numerical failure (no start, or the branch ended before its range); 4 input or output failed \
(full disk, no permission, damaged folder); 130 interrupted";

/// Everything that can end a verb early.
#[derive(Debug, thiserror::Error)]
pub(crate) enum VerbFailure {
    #[error("{0}")]
    Problem(#[from] ProblemError),
    /// What cannot be computed, with the line of the problem file it is about.
    #[error("{0}")]
    Placed(ProblemError, VerbExit),
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
    Radial(#[from] radial::RadialError),
    #[error("{0}")]
    Usage(#[from] Usage),
    /// Standard output.
    #[error("{0}")]
    Output(io::Error),
}

impl VerbFailure {
    /// What helps, if it does not say so itself, with the options that the verb has.
    pub(crate) fn cure(&self, offers: Offers) -> &'static str {
        match self {
            VerbFailure::Store(error) | VerbFailure::Plot(PlotError::Store(error)) => {
                error.cure(offers)
            }
            _ => "",
        }
    }

    /// The exit code that it means.
    pub(crate) fn exit(&self) -> VerbExit {
        match self {
            VerbFailure::Placed(_, exit) => *exit,
            VerbFailure::Run(RunError::NoHopf(NoHopf::Parameter)) => VerbExit::BadInput,
            VerbFailure::Run(RunError::NoStart(_) | RunError::NoHopf(_))
            | VerbFailure::Radial(_) => VerbExit::Numerical,
            VerbFailure::Curve(
                NoCurve::Run(RunError::Asked(_)) | NoCurve::Outside { .. } | NoCurve::Kind { .. },
            ) => VerbExit::BadInput,
            VerbFailure::Curve(_) => VerbExit::Numerical,
            VerbFailure::Store(error) | VerbFailure::Plot(PlotError::Store(error)) => {
                match error.is_usage() {
                    true => VerbExit::BadInput,
                    false => VerbExit::InputOutput,
                }
            }
            VerbFailure::Output(_) => VerbExit::InputOutput,
            _ => VerbExit::BadInput,
        }
    }
}

/// What the user asked for in vain, on the command line or in a problem file.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Usage {
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    #[error("{}: it would be replaced, and is read as well; take another name", .0.display())]
    Replaced(PathBuf),
    #[error("{}: give the picture a name that ends in .svg, .png, .pdf or .tex", .0.display())]
    PictureName(PathBuf),
    #[error("`{0}` is no format; take svg, png, pdf or tex")]
    Format(String),
    #[error("`{0}` is no range: write LOW,HIGH, for example 0.001,0.01")]
    Ends(String),
    #[error(
        "`--spectrum` is of waves; of a system leave it out: multipliers or eigenvalues are counted anyway"
    )]
    OfWaves,
    #[error("`--arcs` is of waves and orbits; of equilibria leave it out")]
    OfOrbits,
    #[error("write NAME=VALUE, for example mismatch=0.045")]
    Assignment,
    #[error("`{name}` is no parameter; known: {known}")]
    Parameter { name: String, known: String },
    #[error("`{0}` is not a number")]
    Number(String),
    #[error("{0} is not finite")]
    NotFinite(f64),
    #[error("{} = {value} is not admitted: {rule}", parameter.column())]
    NotAdmitted {
        parameter: Parameter,
        value: f64,
        rule: String,
    },
    #[error("there is no Bloch sector {sector} for mode {mode}: take 0 to {}", mode - 1)]
    Sector { sector: usize, mode: usize },
    #[error(
        "{} = {value} lies outside the range from {} to {} of the problem", parameter.column(), range.0, range.1
    )]
    OutOfRange {
        parameter: Parameter,
        value: f64,
        range: (f64, f64),
    },
    #[error("`{0}` is no number of points; take {least} to {most}", least = discretised::LEAST_POINTS, most = discretised::MOST_POINTS)]
    Points(String),
    #[error("{0} points per wavelength do not resolve a wave; take {least} at least", least = discretised::LEAST_POINTS)]
    FewPoints(u128),
    #[error(
        "the dense eigenvalue problem of {0} points per wavelength takes about {gigabytes:.0} GB; take \
         {most} points at most",
        gigabytes = discretised::memory(*.0 as f64) / 1e9,
        most = discretised::MOST_POINTS
    )]
    ManyPoints(u128),
    #[error("take a positive number such as 0.005")]
    NotPositive,
    #[error(
        "--epsilon smooths Coulomb's law, but `friction_law` is Regularised(epsilon: {0}); leave the \
         option out, or give --at smoothing=VALUE"
    )]
    OwnWidth(f64),
    #[error(
        "`friction_law`: the discretised ring has Coulomb's or Stribeck's law smoothed, or Regularised(…)\n  \
         help: leave out --discretised for the exact eigenvalues under this one"
    )]
    LawOfRing,
    #[error("`{0}` is not a number of waves; write 1..20 or 4")]
    Waves(String),
    #[error("{0}..{1} is no range of modes: write the smaller one first, from 1 to {most}", most = crate::problem::MAX_MODE)]
    Modes(u32, u32),
    #[error("write I/N with 1 ≤ I ≤ N, for example 2/4")]
    Shard,
    #[error("name a problem file")]
    NoProblem,
    #[error("{} and {} are shards of different problems", .0.display(), .1.display())]
    OtherShards(PathBuf, PathBuf),
    #[error("{}: there is no such folder", .0.display())]
    NoFolder(PathBuf),
    #[error("{}: it is there already; --force replaces it", .0.display())]
    Drawn(PathBuf),
    #[error("--at gives {} two values", .0.column())]
    Twice(Parameter),
    #[error("--passage counts passages of the branch through a value of {0}: give --at {0}=VALUE")]
    Passage(&'static str),
    #[error("{} holds no branch", .0.display())]
    NoBranch(PathBuf),
    #[error("{} holds no branch: --x, --y, --log and --range draw columns of one, and --y a state of a scan", .0.display())]
    NoView(PathBuf),
    #[error("{} is a shard of a {verb}: join all of them first with `brakewave {verb} merge`", folder.display())]
    Unjoined { folder: PathBuf, verb: &'static str },
    #[error("{} is no scan, over which a branch could be drawn", .0.display())]
    NoScan(PathBuf),
    #[error("{} holds no branch of orbits in `{parameter}`, the parameter of the scan", folder.display())]
    NoBranchIn { folder: PathBuf, parameter: String },
    #[error("{} holds proofs, which have no picture; plot the folder of the run", .0.display())]
    NoPicture(PathBuf),
    #[error("{} holds results of a system of one's own, of which no pictures are drawn yet", .0.display())]
    Unpictured(PathBuf),
    #[error("{option} is for waves of a tube, and the problem has a system")]
    OfTubes { option: &'static str },
    #[error(
        "the motion begins at a label of another run: write `start: (mode: .., state: ..)` into `simulation`"
    )]
    NoBeginning,
    #[error("`{name}` is no parameter of the system; it has {known}")]
    NoParameter { name: String, known: String },
    #[error("at these values the system makes no sense: {0}")]
    NoSystem(crate::affine::system::SystemError),
    #[error(
        "every method begins from the closed form: give a problem that starts from `Fast` or `Slow`"
    )]
    Restarted,
    #[error("the reference, {method}, takes longer than --budget {budget}: give a larger one")]
    Budget { method: String, budget: f64 },
    #[error(
        "{} is no file: name a table of a run, like results/x/profiles/3.csv, in `simulation: (start: \
         Profile(file: .., speed: ..))`", .0.display()
    )]
    NoProfile(PathBuf),
    #[error(
        "{} holds no waves to begin with: follow them first with `brakewave run` and `output: (profiles: \
         9)`, or name the folder of such a run in `simulation: (start: Wave(dir: ..))`", .0.display()
    )]
    NoWaves(PathBuf),
    #[error(
        "label {label} of {} has no profile; `output: (profiles: 9)` in the problem of the run has \
         profiles written", dir.display()
    )]
    Unprofiled { dir: PathBuf, label: usize },
    #[error("{0}")]
    Profile(#[from] ProfileError),
    #[error("{file}: {reason}")]
    Simulation { file: String, reason: NoCourse },
}
