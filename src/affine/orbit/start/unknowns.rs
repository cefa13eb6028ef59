//! Zones and places of a guess as the unknowns of an orbit, in units of their own, and the orbit that Newton's method finds there.

use std::sync::Arc;

use super::Wanted;
use super::failure::NoStart;
use crate::affine::orbit::CLOSING;
use crate::affine::orbit::layout::{AffineOrbit, OrbitAt, ZonePoint};
use crate::affine::orbit::row::first_of;
use crate::affine::orbit::section::of_orbit;
use crate::affine::orbit::setting::{OrbitFailure, Scales, Setting};
use crate::affine::orbit::signature::{Sequence, Zone};
use crate::continuation::newton::{self, Fixed, Settings};
use crate::linalg::periodic_schur::balance;
use crate::linalg::{Matrix, Vector};
use crate::orbit::special::NoFollower;
use crate::orbit::switch::{admitted, is_in_family};
use crate::orbit::{Zones, rounding_across};

/// The orbit with these zones next to these places.
pub(super) fn pose(
    wanted: &Wanted,
    parts: Vec<(Zone, ZonePoint)>,
    periods: u32,
    settings: &Settings,
) -> Result<(AffineOrbit, Vector), NoStart> {
    let (orbit, guess) = scaled(wanted, parts, periods)?;
    found(wanted, (&orbit, &guess), periods, settings).or_else(|reason| {
        let in_shots = by_shots(wanted, (&orbit, &guess), periods, settings);
        in_shots.ok_or(reason)
    })
}

/// The orbit next to a guess.
fn found(
    wanted: &Wanted,
    (orbit, guess): (&AffineOrbit, &Vector),
    periods: u32,
    settings: &Settings,
) -> Result<(AffineOrbit, Vector), NoStart> {
    /// Parts of an orbit that differ by less, in its own units, are the same.
    const SAME: f64 = 1e-9;
    let stays = !orbit.is_forced() && orbit.sequence.switches() == 0;
    let rests = |point: &Vector| stays && orbit.varies_within(point, SAME);
    let point = solved(orbit, guess, settings).map_err(|failure| {
        let singular = matches!(failure, newton::Failure::Singular);
        if singular && rests(guess) {
            NoStart::Equilibrium
        } else if singular && is_in_family(orbit, guess) {
            NoStart::Family(NoFollower::Family)
        } else {
            NoStart::Newton(failure)
        }
    })?;
    if let Some(mode) = collapsed(orbit, guess, &point) {
        return Err(NoStart::Shrinks { mode });
    }
    if rests(&point) {
        return Err(NoStart::Equilibrium);
    }
    let times = orbit.traversals_within(&point, SAME);
    // a prescribed period is meant, however often the orbit is traversed in it
    if times > 1 && wanted.prescribed.is_none() {
        // the least period is meant: this one several times over would retrace its branch
        let zones = orbit.at(&point).map_err(failed)?.zones;
        let (sequence, zones) = first_of(times, &orbit.sequence, &zones);
        let parts = sequence.0.into_iter().zip(zones).collect();
        let periods = periods / if orbit.is_forced() { times as u32 } else { 1 };
        return pose(wanted, parts, periods, settings);
    }
    let (orbit, point) =
        in_better_shots(orbit, &point, settings).unwrap_or_else(|| (orbit.clone(), point));
    admitted(&orbit, &point)?;
    Ok((orbit, point))
}

/// The same orbit in as many shots as it asks for, where it was found in others and is known better in these: as well as one that is
/// followed.
fn in_better_shots(
    orbit: &AffineOrbit,
    point: &Vector,
    settings: &Settings,
) -> Option<(AffineOrbit, Vector)> {
    let (orbit, guess) = orbit.in_own_shots(point)?;
    let point = solved(&orbit, &guess, settings).ok()?;
    let is_better = (&point - &guess).amax() > settings.tolerance;
    is_better.then_some((orbit, point))
}

/// The orbit next to a guess along which a motion grows by so much that it asks for several shots: of such a guess the places in between
/// are known, and its end has few digits, or none. What is found has units of its own.
fn by_shots(
    wanted: &Wanted,
    (orbit, guess): (&AffineOrbit, &Vector),
    periods: u32,
    settings: &Settings,
) -> Option<(AffineOrbit, Vector)> {
    if orbit.sequence.further_shots() > 0 {
        return None;
    }
    let (orbit, guess) = orbit.in_own_shots(guess)?;
    let point = solved(&orbit, &guess, settings).ok()?;
    let at = orbit.at(&point).ok()?;
    let zones = orbit.sequence.0.iter().cloned();
    let parts = zones.zip(at.zones).collect();
    let wanted = Wanted {
        values: at.values,
        ..wanted.clone()
    };
    pose(&wanted, parts, periods, settings).ok()
}

