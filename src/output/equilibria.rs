//! The tables of a branch of equilibria.

use super::layout::{self, EIGENVALUES};
use super::orbits::first_broken;
use super::render::Format;
use super::run::{Headers, Lines, Recorded, Restart};
use crate::affine::equilibrium::EquilibriumCurve;
use crate::hybrid::equilibrium::row::{
    EquilibriumEigenvalueRow, EquilibriumEventRow, EquilibriumRow,
};
use crate::hybrid::equilibrium::{EquilibriumItem, EquilibriumRunner, LabelledEquilibrium};
use crate::problem::SystemProblem;
use crate::table;

/// Content of `branch.ron` of a branch of equilibria.
pub(crate) type Equilibria = Restart<EquilibriumRunner>;

impl Recorded for EquilibriumRunner {
    type Problem = SystemProblem;
    type Saved = LabelledEquilibrium;

    fn headers(problem: &SystemProblem) -> Headers {
        let source = &problem.system.source;
        let monitors = || problem.monitor.names();
        let branch = table::columns(&EquilibriumRow::columns(source, monitors()));
        let events = table::columns(&EquilibriumEventRow::columns(source, monitors()));
        Headers {
            branch: table::line_of(&branch),
            events: table::line_of(&events),
            spectrum: Some((EIGENVALUES, table::header::<EquilibriumEigenvalueRow>())),
            pictures: layout::pictures_of_orbits(problem, Format::Svg),
        }
    }

    fn lines(problem: &SystemProblem, item: &EquilibriumItem) -> Lines<LabelledEquilibrium> {
        let source = &problem.system.source;
        let event = item.event.as_ref();
        let saved = item.saved.as_ref();
        Lines {
            branch: table::line(&EquilibriumRow::new(source, &item.point)),
            event: event.map(|event| table::line(&EquilibriumEventRow::new(source, event))),
            spectrum: item.spectrum.iter().map(table::line).collect(),
            // an equilibrium has no profile
            kept: saved.map(|saved| (saved.clone(), saved.label, None)),
        }
    }

    fn label(saved: &LabelledEquilibrium) -> usize {
        saved.label
    }

    fn broken(problem: &SystemProblem, saved: &[LabelledEquilibrium]) -> Option<usize> {
        first_broken::<EquilibriumCurve>(problem, saved, |one| one.is_whole(&problem.system))
    }
}
