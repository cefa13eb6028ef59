//! Arcs of waves, between two special points of a branch.
//!
//! Coordinates are the excess speed, the lengths of zones and the parameter. A zone that opens where its neighbours touch a limit
//! has, like a fold, a length in which the parameter is stationary at the event. An arc that begins at a change of regime
//! begins with its wave in the signature beyond ([`super::change`]).

use super::arc::{self, Broken, Curve, Joint, Moving, Way};
use super::change::{self, NotBeyond};
use super::equations::Evaluated;
use super::inequality::{self, Part, Unproven};
use super::krawczyk;
use super::system::{Condition, Near, Posed, System};
use super::{Proof, enclosed, units};
use crate::interval::Interval;
use crate::tube::wave::admissibility::Watch;

/// Why an arc of waves is not proven.
pub type Undecided = Broken<Unproven, NotBeyond>;

/// A point of the branch, in doubles.
#[derive(Clone, Copy)]
struct Place<'a> {
    near: &'a Near,
    condition: &'a Condition,
}

impl<'a> Place<'a> {
    fn new(near: &'a Near, condition: &'a Condition) -> Place<'a> {
        Place { near, condition }
    }

    /// The zone that has no length here.
    fn closed(&self) -> Option<usize> {
        let zones = 0..self.near.signature.len();
        match self.condition {
            Condition::Margin {
                watch: Watch::Duration,
                zone,
                ..
            } if zones.contains(zone) => Some(*zone),
            _ => None,
        }
    }
}

/// An end of the arc.
struct Ending<'a> {
    place: Place<'a>,
    joint: Joint,
    /// The equations of a fold and their zero in doubles, where the parameter is stationary along the arc.
    fold: Option<(System<'a>, Vec<f64>)>,
    /// e₀ of the arc over that of the end.
    ratio: Interval,
}

impl<'a> Ending<'a> {
    fn new(posed: &'a Posed, place: Place<'a>, steps: &[usize], excess: f64) -> Option<Ending<'a>> {
        let Place { near, condition } = place;
        let (system, guess) = System::cut(posed, near, condition, Some(steps))?;
        let mut at = enclosed(posed, &system, &guess)?;
        at.truncate(system.waves());
        if system.minimum(&at).is_some() {
            at.remove(system.waves() - 3);
        }
        // 1 + u = e/e₀
        let ratio = Interval::point(near.excess) / Interval::point(excess);
        let index = at.len() - 2;
        at[index] = (Interval::ONE + at[index]) * ratio - Interval::ONE;
        let stationary = *condition == Condition::Fold || change::is_touch(posed, near, condition);
        let fold = stationary.then(|| System::cut(posed, near, &Condition::Fold, Some(steps)));
        Some(Ending {
            place,
            joint: Joint::new(at),
            fold: fold.flatten(),
            ratio,
        })
    }
}

struct Arc<'a> {
    system: System<'a>,
    units: Vec<f64>,
    ends: [Ending<'a>; 2],
}

/// Proves that between two points of a branch the waves are one curve, on which no fold and no change of regime
/// lies.
pub fn prove(from: &Proof, to: &Proof) -> Result<(), Undecided> {
    let posed = &from.posed;
    // what is beyond is proven with the point
    let begin = match (&from.beyond, &from.condition) {
        (Some(beyond), _) => Place::new(&beyond.near, &beyond.condition),
        (None, Condition::Margin { .. }) => return Err(Broken::Beyond(NotBeyond::None)),
        (None, condition) => Place::new(&from.near, condition),
    };
    let end = Place::new(&to.near, &to.condition);
    if posed.fixed() != to.posed.fixed() || begin.near.signature != end.near.signature {
        return Err(Broken::Apart);
    }
    // where a zone opens or closes it is one step; where it is longer at the other end it is cut anew between
    let stops = [waypoint(posed, begin, end)?, waypoint(posed, end, begin)?];
    let stops: Vec<(Near, Condition)> = stops.into_iter().flatten().collect();
    let between = stops.iter().map(|(near, value)| Place::new(near, value));
    let places: Vec<Place> = [begin].into_iter().chain(between).chain([end]).collect();
    let legs = places.windows(2);
    let legs = legs.map(|ends| Arc::between(posed, [ends[0], ends[1]]));
    let legs: Vec<Arc> = legs.collect::<Result<_, _>>()?;
    for (both, (near, _)) in legs.windows(2).zip(&stops) {
        let cuts = [&both[0].system, &both[1].system];
        if !change::is_cut_anew(posed, near, cuts) {
            return Err(Broken::Tube(near.parameter));
        }
    }
    legs.iter().try_for_each(Arc::prove)
}

