//! What a statement on a wave presupposes, so that what is proven is what it says.
//!
//! | part | presupposed |
//! |---|---|
//! | model | −1 < ν < ½, ξ > 1, γ > 0, δ > 0, f > 0, r ≥ 1, α ≥ 0, g > 0, h > 0; the continuation parameter enters the equations |
//! | margin | it is a condition of its zone and switch |
//! | wave | 2π/k is its least period |
//! | crossing | 0 ≤ j < k; 0 is not in ω of an HB; at a BP j ≡ −j and ω = 0 |
//! | beyond | the cycle of zones is another, and an event of the same type is proven there |

use super::certificate::begin_alike;
use super::change::{self, WaveBeyond};
use super::frame::{IntervalFrame, WrittenCoefficients};
use super::krawczyk;
use super::system::{NearWave, PosedWave, WaveCondition, WaveSystem};
use super::{OpenPoint, RefusedProof, WaveProof};
use crate::interval::{Decimal, Interval};
use crate::orbit::{Changes, EventType};
use crate::tube::model::signature::{Regime, Signature, ZoneEntry};
use crate::tube::model::{Impact, Parameter};
use crate::tube::wave::Wave;
use crate::tube::wave::admissibility::{RegimeMargin, WaveWatch};

/// Whether the continuation parameter enters the equations, and there is a mode.
pub(super) fn is_posed(posed: &PosedWave) -> Result<(), OpenPoint> {
    let written = &posed.written;
    let enters = match posed.parameter {
        Parameter::Mismatch | Parameter::Friction | Parameter::MassDamping => true,
        Parameter::StiffnessDamping => written.material.is_some(),
        Parameter::Nu | Parameter::Xi | Parameter::Gamma => {
            matches!(written.origin, WrittenCoefficients::Geometry(_))
        }
        Parameter::Smoothing => false,
    };
    match enters && posed.mode > 0 {
        true => Ok(()),
        false => Err(OpenPoint::Parameter),
    }
}

/// Whether the numbers are those of a model where the continuation parameter has a value.
pub(super) fn is_model(
    posed: &PosedWave,
    value: Interval,
    frame: &IntervalFrame<Interval>,
) -> Result<(), OpenPoint> {
    let written = &posed.written;
    let at = |parameter: Parameter, number: &Decimal| match parameter == posed.parameter {
        true => value,
        false => number.interval(),
    };
    let tube = match &written.origin {
        WrittenCoefficients::Given(_) => true,
        WrittenCoefficients::Geometry([nu, xi, gamma]) => {
            let nu = at(Parameter::Nu, nu);
            nu.low > -1.0
                && nu.high < 0.5
                && at(Parameter::Xi, xi).low > 1.0
                && at(Parameter::Gamma, gamma).is_positive()
        }
    };
    let positive = [frame.mismatch, frame.friction, frame.g, frame.h];
    let holds_more = |ratio: &Decimal| ratio.interval().low >= 1.0;
    let holds = tube
        && positive.iter().all(|number| number.is_positive())
        && frame.damping.low >= 0.0
        && written.ratio.as_ref().is_none_or(holds_more);
    match holds {
        true => Ok(()),
        false => Err(OpenPoint::Model),
    }
}

/// Whether a margin is a condition of a zone, as [`crate::tube::wave::admissibility`] lists them.
pub(super) fn is_condition(
    posed: &PosedWave,
    signature: &Signature,
    watch: WaveWatch,
    zone: usize,
) -> bool {
    if zone >= signature.len() {
        return false;
    }
    let (at, next) = (signature.zone(zone), signature.zone(zone + 1));
    let layered = posed.written.material.is_some();
    let slides = at.regime.sliding().is_some();
    let lands = at.regime == Regime::Separation;
    match watch {
        WaveWatch::Duration => true,
        // P exceeds that of stick where V̇ > 1
        WaveWatch::Pressure => slides && (layered || at.regime == Regime::Slip),
        WaveWatch::Rate => slides,
        WaveWatch::Gap | WaveWatch::LandingSpeed => lands,
        WaveWatch::LandingRate => slides && at.entry == ZoneEntry::Landing,
        WaveWatch::LandingPressure => at.regime == Regime::Slip && at.entry == ZoneEntry::Landing,
        WaveWatch::Tension => at.entry == ZoneEntry::Touch,
        WaveWatch::LowerForce => at.regime == Regime::Stick,
        WaveWatch::UpperForce => match at.regime {
            Regime::Reverse => next.entry == ZoneEntry::Reversal,
            Regime::Separation => {
                next.entry == ZoneEntry::ArrestedLanding && next.regime == Regime::Slip
            }
            _ => false,
        },
        WaveWatch::Impulse => {
            lands && next.entry == ZoneEntry::ArrestedLanding && posed.impact == Impact::Coulomb
        }
        WaveWatch::Release => layered && at.entry == ZoneEntry::Release,
        WaveWatch::Coupling => false,
    }
}

/// Whether 2π/k is the least period of a wave: where its zones repeat themselves, entries or durations differ.
pub(super) fn is_primitive(system: &WaveSystem, x: &[Interval]) -> bool {
    let signature = &system.near.signature;
    let zones = signature.len();
    let unknowns = |zone: usize| {
        let first = system.duration(zone) - 2;
        &x[first..first + 3]
    };
    let same = |zone: usize, shift: usize| {
        let other = unknowns((zone + shift) % zones);
        let mut both = unknowns(zone).iter().zip(other);
        signature.zone(zone) == signature.zone(zone + shift)
            && both.all(|(one, other)| !one.intersection(*other).is_empty())
    };
    let mut shifts = (1..zones).filter(|shift| zones.is_multiple_of(*shift));
    !shifts.any(|shift| (0..zones).all(|zone| same(zone, shift)))
}

