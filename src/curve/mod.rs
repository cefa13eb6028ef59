//! Curves of events in two parameters.
//!
//! An event of a branch — a fold, a change of regime, a Hopf point — moves along a curve when a second
//! parameter is let go. [`system`] poses it, [`crate::continuation`] follows it by pseudo-arclength,
//! and at every point all other inequalities of the wave are proven, as on a branch. On the way,
//! points of codimension two are located:
//!
//! | type | point | test function |
//! |---|---|---|
//! | `GR+RV`, `LP+GR`, … | another margin vanishes: two events at once | the margin |
//! | `GR+LP`, `HB+LP`, … | the wave has a fold too | det F_x |
//! | `CP` | cusp: the curve of folds turns round | (p₁′, p₂′) · (−wᵀF_{p₂}, wᵀF_{p₁}) |
//! | `BT` | ω → 0 in sector 0 or k/2 | ω |
//!
//! where wᵀF_x = 0 along the folds: from F_x x′ + F_p p′ = 0 it follows that wᵀF_p p′ = 0, so that p′ is
//! a multiple of (−wᵀF_{p₂}, wᵀF_{p₁}), and the factor changes sign where the curve has its cusp.
//!
//! Where another margin vanishes the wave changes its regimes. A change of regime that is followed
//! goes on as one of the next wave, if the candidates of the switching table have one on which all
//! inequalities hold: the same margin vanishes there. Folds and Hopf points end: the parameter is
//! stationary at the opening of a zone, and its spectrum is not the continuation of the one before.

mod regions;
pub mod start;
pub mod system;

pub use regions::Region;

use serde::{Deserialize, Serialize};

use crate::bracket::Bracket;
use crate::branch::EventType;
use crate::continuation::{self, Node};
use crate::events;
use crate::follow::describe;
use crate::linalg::{self, Vector};
use crate::model::Parameter;
use crate::model::signature::Signature;
use crate::newton::{self, Constraint, Fixed, Plane};
use crate::stability::spectrum::symmetric;
use crate::wave::Wave;
use crate::wave::admissibility::{AtZero, Examination, Margin, Watch, examine};
use crate::wave::successor::candidates;

use system::{Condition, EventSystem};

/// How far to follow, and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Range of each parameter.
    pub ranges: [(f64, f64); 2],
    /// Step lengths and tolerance.
    pub steps: continuation::Settings,
    /// Largest number of points in either direction.
    pub most_points: usize,
}

/// A point of the curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Both parameters.
    pub parameters: [f64; 2],
    /// Wave speed c, signed.
    pub speed: f64,
    /// Regimes before the event.
    pub before: String,
    /// Regimes after it; empty where no admissible wave was found to go on.
    pub after: String,
    /// ω of a Hopf point.
    pub omega: Option<f64>,
    /// Type of a point of codimension two, of the start and of the ends.
    pub kind: Option<String>,
    /// What happens there, in words; empty at ordinary points.
    pub what: String,
    /// Newton iterations.
    pub newton: usize,
    /// Largest residual relative to its row of the Jacobian.
    pub residual: f64,
    /// Excess speed e = |c|/√a − 1.
    pub excess: f64,
}

/// The curve of an event.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Type of the event.
    pub event: EventType,
    /// Bloch sector of an HB.
    pub sector: Option<usize>,
    /// The two parameters.
    pub parameters: [Parameter; 2],
    /// Points from one end to the other.
    pub points: Vec<Point>,
    /// Index of the event on the branch.
    pub start: usize,
    /// Why the curve ends at its first and at its last point, in words.
    pub ends: [String; 2],
    /// Whether an end is one of Newton's method and not of the curve.
    pub failed: bool,
    /// Names of places beside it.
    pub regions: Vec<Region>,
}

/// A margin below this on the event's own account is the event itself, but for rounding.
const OWN: f64 = 1e-8;

/// ω in units of the frequency of the wave below which it counts as zero. Parameters are even in ω:
/// the point found lies 1e-8 from the limit.
const LEAST_OMEGA: f64 = 1e-4;

/// Margins that vanish closer together than this fraction of a step see one event.
const AT_ONCE: f64 = 1e-6;

/// A curve creeps when so many steps lead on by less than this length in the scaled unknowns. The first
/// step of a curve alone is 50 times as long.
const CREEPING: (usize, f64) = (200, 1e-4);

/// A curve has closed when it passes this close to its start, in units of the last step.
const CLOSED: f64 = 1.0;

/// F_x with a least singular value below this part of the largest is singular along the whole curve:
/// a zone without length makes the parameters stationary.
const SINGULAR: f64 = 1e-10;

/// Test functions at a point.
#[derive(Clone, Debug)]
struct Tests {
    examination: Examination,
    /// det F_x where it tells a fold.
    fold: Option<f64>,
    /// The factor that vanishes at a cusp, with the left null vector behind it.
    cusp: Option<(f64, Vector)>,
}

