//! Following a branch of waves through all its regimes: a wave as a curve for the walker.
//!
//! Every inequality is watched, every event within a step is met in order, and at a change
//! of regime the successor signature goes on.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::EventType;
use super::change;
use super::change::{Beyond, Both};
use super::events::{self, Event, Located};
use super::special::{Change, Close, Ending, Failure, NoFollower, Refusal, Special, Stop};
use crate::continuation::locate::{Place, retangent};
use crate::continuation::newton::System;
use crate::continuation::walk::{self, Beginning, Curve, Outcome, Segment, Walker, Within};
use crate::continuation::{Node, Steps};
use crate::linalg::Vector;
use crate::model::Parameter;
use crate::model::signature::{Regime, Signature};
use crate::wave::Wave;
use crate::wave::admissibility::{Examination, Margin, Watch, examine};

/// How far to follow a branch, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Range of the continuation parameter.
    pub range: (f64, f64),
    /// User points.
    pub stop_at: Vec<f64>,
    /// Step lengths and tolerance.
    pub steps: Steps,
}

impl Limits {
    /// With every user point once, in order: a step then looks at those within it only.
    fn ordered(mut self) -> Limits {
        self.stop_at.sort_by(f64::total_cmp);
        self.stop_at.dedup();
        self
    }
}

/// A point found, in order along the branch.
#[derive(Clone, Debug)]
pub struct Found {
    /// Boundary-value problem before the point.
    pub wave: Arc<Wave>,
    /// Arclength from the beginning of the step.
    pub s: f64,
    /// Boundary-value problem beyond a change of regime, and the point in its unknowns.
    pub entered: Option<(Arc<Wave>, Node)>,
    /// Value of the continuation parameter: exactly the one asked for at user points and edges.
    pub parameter: f64,
    /// The point.
    pub node: Node,
    /// Its margins, extrema and verdict.
    pub examination: Examination,
    /// What makes it special, if anything does.
    pub special: Option<Special>,
    /// Estimated error of the parameter of a special point.
    pub uncertainty: f64,
    /// What comes so close to zero, here or on the way from the point before, that rounding decides.
    pub close: Option<Close>,
}

impl Found {
    /// A point without an event.
    pub(super) fn new(wave: &Arc<Wave>, s: f64, node: &Node, examination: &Examination) -> Found {
        Found {
            wave: wave.clone(),
            s,
            entered: None,
            parameter: wave.parameter_at(&node.point),
            node: node.clone(),
            examination: examination.clone(),
            special: None,
            uncertainty: 0.0,
            close: None,
        }
    }

    /// Its type, if it is special.
    pub fn kind(&self) -> Option<EventType> {
        self.special.as_ref().map(Special::kind)
    }
}

/// The state of a branch between two steps: all that its continuation depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Signature.
    pub signature: Signature,
    /// Scaled unknowns.
    pub point: Vec<f64>,
    /// Unit tangent.
    pub tangent: Vec<f64>,
    /// Length of the next step.
    pub ds: f64,
    /// Direction of the parameter along the branch: +1 or −1.
    pub heading: f64,
    /// Scaled unknowns of the first point, its signature and tangent: a closed branch comes back.
    pub origin: (Signature, Vec<f64>, Vec<f64>),
    /// Arclength since the first point.
    pub travelled: f64,
    /// Steps in a row that creep.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub creeping: usize,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Waves of one signature as a curve in the continuation parameter.
#[derive(Clone, Debug)]
pub struct Branch {
    /// Their boundary-value problem.
    pub wave: Arc<Wave>,
    limits: Arc<Limits>,
    /// Direction of the parameter: +1 or −1.
    heading: f64,
}

/// A branch being followed.
pub type Follower = Walker<Branch>;

