//! A problem made ready to be run: the wave it restarts from, and the ways its branch can go.

use std::path::Path;

use super::failure::{VerbExit, VerbFailure};
use super::options::read;
use super::progress::{ProgressLine, drive};
use crate::branch::SavedWave;
use crate::branch::run::{RunError, WaveRunner};
use crate::hybrid::equilibrium::{EquilibriumRunner, NamedEquilibrium, NoEquilibriumStart};
use crate::hybrid::{self, EarlierPoint, NamedOrbit, NoFirstPoint};
use crate::orbit::EventType;
use crate::orbit::legs::{Run, RunEnd};
use crate::output::attractors::SavedAttractors;
use crate::output::equilibria::Equilibria;
use crate::output::orbits::{Orbits, kind_of};
use crate::output::origin;
use crate::output::store::Checkpoint as _;
use crate::output::waves::{self, Waves};
use crate::problem::{
    self, Any, Continuation, EquilibriumStart, Expectation, OrbitStart, Problem, ProblemError,
    Start, SystemProblem, Toward,
};

/// A problem read and ready to run.
pub(crate) struct Prepared {
    pub problem: Problem,
    pub continuation: Continuation,
    pub restart: Option<SavedWave>,
    pub source: ProblemSource,
}

impl Prepared {
    /// The beginning of the branch, with the search for its first wave shown.
    pub(crate) fn start(&self, quiet: bool, problem: &Problem) -> Result<WaveRunner, RunError> {
        let progress = ProgressLine::new(quiet);
        WaveRunner::begin_watched(
            problem,
            &self.continuation,
            self.restart.as_ref(),
            &mut |walk| {
                progress.show(walk.part(), walk.to_string());
            },
        )
    }

    /// The same, with the line of the problem file that keeps it from beginning.
    pub(crate) fn begin(&self, quiet: bool) -> Result<WaveRunner, VerbFailure> {
        let begun = self.start(quiet, &self.problem);
        begun.map_err(|error| self.source.place(error))
    }
}

/// Follows a branch to its end. `take` has the points of every step, and says where the branch is.
pub(crate) fn follow<R: Run>(
    quiet: bool,
    branch: &mut R,
    mut take: impl FnMut(Vec<R::Item>, &R) -> Result<String, VerbFailure>,
) -> Result<(), VerbFailure> {
    drive(quiet, || {
        if branch.progress().end.is_some() {
            return Ok(None);
        }
        let items = branch.step();
        let words = take(items, branch)?;
        Ok(Some((branch.position(), words)))
    })
}

/// Why a branch ended before its range, if it did.
pub(crate) fn early_end(branch: &impl Run) -> Option<String> {
    match &branch.progress().end {
        Some(RunEnd::Failed(reason)) => {
            Some(format!("the branch ended before its range: {reason}"))
        }
        _ => None,
    }
}

/// The file of a problem, for messages that point into it.
pub(crate) struct ProblemSource {
    name: String,
    text: String,
}

impl ProblemSource {
    /// The text of a file.
    pub(crate) fn new(name: String, text: String) -> ProblemSource {
        ProblemSource { name, text }
    }

    /// The text of the file.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// A refusal of what stands at a path.
    pub(crate) fn refuse(&self, path: &str, message: String, help: &str) -> VerbFailure {
        self.refusal(path, message, help).into()
    }

    fn refusal(&self, path: &str, message: String, help: &str) -> ProblemError {
        problem::refuse_at(&self.text, &self.name, path, message, help)
    }

    /// The same with an exit code of its own.
    pub(crate) fn placed(
        &self,
        path: &str,
        message: String,
        help: &str,
        exit: VerbExit,
    ) -> VerbFailure {
        VerbFailure::Placed(self.refusal(path, message, help), exit)
    }

    /// What ends a run before it begins, with the line it is about if there is one.
    pub(crate) fn place(&self, error: RunError) -> VerbFailure {
        match error.about() {
            None => error.into(),
            Some((path, help)) => {
                let message = error.to_string();
                let place = self.refusal(path, message, help);
                VerbFailure::Placed(place, VerbFailure::Run(error).exit())
            }
        }
    }

    /// What ends a run of orbits before it begins, with the line it is about.
    pub(crate) fn place_orbit(&self, error: &NoFirstPoint) -> VerbFailure {
        let (path, help) = error.about();
        let exit = match error {
            NoFirstPoint::NotBranching { .. } | NoFirstPoint::LabelOutside { .. } => {
                VerbExit::BadInput
            }
            _ => VerbExit::Numerical,
        };
        self.placed(path, error.to_string(), help, exit)
    }