/// Why a step cannot be taken.
enum Refusal {
    /// Newton's method or a flow fails.
    Numerical(String),
    /// The event is none any more.
    Event(String),
}

/// What was found within a step.
enum What {
    Edge(usize, f64),
    Margin(Margin),
    Fold,
    Cusp,
    ZeroOmega,
}

/// What a curve begins with: the same for all its steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Type of the event.
    pub event: EventType,
    /// Its equations.
    pub system: EventSystem,
    /// How far to follow.
    pub settings: Settings,
    /// The event on the branch.
    pub point: Point,
    /// Its unknowns.
    pub unknowns: Vec<f64>,
    /// Unit tangent there.
    pub tangent: Vec<f64>,
}

/// A point with the equations that it solves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// The point.
    pub point: Point,
    signature: Signature,
    condition: Condition,
    unknowns: Vec<f64>,
}

/// All that the next step depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    signature: Signature,
    condition: Condition,
    unknowns: Vec<f64>,
    tangent: Vec<f64>,
    own: Vec<(Watch, usize)>,
    with_fold: bool,
    /// The left null vector behind the factor that vanishes at a cusp, for its sign.
    left: Option<Vec<f64>>,
    travelled: f64,
    ds: f64,
}

/// The end of the curve in one direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// Why, in words.
    pub reason: String,
    /// Whether it is one of Newton's method or of `max_points` and not of the curve.
    pub failed: bool,
    /// Type of the last point unless it has one.
    kind: Option<String>,
}

/// A step in either direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Points found, in order.
    pub found: Vec<Found>,
    /// What comes next.
    pub next: Next,
}

/// What comes after a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Next {
    /// The next step.
    Going(State),
    /// The end in this direction.
    Ended(End),
}

/// A curve being followed in one direction.
struct Follower {
    system: EventSystem,
    event: EventType,
    settings: Settings,
    /// Margins that vanish along the whole curve.
    own: Vec<(Watch, usize)>,
    with_fold: bool,
    node: Node,
    tests: Tests,
    origin: Node,
    travelled: f64,
    ds: f64,
}

/// A curve being followed from its event, first one way and then the other.
pub struct Run {
    head: Head,
    /// Points on either side, away from the event.
    halves: [Vec<Entry>; 2],
    ends: Vec<End>,
    follower: Follower,
}

/// Follows an event both ways from a solution of its equations.
///
/// # Errors
/// When the start does not solve the equations, or has no tangent.
pub fn follow(
    system: &EventSystem,
    event: EventType,
    start: &Vector,
    settings: Settings,
) -> Result<Curve, String> {
    let mut run = Run::begin(system, event, start, settings)?;
    while run.step()?.is_some() {}
    Ok(run.curve())
}

impl Run {
    /// Begins at a solution of the equations.
    ///
    /// # Errors
    /// When it is none, or has no tangent.
    pub fn begin(
        system: &EventSystem,
        event: EventType,
        start: &Vector,
        settings: Settings,
    ) -> Result<Run, String> {
        let mut system = system.clone();
        let node = first_node(&system, start, settings.steps.tolerance)?;
        system.settle(&node.point);
        let follower = Follower::new(system, event, backwards(&node), settings)?;
        let mut point = follower.point(&follower.node);
        point.kind = Some(event.to_string());
        point.what = "the event on the branch".into();
        // the values of the problem where polishing moved them by rounding only
        let given = follower.system.values(start);
        for (value, given) in point.parameters.iter_mut().zip(given) {
            if (*value - given).abs() <= 1e-13 * given.abs().max(1e-3) {
                *value = given;
            }
        }
        let head = Head {
            event,
            system: follower.system.clone(),
            settings,
            point,
            unknowns: node.point.as_slice().to_vec(),
            tangent: node.tangent.as_slice().to_vec(),
        };
        Ok(Run {
            head,
            halves: [Vec::new(), Vec::new()],
            ends: Vec::new(),
            follower,
        })
    }

    /// Goes on after the steps of an earlier run.
    ///
    /// # Errors
    /// When they do not fit.
    pub fn resume(head: Head, steps: Vec<Step>) -> Result<Run, String> {
        let mut run = Run {
            follower: head.follower(0)?,
            head,
            halves: [Vec::new(), Vec::new()],
            ends: Vec::new(),
        };
        let count = steps.len();
        for (index, step) in steps.into_iter().enumerate() {
            if run.ended() {
                return Err("there are steps beyond the end".into());
            }
            let found = step.found.into_iter().map(|found| {
                let system = run.head.system.of(found.signature, found.condition);
                let unknowns = Vector::from_vec(found.unknowns);
                match system.fits(&unknowns) {
                    true => Ok((found.point, system, unknowns)),
                    false => Err("a point does not fit its equations".to_owned()),
                }
            });
            let found = found.collect::<Result<Vec<Entry>, String>>()?;
            run.halves[run.ends.len()].extend(found);
            match step.next {
                Next::Ended(end) => run.end(end)?,
                Next::Going(state) if index + 1 == count => run.follower.set(&run.head, state)?,
                Next::Going(_) => {}
            }
        }
        Ok(run)
    }

