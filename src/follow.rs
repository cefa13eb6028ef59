//! Following a branch of waves through all its regimes.
//!
//! One step of pseudo-arclength continuation, the proof of every inequality at its end, every
//! event inside it in order, and at a change of regime the successor signature. A
//! numerical failure of any kind inside a step rejects the step; it is repeated at half its length.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::branch::EventType;
use crate::continuation::{self, Node};
use crate::events::{self, Located};
use crate::flow::sign::Verdict;
use crate::linalg::Vector;
use crate::model::signature::Signature;
use crate::newton::System;
use crate::wave::Wave;
use crate::wave::admissibility::{Examination, Margin, Watch, examine};

/// What to follow, and how far.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Range of the continuation parameter.
    pub range: (f64, f64),
    /// User points.
    pub stop_at: Vec<f64>,
    /// Step lengths and tolerance.
    pub continuation: continuation::Settings,
}

impl Settings {
    /// With every user point once, in order: a step then looks at those within it only.
    fn ordered(mut self) -> Settings {
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
    /// Type, if it is special.
    pub kind: Option<EventType>,
    /// Signature beyond the point, where it changes.
    pub after: Option<Signature>,
    /// Estimated error of the parameter of a special point.
    pub uncertainty: f64,
    /// What happened, in words; empty at ordinary points.
    pub what: String,
}

/// Whether the branch goes on.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// It does.
    Going,
    /// It reached an end that was asked for.
    Finished,
    /// It ended before its range, for the reason named.
    Failed(String),
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

/// A branch being followed.
#[derive(Clone, Debug)]
pub struct Follower {
    wave: Arc<Wave>,
    node: Node,
    examination: Examination,
    ds: f64,
    heading: f64,
    origin: (Signature, Node),
    travelled: f64,
    creeping: usize,
    settings: Settings,
}

/// How often a step is halved because a margin might have dipped below zero inside it. Eight
/// halvings resolve dips 2⁻⁸ of a step long.
const HALVINGS_FOR_PAIRS: u32 = 8;

/// A branch has closed when it passes this close to its origin, in units of the last step.
const CLOSED: f64 = 1.0;

impl Follower {
    /// Starts at a solved point; `up` is the direction of the parameter.
    pub fn new(wave: Wave, point: &Vector, up: bool, settings: Settings) -> Result<Self, String> {
        let last = wave.unknowns() - 1;
        let heading = if up { 1.0 } else { -1.0 };
        let mut along = Vector::zeros(last + 1);
        along[last] = heading;
        let node = events::retangent(&wave, point, &along, 0)
            .ok_or("the Newton matrix is singular at the start: the start is a fold")?;
        let examination = examine(&wave, &node.point).map_err(|error| error.to_string())?;
        Ok(Follower {
            ds: settings.continuation.ds,
            origin: (wave.signature.clone(), node.clone()),
            wave: Arc::new(wave),
            node,
            examination,
            heading,
            travelled: 0.0,
            creeping: 0,
            settings: settings.ordered(),
        })
    }

    /// Goes on from a saved state. `wave` gives model, mode and scales.
    pub fn resume(wave: &Wave, state: State, settings: Settings) -> Result<Self, String> {
        let (signature, point, tangent) = state.origin;
        let fits = |signature: &Signature, lists: [&Vec<f64>; 2]| {
            !signature.is_empty()
                && lists.iter().all(|list| {
                    list.len() == wave.with_signature(signature.clone()).unknowns()
                        && list.iter().all(|number| number.is_finite())
                })
        };
        let numbers = [state.ds, state.heading, state.travelled];
        if !fits(&state.signature, [&state.point, &state.tangent])
            || !fits(&signature, [&point, &tangent])
            || !numbers.iter().all(|number| number.is_finite())
        {
            return Err("the saved state does not fit its signature".into());
        }
        let wave = wave.with_signature(state.signature);
        let node = Node {
            point: Vector::from_vec(state.point),
            tangent: Vector::from_vec(state.tangent),
            newton: 0,
            residual: 0.0,
        };
        let examination = examine(&wave, &node.point).map_err(|error| error.to_string())?;
        Ok(Follower {
            wave: Arc::new(wave),
            node,
            examination,
            ds: state.ds,
            heading: state.heading,
            origin: (
                signature,
                Node {
                    point: Vector::from_vec(point),
                    tangent: Vector::from_vec(tangent),
                    newton: 0,
                    residual: 0.0,
                },
            ),
            travelled: state.travelled,
            creeping: state.creeping,
            settings: settings.ordered(),
        })
    }