/// The unknowns of the orbit next to a guess at its value of the parameter.
fn solved(
    orbit: &AffineOrbit,
    guess: &Vector,
    settings: &Settings,
) -> Result<Vector, newton::Failure<OrbitFailure>> {
    let index = guess.len() - 1;
    let mut fixed = Fixed {
        index,
        value: guess[index],
    };
    newton::solve(orbit, &mut fixed, guess, settings).map(|solution| solution.point)
}

/// The mode of a zone that has lasted in a guess and lasts no more in its solution.
fn collapsed(orbit: &AffineOrbit, guess: &Vector, point: &Vector) -> Option<String> {
    /// Part of a duration to which Newton's method leads no zone that lasts.
    const LITTLE: f64 = 1e-3;
    let collapses = |zone: &usize| {
        let [before, after] = [guess, point].map(|at| at[orbit.duration_index(*zone)].abs());
        after <= CLOSING && after < LITTLE * before
    };
    let zone = (0..orbit.sequence.len()).find(collapses)?;
    Some(orbit.sequence.zone(zone).name.clone())
}

/// The mode of a zone whose duration is nothing but rounding: the equations hold with it and no orbit has it, as where slip that dies out
/// has become too little to be seen.
pub(super) fn lasts_by_rounding(orbit: &AffineOrbit, point: &Vector) -> Option<String> {
    /// Roundings that a duration has at least.
    const ORDERS: f64 = 10.0;
    let mut along = Vector::zeros(point.len());
    along[point.len() - 1] = 1.0;
    let rounding = rounding_across(orbit, &along, point)?.of_unknowns();
    let is_rounding = |zone: &usize| {
        let duration = orbit.duration_index(*zone);
        point[duration].abs() <= ORDERS * rounding[duration]
    };
    let zone = (0..orbit.sequence.len()).find(is_rounding)?;
    Some(orbit.sequence.zone(zone).name.clone())
}

fn failed(failure: OrbitFailure) -> NoStart {
    NoStart::Newton(newton::Failure::System(failure))
}

/// A size, or 1 where there is none.
fn unit(size: f64) -> f64 {
    if size > 0.0 && size.is_finite() {
        size
    } else {
        1.0
    }
}

/// Units of the states from their sizes along an orbit. A state that is zero along it but for rounding has no size of its own: it is
/// measured by how it acts on others, and they on it, from zone to zone.
fn units(orbit: &AffineOrbit, point: &Vector, sizes: Vec<f64>) -> Result<Vec<f64>, OrbitFailure> {
    /// A state that never exceeds this part of what the others make of it is rounding, and more where that grows along the orbit: by
    /// no more than the second part.
    const NOTHING: f64 = 1e-12;
    const GROWN: f64 = 1e-9;
    /// A state that never exceeds this is zero where that does not tell.
    const SMALL: f64 = 1e-15;
    /// Units further apart are none: what acts on it is lost in what decays.
    const APART: f64 = 1e12;
    let states = sizes.len();
    let at = orbit.at(point)?;
    let passages = at.passages()?;
    let flows = passages
        .iter()
        .map(|passage| passage.flow.view((0, 0), (states, states)).into_owned());
    let flows: Vec<Matrix> = flows.collect();
    // one that is zero since nothing acts on it yet does so in modes beyond an event
    let acts = |one: usize, other: usize| flows.iter().any(|flow| flow[(one, other)] != 0.0);
    let stands_alone = |state: usize| {
        let mut others = (0..states).filter(|other| *other != state);
        sizes[state] <= SMALL && !others.any(|other| acts(state, other) || acts(other, state))
    };
    let rates = match (0..states).any(stands_alone) {
        true => slopes_of_modes(&at),
        false => Vec::new(),
    };
    let alike = balance(&flows.iter().chain(&rates).collect::<Vec<_>>());
    let growth = growth(&flows, &alike);
    let nothing = (NOTHING * growth).min(GROWN);
    let pairs = || sizes.iter().zip(&alike);
    let largest = pairs().fold(0.0, |most: f64, (size, alike)| most.max(size / alike));
    let least = alike.iter().copied().fold(f64::INFINITY, f64::min);
    let tells = alike.iter().all(|alike| *alike <= APART * least);
    let small = |(size, alike): (&f64, &f64)| *size <= nothing * largest * alike;
    let mut is_zero: Vec<bool> = pairs().map(small).collect();
    // along a chain of states units alike fall as one likes: what acts on a state tells that it is small and not zero
    let is_told = |acting: f64, [state, other]: [usize; 2]| {
        acting * alike[other] > GROWN * growth * alike[state]
    };
    while let Some(state) = (0..states).find(|state| {
        let made = made(&flows, &sizes, (*state, &is_zero), is_told);
        is_zero[*state] && made > 0.0 && sizes[*state] > nothing * made
    }) {
        is_zero[state] = false;
    }
    // units alike say nothing of a state that acts on no other: what others make of it does, where it is rounding beside that
    let cancels = |state: usize| {
        let made = made(&flows, &sizes, (state, &is_zero), |_, _| true);
        (sizes[state] <= nothing * made).then_some(made)
    };
    let units = pairs().enumerate().map(|(state, (size, alike))| {
        if is_zero[state] && tells {
            return unit(largest * alike);
        }
        match cancels(state) {
            Some(made) => unit(made),
            None if *size > SMALL => unit(*size),
            None => 1.0,
        }
    });
    Ok(units.collect())
}