impl Walker<Branch> {
    /// Starts at a solved point; `up` is the direction of the parameter.
    ///
    /// # Errors
    /// When the point is a fold, or its inequalities cannot be evaluated.
    pub fn new(
        wave: Wave,
        point: &Vector,
        up: bool,
        limits: Limits,
    ) -> Result<Follower, NoFollower> {
        let last = wave.unknowns() - 1;
        let heading = if up { 1.0 } else { -1.0 };
        let mut along = Vector::zeros(last + 1);
        along[last] = heading;
        let node = retangent(&wave, point, &along, 0).ok_or(NoFollower::Fold)?;
        let steps = limits.steps;
        let branch = Branch {
            wave: Arc::new(wave),
            limits: Arc::new(limits.ordered()),
            heading,
        };
        Ok(Walker::begin(branch, node, steps)?)
    }

    /// Goes on from a saved state. `wave` gives model, mode and scales.
    ///
    /// # Errors
    /// When the state does not fit, or its inequalities cannot be evaluated.
    pub fn resume(wave: &Wave, state: State, limits: Limits) -> Result<Follower, NoFollower> {
        let of = |signature: &Signature, point: Vec<f64>, tangent: Vec<f64>| {
            let lists = [&point, &tangent];
            let fits = !signature.is_empty()
                && lists.iter().all(|list| {
                    list.len() == wave.with_signature(signature.clone()).unknowns()
                        && list.iter().all(|number| number.is_finite())
                });
            let node = Node::at(Vector::from_vec(point), Vector::from_vec(tangent));
            fits.then_some(node).ok_or(NoFollower::Saved)
        };
        let node = of(&state.signature, state.point, state.tangent)?;
        let (signature, point, tangent) = state.origin;
        let first = of(&signature, point, tangent)?;
        let numbers = [state.ds, state.heading, state.travelled];
        if !numbers.iter().all(|number| number.is_finite()) {
            return Err(NoFollower::Saved);
        }
        let steps = limits.steps;
        let branch = Branch {
            wave: Arc::new(wave.with_signature(state.signature)),
            limits: Arc::new(limits.ordered()),
            heading: state.heading,
        };
        Ok(Walker {
            ds: state.ds,
            origin: (signature, first),
            travelled: state.travelled,
            creeping: state.creeping,
            ..Walker::begin(branch, node, steps)?
        })
    }

    /// The state to resume from.
    pub fn state(&self) -> State {
        let list = |vector: &Vector| vector.iter().copied().collect::<Vec<f64>>();
        let (signature, first) = &self.origin;
        State {
            signature: self.curve.wave.signature.clone(),
            point: list(&self.node.point),
            tangent: list(&self.node.tangent),
            ds: self.ds.clamp(self.steps.ds_min, self.steps.ds_max),
            heading: self.curve.heading,
            origin: (signature.clone(), list(&first.point), list(&first.tangent)),
            travelled: self.travelled,
            creeping: self.creeping,
        }
    }
}

/// The first step tried into a new wave is at least this part of the first step of all, however close two
/// events lie: what opens like the square of a duration is lost in rounding where that is 1e-8.
const INTO: f64 = 1e-2;

/// Excess speed |c|/√a − 1 below which a branch may be seen to tend to √a, and how little everything
/// else changes then while it falls by the factor e.
const SONIC: f64 = 1e-4;
const SETTLED: f64 = 1e-3;

impl Curve for Branch {
    type System = Wave;
    type Name = Signature;
    type Watched = Examination;
    type Event = Located;
    type Found = Found;
    type Refusal = Refusal;
    type End = Stop;
    type Close = Close;

    const CREEP: (usize, f64) = (40, 1e-5);

    fn system(&self) -> &Wave {
        &self.wave
    }

    fn name(&self) -> &Signature {
        &self.wave.signature
    }

    fn watch(&self, node: &Node, _: Option<&Examination>) -> Result<Examination, Refusal> {
        Ok(examine(&self.wave, &node.point)?)
    }

    fn may_hide_a_pair(&self, step: &Segment<Examination>) -> bool {
        events::may_hide_a_pair(&self.wave, step)
    }

    fn within(&self, step: &Segment<Examination>, located: &[(Place, Located)]) -> Within<Close> {
        events::within(&self.wave, step, located)
    }

    fn doubted(&self, found: Found, close: Close) -> Found {
        Found {
            close: Some(close),
            ..found
        }
    }

    fn locate(&self, step: &Segment<Examination>) -> Result<Vec<(Place, Located)>, Refusal> {
        events::located(&self.wave, self.limits.range, &self.limits.stop_at, step)
    }

