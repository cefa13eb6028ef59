//! The other branch at an orbit with a multiplier −1, or with one that passes 1 other than by a fold.
//!
//! At a multiplier −1 the orbit traversed twice has the null vector (ξ, −ξ) with (M + 1)ξ = 0; at a multiplier 1 the
//! orbit itself has one. Either belongs to the equations at a fixed parameter, since the branch that is known moves
//! in the parameter. The other one leaves along it. At the event the equations are singular whatever borders them:
//! both branches pass; a short way along the null vector they are not.

use std::sync::Arc;

use super::layout::{AffineOrbit, Setting, ZonePoint};
use super::row::SavedOrbit;
use super::signature::Zone;
use super::start::{NoStart, Wanted, admitted, restart, scaled};
use crate::continuation::arclength::correct;
use crate::continuation::newton::{self, Plane, Settings};
use crate::linalg::{self, Vector};
use crate::orbit::Orbit;

/// The other branch a short way from the event, on one of its sides.
#[derive(Clone, Debug)]
pub struct Side {
    /// Its orbits.
    pub orbit: AffineOrbit,
    /// The first of them.
    pub point: Vector,
    /// Whether the parameter grows from there on.
    pub up: bool,
}

/// A located event solves the singular equations to about 1e-12, and those of an orbit without one are far from it.
const SINGULAR: f64 = 1e-7;

/// How far from the event the branch begins, in scaled unknowns of order one, and how often a quarter of it is tried:
/// the parameter moves by the square of it where the branch begins level.
const AWAY: f64 = 3e-3;
const TRIES: i32 = 5;

/// Both sides of the other branch at a saved event, at a multiplier −1 where it is `doubled`; the one where the
/// parameter grows first. At a doubling and at a loss of symmetry both sides go one way, and one is the other shifted
/// in time or mirrored. Where the saved orbit is itself one of a part of its period, traversed several times, the
/// other branch is that of the part.
///
/// # Errors
/// The saved orbit is none of the system, no other branch passes there, or it is not admissible.
pub fn switch(wanted: &Wanted, saved: &SavedOrbit, doubled: bool) -> Result<Vec<Side>, NoStart> {
    let mut parts = saved.parts().ok_or(NoStart::NoZones)?;
    let (own, at) = scaled(wanted, parts.clone(), saved.periods)?;
    let times = own.traversals(&at);
    if doubled && times > 1 {
        let (orbit, point) = restart(wanted, &saved.part(times))?;
        let side = |up| Side {
            orbit: orbit.clone(),
            point: point.clone(),
            up,
        };
        return Ok([true, false].map(side).into());
    }
    let (orbit, at) = if doubled {
        twice(&mut parts);
        scaled(wanted, parts, 2 * saved.periods)?
    } else {
        (own, at)
    };
    let evaluated = newton::jacobian(&orbit, &at).map_err(newton::Failure::System);
    let (matrix, _) = evaluated.map_err(NoStart::Newton)?;
    let square = matrix.columns(0, at.len() - 1).clone_owned();
    let least = linalg::least(&square).ok_or(NoStart::Newton(newton::Failure::Singular))?;
    if least.value > SINGULAR * least.largest {
        return Err(NoStart::Regular(least.value / least.largest));
    }
    let along = least.right.insert_row(at.len() - 1, 0.0);
    let mut sides = Vec::with_capacity(2);
    let mut refused = NoStart::NoZones;
    for sign in [1.0, -1.0] {
        match side(&orbit, &at, &(&along * sign)) {
            Ok(side) => sides.push(side),
            Err(error) => refused = error,
        }
    }
    sides.sort_by_key(|side| !side.up);
    if sides.is_empty() {
        return Err(refused);
    }
    Ok(sides)
}

/// The zones of an orbit traversed twice. One that never switches is one zone, however long.
fn twice(parts: &mut Vec<(Zone, ZonePoint)>) {
    match &mut parts[..] {
        [(Zone { way: None, .. }, place)] => place.duration *= 2.0,
        _ => parts.extend_from_within(..),
    }
}

/// The branch that leaves a singular point along a null vector.
fn side(orbit: &AffineOrbit, at: &Vector, along: &Vector) -> Result<Side, NoStart> {
    const NEWTON: Settings = Settings {
        tolerance: 1e-10,
        most_iterations: 20,
        halvings: 4,
        polish: 1,
    };
    let mut refused = NoStart::NoZones;
    for exponent in 0..TRIES {
        let guess = at + along * (AWAY * 0.25_f64.powi(exponent));
        let mut plane = Plane {
            normal: along,
            through: &guess,
        };
        let corrected = correct(orbit, &mut plane, &guess, along, &NEWTON);
        let found = corrected.map_err(NoStart::Newton).and_then(|(node, _)| {
            admitted(orbit, &node.point)?;
            Ok(node)
        });
        match found {
            Ok(node) => {
                let setting = Setting {
                    values: values_at(orbit, &node.point),
                    ..(*orbit.setting).clone()
                };
                let begun = AffineOrbit::new(Arc::new(setting), orbit.sequence.clone());
                return Ok(Side {
                    orbit: begun.ok_or(NoStart::NoZones)?,
                    up: node.tangent[at.len() - 1] > 0.0,
                    point: node.point,
                });
            }
            Err(error) => refused = error,
        }
    }
    Err(refused)
}

/// Values of all parameters at a point.
fn values_at(orbit: &AffineOrbit, point: &Vector) -> Vec<f64> {
    let mut values = orbit.setting.values.clone();
    values[orbit.setting.parameter] = orbit.value_at(point);
    values
}
