//! The legs of a run: one branch each way from a first orbit, with numbers of points, labels and events.

use serde::{Deserialize, Serialize};

use super::follow::{BranchState, Follower, Limits, LocatedPoint};
use super::monitor::MonitorStop;
use super::special::{BranchFailure, Ending, ResumeMismatch, Special};
use super::{Data, EventType, Orbit};
use crate::continuation::walk::End as WalkEnd;
use crate::continuation::{Node, Steps};
use crate::linalg::Vector;
use std::sync::Arc;

/// What a run is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Range of the parameter.
    pub range: (f64, f64),
    /// Direction of each leg: whether the parameter grows at first.
    pub directions: Vec<bool>,
    /// Values of the parameter at which a user point is wanted.
    pub stop_at: Vec<f64>,
    /// Values of monitors at which one is wanted, too.
    pub monitors: Vec<MonitorStop>,
    /// Types of events that end the run, each with the occurrence that does.
    pub stop_after: Vec<(EventType, usize)>,
    /// Step lengths and tolerance.
    pub steps: Steps,
    /// Largest number of points of a leg.
    pub most_points: usize,
    /// Equal parts of the range of which the first point of each leg is labelled.
    pub samples: usize,
}

impl Plan {
    /// The same in these ways, if there are any: the other branch at an event has its own.
    pub fn going(mut self, directions: &[bool]) -> Plan {
        if !directions.is_empty() {
            self.directions = directions.to_vec();
        }
        self
    }

    fn limits(&self) -> Limits {
        Limits {
            range: self.range,
            stop_at: self.stop_at.clone(),
            steps: self.steps,
        }
    }
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub enum RunEnd<O: Orbit> {
    /// All that was asked for was done.
    Finished,
    /// The branch ended before its range.
    Failed(BranchFailure<O>),
}

/// The state of a run between two steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Progress<O: Orbit> {
    /// Leg being followed, from 1.
    pub leg: usize,
    /// Points handed out so far.
    pub points: usize,
    /// Labels handed out so far.
    pub labels: usize,
    /// Events handed out so far.
    pub events: usize,
    /// Rows of the table of multipliers or eigenvalues handed out so far.
    pub spectrum_rows: usize,
    /// Points handed out before this leg began: the largest number of points counts from there.
    pub before_leg: usize,
    /// How often each type of [`Plan::stop_after`] has been met.
    pub met: Vec<usize>,
    /// Parts of the range from which this leg has a sample.
    pub passed: Vec<bool>,
    /// First orbit of the run.
    pub first: (O::Signature, Vec<f64>),
    /// State of the branch; `None` before the first step of a leg.
    pub state: Option<BranchState<O::Signature>>,
    /// Reason why an earlier leg ended before its range.
    pub failure: Option<BranchFailure<O>>,
    /// How the run ended; `None` while it goes on.
    pub end: Option<RunEnd<O>>,
}

/// The numbers of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointNumbers {
    /// Running number from 1.
    pub point: usize,
    /// Label from 1, of special points and samples.
    pub label: Option<usize>,
    /// Leg it belongs to, from 1.
    pub leg: usize,
}

/// A step of a leg.
pub struct LegStep<O: Orbit> {
    /// The orbit before it.
    pub orbit: Arc<O>,
    /// Where it set out.
    pub node: Node,
    /// The points found, in order.
    pub found: Vec<LocatedPoint<O>>,
    /// How the leg ended, if it did.
    pub end: Option<Ending<O>>,
}

/// A run leg by leg.
pub struct Legs<O: Orbit> {
    plan: Plan,
    /// The first orbit.
    first: O,
    follower: Follower<O>,
    progress: Progress<O>,
}

impl<O: Orbit> Legs<O> {
    /// Before the first step from a first orbit.
    ///
    /// # Errors
    /// When the branch has no direction there, or its inequalities cannot be evaluated.
    pub fn begin(orbit: O, point: &Vector, plan: Plan) -> Result<Legs<O>, ResumeMismatch<O>> {
        let first = point.iter().copied().collect();
        let progress = Progress {
            leg: 1,
            points: 0,
            labels: 0,
            events: 0,
            spectrum_rows: 0,
            before_leg: 0,
            met: vec![0; plan.stop_after.len()],
            passed: vec![false; plan.samples],
            first: (orbit.signature().clone(), first),
            state: None,
            failure: None,
            end: None,
        };
        Legs::resume(&orbit, progress, plan)
    }