/// Whether λ = iω of a crossing is where its type has it: off 0 at an HB, at 0 for certain at a BP.
///
/// With (ω, η) the equations have (−ω, η̄) as a solution where e^{2πij/k} is real: where they have one zero in a box that
/// holds its mirror image, too, ω = 0.
pub(super) fn crosses_where_said(
    system: &WaveSystem,
    middle: &[f64],
    zero: &[Interval],
) -> Result<(), OpenPoint> {
    let WaveCondition::Crossing { sector, omega } = system.condition else {
        return Ok(());
    };
    if omega != 0.0 {
        return match zero[system.waves()].contains(0.0) {
            true => Err(OpenPoint::AtZero),
            false => Ok(()),
        };
    }
    if !is_real(sector, system.mode()) {
        return Err(OpenPoint::AtZero);
    }
    // ω, and imaginary parts of the eigenfunction
    let mut both = zero.to_vec();
    for x in both.iter_mut().skip(system.waves()).step_by(2) {
        *x = x.hull(-*x);
    }
    let equations = |x: &[Interval]| system.evaluate(x);
    match krawczyk::is_only_zero(&equations, middle, &both) {
        true => Ok(()),
        false => Err(OpenPoint::AtZero),
    }
}

/// Whether the minimum of an event lies inside the step of its zone, not at its ends or beyond them.
pub(super) fn lies_inside(system: &WaveSystem, x: &[Interval]) -> Result<(), OpenPoint> {
    let Some((zone, step, place)) = system.minimum(x) else {
        return Ok(());
    };
    let (_, time) = system.step_at(x, zone, step);
    match place.is_positive() && (time - place).is_positive() {
        true => Ok(()),
        false => Err(OpenPoint::Margin),
    }
}

/// Whether e^{2πij/k} is real.
fn is_real(sector: usize, mode: u32) -> bool {
    u64::try_from(sector).is_ok_and(|sector| (2 * sector).is_multiple_of(u64::from(mode)))
}

/// Type of an event by what vanishes there.
pub(super) fn type_of(near: &NearWave, condition: &WaveCondition) -> EventType {
    match condition {
        WaveCondition::Value(_) => EventType::UZ,
        WaveCondition::Fold => EventType::LP,
        WaveCondition::Crossing { omega: 0.0, .. } => EventType::BP,
        WaveCondition::Crossing { .. } => EventType::HB,
        WaveCondition::Margin { watch, zone, time } => {
            let margin = RegimeMargin {
                watch: *watch,
                zone: *zone,
                time: *time,
                jet: Default::default(),
                beyond: Default::default(),
            };
            Wave::classify(&near.signature, None, &margin)
        }
    }
}

/// Whether the type of an event follows from what vanishes there.
pub(super) fn check_type(
    said: EventType,
    near: &NearWave,
    condition: &WaveCondition,
) -> Result<(), RefusedProof> {
    if let WaveCondition::Margin { zone, .. } = condition
        && *zone >= near.signature.len()
    {
        return Err(RefusedProof::Statement("the zone of the event"));
    }
    let found = match type_of(near, condition) {
        // of a value the certificate does not say who asked for it
        EventType::UZ if said == EventType::EP => EventType::EP,
        found => found,
    };
    if found == said {
        Ok(())
    } else {
        Err(RefusedProof::Kind { said, found })
    }
}

/// Proves that what is stated beyond an event is the wave of a change of regime, as seen from its other side.
///
/// # Errors
/// There is no change, or it is not proven.
pub(super) fn check_beyond(
    posed: &PosedWave,
    near: &NearWave,
    condition: &WaveCondition,
    beyond: &WaveBeyond,
) -> Result<(), RefusedProof> {
    let WaveCondition::Margin { .. } = condition else {
        return Err(RefusedProof::Statement("that the regimes change"));
    };
    if near.signature.is_rotation_of(&beyond.near.signature) {
        return Err(RefusedProof::Statement("the sequence of zones beyond"));
    }
    check_type(type_of(near, condition), &beyond.near, &beyond.condition)?;
    change::prove(posed, near, condition, beyond)
        .map_err(|reason| RefusedProof::NoProof(reason.to_string()))
}

/// Whether the event of another wave may be the same one.
pub(super) fn is_event_of(one: &WaveProof, other: &WaveProof) -> bool {
    let meet = |a: Interval, b: Interval| !a.intersection(b).is_empty();
    let (first, second) = (&one.statement, &other.statement);
    let crosses_alike = |a: usize, b: usize| {
        let omegas = first.omega.zip(second.omega);
        let mode = one.posed.mode as usize;
        omegas.is_some_and(|(x, y)| {
            a == b && meet(x, y) || (a + b).is_multiple_of(mode.max(1)) && meet(x, -y)
        })
    };
    let alike = match (&one.condition, &other.condition) {
        (WaveCondition::Fold, WaveCondition::Fold)
        | (WaveCondition::Margin { .. }, WaveCondition::Margin { .. }) => true,
        (WaveCondition::Crossing { sector: a, .. }, WaveCondition::Crossing { sector: b, .. }) => {
            crosses_alike(*a, *b)
        }
        _ => false,
    };
    let entries = |proof: &WaveProof| -> Vec<Vec<f64>> {
        let zones = proof.near.zones.iter();
        zones.map(|[y, w, _]| vec![*y, *w]).collect()
    };
    alike
        && meet(first.parameter, second.parameter)
        && meet(first.speed, second.speed)
        && begin_alike(&entries(one), &entries(other))
}