    /// What the curve begins with.
    pub fn head(&self) -> &Head {
        &self.head
    }

    /// Where the curve is, in words.
    pub fn position(&self) -> String {
        let [first, second] = self.head.system.parameters().map(|one| one.column());
        let half = &self.halves[self.ends.len().min(1)];
        let point = half.last().map_or(&self.head.point, |(point, _, _)| point);
        format!(
            "{} points, {first} {:.6}, {second} {:.6}",
            1 + self.halves[0].len() + self.halves[1].len(),
            point.parameters[0],
            point.parameters[1]
        )
    }

    /// The points in the order in which they were found.
    pub fn so_far(&self) -> impl Iterator<Item = &Point> {
        let [first, second] = &self.halves;
        let found = first.iter().chain(second).map(|(point, _, _)| point);
        std::iter::once(&self.head.point).chain(found)
    }

    /// Whether both ends are reached.
    fn ended(&self) -> bool {
        self.ends.len() == 2
    }

    /// Takes a step; `None` when both ends are reached.
    ///
    /// # Errors
    /// When the curve does not begin the other way.
    pub fn step(&mut self) -> Result<Option<Step>, String> {
        if self.ended() {
            return Ok(None);
        }
        let half = &mut self.halves[self.ends.len()];
        let before = half.len();
        let end = self.follower.step(half);
        let found = half[before..]
            .iter()
            .map(|(point, system, unknowns)| Found {
                point: point.clone(),
                signature: system.signature().clone(),
                condition: system.condition,
                unknowns: unknowns.as_slice().to_vec(),
            });
        let found = found.collect();
        let next = match end {
            Some(end) => {
                self.end(end.clone())?;
                Next::Ended(end)
            }
            None => Next::Going(self.follower.state()),
        };
        Ok(Some(Step { found, next }))
    }

    /// Ends one direction and turns to the other.
    fn end(&mut self, end: End) -> Result<(), String> {
        if let Some((last, _, _)) = self.halves[self.ends.len()].last_mut()
            && let Some(kind) = &end.kind
        {
            last.kind.get_or_insert_with(|| kind.clone());
            if last.what.is_empty() {
                last.what.clone_from(&end.reason);
            }
        }
        let closed = end.reason == CLOSES;
        self.ends.push(end.clone());
        if closed && !self.ended() {
            // the second half would be the first one backwards
            self.ends.push(end);
        } else if !self.ended() {
            self.follower = self.head.follower(1)?;
        }
        Ok(())
    }

    /// The curve from one end to the other, with what lies beside it.
    pub fn curve(self) -> Curve {
        let Run {
            head, halves, ends, ..
        } = self;
        let sector = head.sector();
        let [mut points, second] = halves;
        points.reverse();
        let start = points.len();
        points.push((
            head.point,
            head.system.clone(),
            Vector::from_vec(head.unknowns),
        ));
        points.extend(second);
        let regions = regions::regions(&points, &head.settings);
        let failed = ends.iter().any(|end| end.failed);
        let mut reasons = ends.into_iter().map(|end| end.reason);
        Curve {
            event: head.event,
            sector,
            parameters: head.system.parameters(),
            points: points.into_iter().map(|(point, _, _)| point).collect(),
            start,
            ends: [
                reasons.next().unwrap_or_default(),
                reasons.next().unwrap_or_default(),
            ],
            failed,
            regions,
        }
    }
}

impl Head {
    /// Bloch sector of an HB.
    pub fn sector(&self) -> Option<usize> {
        match self.system.condition {
            Condition::Hopf { sector } => Some(sector),
            _ => None,
        }
    }

    /// The follower in the first direction (0) or the second (1).
    fn follower(&self, half: usize) -> Result<Follower, String> {
        let point = Vector::from_column_slice(&self.unknowns);
        let tangent = Vector::from_column_slice(&self.tangent);
        if !(self.system.fits(&point) && self.system.fits(&tangent)) {
            return Err("the event does not fit its equations".into());
        }
        let node = Node {
            point,
            tangent,
            newton: self.point.newton,
            residual: self.point.residual,
        };
        let node = if half == 0 { backwards(&node) } else { node };
        Follower::new(self.system.clone(), self.event, node, self.settings)
    }
}

/// A node seen the other way.
fn backwards(node: &Node) -> Node {
    Node {
        tangent: -&node.tangent,
        ..node.clone()
    }
}

/// The end of a closed curve.
const CLOSES: &str = "the curve closes on its start";

type Entry = (Point, EventSystem, Vector);