    /// Goes on from saved progress; `orbit` gives everything but the signature.
    ///
    /// # Errors
    /// When the progress is not one that a run of this plan leaves.
    pub fn resume(
        orbit: &O,
        progress: Progress<O>,
        plan: Plan,
    ) -> Result<Legs<O>, ResumeMismatch<O>> {
        let fits = progress.met.len() == plan.stop_after.len()
            && progress.passed.len() == plan.samples
            && progress.first.1.iter().all(|number| number.is_finite());
        if !fits {
            return Err(ResumeMismatch::Progress);
        }
        let first = orbit.posed(progress.first.0.clone());
        let first = first.ok_or(ResumeMismatch::Progress)?;
        Ok(Legs {
            follower: follower(&first, &progress, &plan)?,
            first,
            plan,
            progress,
        })
    }

    /// The state after the last step.
    pub fn progress(&self) -> &Progress<O> {
        &self.progress
    }

    /// All that is needed to go on from here with a run that was asked for these directions.
    pub fn state<B>(&self, requested: &[bool], beside: B) -> RunState<O, B> {
        let directions = &self.plan.directions;
        RunState {
            legs: self.progress.clone(),
            directions: if directions == requested {
                Vec::new()
            } else {
                directions.clone()
            },
            beside,
        }
    }

    /// Whether the next step is the first of a leg.
    pub fn at_beginning(&self) -> bool {
        self.progress.state.is_none()
    }

    /// The point reached.
    pub fn here(&self) -> LocatedPoint<O> {
        self.follower.here()
    }

    /// The first point of a leg, now taken.
    pub fn set_out(&mut self) -> LocatedPoint<O> {
        self.progress.state = Some(self.follower.state());
        LocatedPoint {
            special: Some(Special::Start),
            ..self.follower.here()
        }
    }

    /// Takes one step of the leg.
    pub fn step(&mut self) -> LegStep<O> {
        let orbit = self.follower.curve().orbit.clone();
        let node = self.follower.node().clone();
        let (found, end) = self.follower.step();
        self.progress.state = Some(self.follower.state());
        LegStep {
            orbit,
            node,
            found,
            end,
        }
    }

    /// Numbers a point. A special point serves as the sample of its part of the range.
    pub fn number(&mut self, found: &LocatedPoint<O>) -> PointNumbers {
        let special = found.special.is_some();
        self.progress.points += 1;
        let sampled = self.is_sample(found.parameter);
        let labelled = special || sampled;
        self.progress.labels += usize::from(labelled);
        self.progress.events += usize::from(special);
        PointNumbers {
            point: self.progress.points,
            label: labelled.then_some(self.progress.labels),
            leg: self.progress.leg,
        }
    }

    /// Counts rows of the table of multipliers or eigenvalues that are handed out.
    pub fn count_spectrum(&mut self, rows: usize) {
        self.progress.spectrum_rows += rows;
    }

    /// Whether a point is the first of its leg in one of the equal parts of the range.
    fn is_sample(&mut self, value: f64) -> bool {
        let (low, high) = self.plan.range;
        let count = self.progress.passed.len();
        if count == 0 {
            return false;
        }
        let width = (high - low) / count as f64;
        let cell = ((value - low) / width)
            .floor()
            .clamp(0.0, (count - 1) as f64) as usize;
        !std::mem::replace(&mut self.progress.passed[cell], true)
    }

    /// Whether a point of this type ends the run.
    pub fn stops_at(&mut self, kind: Option<EventType>) -> bool {
        let mut stop = false;
        let entries = self.progress.met.iter_mut().zip(&self.plan.stop_after);
        for (met, (event, count)) in entries {
            if Some(*event) == kind {
                *met += 1;
                stop |= *met >= *count;
            }
        }
        stop
    }

