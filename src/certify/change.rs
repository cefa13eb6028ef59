//! A change of regime, seen from both sides.
//!
//! At the event a wave of one signature is a wave of another: a zone has no length in one of them, or is about
//! to be divided. What holds at that instant is the same on both sides, by what the equations of a zone become
//! as its duration T → 0:
//!
//! | of no length | by its equations |
//! |---|---|
//! | stick | W = 1 and Q = fP |
//! | slip, reverse slip after a landing | U = δ, and W = 1 or P = 0 as it ends |
//! | slip, reverse slip after a reversal, or reverse slip after a landing that arrests, (W − 1)/T → Ẇ | W = 1 and Q = fP, Q = −fP |
//! | separation after a take-off, (U − δ)/T³ → U⃛/6 = −κẆ/6m_b | P = 0 and Ẇ = 0 |
//! | separation after a touch, (U − δ)/T² → Ü/2 = −P/2m_b | U = δ and P = 0 |
//!
//! The wave of the signature beyond is proven like that of the event. Without its zone of no length it solves
//! the equations of the event, and it lies where these have one solution only: it is the same wave.

use serde::{Deserialize, Serialize};

use super::inequality::{self, ProvenPart};
use super::system::{NearWave, TIME, WaveCondition, WaveSystem};
use super::{OpenPoint, PosedWave, enclosed, krawczyk, system};
use crate::branch::special::Change;
use crate::interval::Interval;
use crate::linalg::Vector;
use crate::tube::model::Impact;
use crate::tube::model::signature::{Regime, Signature, ZoneEntry};
use crate::tube::wave::Wave;
use crate::tube::wave::admissibility::{RegimeMargin, WaveWatch, examine};
use crate::tube::wave::successor::candidates;

/// The wave of an event in the signature beyond it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaveBeyond {
    /// What vanishes there in this signature.
    pub condition: WaveCondition,
    /// The wave in doubles.
    pub near: NearWave,
}

impl WaveBeyond {
    /// The wave beyond a change of regime as the continuation has entered it.
    pub(super) fn new(wave: &Wave, point: &Vector, change: &Change) -> Option<WaveBeyond> {
        let after = change.after.as_ref()?;
        let mut list = candidates(wave, point, &change.margin).ok()?.into_iter();
        let candidate = list.find(|candidate| candidate.orbit.signature == *after)?;
        let condition = match candidate.nascent.first() {
            Some(zone) => WaveCondition::Margin {
                watch: WaveWatch::Duration,
                zone: *zone,
                time: 0.0,
            },
            None => {
                let margins = examine(&candidate.orbit, &candidate.point).ok()?.margins;
                let size = |margin: &RegimeMargin| margin.jet.value.abs();
                // a flight that lands at P = 0 may land without speed, too
                let grazes = matches!(
                    change.margin.watch,
                    WaveWatch::Gap | WaveWatch::LandingSpeed
                );
                let named =
                    |margin: &RegimeMargin| grazes || margin.watch != WaveWatch::LandingSpeed;
                let least = margins.into_iter().filter(named);
                least.min_by(|a, b| size(a).total_cmp(&size(b)))?.into()
            }
        };
        Some(WaveBeyond {
            condition,
            near: NearWave::new(&candidate.orbit, &candidate.point),
        })
    }
}

/// What holds at the instant of an event besides the equations of the flows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum EventLaw {
    /// W = 1.
    Sticking,
    /// Q = fP.
    Upper,
    /// Q = −fP.
    Lower,
    /// P = 0.
    Lifted,
    /// Ẇ = 0.
    Level,
    /// U = δ.
    Landed,
    /// U̇ = 0.
    Grazing,
}

use EventLaw::{Grazing, Landed, Level, Lifted, Lower, Sticking, Upper};

