//! The tables of a branch of equilibria.

use super::layout::{self, EIGENVALUES};
use super::render::Format;
use super::run::{Headers, Lines, Recorded, Restart};
use crate::affine::equilibrium::EquilibriumCurve;
use crate::hybrid::equilibrium::row::{
    EquilibriumEigenvalueRow, EquilibriumEventRow, EquilibriumRow,
};
use crate::hybrid::equilibrium::run::EquilibriumProgress;
use crate::hybrid::equilibrium::{EquilibriumItem, EquilibriumRunner, LabelledEquilibrium};
use crate::orbit::legs;
use crate::problem::SystemProblem;
use crate::table;

/// Content of `branch.ron` of a branch of equilibria.
pub(crate) type Equilibria = Restart<EquilibriumRunner>;

impl Recorded for EquilibriumRunner {
    type Problem = SystemProblem;
    type Progress = EquilibriumProgress;
    type Saved = LabelledEquilibrium;

    fn saved(&self) -> EquilibriumProgress {
        self.state()
    }

    fn legs(progress: &EquilibriumProgress) -> &legs::Progress<EquilibriumCurve> {
        &progress.legs
    }

    fn eigenvalues(progress: &EquilibriumProgress) -> usize {
        progress.eigenvalues
    }

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
            spectrum: item.eigenvalues.iter().map(table::line).collect(),
            // an equilibrium has no profile
            kept: saved.map(|saved| (saved.clone(), saved.label, None)),
        }
    }

    fn label(saved: &LabelledEquilibrium) -> usize {
        saved.label
    }

    /// All equilibria have the parameters of the problem, but for the one they were followed in.
    fn broken(problem: &SystemProblem, saved: &[LabelledEquilibrium]) -> Option<usize> {
        let values = match (problem.earlier_run(), saved.first()) {
            (Some(_), Some(first)) => first.values.clone(),
            _ => problem.values(),
        };
        let followed = problem.parameter();
        saved.iter().position(|one| {
            let pairs = one.values.iter().zip(&values).enumerate();
            let differs = |(index, (own, known)): (usize, (&f64, &f64))| {
                Some(index) != followed && own != known
            };
            !one.is_whole(&problem.system) || pairs.into_iter().any(differs)
        })
    }
}