    fn meet(
        &self,
        step: &Segment<Examination>,
        place: &Place,
        together: &[Located],
    ) -> Result<Outcome<Branch>, Refusal> {
        let Located { event, uncertainty } = together[0];
        let examination = examine(&self.wave, &place.node.point)?;
        // nothing may have failed before: another event would have come first
        if !events::holds(place, &examination) {
            return Err(Refusal::Order);
        }
        let mut found = Found {
            uncertainty,
            ..self.point(place.s, &place.node, &examination)
        };
        let parameter = self.wave.parameter;
        // an inequality that fails by no more than rounding
        let mut fails = examination.margins.iter();
        let fails = fails.find(|margin| margin.jet.value <= 0.0);
        if !matches!(event, Event::Change(_)) {
            found.close = fails.map(|margin| Close::margin(&self.wave, margin));
        }
        match event {
            Event::Fold => found.special = Some(Special::Fold(parameter)),
            Event::User(value) => {
                found.parameter = value;
                found.special = Some(Special::User(parameter, value));
            }
            Event::Edge(value) => {
                found.parameter = value;
                let lands = self.wave.signature.has(Regime::Separation);
                found.special = Some(match parameter {
                    Parameter::StiffnessDamping if lands && value == 0.0 => Special::CoulombLimit,
                    _ => Special::Edge(parameter, value),
                });
                return Ok(Outcome::Ended(vec![found], walk::End::Edge));
            }
            Event::Change(margin) if margin.watch == Watch::Coupling => {
                let end = walk::End::Own(Stop::Against);
                found.special = Some(failed(&end));
                return Ok(Outcome::Ended(vec![found], end));
            }
            Event::Change(_) => {
                // several margins may vanish at one event: the table is asked for each. At the stiff
                // end rounding keeps their zeros apart, or one of them from being located
                let seen = together.iter().filter_map(|located| match located.event {
                    Event::Change(margin) => Some(margin),
                    _ => None,
                });
                let vanished = examination.margins.iter().filter(|margin| {
                    let beyond = step.after.find(margin.watch, margin.zone);
                    margin.jet.value.abs() <= events::rounding(place, margin)
                        && beyond.is_some_and(|beyond| beyond.jet.value <= 0.0)
                });
                let mut margins: Vec<Margin> = seen.chain(vanished.copied()).collect();
                // a zone without length says most about what comes next
                margins.sort_by_key(|margin| margin.watch != Watch::Duration);
                return Ok(self.change(found, &margins, step));
            }
        }
        Ok(Outcome::Passed(found))
    }

    fn arrive(&mut self, node: &Node) {
        if node.tangent[node.tangent.len() - 1] * self.heading < 0.0 {
            self.heading = -self.heading;
        }
    }

    fn point(&self, s: f64, node: &Node, examination: &Examination) -> Found {
        Found::new(&self.wave, s, node, examination)
    }

    fn closing(&self, s: f64, first: &Node, reached: Found) -> Found {
        let examination = examine(&self.wave, &first.point).unwrap_or(reached.examination);
        Found {
            special: Some(Special::Closed),
            ..self.point(s, first, &examination)
        }
    }

    /// D = 0; or the branch has no end in the range as its speed tends to √a: ln(|c|/√a − 1) falls
    /// without bound and everything else tends to a limit, as a power of the excess speed.
    fn exhausted(&self, node: &Node) -> Option<Stop> {
        let Node { point, tangent, .. } = node;
        if events::is_undriven(&self.wave, point) {
            return Some(Stop::Undriven);
        }
        let last = point.len() - 1;
        let excess = self.wave.excess_at(point);
        // change per e-fold of the excess speed: of everything, and of the parameter
        let fall = -tangent[last - 1];
        let rest = (1.0 - fall * fall).max(0.0).sqrt();
        let drift = tangent[last].abs() * self.wave.scales.parameter;
        let value = self.wave.parameter_at(point);
        let (low, high) = self.limits.range;
        let room = (value - low).min(high - value).min(value.abs());
        let sonic = fall > 0.0 && excess < SONIC && rest < SETTLED && drift < SETTLED * room;
        sonic.then_some(Stop::Sonic {
            excess,
            parameter: self.wave.parameter,
            value,
        })
    }

