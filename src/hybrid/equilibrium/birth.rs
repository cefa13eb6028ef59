//! The cycle that is born at a Hopf point of a branch of equilibria, or grows from a boundary equilibrium.

use super::super::begin::{FirstOrbit, NoFirstPoint, wanted};
use super::begin::NamedEquilibrium;
use super::point::LabelledEquilibrium;
use crate::affine::equilibrium::EquilibriumCurve;
use crate::affine::equilibrium::cycle::{CycleGuess, NoCycle};
use crate::affine::equilibrium::start::EquilibriumRequest;
use crate::affine::orbit::AffineOrbit;
use crate::affine::orbit::start::{Beginning, Search, Wanted, first};
use crate::linalg::Vector;
use crate::orbit::EventType;
use crate::problem::{Continuation, SystemProblem};

/// The cycle of a guess, if Newton's method comes to it, at the other values of the parameters.
fn cycle(
    guess: &CycleGuess,
    wanted: &Wanted,
    mut values: Vec<f64>,
) -> Option<(AffineOrbit, Vector)> {
    values[wanted.parameter] = guess.value;
    let beginning = Beginning {
        mode: guess.mode,
        state: guess.state.clone(),
        phase: 0.0,
    };
    let asked = Wanted {
        values,
        ..wanted.clone()
    };
    let (orbit, point) = first(&asked, &beginning, Search::Guess(guess.period)).ok()?;
    let extremes = orbit.extremes(&point).ok()?;
    let ranges: Vec<f64> = extremes.iter().map(|(low, high)| high - low).collect();
    let period = orbit.at(&point).ok()?.period();
    let units = &orbit.setting.scales.states;
    guess
        .is_like(period, &ranges, units)
        .then_some((orbit, point))
}

/// The first cycle on the side of an event on which cycles lie; the branch leads away from it.
pub(in crate::hybrid) fn born(
    problem: &SystemProblem,
    continuation: &Continuation<String>,
    named: &NamedEquilibrium,
) -> Result<FirstOrbit, NoFirstPoint> {
    let NamedEquilibrium { saved, kind } = named;
    let LabelledEquilibrium {
        label,
        mode,
        state,
        values,
        ..
    } = saved;
    if !matches!(kind, Some(EventType::HB | EventType::BE)) {
        return Err(NoFirstPoint::NotHopf {
            label: *label,
            kind: kind.map_or_else(|| "none".to_owned(), |kind| kind.to_string()),
        });
    }
    let wanted = wanted(problem, continuation, values.clone())?;
    let request = EquilibriumRequest {
        system: problem.system.clone(),
        values: values.clone(),
        parameter: wanted.parameter,
        width: wanted.width,
        mode: problem.system.mode(mode).ok_or(NoFirstPoint::Unknown)?,
    };
    // at a kink the rates have no derivatives, and their eigenvalues jump
    let at = EquilibriumCurve::at(&request, state);
    let (curve, point) = at.map_err(|_| NoFirstPoint::NoCycle(NoCycle::NoHopf))?;
    let guesses = match kind {
        Some(EventType::BE) => curve.boundary_cycles(&point),
        _ => curve.cycles(&point),
    };
    let guesses = guesses.map_err(NoFirstPoint::NoCycle)?;
    let (low, high) = continuation.range;
    let within = guesses
        .iter()
        .filter(|guess| (low..=high).contains(&guess.value));
    let mut tried = 0;
    for guess in within {
        tried += 1;
        if let Some((orbit, point)) = cycle(guess, &wanted, values.clone()) {
            let directions = vec![guess.up];
            return Ok(FirstOrbit {
                orbit,
                point,
                directions,
            });
        }
    }
    match guesses.first() {
        Some(guess) if tried == 0 => Err(NoFirstPoint::LabelOutside {
            label: *label,
            column: continuation.parameter.clone(),
            value: guess.value,
            low,
            high,
        }),
        _ => Err(NoFirstPoint::NoCycle(NoCycle::NotFound)),
    }
}
