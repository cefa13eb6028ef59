//! The other branch at an orbit with a multiplier −1, or with one that passes 1 other than by a fold.
//!
//! At a multiplier −1 the orbit traversed twice has the null vector (ξ, −ξ) with (M + 1)ξ = 0; at a multiplier 1 the
//! orbit itself has one.

use std::sync::Arc;

use super::layout::AffineOrbit;
use super::row::{SavedOrbit, twice};
use super::setting::Setting;
use super::start::{NoStart, Wanted, restart, scaled};
use crate::continuation::Node;
use crate::linalg::Vector;
use crate::orbit::switch::other;
use crate::orbit::{CoordinateChanges, Zones};

/// The same orbit, and a direction there, in as many shots as its growth asks for, where these are others: traversed twice the square
/// of it.
fn parted(orbit: &AffineOrbit, node: &Node) -> Option<(AffineOrbit, Node)> {
    let examination = orbit.examination(&node.point).ok()?;
    let parted = orbit.renewed(&node.point, &examination, false)?;
    let node = orbit.carried(&parted, node)?;
    Some((parted, node))
}

/// The first orbit of the other branch at a saved event, at a multiplier −1 where it is `doubled`, and the ways that
/// it goes, of those asked for where it goes both. Where the saved orbit is itself one of a part of its period,
/// traversed several times, the other branch is that of the part.
///
/// # Errors
/// The saved orbit is none of the system, no other branch passes there, or it is not admissible.
pub fn switch(
    wanted: &Wanted,
    saved: &SavedOrbit,
    doubled: bool,
    directions: &[bool],
) -> Result<(AffineOrbit, Vector, Vec<bool>), NoStart> {
    let parts = saved.parts().ok_or(NoStart::NoZones)?;
    let (own, at) = scaled(wanted, parts, saved.periods)?;
    let times = own.traversals(&at);
    if doubled && times > 1 {
        let (orbit, point) = restart(wanted, &saved.part(times))?;
        return Ok((orbit, point, directions.to_vec()));
    }
    let along = saved.beside.as_ref().filter(|_| !doubled);
    let along = along.and_then(|beside| own.direction_to(&at, beside));
    let (orbit, at) = if doubled {
        let mut zones = saved.zones.clone();
        twice(&saved.sequence, &mut zones);
        let sequence = saved.sequence.0.iter().cycle().cloned();
        scaled(wanted, sequence.zip(zones).collect(), 2 * saved.periods)?
    } else {
        (own, at)
    };
    // one of no length is none
    let along = along.unwrap_or_else(|| Vector::zeros(at.len()));
    let node = Node::at(at, along);
    let (orbit, node) = parted(&orbit, &node).unwrap_or((orbit, node));
    let (point, ways) = other(&orbit, (&node.point, Some(node.tangent)), directions)?;
    let setting = Setting {
        values: orbit.values_at(&point),
        ..(*orbit.setting).clone()
    };
    let begun = AffineOrbit::new(Arc::new(setting), orbit.sequence.clone());
    Ok((begun.ok_or(NoStart::NoZones)?, point, ways))
}
