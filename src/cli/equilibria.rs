//! A problem with equilibria made ready to be run: the equilibrium it restarts from, and the ways its branch can go.

use std::path::Path;

use super::failure::{VerbExit, VerbFailure};
use super::prepare::{ProblemSource, named_equilibrium, ways};
use crate::hybrid::equilibrium::{EquilibriumRunner, NamedEquilibrium, NoEquilibriumStart};
use crate::problem::{self, Continuation, EquilibriumStart, SystemProblem};

/// A problem with equilibria of a system, read and ready to run.
pub(crate) struct PreparedEquilibrium {
    pub problem: SystemProblem,
    pub continuation: Continuation<String>,
    named: Option<NamedEquilibrium>,
    source: ProblemSource,
}

impl PreparedEquilibrium {
    /// The beginning of the branch, or the line of the problem file that keeps it from beginning.
    pub(crate) fn begin(&self) -> Result<EquilibriumRunner, VerbFailure> {
        self.start().map_err(|error| {
            let (path, help) = error.about();
            let message = error.to_string();
            self.source.placed(path, message, help, VerbExit::Numerical)
        })
    }

    /// The text of the problem file.
    pub(crate) fn text(&self) -> &str {
        self.source.text()
    }

    /// The beginning of the branch.
    pub(crate) fn start(&self) -> Result<EquilibriumRunner, NoEquilibriumStart> {
        EquilibriumRunner::begin(&self.problem, &self.continuation, self.named.as_ref())
    }
}

/// The branch of a problem that was read, and the equilibrium it restarts from if it does.
pub(crate) fn ready(
    problem: SystemProblem,
    text: String,
    path: &Path,
) -> Result<PreparedEquilibrium, VerbFailure> {
    let source = ProblemSource::new(problem::name_of(path), text);
    let section = problem.continuation(source.text(), source.name())?;
    let mut continuation = section.clone();
    let start = problem.equilibrium.as_ref().map(|section| &section.start);
    let named = match start {
        Some(
            EquilibriumStart::Restart { dir, label } | EquilibriumStart::Switch { dir, label },
        ) => {
            let is_event = matches!(start, Some(EquilibriumStart::Switch { .. }));
            let at = ("equilibrium.start", is_event);
            Some(named_equilibrium(&problem, (dir, *label), at, &source)?)
        }
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