/// What holds at the instant of an event, in order; `None` where that is not covered.
fn laws(
    posed: &PosedWave,
    signature: &Signature,
    watch: WaveWatch,
    index: usize,
) -> Option<[EventLaw; 2]> {
    let zone = signature.zone(index);
    let next = signature.zone(index + 1).entry;
    let force = match zone.regime {
        Regime::Reverse => Lower,
        _ => Upper,
    };
    let laws = match (watch, zone.regime, zone.entry) {
        (WaveWatch::Duration, Regime::Stick, ZoneEntry::Arrest | ZoneEntry::ArrestedLanding) => {
            [Sticking, Upper]
        }
        (WaveWatch::Duration, Regime::Slip | Regime::Reverse, ZoneEntry::Landing) => match next {
            ZoneEntry::TakeOff => [Lifted, Landed],
            _ => [Sticking, Landed],
        },
        (WaveWatch::Duration, Regime::Slip | Regime::Reverse, ZoneEntry::Reversal)
            if next != ZoneEntry::TakeOff =>
        {
            [Sticking, force]
        }
        (WaveWatch::Duration, Regime::Reverse, ZoneEntry::ArrestedLanding)
            if next == ZoneEntry::Arrest =>
        {
            [Sticking, Lower]
        }
        (WaveWatch::Duration, Regime::Separation, ZoneEntry::TakeOff)
            if next == ZoneEntry::Landing =>
        {
            [Lifted, Level]
        }
        (WaveWatch::Duration, Regime::Separation, ZoneEntry::Touch) => [Lifted, Landed],
        (WaveWatch::LandingRate, ..) => [Sticking, Landed],
        (WaveWatch::LandingPressure | WaveWatch::Tension, ..) => [Lifted, Landed],
        (WaveWatch::LowerForce, _, ZoneEntry::Arrest | ZoneEntry::ArrestedLanding) => {
            [Sticking, Lower]
        }
        (WaveWatch::UpperForce, ..) => [Sticking, Upper],
        (WaveWatch::LandingSpeed | WaveWatch::Gap, ..) => [Landed, Grazing],
        (WaveWatch::Pressure, ..) => [Lifted, Level],
        (WaveWatch::Rate, ..) => [Sticking, force],
        _ => return None,
    };
    // static friction holds more than kinetic friction does; an impact changes W where something lands; with
    // material damping zones open otherwise
    let forced = laws.contains(&Upper) || laws.contains(&Lower);
    let stuck = forced && posed.written.ratio.is_some();
    let layered = posed.written.material.is_some();
    let struck = laws.contains(&Landed) && posed.impact == Impact::Coulomb;
    (!stuck && !struck && !layered).then_some(laws)
}

/// A zone, or one of the two parts into which an event inside it cuts it.
#[derive(Clone, Copy)]
struct CutZone {
    zone: usize,
    /// Time after the entry of the zone at which it begins.
    from: Interval,
    time: Interval,
}

/// The zones that have a length, from the instant of an event to its return; of waves without an event all.
fn stretches(system: &WaveSystem, x: &[Interval]) -> Vec<CutZone> {
    let zones = system.near.zones.len();
    let whole = |zone: usize| CutZone {
        zone: zone % zones,
        from: Interval::ZERO,
        time: x[system.duration(zone % zones)],
    };
    let WaveCondition::Margin { watch, zone, .. } = &system.condition else {
        return (0..zones).map(whole).collect();
    };
    if let Some((zone, step, place)) = system.minimum(x) {
        let CutZone { time, .. } = whole(zone);
        let at = time * Interval::point(step as f64) / Interval::point(system.steps(zone) as f64)
            + place;
        let (first, last) = (
            CutZone {
                zone,
                from: at,
                time: time - at,
            },
            CutZone {
                zone,
                from: Interval::ZERO,
                time: at,
            },
        );
        let between = (zone + 1..zone + zones).map(whole);
        return std::iter::once(first)
            .chain(between)
            .chain(std::iter::once(last))
            .collect();
    }
    let (from, to) = match watch {
        WaveWatch::Duration => (zone + 1, zone + zones),
        WaveWatch::UpperForce | WaveWatch::LandingSpeed => (zone + 1, zone + 1 + zones),
        _ => (*zone, zone + zones),
    };
    (from..to).map(whole).collect()
}