    /// The state to resume from.
    pub fn state(&self) -> State {
        let list = |vector: &Vector| vector.iter().copied().collect::<Vec<f64>>();
        State {
            signature: self.wave.signature.clone(),
            point: list(&self.node.point),
            tangent: list(&self.node.tangent),
            ds: self.ds,
            heading: self.heading,
            origin: (
                self.origin.0.clone(),
                list(&self.origin.1.point),
                list(&self.origin.1.tangent),
            ),
            travelled: self.travelled,
            creeping: self.creeping,
        }
    }

    /// Boundary-value problem and point from which the next step sets out.
    pub fn from(&self) -> (&Arc<Wave>, &Node) {
        (&self.wave, &self.node)
    }

    /// The point the branch has reached.
    pub fn here(&self) -> Found {
        Found {
            wave: self.wave.clone(),
            s: 0.0,
            entered: None,
            parameter: self.wave.parameter_at(&self.node.point),
            node: self.node.clone(),
            examination: self.examination.clone(),
            kind: None,
            after: None,
            uncertainty: 0.0,
            what: String::new(),
        }
    }

    /// Takes one step. Returns the points found, in order, and whether the branch goes on.
    pub fn step(&mut self) -> (Vec<Found>, Status) {
        let limits = self.settings.continuation;
        let mut ds = self.ds.clamp(limits.ds_min, limits.ds_max);
        let mut halvings = 0;
        loop {
            match self.attempt(ds, halvings < HALVINGS_FOR_PAIRS) {
                Ok(result) => return result,
                Err(reason) => {
                    if ds <= limits.ds_min {
                        return self.fail(reason.0);
                    }
                    if reason.1 {
                        halvings += 1;
                    }
                    ds = (0.5 * ds).max(limits.ds_min);
                }
            }
        }
    }

    fn fail(&self, reason: String) -> (Vec<Found>, Status) {
        let what = format!(
            "no step of at least ds_min = {:e} succeeds: {reason}",
            self.settings.continuation.ds_min
        );
        let found = Found {
            kind: Some(EventType::MX),
            what: what.clone(),
            ..self.here()
        };
        (vec![found], Status::Failed(what))
    }