/// Steps of every zone at a point; what is one or two steps at two points is one on the way.
fn steps(posed: &Posed, places: [Place; 2]) -> Option<Vec<usize>> {
    let [one, other] = places.map(|Place { near, .. }| {
        let (system, _) = System::new(posed, near, &near.value())?;
        let zones = 0..near.signature.len();
        Some(zones.map(|zone| system.steps(zone)).collect::<Vec<_>>())
    });
    let both = one?.into_iter().zip(other?).enumerate();
    let steps = both.map(|(zone, both)| match both {
        (1, 2) | (2, 1) => 1,
        _ if places.iter().any(|place| place.closed() == Some(zone)) => 1,
        (a, b) => a.max(b),
    });
    Some(steps.collect())
}

/// The point on an arc at which a zone that opens or closes at an end has grown to [`STEP`], and its condition, where
/// the zone is more than two steps at the other end.
fn waypoint(
    posed: &Posed,
    end: Place,
    other: Place,
) -> Result<Option<(Near, Condition)>, Undecided> {
    const STEP: f64 = 1.5;
    /// Steps in which it is reached.
    const STRIDES: usize = 16;
    let lost = Broken::Tube(end.near.parameter);
    let Some(zone) = end.closed() else {
        return Ok(None);
    };
    let long = steps(posed, [other, other]).ok_or(Broken::End)?;
    if long[zone] <= 2 {
        return Ok(None);
    }
    let arc = Arc::between(posed, [end, end])?;
    let reached = || {
        let mut joint = arc.ends[0].joint.clone();
        let frame = arc.system.frame_at(&joint.at)?;
        let longest = STEP / arc.system.flow(&frame, zone)?.norm();
        for stride in 1..=STRIDES {
            let length = longest * stride as f64 / STRIDES as f64;
            let tangent = arc.tangent(&joint)?;
            joint = arc.joint(&joint, &tangent, arc.system.duration(zone), length)?;
        }
        Some(arc.system.refined(&joint.near))
    };
    let near: Near = reached().ok_or(lost)?;
    let value = near.value();
    Ok(Some((near, value)))
}

impl<'a> Arc<'a> {
    fn between(posed: &'a Posed, ends: [Place<'a>; 2]) -> Result<Arc<'a>, Undecided> {
        let steps = steps(posed, ends).ok_or(Broken::End)?;
        let near = ends[0].near;
        let (system, guess) =
            System::cut(posed, near, &near.value(), Some(&steps)).ok_or(Broken::End)?;
        let [first, last] =
            ends.map(|place| Ending::new(posed, place, &steps, near.excess).ok_or(Broken::End));
        Ok(Arc {
            units: units(&system, &guess, near, posed.unit),
            ends: [first?, last?],
            system,
        })
    }

    fn prove(&self) -> Result<(), Undecided> {
        let [excess, _] = self.system.tail();
        let Place { condition, .. } = self.ends[0].place;
        let way = match self.ends[0].place.closed() {
            Some(zone) => Way::Grows(self.system.duration(zone)),
            None if *condition == Condition::Fold => Way::Fold(Some(excess)),
            None => Way::Parameter,
        };
        arc::prove(self, self.ends.each_ref().map(|end| &end.joint), way)
    }
}

impl Curve for Arc<'_> {
    type Unproven = Unproven;
    type Beyond = NotBeyond;

    fn units(&self) -> &[f64] {
        &self.units
    }

    fn parameter(&self) -> usize {
        let [_, parameter] = self.system.tail();
        parameter
    }

    fn coordinates(&self) -> Vec<usize> {
        let zones = 0..self.system.near.zones.len();
        let durations = zones.map(|zone| self.system.duration(zone));
        durations.chain(self.system.tail()).collect()
    }

    fn equations(&self, x: &[Interval]) -> Option<Evaluated> {
        self.system.waves_into(x, x.len())
    }

    fn hold(&self, x: &[Moving], next_to: Option<usize>) -> Result<(), Unproven> {
        let condition = &self.system.condition;
        let hull: Vec<Interval> = x.iter().map(|x| x.value).collect();
        let over = |part| inequality::prove(&self.system, condition, part, &hull);
        let held = match next_to {
            None => over(Part::All),
            Some(end) => {
                // a zone that closes there has nothing to grow from
                let closed = self.ends[end].place.closed();
                let rest = closed.map_or(Part::All, Part::But);
                inequality::prove(&self.system, condition, rest, x)
                    .and_then(|_| closed.map_or(Ok(0), |zone| over(Part::Within(zone))))
            }
        };
        held.map(|_| ())
    }

    fn is_only_fold(&self, end: usize, _: usize, x: &[Interval], tangent: &[Interval]) -> bool {
        let Some((system, guess)) = &self.ends[end].fold else {
            return false;
        };
        let [excess, parameter] = self.system.tail();
        let ratio = Interval::ONE / self.ends[end].ratio;
        let mut x = x.to_vec();
        x[excess] = (Interval::ONE + x[excess]) * ratio - Interval::ONE;
        let mut v = tangent[..parameter].to_vec();
        v[excess] = v[excess] * ratio;
        x.extend(arc::direction(system.normal(), &v));
        let equations = |x: &[Interval]| system.evaluate(x);
        krawczyk::is_only_zero(&equations, guess, &x)
    }
}