/// The state at a time after the beginning of a stretch.
fn state_at(
    system: &WaveSystem,
    x: &[Interval],
    stretch: CutZone,
    time: Interval,
) -> Option<[Interval; 4]> {
    let CutZone { zone, from, .. } = stretch;
    let frame = system.frame_at(x)?;
    let (_, step) = system.step_at(x, zone, 0);
    let time = from + time;
    let index = (time.middle() / step.middle()).floor();
    let index = if index > 0.0 { index as usize } else { 0 };
    let index = index.min(system.steps(zone) - 1);
    let (state, _) = system.step_at(x, zone, index);
    let rest = time - step * Interval::point(index as f64);
    Some(system.later(&frame, zone, state, rest))
}

/// A wave enclosed by one system in the unknowns of another with the same stretches; `None` if they are not.
pub(super) fn carried(
    from: &WaveSystem,
    x: &[Interval],
    to: &WaveSystem,
    middle: &[f64],
) -> Option<Vec<Interval>> {
    let points: Vec<Interval> = middle.iter().copied().map(Interval::point).collect();
    let (sources, targets) = (stretches(from, x), stretches(to, &points));
    let alike = |(index, (one, other)): (usize, (&CutZone, &CutZone))| {
        let one = from.near.signature.zone(one.zone);
        let other = to.near.signature.zone(other.zone);
        one.regime == other.regime && (index == 0 || one.entry == other.entry)
    };
    let mut both = sources.iter().zip(&targets).enumerate();
    if sources.len() != targets.len() || !both.all(alike) {
        return None;
    }
    let mut carried = vec![Interval::ZERO; to.waves()];
    let [excess, parameter] = to.tail();
    let [from_excess, from_parameter] = from.tail();
    // 1 + u = e/e₀
    let ratio = Interval::point(from.near.excess) / Interval::point(to.near.excess);
    carried[excess] = (Interval::ONE + x[from_excess]) * ratio - Interval::ONE;
    carried[parameter] = x[from_parameter];
    for zone in 0..to.near.zones.len() {
        let duration = to.duration(zone);
        // of a zone that is cut the last stretch comes first
        let own = targets.iter().zip(&sources).rev();
        let own: Vec<CutZone> = own
            .filter(|(target, _)| target.zone == zone)
            .map(|(_, source)| *source)
            .collect();
        let first = own.first().or(sources.first()).copied()?;
        let time = own.iter().fold(Interval::ZERO, |sum, own| sum + own.time);
        let steps = Interval::point(to.steps(zone) as f64);
        for step in 0..to.steps(zone) {
            let at = time * Interval::point(step as f64) / steps;
            let state = match own.get(1) {
                Some(second) if at.middle() > first.time.middle() => {
                    state_at(from, x, *second, at - first.time)?
                }
                _ => state_at(from, x, first, at)?,
            };
            let columns = to.columns(zone, step, duration);
            for (column, value) in columns[..TIME].iter().zip(state) {
                if let Some(column) = column {
                    carried[*column] = value;
                }
            }
        }
        carried[duration] = time;
        if let Some((at, step, _)) = to.minimum(&points)
            && at == zone
        {
            carried[to.waves() - 3] = first.time - time * Interval::point(step as f64) / steps;
        }
    }
    Some(carried)
}

/// Why the wave beyond an event is not proven.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WaveNotBeyond {
    /// What holds at the instant is not covered.
    #[error("not covered: how the zones of this event open or close")]
    Laws,
    /// It is not proven, or an inequality is not.
    #[error(transparent)]
    Open(#[from] OpenPoint),
    #[error("undecided: the wave beyond may be another")]
    Another,
    /// The certificate of the event has none beyond it.
    #[error("in no other sequence of zones the wave is proven")]
    None,
}