    /// One step of length `ds`. An error says why it must be shorter, and whether only because a
    /// pair of events may hide in it.
    fn attempt(
        &mut self,
        ds: f64,
        look_for_pairs: bool,
    ) -> Result<(Vec<Found>, Status), (String, bool)> {
        let tolerance = self.settings.continuation.tolerance;
        let wave: &Wave = &self.wave;
        let from = &self.node;
        let shorter = |reason: &str| (reason.to_string(), false);
        let step = continuation::advance(wave, from, ds, tolerance)
            .map_err(|refusal| (refusal.to_string(), false))?;
        let to = step.node;
        let examination = examine(wave, &to.point).map_err(|error| (error.to_string(), false))?;
        let start = (from, &self.examination);
        if look_for_pairs && events::may_hide_a_pair(wave, start, (&to, &examination), ds) {
            return Err(("two events lie closer together than a step".into(), true));
        }
        let mut located: Vec<(Located, What)> = Vec::new();
        self.smooth_events(&to, ds, &mut located)
            .ok_or_else(|| shorter("a fold or a user point inside the step was not found"))?;
        if examination.verdict != Verdict::Positive {
            let negative: Vec<&Margin> = examination
                .margins
                .iter()
                .filter(|margin| margin.jet.value <= 0.0)
                .collect();
            if negative.is_empty() {
                return Err(shorter(&events::refusal(wave, &examination)));
            }
            let changes = negative.len();
            for margin in negative {
                if let Some((place, margin)) =
                    events::at_margin(wave, start, (&to, margin), ds, tolerance)
                {
                    located.push((place, What::Change(margin)));
                }
            }
            if !located
                .iter()
                .any(|(_, what)| matches!(what, What::Change(_)))
            {
                return Err(shorter(&format!(
                    "{changes} inequalities fail within the step and none is located"
                )));
            }
        }
        // where a zone closes the parameter is stationary along the arc: that is the event itself
        let near = AT_ONCE * ds.max(1e-3);
        let changes: Vec<f64> = located
            .iter()
            .filter(|(_, what)| matches!(what, What::Change(_)))
            .map(|(place, _)| place.s)
            .collect();
        located.retain(|(place, what)| {
            *what != What::Fold || changes.iter().all(|s| (s - place.s).abs() > near)
        });
        for (place, what) in &located {
            let value = wave.parameter_at(&place.node.point);
            let unit = wave.scales.parameter.abs().max(value.abs());
            let certain = place.uncertainty <= UNCERTAIN.max(MOST_UNCERTAIN * tolerance) * unit;
            if !certain && matches!(what, What::Fold | What::Change(_)) {
                return Err(shorter(&format!(
                    "what happens near {} = {value:.6} is known to {:.0e} only",
                    wave.parameter.column(),
                    place.uncertainty
                )));
            }
        }
        located.sort_by(|one, other| one.0.s.total_cmp(&other.0.s));
        let mut points = Vec::new();
        for index in 0..located.len() {
            let (place, what) = &located[index];
            let at = examine(wave, &place.node.point).map_err(|e| (e.to_string(), false))?;
            // nothing may have failed before: another event would have come first
            if !place.holds(&at) {
                return Err(shorter("the order of two events is not resolved"));
            }
            let found = |kind, after, text| Found {
                wave: self.wave.clone(),
                s: place.s,
                entered: None,
                parameter: match what {
                    What::User(value) | What::Edge(value) => *value,
                    _ => wave.parameter_at(&place.node.point),
                },
                node: place.node.clone(),
                examination: at.clone(),
                kind: Some(kind),
                after,
                uncertainty: place.uncertainty,
                what: text,
            };
            match what {
                What::Fold => points.push(found(
                    EventType::LP,
                    None,
                    format!("fold in {}", wave.parameter.column()),
                )),
                What::User(value) => points.push(found(
                    EventType::UZ,
                    None,
                    format!("user point {} = {value}", wave.parameter.column()),
                )),
                What::Edge(value) => {
                    points.push(found(
                        EventType::EP,
                        None,
                        format!("edge of the range, {} = {value}", wave.parameter.column()),
                    ));
                    return Ok((points, Status::Finished));
                }
                What::Change(margin) if margin.watch == Watch::Coupling => {
                    points.push(found(EventType::MX, None, UNCOUPLED.into()));
                    return Ok((points, Status::Failed(UNCOUPLED.into())));
                }
                What::Change(_) => {
                    // several margins may vanish at one event: the table is asked for each. At the stiff
                    // end rounding keeps their zeros apart, or one of them from being located
                    let mut together: Vec<(Located, Margin)> = located[index..]
                        .iter()
                        .filter(|(other, _)| other.s - place.s <= near)
                        .filter_map(|(_, what)| match what {
                            What::Change(margin) => Some((place.clone(), *margin)),
                            _ => None,
                        })
                        .collect();
                    let vanished = at.margins.iter().filter(|margin| {
                        let beyond = examination.find(margin.watch, margin.zone);
                        margin.jet.value.abs() <= place.rounding(margin)
                            && beyond.is_some_and(|beyond| beyond.jet.value <= 0.0)
                    });
                    together.extend(vanished.map(|margin| (place.clone(), *margin)));
                    return Ok(self.change(points, together, ds));
                }
            }
        }
        let closed = self.closes(&to, ds);
        let origin = if closed {
            from.tangent.dot(&(&self.origin.1.point - &from.point))
        } else {
            0.0
        };
        self.travelled += ds;
        if located.iter().any(|(_, what)| *what == What::Fold)
            || to.tangent[to.tangent.len() - 1] * self.heading < 0.0
        {
            self.heading = to.tangent[to.tangent.len() - 1].signum();
        }
        self.node = to;
        self.examination = examination;
        self.ds = step.next.clamp(
            self.settings.continuation.ds_min,
            self.settings.continuation.ds_max,
        );
        if closed {
            let node = self.origin.1.clone();
            points.push(Found {
                s: origin,
                parameter: self.wave.parameter_at(&node.point),
                examination: examine(&self.wave, &node.point)
                    .unwrap_or_else(|_| self.examination.clone()),
                node,
                kind: Some(EventType::EP),
                what: "the branch closes on its first point".into(),
                ..self.here()
            });
            return Ok((points, Status::Finished));
        }
        points.push(Found {
            s: ds,
            ..self.here()
        });
        let short = ds < CREEP * self.settings.continuation.ds;
        self.creeping = if short { self.creeping + 1 } else { 0 };
        let uncoupled = uncoupled(&self.wave, &self.node.point).then(|| D_ZERO.to_owned());
        let status = match uncoupled.or_else(|| self.sonic().or_else(|| self.creeps())) {
            Some(reason) => {
                points.push(Found {
                    s: ds,
                    kind: Some(EventType::MX),
                    what: reason.clone(),
                    ..self.here()
                });
                Status::Failed(reason)
            }
            None => Status::Going,
        };
        Ok((points, status))
    }