/// Why a curve creeps, if it does: beside the opening of a separation zone the landing jump of a
/// perturbation is singular, and Newton's method converges slowly at any length of step.
fn creeping(points: &[Entry]) -> Option<String> {
    let (steps, least) = CREEPING;
    let (_, system, here) = points.last()?;
    let (_, before, there) = &points[points.len().checked_sub(steps)?];
    if before.signature() != system.signature() || (here - there).norm() >= least {
        return None;
    }
    let (wave, own) = system.wave(here, 0);
    let lengths = (0..wave.zones()).map(|zone| (zone, wave.duration_at(&own, zone)));
    let (zone, duration) = lengths.min_by(|one, other| one.1.total_cmp(&other.1))?;
    Some(format!(
        "{steps} steps lead on by less than {least:e}: Newton's method hardly converges beside a {} zone \
         of length {:.1e}",
        wave.signature.zone(zone).regime.name(),
        duration * wave.speed_at(&own).abs()
    ))
}

/// The start with its unit tangent, the null vector of the Jacobian.
fn first_node(system: &EventSystem, start: &Vector, tolerance: f64) -> Result<Node, String> {
    let tangent = |point: &Vector| {
        let (matrix, residual) =
            newton::jacobian(system, point).map_err(|error| error.to_string())?;
        let kernel = linalg::kernel(&matrix).ok_or("the event has no tangent")?;
        Ok::<_, String>((kernel.null_vector, residual))
    };
    let (normal, _) = tangent(start)?;
    let mut plane = Plane {
        normal: &normal,
        through: start,
    };
    let settings = newton::Settings {
        tolerance,
        most_iterations: 20,
        halvings: 4,
        polish: 1,
    };
    let solution = newton::solve(system, &mut plane, start, &settings)
        .map_err(|error| format!("the event of the branch is no solution: {error}"))?;
    let (mut null, residual) = tangent(&solution.point)?;
    // towards larger values of the first parameter, the second where that is stationary
    let count = null.len();
    let heading = if null[count - 2].abs() > 1e-9 {
        null[count - 2]
    } else {
        null[count - 1]
    };
    if heading < 0.0 {
        null.neg_mut();
    }
    Ok(Node {
        point: solution.point,
        tangent: null,
        newton: solution.iterations,
        residual,
    })
}

impl Follower {
    fn new(
        system: EventSystem,
        event: EventType,
        node: Node,
        settings: Settings,
    ) -> Result<Follower, String> {
        let (wave, own) = system.wave(&node.point, 0);
        let examination = examine(&wave, &own).map_err(|error| error.to_string())?;
        let vanish = examination
            .margins
            .iter()
            .filter(|margin| margin.jet.value.abs() < OWN)
            .map(|margin| (margin.watch, margin.zone))
            .collect();
        let (_, by) = system
            .wave_equations(&node.point)
            .map_err(|error| error.to_string())?;
        let square = by.columns(0, system.wave_unknowns()).clone_owned();
        let regular =
            linalg::least(&square).is_some_and(|least| least.value > SINGULAR * least.largest);
        let mut follower = Follower {
            with_fold: regular && system.condition != Condition::Fold,
            tests: Tests {
                examination,
                fold: None,
                cusp: None,
            },
            own: vanish,
            origin: node.clone(),
            node,
            travelled: 0.0,
            ds: settings.steps.ds,
            system,
            event,
            settings,
        };
        follower.tests = follower
            .tests(&follower.node)
            .map_err(|refusal| match refusal {
                Refusal::Numerical(reason) | Refusal::Event(reason) => reason,
            })?;
        Ok(follower)
    }

    /// One step, shorter if need be, appended to the points of its direction; `Some` is the end.
    fn step(&mut self, points: &mut Vec<Entry>) -> Option<End> {
        let limits = self.settings.steps;
        let end = |reason, failed, kind: Option<&str>| {
            Some(End {
                reason,
                failed,
                kind: kind.map(str::to_owned),
            })
        };
        let most = self.settings.most_points;
        if points.len() >= most {
            let reason = format!("`max_points`, {most} in either direction, are reached");
            return end(reason, true, Some("MX"));
        }
        if let Some(reason) = creeping(points) {
            return end(reason, true, Some("MX"));
        }
        let mut ds = self.ds.clamp(limits.ds_min, limits.ds_max);
        loop {
            match self.attempt(ds, points) {
                Ok(reason) => return reason.and_then(|reason| end(reason, false, None)),
                Err(_) if ds > limits.ds_min => ds = (0.5 * ds).max(limits.ds_min),
                Err(Refusal::Event(reason)) => return end(reason, false, Some("EP")),
                Err(Refusal::Numerical(reason)) => {
                    let reason = format!(
                        "no step of at least ds_min = {:e} succeeds: {reason}",
                        limits.ds_min
                    );
                    return end(reason, true, Some("MX"));
                }
            }
        }
    }

    /// All that the next step depends on.
    fn state(&self) -> State {
        State {
            signature: self.system.signature().clone(),
            condition: self.system.condition,
            unknowns: self.node.point.as_slice().to_vec(),
            tangent: self.node.tangent.as_slice().to_vec(),
            own: self.own.clone(),
            with_fold: self.with_fold,
            left: (self.tests.cusp.as_ref()).map(|(_, left)| left.as_slice().to_vec()),
            travelled: self.travelled,
            ds: self.ds,
        }
    }