/// Proves that the wave of an event is a wave of the signature beyond it.
pub(super) fn prove(
    posed: &PosedWave,
    near: &NearWave,
    condition: &WaveCondition,
    beyond: &WaveBeyond,
) -> Result<(), WaveNotBeyond> {
    let instant = |near: &NearWave, condition: &WaveCondition| match condition {
        WaveCondition::Margin { watch, zone, .. } if *zone < near.signature.len() => {
            laws(posed, &near.signature, *watch, *zone)
        }
        _ => None,
    };
    let both = instant(near, condition).zip(instant(&beyond.near, &beyond.condition));
    if both.is_none_or(|(one, other)| one != other) {
        return Err(WaveNotBeyond::Laws);
    }
    let (event, middle) = system(posed, near, condition)?;
    let (other, guess) = system(posed, &beyond.near, &beyond.condition)?;
    let zero = enclosed(posed, &other, &guess).ok_or(OpenPoint::NotIsolated)?;
    inequality::prove(&other, &beyond.condition, ProvenPart::All, &zero)
        .map_err(OpenPoint::from)?;
    let carried = carried(&other, &zero, &event, &middle).ok_or(WaveNotBeyond::Laws)?;
    if is_same(posed, &event, &middle, &carried) {
        Ok(())
    } else {
        Err(WaveNotBeyond::Another)
    }
}

/// Whether two systems that cut the zones of a wave otherwise have the same wave by the value of its parameter.
pub(super) fn is_cut_anew(posed: &PosedWave, near: &NearWave, cuts: [&WaveSystem; 2]) -> bool {
    let [one, other] = cuts.map(|cut| {
        let zones = 0..near.zones.len();
        let steps: Vec<usize> = zones.map(|zone| cut.steps(zone)).collect();
        WaveSystem::cut(posed, near, &near.value(), Some(&steps))
    });
    let Some(((one, guess), (other, middle))) = one.zip(other) else {
        return false;
    };
    let wave = enclosed(posed, &one, &guess);
    let carried = wave.and_then(|wave| carried(&one, &wave, &other, &middle));
    carried.is_some_and(|carried| is_same(posed, &other, &middle, &carried))
}

/// Whether a wave that solves the equations of a system is the one that they have next to `middle`.
fn is_same(posed: &PosedWave, system: &WaveSystem, middle: &[f64], wave: &[Interval]) -> bool {
    let Some(zero) = enclosed(posed, system, middle) else {
        return false;
    };
    let both: Vec<Interval> = wave.iter().zip(&zero).map(|(a, b)| a.hull(*b)).collect();
    let equations = |x: &[Interval]| system.evaluate(x);
    krawczyk::is_only_zero(&equations, middle, &both)
}

/// Whether at an event a zone closes where the zones on both sides of it touch a limit and turn back: W = 1 and
/// Ẇ = 0 in slip, or P = 0 and Ẇ = 0. To first order the zone takes its length from its neighbours and changes
/// nothing else, so that parameter and speed are stationary in it.
pub(super) fn is_touch(posed: &PosedWave, near: &NearWave, condition: &WaveCondition) -> bool {
    let WaveCondition::Margin {
        watch: WaveWatch::Duration,
        zone,
        ..
    } = condition
    else {
        return false;
    };
    let regime = |zone: usize| near.signature.zone(zone).regime;
    let before = regime(zone + near.signature.len() - 1);
    let touched = match laws(posed, &near.signature, WaveWatch::Duration, *zone) {
        Some([Sticking, Upper]) => regime(*zone) == Regime::Stick && before == Regime::Slip,
        Some([Lifted, Level]) => true,
        _ => false,
    };
    touched && before == regime(zone + 1)
}