/// The most that a perturbation grows by along one of these flows, in these units.
fn growth(flows: &[Matrix], units: &[f64]) -> f64 {
    let states = units.len();
    let grown = |flow: &Matrix| {
        Matrix::from_fn(states, states, |to, from| {
            flow[(to, from)] * units[from] / units[to]
        })
        .amax()
    };
    flows.iter().map(grown).fold(1.0, f64::max)
}

/// The most that another state, which is not zero, makes of a state along one of these flows, of those whose action counts.
fn made(
    flows: &[Matrix],
    sizes: &[f64],
    (state, is_zero): (usize, &[bool]),
    counts: impl Fn(f64, [usize; 2]) -> bool,
) -> f64 {
    let others = (0..sizes.len()).filter(|other| *other != state && !is_zero[*other]);
    let by = |other: usize| {
        let entries = flows.iter().map(|flow| flow[(state, other)].abs());
        let acting = entries.fold(0.0, f64::max);
        if counts(acting, [state, other]) {
            acting * sizes[other]
        } else {
            0.0
        }
    };
    others.map(by).fold(0.0, f64::max)
}

/// The derivatives of the rates of every mode of a system at the beginning of an orbit.
fn slopes_of_modes(at: &OrbitAt) -> Vec<Matrix> {
    let system = &at.posed.system;
    let begin = Vector::from_column_slice(&at.zones[0].state);
    let slopes = |mode: usize| {
        let rates = system.rates(mode, &begin)?;
        Some(rates.slopes.rows(0, begin.len()).into_owned())
    };
    (0..system.modes.len()).filter_map(slopes).collect()
}

/// The orbits with these zones, in units of these places, and the places in those.
pub(in crate::affine::orbit) fn scaled(
    wanted: &Wanted,
    parts: Vec<(Zone, ZonePoint)>,
    periods: u32,
) -> Result<(AffineOrbit, Vector), NoStart> {
    let (zones, points): (Vec<Zone>, Vec<ZonePoint>) = parts.into_iter().unzip();
    if wanted.values.len() != wanted.system.source.parameters.0.len() {
        return Err(NoStart::NoZones);
    }
    let states = wanted.system.source.states.len();
    if points.is_empty() || points.iter().any(|point| point.state.len() != states) {
        return Err(NoStart::NoZones);
    }
    let scales = Scales {
        states: vec![1.0; states],
        time: unit(points.iter().map(|point| point.duration).sum()),
        parameter: wanted.width,
        free: wanted
            .prescribed
            .as_ref()
            .map(|prescribed| unit(wanted.values[prescribed.free()].abs())),
        section: None,
    };
    let setting = |scales: Scales| Setting {
        system: wanted.system.clone(),
        values: wanted.values.clone(),
        parameter: wanted.parameter,
        second: None,
        periods,
        prescribed: wanted.prescribed.clone(),
        stability: wanted.stability,
        scales,
    };
    let sequence = Sequence(zones);
    let posed = |scales: Scales| {
        let orbit = AffineOrbit::new(Arc::new(setting(scales)), sequence.clone());
        orbit.ok_or(NoStart::NoZones)
    };
    // a state may be zero at all of the switches: its size is that between them
    let bare = posed(scales.clone())?;
    let guess = bare.pack(&points, &wanted.values);
    let extremes = bare.extremes(&guess).map_err(failed)?;
    let sizes = extremes.iter().map(|(low, high)| low.abs().max(high.abs()));
    let units = units(&bare, &guess, sizes.collect()).map_err(failed)?;
    let free = wanted.system.source.forcing.is_none();
    let orbit = posed(Scales {
        section: free.then(|| of_orbit(&extremes, &units)).flatten(),
        states: units,
        ..scales
    })?;
    let orbit = orbit.keeping(&points[0].state);
    let point = orbit.pack(&points, &wanted.values);
    let begun = free && orbit.sequence.switches() == 0;
    let point = match begun {
        true => orbit.begun_at_section(&orbit, &point).map_err(failed)?,
        false => point,
    };
    Ok((orbit, point))
}