    /// Goes to a state.
    fn set(&mut self, head: &Head, state: State) -> Result<(), String> {
        self.system = head.system.of(state.signature, state.condition);
        let zones = self.system.signature().len();
        let left = state.left.map(Vector::from_vec);
        let node = Node {
            point: Vector::from_vec(state.unknowns),
            tangent: Vector::from_vec(state.tangent),
            newton: 0,
            residual: 0.0,
        };
        let fits = self.system.fits(&node.point)
            && self.system.fits(&node.tangent)
            && left
                .as_ref()
                .is_none_or(|left| left.len() == self.system.wave_unknowns())
            && state.own.iter().all(|(_, zone)| *zone < zones);
        if !fits {
            return Err("the saved state does not fit its equations".into());
        }
        self.node = node;
        self.own = state.own;
        self.with_fold = state.with_fold;
        self.travelled = state.travelled;
        self.ds = state.ds;
        self.tests.cusp = left.map(|left| (0.0, left));
        self.tests = self.tests(&self.node).map_err(|refusal| match refusal {
            Refusal::Numerical(reason) | Refusal::Event(reason) => reason,
        })?;
        Ok(())
    }

    /// One step; `Some` is the end of the curve.
    fn attempt(&mut self, ds: f64, points: &mut Vec<Entry>) -> Result<Option<String>, Refusal> {
        let tolerance = self.settings.steps.tolerance;
        let step = continuation::advance(&self.system, &self.node, ds, tolerance)
            .map_err(|refusal| Refusal::Numerical(refusal.to_string()))?;
        let to = step.node;
        let tests = self.tests(&to)?;
        let mut located = self.edges(&to)?;
        self.margins(&tests, ds, &mut located)?;
        self.signs(&to, &tests, ds, &mut located)?;
        located.sort_by(|one, other| one.0.s.total_cmp(&other.0.s));
        // one event is seen by several margins: a zone without length says most about what comes next
        let near = AT_ONCE * ds.max(1e-3);
        let seen: Vec<(f64, Margin)> = located
            .iter()
            .filter_map(|(place, what)| match what {
                What::Margin(margin) => Some((place.s, *margin)),
                _ => None,
            })
            .collect();
        for (place, what) in located {
            let mut point = self.point(&place.node);
            let mut entered = None;
            let (kind, text, ends) = match what {
                What::Edge(index, value) => {
                    // exactly the value that was asked for
                    point.parameters[index] = value;
                    let name = self.system.parameters()[index].column();
                    let text = format!("edge of the range, {name} = {value}");
                    ("EP".to_owned(), text, true)
                }
                What::Margin(_) => {
                    let mut together: Vec<Margin> = seen
                        .iter()
                        .filter(|(s, _)| (s - place.s).abs() <= near)
                        .map(|(_, margin)| *margin)
                        .collect();
                    together.sort_by_key(|margin| margin.watch != Watch::Duration);
                    let (kind, mut text) = self.second_event(&place.node.point, &together[0]);
                    entered = together
                        .iter()
                        .find_map(|margin| self.enter(&place.node, margin));
                    if let Some(next) = &entered {
                        let name = next.system.signature();
                        text = format!("{text}; the curve goes on in {name}");
                    } else if matches!(self.system.condition, Condition::Margin(_)) {
                        text.push_str("; no curve of this event goes on from here");
                    }
                    let ends = entered.is_none();
                    (format!("{}+{kind}", self.event), text, ends)
                }
                What::Fold => {
                    let text = "the wave has a fold here too".to_owned();
                    (format!("{}+LP", self.event), text, false)
                }
                What::Cusp => (
                    "CP".to_owned(),
                    "cusp: two folds meet and vanish".to_owned(),
                    false,
                ),
                What::ZeroOmega => (
                    "BT".to_owned(),
                    "ω → 0: the pair meets on the real axis, and with it a fold".to_owned(),
                    true,
                ),
            };
            point.kind = Some(kind);
            point.what.clone_from(&text);
            points.push((point, self.system.clone(), place.node.point));
            if ends {
                return Ok(Some(text));
            }
            if let Some(next) = entered {
                *self = Follower {
                    travelled: self.travelled + place.s,
                    ..next
                };
                return Ok(None);
            }
        }
        let closed = self.closes(&to, ds);
        self.travelled += ds;
        self.node = to;
        self.tests = tests;
        self.ds = step.next;
        self.system.settle(&self.node.point);
        points.push((
            self.point(&self.node),
            self.system.clone(),
            self.node.point.clone(),
        ));
        Ok(closed.then(|| CLOSES.to_owned()))
    }

