//! The pipeline from a problem to a branch of a user's system: legs, points, labels and events. Orbits and equilibria
//! differ in where they begin and in what they tell of a point.

use super::begin::plan;
use crate::continuation::Node;
use crate::linalg::Vector;
use crate::orbit::follow::LocatedPoint;
use crate::orbit::legs::{Legs, PointNumbers, Progress, Run, RunState};
use crate::orbit::special::{Close, ResumeMismatch, Special};
use crate::orbit::{Data, Orbit};
use crate::problem::{Continuation, SystemProblem};

/// What a branch of a user's system consists of, and what results tell of it.
pub trait SystemOrbit: Orbit<Parameter = String> {
    /// Units of the unknowns.
    type Scales: Data;
    /// A row of the branch.
    type Point: Clone;
    /// A row of the events.
    type Event: Clone;
    /// A row of the table of multipliers or eigenvalues.
    type SpectrumRow: Clone;
    /// A labelled point in physical numbers: what a restart needs.
    type Saved: Data;

    /// Units of the unknowns.
    fn scales(&self) -> Self::Scales;

    /// Values of all parameters at a point.
    fn parameters(&self, point: &Vector) -> Vec<f64>;

    /// Values of all parameters at a saved point.
    fn saved_parameters(saved: &Self::Saved) -> &[f64];

    /// The boundary-value problem of a saved point in these units, with the monitors of its problem; `None` where the system has
    /// none.
    fn resumed(
        problem: &SystemProblem,
        parameter: &str,
        saved: &Self::Saved,
        scales: Self::Scales,
    ) -> Option<Self>;

    /// The row of a point at these values of the parameters.
    fn point(
        problem: &SystemProblem,
        found: &LocatedPoint<Self>,
        numbers: PointNumbers,
        values: Vec<f64>,
    ) -> Self::Point;

    /// The row of an event.
    fn event(
        problem: &SystemProblem,
        point: &Self::Point,
        special: &Special<Self>,
        found: &LocatedPoint<Self>,
    ) -> Self::Event;

    /// The multipliers or eigenvalues of the point of a label.
    fn spectrum(label: usize, point: &Self::Point) -> Vec<Self::SpectrumRow>;

    /// The point of a label in physical numbers; `None` where these cannot be evaluated.
    fn saved(label: usize, point: &Self::Point, found: &LocatedPoint<Self>) -> Option<Self::Saved>;
}

/// A row of the branch, with what belongs to it.
#[derive(Clone, Debug)]
pub struct SystemItem<O: SystemOrbit> {
    /// The row.
    pub point: O::Point,
    /// The event, at special points.
    pub event: Option<O::Event>,
    /// What makes the point special.
    pub special: Option<Special<O>>,
    /// Multipliers or eigenvalues at labelled points.
    pub spectrum: Vec<O::SpectrumRow>,
    /// The point in physical numbers, at labelled points.
    pub saved: Option<O::Saved>,
    found: LocatedPoint<O>,
}

impl<O: SystemOrbit> SystemItem<O> {
    /// The boundary-value problem, and its scaled unknowns.
    pub fn orbit(&self) -> (&O, &Vector) {
        let Node { point, .. } = &self.found.node;
        (&self.found.orbit, point)
    }
}

/// What could not be settled in a run.
#[derive(Clone, Debug, PartialEq)]
pub enum SystemNote<I> {
    /// What comes so close to zero at a point, or between it and the one before, that rounding decides.
    Close {
        /// Name of the parameter.
        parameter: String,
        /// Its value.
        value: f64,
        /// What.
        what: Close<I>,
    },
}

/// A branch of a user's system being computed from a problem.
pub struct SystemRunner<O: SystemOrbit> {
    problem: SystemProblem,
    continuation: Continuation<String>,
    /// Values of the parameters at the first point: as the problem has them.
    values: Vec<f64>,
    legs: Legs<O>,
    scales: O::Scales,
    notes: Vec<SystemNote<O::Inequality>>,
}

impl<O: SystemOrbit> SystemRunner<O> {
    /// Before the first step from a first point, at which the parameters have these values.
    pub(super) fn set_out(
        (problem, continuation): (&SystemProblem, &Continuation<String>),
        (orbit, point): (O, &Vector),
        values: Vec<f64>,
        directions: &[bool],
    ) -> Result<SystemRunner<O>, ResumeMismatch<O>> {
        let scales = orbit.scales();
        let plan = plan(problem, continuation).going(directions);
        Ok(SystemRunner {
            problem: problem.clone(),
            continuation: continuation.clone(),
            values,
            legs: Legs::begin(orbit, point, plan)?,
            scales,
            notes: Vec::new(),
        })
    }