    /// Why a branch ends whose steps have been short for so long that it does not get on any more: a step
    /// may be half as long again as the one before, and those so short come from rejections.
    fn creeps(&self) -> Option<String> {
        let longest = CREEP * self.settings.continuation.ds;
        (self.creeping >= MOST_CREEPING).then(|| {
            format!(
                "the branch does not get on: none of its last {MOST_CREEPING} steps is as long as \
                 {longest:.0e}, and longer ones fail"
            )
        })
    }

    /// Why the branch has no end in the range where its speed tends to √a: ln(|c|/√a − 1) falls without
    /// bound and everything else tends to a limit, as a power of the excess speed.
    fn sonic(&self) -> Option<String> {
        let Node { point, tangent, .. } = &self.node;
        let last = point.len() - 1;
        let excess = self.wave.excess_at(point);
        // change per e-fold of the excess speed: of everything, and of the parameter
        let fall = -tangent[last - 1];
        let rest = (1.0 - fall * fall).max(0.0).sqrt();
        let drift = tangent[last].abs() * self.wave.scales.parameter;
        let parameter = self.wave.parameter_at(point);
        let (low, high) = self.settings.range;
        let room = (parameter - low).min(high - parameter).min(parameter.abs());
        (fall > 0.0 && excess < SONIC && rest < SETTLED && drift < SETTLED * room).then(|| {
            format!(
                "the speed tends to √a: |c|/√a − 1 = {excess:.1e} falls without end while everything \
                 else tends to a limit, {} to {parameter:.6}; waves must be faster than √a",
                self.wave.parameter.column()
            )
        })
    }