    /// Test functions at a node. Refused where the event is none any more.
    fn tests(&self, node: &Node) -> Result<Tests, Refusal> {
        let numerical = |error: crate::flow::FlowError| Refusal::Numerical(error.to_string());
        let (wave, own) = self.system.wave(&node.point, 0);
        let examination = examine(&wave, &own).map_err(numerical)?;
        for (watch, zone) in &self.own {
            let regime = wave.signature.zone(*zone).regime.name();
            let itself = match self.system.condition {
                Condition::Margin(margin) => (margin.watch, margin.zone) == (*watch, *zone),
                _ => false,
            };
            let reason = match examination.find(*watch, *zone) {
                Some(margin) if margin.jet.value >= -OWN => continue,
                Some(_) if itself => {
                    format!("another minimum inside the {regime} zone falls below zero first")
                }
                None if itself => format!(
                    "the minimum inside the {regime} zone reaches an end of the zone: no \
                     inequality fails there any more"
                ),
                _ => format!(
                    "an inequality of the {regime} zone that vanishes along with the event fails"
                ),
            };
            return Err(Refusal::Event(reason));
        }
        let (mut fold, mut cusp) = (None, None);
        if self.with_fold || self.system.condition == Condition::Fold {
            let count = self.system.wave_unknowns();
            let (_, by) = self.system.wave_equations(&node.point).map_err(numerical)?;
            let square = by.columns(0, count).clone_owned();
            if self.with_fold {
                fold = Some(square.determinant());
            } else if let Some(least) = linalg::least(&square) {
                let mut left = least.left;
                if let Some((_, before)) = &self.tests.cusp
                    && before.dot(&left) < 0.0
                {
                    left.neg_mut();
                }
                let last = node.tangent.len() - 2;
                let factor = -node.tangent[last] * left.dot(&by.column(count + 1))
                    + node.tangent[last + 1] * left.dot(&by.column(count));
                cusp = Some((factor, left));
            }
        }
        Ok(Tests {
            examination,
            fold,
            cusp,
        })
    }

    /// Edges of the ranges within the step.
    fn edges(&self, to: &Node) -> Result<Vec<(Place, What)>, Refusal> {
        let mut located = Vec::new();
        let first = to.point.len() - 2;
        for (index, (low, high)) in self.settings.ranges.into_iter().enumerate() {
            let column = first + index;
            for value in [low, high] {
                let scaled = value / self.system.widths()[index];
                let (p0, p1) = (self.node.point[column] - scaled, to.point[column] - scaled);
                let outwards = if value == low { p1 < 0.0 } else { p1 > 0.0 };
                // a start on the edge may go inwards
                if !outwards || p0 == p1 {
                    continue;
                }
                let share = (p0 / (p0 - p1)).clamp(0.0, 1.0);
                let guess = &self.node.point + (&to.point - &self.node.point) * share;
                let mut fixed = Fixed {
                    index: column,
                    value: scaled,
                };
                let place = self.solve(&mut fixed, &guess)?;
                located.push((place, What::Edge(index, value)));
            }
        }
        Ok(located)
    }

    /// Margins that vanish within the step.
    fn margins(
        &self,
        to: &Tests,
        ds: f64,
        located: &mut Vec<(Place, What)>,
    ) -> Result<(), Refusal> {
        for margin in &to.examination.margins {
            let own = self.own.contains(&(margin.watch, margin.zone));
            if own || margin.jet.value > 0.0 {
                continue;
            }
            let before = self
                .tests
                .examination
                .find(margin.watch, margin.zone)
                .map(|before| before.jet.value)
                .filter(|value| *value > 0.0)
                .ok_or_else(|| {
                    Refusal::Numerical("an inequality fails as soon as it is posed".into())
                })?;
            let mut at = AtZero { margin: *margin };
            let place = self.zero((0.0, before), (ds, margin.jet.value), |_, point| {
                let (wave, own) = self.system.wave(point, 0);
                at.margin_at(&wave, &own)
                    .ok()
                    .map(|margin| margin.jet.value)
            })?;
            located.push((place, What::Margin(*margin)));
        }
        Ok(())
    }

    /// Smooth test functions that change sign within the step.
    fn signs(
        &self,
        to: &Node,
        tests: &Tests,
        ds: f64,
        located: &mut Vec<(Place, What)>,
    ) -> Result<(), Refusal> {
        if let (Some(before), Some(after)) = (self.tests.fold, tests.fold)
            && before * after < 0.0
        {
            let place = self.zero((0.0, before), (ds, after), |follower, point| {
                let (_, by) = follower.system.wave_equations(point).ok()?;
                let count = follower.system.wave_unknowns();
                Some(by.columns(0, count).clone_owned().determinant())
            })?;
            located.push((place, What::Fold));
        }
        if let (Some((before, _)), Some((after, _))) = (&self.tests.cusp, &tests.cusp)
            && before * after < 0.0
        {
            let place = self.zero_of_node((0.0, *before), (ds, *after), |follower, node| {
                Some(follower.tests(node).ok()?.cusp?.0)
            })?;
            located.push((place, What::Cusp));
        }
        if let Condition::Hopf { sector } = self.system.condition {
            let count = self.system.wave_unknowns();
            let (wave, _) = self.system.wave(&to.point, 0);
            let symmetric = symmetric(sector, wave.mode);
            let sign = self.node.point[count].signum();
            let least = |point: &Vector| sign * point[count] - LEAST_OMEGA;
            let (before, after) = (least(&self.node.point), least(&to.point));
            if symmetric && before > 0.0 && after <= 0.0 {
                let place = self.zero((0.0, before), (ds, after), |_, point| Some(least(point)))?;
                located.push((place, What::ZeroOmega));
            }
        }
        Ok(())
    }