    /// The run of a folder to restart from, which must hold waves of this mode.
    pub(crate) fn restart(&self, dir: &Path, mode: u32) -> Result<Waves, VerbFailure> {
        let earlier = Waves::read(dir)?;
        let known = earlier.problem.wave.mode;
        if known != mode {
            let message = format!(
                "{} holds waves of mode {known}, not of mode {mode}",
                dir.display()
            );
            let help = format!("write `mode: {known}`, or name another folder");
            return Err(self.refuse("wave.mode", message, &help));
        }
        Ok(earlier)
    }

    /// Refuses a label at which no wave of this mode, of twice the wavelength, branches off.
    fn doubling(&self, dir: &Path, label: usize, mode: u32) -> Result<(), VerbFailure> {
        let event = waves::labelled(dir, label)?;
        if event.kind == EventType::BP && event.sector == mode as usize {
            return Ok(());
        }
        let message = format!(
            "label {label} of {} is a {} of sector {}: waves of twice the wavelength branch off at a BP of sector {mode}",
            dir.display(),
            event.kind,
            event.sector
        );
        Err(self.refuse(
            "wave.start.label",
            message,
            "name such a label, `events.csv` lists them",
        ))
    }
}

/// Reads a problem file, and the wave it restarts from if it does.
pub(crate) fn prepare(path: &Path) -> Result<Prepared, VerbFailure> {
    let (problem, text) = read(path)?;
    ready(problem, text, path)
}

/// The branch of a problem that was read, and the wave it restarts from if it does.
pub(crate) fn ready(problem: Problem, text: String, path: &Path) -> Result<Prepared, VerbFailure> {
    let source = ProblemSource::new(problem::name_of(path), text);
    let mut continuation = problem.continuation(&source.text, &source.name)?.clone();
    let mut restart = None;
    if let Some((dir, label)) = problem.wave.start.label() {
        let doubles = matches!(problem.wave.start, Start::Switch { .. });
        let earlier = source.restart(dir, problem.wave.mode * if doubles { 2 } else { 1 })?;
        let wave = earlier.labelled(dir, label)?.clone();
        if doubles {
            source.doubling(dir, label, problem.wave.mode)?;
        }
        let law = problem.model.law;
        let other = std::mem::discriminant(&law) != std::mem::discriminant(&wave.model.law);
        if other && problem::says(&source.text, "model.friction_law") {
            let message = format!(
                "label {label} of {} was computed under another friction law",
                dir.display()
            );
            let help = "leave out `friction_law`: a restart brings its own";
            return Err(source.refuse("model.friction_law", message, help));
        }
        restart = Some(wave);
    }
    let parameter = continuation.parameter;
    continuation.toward = match (&problem.wave.start, &restart) {
        // there are waves on one side of it only
        (Start::Hopf, _) => Toward::beyond_hopf(parameter),
        // the other branch at an event goes the way it goes
        (Start::Switch { .. }, _) => continuation.toward,
        (_, Some(wave)) => {
            let first = wave.model.value(parameter);
            ways(&continuation, parameter.column(), first, &source)?
        }
        _ => {
            let first = problem.model.value(parameter);
            ways(&continuation, parameter.column(), first, &source)?
        }
    };
    Ok(Prepared {
        problem,
        continuation,
        restart,
        source,
    })
}

/// A problem with a system of one's own, read and ready to run; `N` is a point of an earlier run.
pub(crate) struct PreparedSystem<N = EarlierPoint> {
    pub problem: SystemProblem,
    pub continuation: Continuation<String>,
    pub named: Option<N>,
    pub source: ProblemSource,
}

impl<N> PreparedSystem<N> {
    /// A problem that begins at a point of an earlier run, with these values of the parameters, or anew.
    fn new(
        problem: SystemProblem,
        source: ProblemSource,
        named: Option<N>,
        values: impl FnOnce(&N) -> &[f64],
        is_switch: bool,
    ) -> Result<PreparedSystem<N>, VerbFailure> {
        let mut continuation = problem.continuation(&source.text, &source.name)?.clone();
        let values = named
            .as_ref()
            .map_or_else(|| problem.values(), |named| values(named).to_vec());
        let first = problem.parameter();
        let first = first.and_then(|index| values.get(index).copied());
        // the other branch at an event goes the way it goes
        if !is_switch {
            let column = continuation.parameter.clone();
            continuation.toward = ways(&continuation, &column, first, &source)?;
        }
        Ok(PreparedSystem {
            problem,
            continuation,
            named,
            source,
        })
    }

