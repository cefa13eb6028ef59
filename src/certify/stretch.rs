//! Arcs of waves, between two special points of a branch.
//!
//! Coordinates are the excess speed, the lengths of zones and the parameter. A zone that opens where its neighbours touch a limit
//! has, like a fold, a length in which the parameter is stationary at the event. An arc that begins at a change of regime
//! begins with its wave in the signature beyond ([`super::change`]).

use super::arc::{self, ArcDirection, ArcEquations, Broken, Joint, Moving};
use super::change::{self, WaveNotBeyond};
use super::equations::Evaluated;
use super::inequality::{self, ProvenPart, UnprovenWave};
use super::krawczyk;
use super::system::{NearWave, PosedWave, WaveCondition, WaveSystem};
use super::{WaveProof, enclosed, units};
use crate::interval::Interval;
use crate::tube::wave::admissibility::WaveWatch;

/// Why an arc of waves is not proven.
pub type Undecided = Broken<UnprovenWave, WaveNotBeyond>;

/// A point of the branch, in doubles.
#[derive(Clone, Copy)]
struct WaveArcPoint<'a> {
    near: &'a NearWave,
    condition: &'a WaveCondition,
}

impl<'a> WaveArcPoint<'a> {
    fn new(near: &'a NearWave, condition: &'a WaveCondition) -> WaveArcPoint<'a> {
        WaveArcPoint { near, condition }
    }

    /// The zone that has no length here.
    fn closed(&self) -> Option<usize> {
        let zones = 0..self.near.signature.len();
        match self.condition {
            WaveCondition::Margin {
                watch: WaveWatch::Duration,
                zone,
                ..
            } if zones.contains(zone) => Some(*zone),
            _ => None,
        }
    }
}

/// An end of the arc.
struct WaveArcEnd<'a> {
    place: WaveArcPoint<'a>,
    joint: Joint,
    /// The equations of a fold and their zero in doubles, where the parameter is stationary along the arc.
    fold: Option<(WaveSystem<'a>, Vec<f64>)>,
    /// e₀ of the arc over that of the end.
    ratio: Interval,
}

impl<'a> WaveArcEnd<'a> {
    fn new(
        posed: &'a PosedWave,
        place: WaveArcPoint<'a>,
        steps: &[usize],
        excess: f64,
    ) -> Option<WaveArcEnd<'a>> {
        let WaveArcPoint { near, condition } = place;
        let (system, guess) = WaveSystem::cut(posed, near, condition, Some(steps))?;
        let mut at = enclosed(posed, &system, &guess)?;
        at.truncate(system.waves());
        if system.minimum(&at).is_some() {
            at.remove(system.waves() - 3);
        }
        // 1 + u = e/e₀
        let ratio = Interval::point(near.excess) / Interval::point(excess);
        let index = at.len() - 2;
        at[index] = (Interval::ONE + at[index]) * ratio - Interval::ONE;
        let stationary =
            *condition == WaveCondition::Fold || change::is_touch(posed, near, condition);
        let fold =
            stationary.then(|| WaveSystem::cut(posed, near, &WaveCondition::Fold, Some(steps)));
        Some(WaveArcEnd {
            place,
            joint: Joint::new(at),
            fold: fold.flatten(),
            ratio,
        })
    }
}

struct WaveArc<'a> {
    system: WaveSystem<'a>,
    units: Vec<f64>,
    ends: [WaveArcEnd<'a>; 2],
}