    /// The zero of a function of the point along the step.
    fn zero(
        &self,
        low: (f64, f64),
        high: (f64, f64),
        mut test: impl FnMut(&Follower, &Vector) -> Option<f64>,
    ) -> Result<Place, Refusal> {
        self.zero_of_node(low, high, |follower, node| test(follower, &node.point))
    }

    /// The zero of a function of point and tangent along the step, by the Illinois variant of the
    /// secant rule.
    fn zero_of_node(
        &self,
        low: (f64, f64),
        high: (f64, f64),
        mut test: impl FnMut(&Follower, &Node) -> Option<f64>,
    ) -> Result<Place, Refusal> {
        /// Relative width of the bracket, or value, at which the place is known to rounding.
        const EXACT: f64 = 1e-14;
        let lost = || Refusal::Numerical("a point of codimension two was not located".into());
        let size = low.1.abs().max(high.1.abs());
        let width = high.0;
        let mut bracket = Bracket::new(low, high);
        let mut found = None;
        for _ in 0..80 {
            let s = bracket.secant();
            let node = self.node_at(s).ok_or_else(lost)?;
            let value = test(self, &node).ok_or_else(lost)?;
            found = Some(Place { s, node });
            if value.abs() <= EXACT * size || bracket.width().abs() <= EXACT * width {
                break;
            }
            bracket.shrink(s, value);
        }
        found.ok_or_else(lost)
    }

    /// The node at arclength s along the step.
    fn node_at(&self, s: f64) -> Option<Node> {
        let predicted = &self.node.point + &self.node.tangent * s;
        let mut plane = Plane {
            normal: &self.node.tangent,
            through: &predicted,
        };
        let settings = self.newton();
        continuation::correct(
            &self.system,
            &mut plane,
            &predicted,
            &self.node.tangent,
            &settings,
        )
        .ok()
        .map(|(node, _)| node)
    }

    fn newton(&self) -> newton::Settings {
        newton::Settings {
            tolerance: self.settings.steps.tolerance,
            most_iterations: 12,
            halvings: 0,
            polish: 1,
        }
    }

    /// Solves the event together with a constraint.
    fn solve(
        &self,
        constraint: &mut impl Constraint<EventSystem>,
        guess: &Vector,
    ) -> Result<Place, Refusal> {
        let settings = self.newton();
        let tangent = &self.node.tangent;
        let (node, _) = continuation::correct(&self.system, constraint, guess, tangent, &settings)
            .map_err(|failure| Refusal::Numerical(failure.to_string()))?;
        Ok(Place {
            s: tangent.dot(&(&node.point - &self.node.point)),
            node,
        })
    }

    /// The same event of the wave beyond a change of regime, a step into it being admissible.
    fn enter(&self, node: &Node, second: &Margin) -> Option<Follower> {
        let Condition::Margin(first) = self.system.condition else {
            return None;
        };
        let tolerance = self.settings.steps.tolerance;
        let (wave, own) = self.system.wave(&node.point, 0);
        let regime = wave.signature.zone(first.zone).regime;
        let here = AtZero { margin: *second }.margin_at(&wave, &own).ok()?;
        for candidate in candidates(&wave, &own, &here).ok()? {
            let Ok(examination) = examine(&candidate.wave, &candidate.point) else {
                continue;
            };
            let vanish: Vec<Margin> = examination
                .margins
                .iter()
                .copied()
                .filter(|margin| margin.jet.value.abs() < AT_SECOND)
                .collect();
            for margin in vanish.iter().filter(|margin| {
                margin.watch == first.watch
                    && candidate.wave.signature.zone(margin.zone).regime == regime
                    && !(margin.watch == Watch::Duration
                        && candidate.nascent.contains(&margin.zone))
            }) {
                let system = self
                    .system
                    .of(candidate.wave.signature.clone(), Condition::Margin(*margin));
                let count = system.wave_unknowns();
                let parameters = node.point.len() - 2;
                let point = Vector::from_fn(count + 2, |row, _| match row {
                    row if row < count => candidate.point[row],
                    row => node.point[parameters + row - count],
                });
                let Ok((matrix, residual)) = newton::jacobian(&system, &point) else {
                    continue;
                };
                let Some(kernel) = linalg::kernel(&matrix) else {
                    continue;
                };
                if residual.is_nan() || residual > AT_SECOND {
                    continue;
                }
                let mut ds = self.ds.min(self.settings.steps.ds);
                for _ in 0..TRIES {
                    for sign in [1.0, -1.0] {
                        let from = Node {
                            point: point.clone(),
                            tangent: &kernel.null_vector * sign,
                            newton: 0,
                            residual,
                        };
                        let into = self.into(&system, &from, &vanish, ds, tolerance);
                        // the event itself goes on, alone as before, and new zones do grow
                        if let Some(own) = into.filter(|own| {
                            own.contains(&(margin.watch, margin.zone))
                                && own.len() <= self.own.len()
                                && !candidate
                                    .nascent
                                    .iter()
                                    .any(|zone| own.contains(&(Watch::Duration, *zone)))
                        }) {
                            let mut next =
                                Follower::new(system.clone(), self.event, from, self.settings)
                                    .ok()?;
                            next.own = own;
                            next.ds = ds;
                            next.origin = self.origin.clone();
                            return Some(next);
                        }
                    }
                    ds *= 0.25;
                }
            }
        }
        None
    }