    /// What is expected of the branch, and the parameter that it is followed in.
    pub(crate) fn expected(&self) -> (&[Expectation], &str) {
        (&self.problem.expect, &self.continuation.parameter)
    }
}

impl PreparedSystem {
    /// The beginning of the branch, or the line of the problem file that keeps it from beginning.
    pub(crate) fn begin(&self) -> Result<hybrid::OrbitRunner, VerbFailure> {
        let begun = self.start(&self.problem);
        begun.map_err(|error| self.source.place_orbit(&error))
    }

    /// The same for the problem with other settings.
    pub(crate) fn start(
        &self,
        problem: &SystemProblem,
    ) -> Result<hybrid::OrbitRunner, NoFirstPoint> {
        hybrid::OrbitRunner::begin(problem, &self.continuation, self.named.as_ref())
    }
}

impl PreparedSystem<NamedEquilibrium> {
    /// The beginning of the branch, or the line of the problem file that keeps it from beginning.
    pub(crate) fn begin(&self) -> Result<EquilibriumRunner, VerbFailure> {
        self.start().map_err(|error| {
            let (path, help) = error.about();
            let message = error.to_string();
            self.source.placed(path, message, help, VerbExit::Numerical)
        })
    }

    /// The beginning of the branch.
    pub(crate) fn start(&self) -> Result<EquilibriumRunner, NoEquilibriumStart> {
        EquilibriumRunner::begin(&self.problem, &self.continuation, self.named.as_ref())
    }
}

/// The branch of a problem with a system that was read, and the orbit it restarts from if it does.
pub(crate) fn ready_system(
    problem: SystemProblem,
    text: String,
    path: &Path,
) -> Result<PreparedSystem, VerbFailure> {
    let source = ProblemSource::new(problem::name_of(path), text);
    problem.continuation(&source.text, &source.name)?;
    let start = &problem.orbit.start;
    let named = match start {
        OrbitStart::Restart { dir, label } | OrbitStart::Switch { dir, label } => {
            let is_event = matches!(start, OrbitStart::Switch { .. });
            Some(match holds_equilibria(dir) && is_event {
                true => {
                    let place = (dir.as_path(), *label);
                    let at = ("orbit.start", true);
                    let earlier = named_equilibrium(&problem, place, at, &source)?;
                    EarlierPoint::Equilibrium(earlier)
                }
                false => EarlierPoint::Orbit(named(&problem, dir, *label, is_event, &source)?),
            })
        }
        OrbitStart::Nowhere | OrbitStart::Simulate { .. } | OrbitStart::Given { .. } => None,
    };
    let is_switch = matches!(start, OrbitStart::Switch { .. });
    PreparedSystem::new(problem, source, named, EarlierPoint::values, is_switch)
}

/// The branch of a problem with equilibria that was read, and the equilibrium it restarts from if it does.
pub(crate) fn ready_equilibrium(
    problem: SystemProblem,
    text: String,
    path: &Path,
) -> Result<PreparedSystem<NamedEquilibrium>, VerbFailure> {
    let source = ProblemSource::new(problem::name_of(path), text);
    problem.continuation(&source.text, &source.name)?;
    let start = problem.equilibrium.as_ref().map(|section| &section.start);
    let is_switch = matches!(start, Some(EquilibriumStart::Switch { .. }));
    let named = match start {
        Some(
            EquilibriumStart::Restart { dir, label } | EquilibriumStart::Switch { dir, label },
        ) => {
            let at = ("equilibrium.start", is_switch);
            Some(named_equilibrium(&problem, (dir, *label), at, &source)?)
        }
        _ => None,
    };
    PreparedSystem::new(problem, source, named, NamedEquilibrium::values, is_switch)
}

/// Whether a folder is that of a branch of equilibria.
fn holds_equilibria(dir: &Path) -> bool {
    let earlier = origin::problem(dir);
    matches!(earlier, Ok(Some(Any::System(other))) if other.equilibrium.is_some())
}

