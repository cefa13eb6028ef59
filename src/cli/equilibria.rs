//! A problem with equilibria made ready to be run: the equilibrium it restarts from, and the ways its branch can go.

use std::path::Path;

use super::failure::{Exit, Failure};
use super::prepare::{Source, ways};
use crate::hybrid::equilibrium::{EquilibriumRunner, NamedEquilibrium, NoEquilibriumStart};
use crate::output::equilibria::Equilibria;
use crate::output::orbits::kind_of;
use crate::output::origin;
use crate::problem::{Any, Continuation, EquilibriumStart, SystemProblem};

/// A problem with equilibria of a system, read and ready to run.
pub(crate) struct PreparedEquilibrium {
    pub problem: SystemProblem,
    pub continuation: Continuation<String>,
    named: Option<NamedEquilibrium>,
    source: Source,
}

impl PreparedEquilibrium {
    /// The beginning of the branch, or the line of the problem file that keeps it from beginning.
    pub(crate) fn begin(&self) -> Result<EquilibriumRunner, Failure> {
        let begun =
            EquilibriumRunner::begin(&self.problem, &self.continuation, self.named.as_ref());
        begun.map_err(|error: NoEquilibriumStart| {
            let (path, help) = error.about();
            let message = error.to_string();
            self.source.placed(path, message, help, Exit::Numerical)
        })
    }
}

/// The branch of a problem that was read, and the equilibrium it restarts from if it does.
pub(crate) fn ready(
    problem: SystemProblem,
    text: String,
    path: &Path,
) -> Result<PreparedEquilibrium, Failure> {
    let source = Source::new(path.display().to_string(), text);
    let section = problem.continuation(source.text(), source.name())?;
    let mut continuation = section.clone();
    let start = problem.equilibrium.as_ref().map(|section| &section.start);
    let named = match start {
        Some(
            EquilibriumStart::Restart { dir, label } | EquilibriumStart::Switch { dir, label },
        ) => Some(named(
            &problem,
            (dir, *label),
            "equilibrium.start",
            &source,
        )?),
        _ => None,
    };
    let values = match &named {
        Some(named) => named.saved.values.clone(),
        None => problem.values(),
    };
    let first = problem.parameter();
    let first = first.and_then(|index| values.get(index).copied());
    // the other branch at an event goes the way it goes
    if !matches!(start, Some(EquilibriumStart::Switch { .. })) {
        let column = continuation.parameter.clone();
        continuation.toward = ways(&continuation, &column, first, &source)?;
    }
    Ok(PreparedEquilibrium {
        problem,
        continuation,
        named,
        source,
    })
}

/// The equilibrium of a run of the same system, and what it is there, named at a path of the problem; that of an event is one
/// of its own equations only.
pub(super) fn named(
    problem: &SystemProblem,
    (dir, label): (&Path, usize),
    at: &str,
    source: &Source,
) -> Result<NamedEquilibrium, Failure> {
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
    let switch = problem.equilibrium.as_ref();
    let is_event =
        switch.is_none_or(|section| matches!(section.start, EquilibriumStart::Switch { .. }));
    if is_event && !others.is_same(own) {
        return Err(refuse("equilibria of another system"));
    }
    Ok(NamedEquilibrium {
        saved: earlier.labelled(dir, label)?.clone(),
        kind: kind_of(dir, label)?,
    })
}