    /// The margins that vanish at both ends of a step into a candidate; `None` where that is not
    /// admissible.
    fn into(
        &self,
        system: &EventSystem,
        from: &Node,
        vanish: &[Margin],
        ds: f64,
        tolerance: f64,
    ) -> Option<Vec<(Watch, usize)>> {
        let to = continuation::advance(system, from, ds, tolerance)
            .ok()?
            .node;
        let (wave, own) = system.wave(&to.point, 0);
        let examination = examine(&wave, &own).ok()?;
        let mut along = Vec::new();
        for one in &examination.margins {
            let began = vanish
                .iter()
                .any(|known| known.watch == one.watch && known.zone == one.zone);
            if began && one.jet.value.abs() < OWN {
                along.push((one.watch, one.zone));
            } else if one.jet.value.is_nan() || one.jet.value <= 0.0 {
                return None;
            }
        }
        Some(along)
    }

    /// Type and words of a second event at a point.
    fn second_event(&self, point: &Vector, margin: &Margin) -> (EventType, String) {
        let (wave, own) = self.system.wave(point, 0);
        let tolerance = self.settings.steps.tolerance;
        let mut at = AtZero { margin: *margin };
        let here = at.margin_at(&wave, &own).unwrap_or(*margin);
        let after = successor(&wave, &own, &here, tolerance);
        let kind = events::classify(&wave.signature, after.as_ref(), &here);
        let text = describe(kind, &wave.signature, after.as_ref(), &here);
        (kind, format!("another inequality fails: {text} ({kind})"))
    }

    /// A node as a point of the curve.
    fn point(&self, node: &Node) -> Point {
        let (wave, own) = self.system.wave(&node.point, 0);
        let before = wave.signature.to_string();
        let after = match self.system.condition {
            Condition::Margin(margin) => {
                let here = AtZero { margin }.margin_at(&wave, &own).unwrap_or(margin);
                successor(&wave, &own, &here, self.settings.steps.tolerance)
                    .map_or_else(String::new, |after| after.to_string())
            }
            _ => before.clone(),
        };
        Point {
            parameters: self.system.values(&node.point),
            speed: wave.speed_at(&own),
            excess: wave.excess_at(&own),
            before,
            after,
            omega: self.system.omega(&node.point),
            kind: None,
            what: String::new(),
            newton: node.newton,
            residual: newton::jacobian(&self.system, &node.point)
                .map_or(node.residual, |(_, residual)| residual),
        }
    }

    /// Whether the step to a node passes the start again.
    fn closes(&self, to: &Node, ds: f64) -> bool {
        // another signature has other unknowns
        if self.travelled < 4.0 * ds || self.origin.point.len() != to.point.len() {
            return false;
        }
        let side = |point: &Vector| self.origin.tangent.dot(&(point - &self.origin.point));
        side(&self.node.point) < 0.0
            && side(&to.point) >= 0.0
            && (&to.point - &self.origin.point).norm() <= CLOSED * ds
            && to.tangent.dot(&self.origin.tangent) > 0.9
    }
}

/// Margins and residuals of a candidate below this vanish at the point where two events meet: it is
/// known to 1e-12 or better, and reduced switching functions of nascent zones amplify that.
const AT_SECOND: f64 = 1e-8;

/// Steps tried into a candidate: from the given one down by factors of 4.
const TRIES: usize = 8;

/// A point located within a step.
struct Place {
    s: f64,
    node: Node,
}

/// First step into a wave beyond an event, as on a branch.
const INTO: f64 = 1e-3;

/// The signature beyond a change of regime.
fn successor(wave: &Wave, point: &Vector, margin: &Margin, tolerance: f64) -> Option<Signature> {
    events::beyond(wave, point, margin, INTO, tolerance)
        .beyond
        .map(|beyond| beyond.wave.signature)
}