    /// The point that ends a leg that has as many as it may, and that end.
    pub fn at_most_points(&self) -> Option<(LocatedPoint<O>, Ending<O>)> {
        let most = self.plan.most_points;
        if self.progress.points - self.progress.before_leg < most {
            return None;
        }
        let end = WalkEnd::MaxPoints { most };
        let found = LocatedPoint {
            special: Some(Special::Failed(BranchFailure::Ended(Box::new(end.clone())))),
            ..self.follower.here()
        };
        Some((found, end))
    }

    /// Takes note of how a leg ended; `stopped` where the whole run is to.
    pub fn finish(&mut self, end: Option<Ending<O>>, stopped: bool) {
        let closed = end == Some(WalkEnd::Closed);
        let done = |end: &Ending<O>| match end {
            WalkEnd::Edge | WalkEnd::Closed => true,
            WalkEnd::Own(stop) => stop.completes(),
            _ => false,
        };
        if let Some(end) = end.filter(|end| !stopped && !done(end)) {
            let failure = BranchFailure::Ended(Box::new(end));
            self.progress.failure.get_or_insert(failure);
        }
        // a closed branch is the same either way
        if self.progress.leg < self.plan.directions.len() && !stopped && !closed {
            let next = Progress {
                leg: self.progress.leg + 1,
                before_leg: self.progress.points,
                state: None,
                passed: vec![false; self.plan.samples],
                ..self.progress.clone()
            };
            match follower(&self.first, &next, &self.plan) {
                Ok(follower) => {
                    self.follower = follower;
                    self.progress = next;
                    return;
                }
                Err(reason) => {
                    let failure = BranchFailure::NoLeg(reason);
                    self.progress.failure.get_or_insert(failure);
                }
            }
        }
        self.progress.end = Some(match self.progress.failure.clone() {
            Some(reason) => RunEnd::Failed(reason),
            None => RunEnd::Finished,
        });
    }

    /// Share of the way to the ends of the range behind the branch, for progress.
    pub fn position(&self) -> f64 {
        let (low, high) = self.plan.range;
        let directions = &self.plan.directions;
        let leg = self.progress.leg.clamp(1, directions.len().max(1));
        let edge = match directions.get(leg - 1) {
            Some(false) => low,
            _ => high,
        };
        let (_, point) = &self.progress.first;
        let first = point.last().map_or(low, |last| last * self.first.unit());
        let part = (self.follower.here().parameter - first) / (edge - first);
        let behind = (leg - 1) as f64 + part.clamp(0.0, 1.0);
        behind / directions.len() as f64
    }
}

/// All that is needed to go on with a run between two of its steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "B: Data")]
pub struct RunState<O: Orbit, B> {
    /// The legs.
    pub legs: Progress<O>,
    /// Directions of the legs where they are not those of the problem: the other branch at an event has its own.
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    pub directions: Vec<bool>,
    /// What orbits of this kind add.
    pub beside: B,
}

/// A run that is taken step by step, and hands out what it found.
pub trait Run {
    /// The orbits that it follows.
    type Orbit: Orbit;
    /// A point, with all that is told of it.
    type Item;
    /// What it has to remember beside its legs.
    type Beside: Data;

    /// The state of the legs after the last step.
    fn progress(&self) -> &Progress<Self::Orbit>;

    /// All that is needed to go on from here.
    fn state(&self) -> RunState<Self::Orbit, Self::Beside>;

    /// Takes one step and returns the points found; empty once the run has ended.
    fn step(&mut self) -> Vec<Self::Item>;

    /// Share of the way to the ends of the range behind the branch.
    fn position(&self) -> f64;
}

/// The branch of a leg where it is.
fn follower<O: Orbit>(
    first: &O,
    progress: &Progress<O>,
    plan: &Plan,
) -> Result<Follower<O>, ResumeMismatch<O>> {
    let leg = progress.leg.checked_sub(1);
    let up = leg.and_then(|leg| plan.directions.get(leg));
    let up = up.ok_or(ResumeMismatch::Progress)?;
    let (_, point) = &progress.first;
    if point.len() != first.unknowns() {
        return Err(ResumeMismatch::FirstWave);
    }
    let follower = match &progress.state {
        Some(state) => Follower::resume(first, state.clone(), plan.limits())?,
        None => Follower::new(
            first.clone(),
            &Vector::from_vec(point.clone()),
            *up,
            plan.limits(),
        )?,
    };
    Ok(follower.stopping_at(&plan.monitors))
}