/// Proves that between two points of a branch the waves are one curve, on which no fold and no change of regime
/// lies.
pub fn prove(from: &WaveProof, to: &WaveProof) -> Result<(), Undecided> {
    let posed = &from.posed;
    // what is beyond is proven with the point
    let begin = match (&from.beyond, &from.condition) {
        (Some(beyond), _) => WaveArcPoint::new(&beyond.near, &beyond.condition),
        (None, WaveCondition::Margin { .. }) => return Err(Broken::Beyond(WaveNotBeyond::None)),
        (None, condition) => WaveArcPoint::new(&from.near, condition),
    };
    let end = WaveArcPoint::new(&to.near, &to.condition);
    if posed.fixed() != to.posed.fixed() || begin.near.signature != end.near.signature {
        return Err(Broken::Apart);
    }
    // where a zone opens or closes it is one step; where it is longer at the other end it is cut anew between
    let stops = [waypoint(posed, begin, end)?, waypoint(posed, end, begin)?];
    let stops: Vec<(NearWave, WaveCondition)> = stops.into_iter().flatten().collect();
    let between = stops
        .iter()
        .map(|(near, value)| WaveArcPoint::new(near, value));
    let places: Vec<WaveArcPoint> = [begin].into_iter().chain(between).chain([end]).collect();
    let legs = places.windows(2);
    let legs = legs.map(|ends| WaveArc::between(posed, [ends[0], ends[1]]));
    let legs: Vec<WaveArc> = legs.collect::<Result<_, _>>()?;
    for (both, (near, _)) in legs.windows(2).zip(&stops) {
        let cuts = [&both[0].system, &both[1].system];
        if !change::is_cut_anew(posed, near, cuts) {
            return Err(Broken::Tube(near.parameter));
        }
    }
    legs.iter().try_for_each(WaveArc::prove)
}

/// Steps of every zone at a point; what is one or two steps at two points is one on the way.
fn steps(posed: &PosedWave, places: [WaveArcPoint; 2]) -> Option<Vec<usize>> {
    let [one, other] = places.map(|WaveArcPoint { near, .. }| {
        let (system, _) = WaveSystem::new(posed, near, &near.value())?;
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
    posed: &PosedWave,
    end: WaveArcPoint,
    other: WaveArcPoint,
) -> Result<Option<(NearWave, WaveCondition)>, Undecided> {
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
    let arc = WaveArc::between(posed, [end, end])?;
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
    let near: NearWave = reached().ok_or(lost)?;
    let value = near.value();
    Ok(Some((near, value)))
}

impl<'a> WaveArc<'a> {
    fn between(
        posed: &'a PosedWave,
        ends: [WaveArcPoint<'a>; 2],
    ) -> Result<WaveArc<'a>, Undecided> {
        let steps = steps(posed, ends).ok_or(Broken::End)?;
        let near = ends[0].near;
        let (system, guess) =
            WaveSystem::cut(posed, near, &near.value(), Some(&steps)).ok_or(Broken::End)?;
        let [first, last] =
            ends.map(|place| WaveArcEnd::new(posed, place, &steps, near.excess).ok_or(Broken::End));
        Ok(WaveArc {
            units: units(&system, &guess, near, posed.unit),
            ends: [first?, last?],
            system,
        })
    }

    fn prove(&self) -> Result<(), Undecided> {
        let [excess, _] = self.system.tail();
        let WaveArcPoint { condition, .. } = self.ends[0].place;
        let way = match self.ends[0].place.closed() {
            Some(zone) => ArcDirection::Grows(self.system.duration(zone)),
            None if *condition == WaveCondition::Fold => ArcDirection::Fold(Some(excess)),
            None => ArcDirection::Parameter,
        };
        arc::prove(self, self.ends.each_ref().map(|end| &end.joint), way)
    }
}

impl ArcEquations for WaveArc<'_> {
    type Unproven = UnprovenWave;
    type Beyond = WaveNotBeyond;

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

    fn hold(&self, x: &[Moving], next_to: Option<usize>) -> Result<(), UnprovenWave> {
        let condition = &self.system.condition;
        let hull: Vec<Interval> = x.iter().map(|x| x.value).collect();
        let over = |part| inequality::prove(&self.system, condition, part, &hull);
        let held = match next_to {
            None => over(ProvenPart::All),
            Some(end) => {
                // a zone that closes there has nothing to grow from
                let closed = self.ends[end].place.closed();
                let rest = closed.map_or(ProvenPart::All, ProvenPart::But);
                inequality::prove(&self.system, condition, rest, x)
                    .and_then(|_| closed.map_or(Ok(0), |zone| over(ProvenPart::Within(zone))))
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