    fn last(&self, end: &Ending, here: Found) -> Option<Found> {
        Some(Found {
            special: Some(failed(end)),
            ..here
        })
    }
}

fn failed(end: &Ending) -> Special {
    Special::Failed(Failure::Ended(Box::new(end.clone())))
}

impl Branch {
    /// A change of regime: the event, and the branch beyond it.
    fn change(
        &self,
        mut found: Found,
        margins: &[Margin],
        step: &Segment<Examination>,
    ) -> Outcome<Branch> {
        let ds = step.ds.clamp(INTO * step.steps.ds, step.steps.ds);
        let point = &found.node.point;
        let search =
            |margin: &Margin| change::beyond(&self.wave, point, margin, ds, step.steps.tolerance);
        let mut margin = margins[0];
        let mut search_there = search(&margin);
        for other in &margins[1..] {
            if search_there.beyond.is_some() {
                break;
            }
            let found = search(other);
            if found.beyond.is_some() {
                (margin, search_there) = (*other, found);
            }
        }
        let mut passed = Vec::new();
        if search_there.beyond.is_none()
            && let Some(both) =
                change::beyond_both(&self.wave, &found.node, margins, ds, step.steps.tolerance)
        {
            margin = both.second;
            let second = self.second(&mut found, &both);
            passed.push(std::mem::replace(&mut found, second));
            search_there = both.search;
        }
        let change::Search {
            beyond,
            refused,
            others,
        } = search_there;
        let after = beyond.as_ref().map(|beyond| beyond.wave.signature.clone());
        let mut change = Change {
            others,
            ..Change::new(&found.wave.signature, after, margin)
        };
        let Some(Beyond { wave, node, ds }) = beyond else {
            let stop = change::ending(&self.wave, &found.node.point, &margin, refused);
            change.end = Some(stop.clone());
            let at_hopf = stop == Stop::SlipAlone;
            let end = walk::End::Own(stop);
            found.special = Some(Special::Change(Box::new(change)));
            // no failure: the waves that are left all have this value of the parameter
            if at_hopf {
                return Outcome::Ended(vec![found], end);
            }
            let failure = Found {
                special: Some(failed(&end)),
                ..found.clone()
            };
            return Outcome::Ended(vec![found, failure], end);
        };
        let watched = match examine(&wave, &node.point) {
            Ok(watched) => watched,
            Err(error) => {
                found.special = Some(Special::Change(Box::new(change)));
                passed.push(found);
                return Outcome::Ended(passed, walk::End::Own(Stop::Flow(error)));
            }
        };
        let drift = node.tangent[node.tangent.len() - 1];
        change.turned_back = drift * self.heading < 0.0 && !events::is_vertical(&wave, &node);
        let wave = Arc::new(wave);
        let curve = Branch {
            wave: wave.clone(),
            limits: self.limits.clone(),
            heading: if change.turned_back {
                -self.heading
            } else {
                self.heading
            },
        };
        found.entered = Some((wave, node.clone()));
        found.special = Some(Special::Change(Box::new(change)));
        let entry = Beginning {
            curve,
            node,
            watched,
            ds: ds.max(step.steps.ds_min),
        };
        passed.push(found);
        Outcome::Entered(passed, entry)
    }

    /// The second of two changes of regime at the place of the first, which leads to the wave in between.
    fn second(&self, first: &mut Found, both: &Both) -> Found {
        let between = Arc::new(both.between.clone());
        let after = Some(between.signature.clone());
        let change = Change::new(&self.wave.signature, after, both.first);
        first.special = Some(Special::Change(Box::new(change)));
        first.entered = Some((between.clone(), both.node.clone()));
        let examination = examine(&between, &both.node.point);
        let examination = examination.unwrap_or_else(|_| first.examination.clone());
        let drift = first.node.tangent[first.node.tangent.len() - 1].abs();
        Found {
            uncertainty: first.uncertainty + both.distance * drift * between.scales.parameter,
            ..Found::new(&between, first.s, &both.node, &examination)
        }
    }
}