    /// Folds, user points and edges of the range within a step; `None` if one is not found.
    fn smooth_events(&self, to: &Node, ds: f64, located: &mut Vec<(Located, What)>) -> Option<()> {
        let wave: &Wave = &self.wave;
        let from = &self.node;
        let tolerance = self.settings.continuation.tolerance;
        let last = wave.unknowns() - 1;
        // pieces of the step on which the parameter is monotone
        let mut ends: Vec<(&Node, f64)> = vec![(from, 0.0)];
        let fold;
        let (mut beginning, after) = ((0.0, from.tangent[last]), to.tangent[last]);
        if beginning.1.abs() <= VERTICAL {
            // where a zone opens the parameter is stationary: a short way on it tells its direction
            let near = 1e-3 * ds;
            let node = continuation::advance(wave, from, near, tolerance)
                .ok()?
                .node;
            beginning = (near, node.tangent[last]);
        }
        if beginning.1 * after < 0.0 {
            fold = events::fold(wave, from, beginning, to, ds, tolerance)?;
            located.push((fold.clone(), What::Fold));
            ends.push((&fold.node, fold.s));
        }
        ends.push((to, ds));
        let (lower, upper) = self.settings.range;
        // of many user points those between the least and the largest value of the step
        let values = ends.iter().map(|(node, _)| wave.parameter_at(&node.point));
        let (least, largest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        let slack = 8.0 * f64::EPSILON * least.abs().max(largest.abs());
        let user = &self.settings.stop_at;
        let first = user.partition_point(|value| *value < least - slack);
        let targets = user[first..]
            .iter()
            .take_while(|value| **value <= largest + slack)
            .map(|&value| (value, What::User(value)))
            .chain([lower, upper].map(|value| (value, What::Edge(value))));
        for (value, what) in targets {
            for pair in ends.windows(2) {
                let ((one, _), (other, _)) = (pair[0], pair[1]);
                let scaled = value / wave.scales.parameter;
                let (p0, p1) = (one.point[last] - scaled, other.point[last] - scaled);
                // a point that lies on the target was reported when it was reached
                if p0.abs() <= ON_TARGET * scaled.abs().max(f64::MIN_POSITIVE) || p0 * p1 > 0.0 {
                    continue;
                }
                let guess = &one.point + (&other.point - &one.point) * (p0 / (p0 - p1));
                let mut place = events::at_parameter(wave, from, &guess, value, tolerance)?;
                // exactly the value that was asked for, not the next number
                place.node.point[last] = scaled;
                located.push((place, what));
            }
        }
        Some(())
    }

    /// A change of regime: the event, and the branch beyond it.
    fn change(
        &mut self,
        mut points: Vec<Found>,
        mut together: Vec<(Located, Margin)>,
        ds: f64,
    ) -> (Vec<Found>, Status) {
        let limits = self.settings.continuation;
        // a zone without length says most about what comes next
        together.sort_by_key(|(_, margin)| margin.watch != Watch::Duration);
        let mut search = None;
        let (mut place, mut margin) = together[0].clone();
        for (at, tried) in &together {
            let found = events::beyond(
                &self.wave,
                &at.node.point,
                tried,
                ds.min(limits.ds),
                limits.tolerance,
            );
            let success = found.beyond.is_some();
            if success || search.is_none() {
                search = Some(found);
                (place, margin) = (at.clone(), *tried);
            }
            if success {
                break;
            }
        }
        let before = self.wave.signature.clone();
        let (beyond, refused, others) = match search {
            Some(search) => (search.beyond, search.refused, search.others),
            None => (None, Vec::new(), Vec::new()),
        };
        let after = beyond.as_ref().map(|beyond| beyond.wave.signature.clone());
        let kind = events::classify(&before, after.as_ref(), &margin);
        let mut what = describe(kind, &before, after.as_ref(), &margin);
        if !others.is_empty() {
            let names: Vec<String> = others.iter().map(Signature::to_string).collect();
            what.push_str(&format!("; also admissible: {}", names.join(", ")));
        }
        let examination =
            examine(&self.wave, &place.node.point).unwrap_or_else(|_| self.examination.clone());
        let mut found = Found {
            wave: self.wave.clone(),
            s: place.s,
            entered: None,
            parameter: self.wave.parameter_at(&place.node.point),
            node: place.node.clone(),
            examination,
            kind: Some(kind),
            after: after.clone(),
            uncertainty: place.uncertainty,
            what,
        };
        let Some(beyond) = beyond else {
            let reason = ending(&self.wave, &place.node.point, &margin, &refused);
            found.what.push_str(&format!("; {reason}"));
            let failure = Found {
                kind: Some(EventType::MX),
                what: reason.clone(),
                ..found.clone()
            };
            points.push(found);
            points.push(failure);
            return (points, Status::Failed(reason));
        };
        let last = beyond.wave.unknowns() - 1;
        let examination = match examine(&beyond.wave, &beyond.node.point) {
            Ok(examination) => examination,
            Err(error) => {
                let reason = error.to_string();
                points.push(found);
                return (points, Status::Failed(reason));
            }
        };
        if beyond.node.tangent[last].abs() > VERTICAL
            && beyond.node.tangent[last] * self.heading < 0.0
        {
            found
                .what
                .push_str("; the branch turns back in the parameter here");
            self.heading = -self.heading;
        }
        self.travelled += place.s.max(0.0);
        self.creeping = 0;
        self.wave = Arc::new(beyond.wave);
        self.node = beyond.node;
        found.entered = Some((self.wave.clone(), self.node.clone()));
        points.push(found);
        self.examination = examination;
        self.ds = beyond.ds.max(limits.ds_min);
        (points, Status::Going)
    }

    /// Whether the step to a node passes the first point of the branch again.
    fn closes(&self, to: &Node, ds: f64) -> bool {
        let (signature, origin) = &self.origin;
        if self.travelled < 4.0 * ds || *signature != self.wave.signature {
            return false;
        }
        let side = |point: &Vector| origin.tangent.dot(&(point - &origin.point));
        let (before, after) = (side(&self.node.point), side(&to.point));
        before < 0.0
            && after >= 0.0
            && (&to.point - &origin.point).norm() <= CLOSED * ds.abs()
            && to.tangent.dot(&origin.tangent) > 0.9
    }
}

/// What was located within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    Fold,
    User(f64),
    Edge(f64),
    Change(Margin),
}

/// A tangent whose parameter component is below this does not tell a direction: beyond the
/// opening of a zone the branch starts with none.
const VERTICAL: f64 = 1e-7;

/// Excess speed |c|/√a − 1 below which a branch may be seen to tend to √a, and how little everything
/// else changes then while it falls by the factor e.
const SONIC: f64 = 1e-4;
const SETTLED: f64 = 1e-3;

/// A step shorter than this, in units of the first one, creeps; a branch ends after so many in a row.
/// From there steps that succeed at once grow to the first one again in thirty.
const CREEP: f64 = 1e-5;
const MOST_CREEPING: usize = 40;

/// Relative distance at which a point lies on a user point or an edge.
const ON_TARGET: f64 = 1e-13;

/// An event known less well than this, relative to the parameter or its range, is not reported;
/// rounding at the stiff end leaves 1e-9. With a coarse tolerance: than this many tolerances.
const UNCERTAIN: f64 = 1e-6;
const MOST_UNCERTAIN: f64 = 1e4;

/// Events closer than this fraction of a step are one event seen by several margins.
const AT_ONCE: f64 = 1e-6;

/// What is left of a wave where D = 0.
const D_ZERO: &str = "D = 0: nothing drives a wave here; what is left is steady sliding with a linear wave \
                      of arbitrary amplitude, which neither grows nor decays";

/// Whether D = 0 but for rounding.
fn uncoupled(wave: &Wave, point: &Vector) -> bool {
    let coupling = wave.flows(point).map(|flows| flows.frame.at.kappa);
    coupling.is_ok_and(|kappa| kappa.abs() < events::AT_ZERO * wave.scales.pressure)
}

/// Why a branch ends where D = 0 does not end the wave itself, as under static friction.
const UNCOUPLED: &str = "D = 0: waves run in the direction of D, and beyond it this one would run \
                         against it; such waves are not followed";

/// The event in a sentence.
pub(crate) fn describe(
    kind: EventType,
    before: &Signature,
    after: Option<&Signature>,
    margin: &Margin,
) -> String {
    let regime = before.zone(margin.zone).regime.name();
    let closes = margin.watch == Watch::Duration;
    match kind {
        EventType::GR if closes => "the separation zone closes".into(),
        EventType::GR => format!("the pressure touches zero in a {regime} zone: separation opens"),
        EventType::RV if closes => "the reverse-slip zone closes before stick".into(),
        EventType::RV => "reverse slip opens before stick".into(),
        EventType::ST if closes => "the stick zone vanishes".into(),
        EventType::ST => "a stick zone opens".into(),
        _ if closes => {
            let replaced = after.is_some_and(|after| after.len() == before.len());
            if replaced {
                format!("V̇ = 1 at both ends of a {regime} zone: it gives way to another")
            } else {
                format!("the {regime} zone between its neighbours shrinks to nothing")
            }
        }
        _ => match margin.watch {
            Watch::Gap => "the separated surface touches the shaft".into(),
            Watch::Rate => format!("V̇ = 1 is touched inside a {regime} zone"),
            Watch::LandingRate => "landing passes through V̇ = 1".into(),
            Watch::LandingPressure => "the pressure after landing reaches zero".into(),
            Watch::Tension => "the tension after a touch reaches zero: contact begins".into(),
            Watch::Impulse => "the impulse of landing no longer arrests the surface".into(),
            _ => "two switching points coalesce".into(),
        },
    }
}

/// Why a branch ends at an event.
fn ending(before: &Wave, point: &Vector, margin: &Margin, refused: &[String]) -> String {
    if uncoupled(before, point) {
        return D_ZERO.into();
    }
    if before.material && margin.watch == Watch::Pressure {
        return "separation is not covered with material damping; take `damping: (stiffness: 0)` to \
                follow the wave through it"
            .into();
    }
    if margin.watch == Watch::Duration && before.zones() == 2 {
        return "what is left is one zone of slip around the whole circumference: a linear wave \
                on steady sliding, of arbitrary amplitude, at its Hopf point; no wave with \
                switches continues"
            .into();
    }
    if refused.is_empty() {
        "no signature of the switching table solves the equations beyond this event".into()
    } else {
        format!(
            "no admissible signature continues beyond this event; tried {}",
            refused.join("; ")
        )
    }
}