    /// Goes on from a saved state; `first` is the point of label 1.
    ///
    /// # Errors
    /// When the state is not one that a run of this problem leaves.
    pub fn resume(
        problem: &SystemProblem,
        continuation: &Continuation<String>,
        first: &O::Saved,
        state: RunState<O, O::Scales>,
    ) -> Result<SystemRunner<O>, ResumeMismatch<O>> {
        let scales = state.beside;
        let orbit = O::resumed(problem, &continuation.parameter, first, scales.clone());
        let orbit = orbit.ok_or(ResumeMismatch::Progress)?;
        let plan = plan(problem, continuation).going(&state.directions);
        Ok(SystemRunner {
            problem: problem.clone(),
            continuation: continuation.clone(),
            values: O::saved_parameters(first).to_vec(),
            legs: Legs::resume(&orbit, state.legs, plan)?,
            scales,
            notes: Vec::new(),
        })
    }

    /// What could not be settled so far.
    pub fn notes(&self) -> &[SystemNote<O::Inequality>] {
        &self.notes
    }

    fn parameter_index(&self) -> Option<usize> {
        let parameters = &self.problem.system.source.parameters;
        parameters.index(&self.continuation.parameter)
    }

    /// The first point of a leg.
    fn first(&mut self) -> SystemItem<O> {
        let mut found = self.legs.set_out();
        // the value of the problem, not the scaled unknown's
        let exact = self
            .parameter_index()
            .and_then(|index| self.values.get(index));
        found.parameter = exact.copied().unwrap_or(found.parameter);
        self.item(found)
    }

    /// Ends a leg that has as many points as it may, with an item that says so.
    fn check_points(&mut self, items: &mut Vec<SystemItem<O>>) {
        let Some((found, end)) = self.legs.at_most_points() else {
            return;
        };
        items.push(self.item(found));
        self.legs.finish(Some(end), false);
    }

    /// The item of a point, which is numbered.
    fn item(&mut self, found: LocatedPoint<O>) -> SystemItem<O> {
        if let Some(what) = found.close.clone() {
            self.notes.push(SystemNote::Close {
                parameter: self.continuation.parameter.clone(),
                value: found.parameter,
                what,
            });
        }
        let mut values = found.orbit.parameters(&found.node.point);
        if let Some(index) = self.parameter_index() {
            values[index] = found.parameter;
        }
        let numbers = self.legs.number(&found);
        let point = O::point(&self.problem, &found, numbers, values);
        let label = numbers.label;
        let spectrum = label.map_or_else(Vec::new, |label| O::spectrum(label, &point));
        self.legs.count_spectrum(spectrum.len());
        let special = found.special.clone();
        let event = special.as_ref();
        SystemItem {
            event: event.map(|special| O::event(&self.problem, &point, special, &found)),
            saved: label.and_then(|label| O::saved(label, &point, &found)),
            point,
            special,
            spectrum,
            found,
        }
    }
}

impl<O: SystemOrbit> Run for SystemRunner<O> {
    type Orbit = O;
    type Item = SystemItem<O>;
    type Beside = O::Scales;

    fn progress(&self) -> &Progress<O> {
        self.legs.progress()
    }

    fn state(&self) -> RunState<O, O::Scales> {
        let requested = self.continuation.toward.directions();
        self.legs.state(requested, self.scales.clone())
    }

    fn step(&mut self) -> Vec<SystemItem<O>> {
        let mut items = Vec::new();
        if self.progress().end.is_some() {
            return items;
        }
        if self.legs.at_beginning() {
            items.push(self.first());
            self.check_points(&mut items);
            return items;
        }
        let step = self.legs.step();
        for found in step.found {
            let kind = found.kind();
            items.push(self.item(found));
            if self.legs.stops_at(kind) {
                self.legs.finish(step.end, true);
                return items;
            }
        }
        if step.end.is_some() {
            self.legs.finish(step.end, false);
        } else {
            self.check_points(&mut items);
        }
        items
    }

    fn position(&self) -> f64 {
        self.legs.position()
    }
}