/// The orbit of a run of the same system, and what it is there; where that counts its equations must be the same, too.
pub(crate) fn named(
    problem: &SystemProblem,
    dir: &Path,
    label: usize,
    is_event: bool,
    source: &ProblemSource,
) -> Result<NamedOrbit, VerbFailure> {
    let others = match origin::problem(dir) {
        Ok(Some(Any::Tube(_))) => Some("waves of a tube, not orbits of a system"),
        _ if holds_equilibria(dir) => Some("equilibria, not orbits of a system"),
        _ => None,
    };
    if let Some(others) = others {
        let message = format!("{} holds {others}", dir.display());
        return Err(source.refuse("orbit.start", message, "name another folder"));
    }
    let belongs = |earlier: &SystemProblem| {
        let (own, others) = (&problem.system.source, &earlier.system.source);
        let refuse = |what: &str| {
            let message = format!("{} holds orbits {what}", dir.display());
            Err(source.refuse("orbit.start", message, "name another folder"))
        };
        if others.states != own.states {
            return refuse("with other states");
        }
        if !others.parameters.names().eq(own.parameters.names()) {
            return refuse("of a system with other parameters");
        }
        // an event is one of its own equations only
        if is_event && !others.is_same(own) {
            return refuse("of another system");
        }
        Ok(())
    };
    if dir.join(SavedAttractors::FILE).exists() {
        let earlier = SavedAttractors::read(dir)?;
        belongs(&earlier.problem)?;
        return Ok(NamedOrbit {
            saved: earlier.labelled(dir, label)?.clone(),
            kind: None,
            has_shrunk: false,
        });
    }
    let earlier = Orbits::read(dir)?;
    belongs(&earlier.problem)?;
    let saved = earlier.labelled(dir, label)?.clone();
    let kind = kind_of(dir, label)?;
    Ok(NamedOrbit {
        has_shrunk: kind == Some(EventType::BP) && saved.has_shrunk(&earlier.labelled),
        saved,
        kind,
    })
}

/// The equilibrium of a run of the same system, and what it is there, named at a path of the problem; where that counts its
/// equations must be the same, too.
pub(super) fn named_equilibrium(
    problem: &SystemProblem,
    (dir, label): (&Path, usize),
    (at, is_event): (&str, bool),
    source: &ProblemSource,
) -> Result<NamedEquilibrium, VerbFailure> {
    let refuse = |what: &str| {
        let message = format!("{} holds {what}", dir.display());
        source.refuse(at, message, "name another folder")
    };
    match origin::problem(dir) {
        Ok(Some(Any::Tube(_))) => return Err(refuse("waves of a tube, not equilibria")),
        Ok(Some(Any::System(other))) if other.equilibrium.is_none() => {
            return Err(refuse("orbits, not equilibria"));
        }
        _ => {}
    }
    let earlier = Equilibria::read(dir)?;
    let (own, others) = (&problem.system.source, &earlier.problem.system.source);
    if others.states != own.states {
        return Err(refuse("equilibria with other states"));
    }
    if !others.parameters.names().eq(own.parameters.names()) {
        return Err(refuse("equilibria of a system with other parameters"));
    }
    // an event is one of its own equations only
    if is_event && !others.is_same(own) {
        return Err(refuse("equilibria of another system"));
    }
    Ok(NamedEquilibrium {
        saved: earlier.labelled(dir, label)?.clone(),
        kind: kind_of(dir, label)?,
    })
}

/// The ways a branch can go from its first point: at an end of the range there is but one.
pub(super) fn ways<P>(
    continuation: &Continuation<P>,
    column: &str,
    first: Option<f64>,
    source: &ProblemSource,
) -> Result<Toward, VerbFailure> {
    let (low, high) = continuation.range;
    let first = first.unwrap_or(f64::NAN);
    match continuation.toward {
        Toward::Both if first == low => Ok(Toward::Up),
        Toward::Both if first == high => Ok(Toward::Down),
        // a problem with its own start has been checked for this; a restart brings its own value
        toward
            if (toward == Toward::Down && first == low)
                || (toward == Toward::Up && first == high) =>
        {
            let message = format!(
                "the branch starts at {} = {first:?}, an end of the range from {low:?} to {high:?} \
                 with nothing beyond",
                column
            );
            let help = "go the other way, or widen the range";
            Err(source.refuse("continuation.toward", message, help))
        }
        toward => Ok(toward),
    }
}
