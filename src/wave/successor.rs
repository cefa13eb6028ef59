//! The signature that follows an event, by the rules of the switching table.
//!
//! At an event one zone has no length, or one zone is about to be split, or the table decides
//! otherwise at one switch. In each case the wave is cut open at that instant, between a zone
//! `before` and a zone `after` it, and every chain of zones that the switching table allows from
//! one to the other is a candidate: the new zones start with no length. Whether a candidate solves
//! its equations at the event, and whether it is admissible a step further on, decides; there is
//! no list of known sequences.

use crate::flow::FlowError;
use crate::linalg::Vector;
use crate::model::signature::{Entry, Regime, Signature, Zone, paths};
use crate::newton::System;

use super::admissibility::{Margin, Watch};
use super::{Flows, Wave};

/// New zones tried at one event: two suffice for every codimension-one event of the table, since
/// one instant can pass at most through reverse and stick on its way between two others.
const LONGEST_CHAIN: usize = 2;

/// A signature to try from an event.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Boundary-value problem of the new signature.
    pub wave: Wave,
    /// The wave of the event in its unknowns.
    pub point: Vector,
    /// Zones that have no length yet.
    pub nascent: Vec<usize>,
}

/// A wave cut open at one instant: zones in order from just after the instant to just before it.
struct Opened {
    zones: Vec<Zone>,
    /// (Y, W, T) of each.
    states: Vec<[f64; 3]>,
    /// (Y, W) at the instant.
    instant: [f64; 2],
    /// The zones on both sides are two parts of one: nothing new needs no switch.
    joined: bool,
}

/// Every candidate for the signature beyond an event.
pub fn candidates(
    wave: &Wave,
    point: &Vector,
    margin: &Margin,
) -> Result<Vec<Candidate>, FlowError> {
    let Some(opened) = open(wave, point, margin)? else {
        return Ok(Vec::new());
    };
    let excess = wave.excess_at(point);
    let parameter = wave.parameter_at(point);
    let flows = wave.flows(point)?;
    let mut found = Vec::new();
    let mut add = |zones: Vec<Zone>, states: Vec<[f64; 3]>, nascent: Vec<usize>| {
        let (zones, states, nascent) = match sectioned(wave, &flows, zones, states, nascent) {
            Some(cut) => cut,
            // one zone alone has no switch that could fix its phase
            None => return,
        };
        let (zones, states, nascent) = from_release(zones, states, nascent);
        let signature = Signature(zones);
        if signature.is_rotation_of(&wave.signature) {
            return;
        }
        let candidate = wave.with_signature(signature);
        let point = candidate.pack(&states, excess, parameter);
        if candidate.unknowns() <= crate::newton::MOST_UNKNOWNS {
            found.push(Candidate {
                wave: candidate,
                point,
                nascent,
            });
        }
    };
    let count = opened.zones.len();
    let (first, last) = (opened.zones[0], opened.zones[count - 1]);
    // both sides in the same regime: they may become one zone
    if first.regime == last.regime && count > 1 && !opened.joined {
        let mut zones = opened.zones[1..].to_vec();
        let mut states = opened.states[1..].to_vec();
        let merged = states.len() - 1;
        states[merged][2] += opened.states[0][2];
        // the merged zone closes the cycle
        zones.rotate_right(1);
        states.rotate_right(1);
        add(zones, states, Vec::new());
    }
    // a contact zone that is left alone closes on itself
    if count == 1 && first.regime == Regime::Contact && !opened.joined {
        add(opened.zones.clone(), opened.states.clone(), Vec::new());
    }
    for chain in paths(last.regime, first.regime, LONGEST_CHAIN, wave.model.impact) {
        if !chain.iter().all(|zone| wave.model.law.has(zone.regime)) {
            continue;
        }
        let inserted = chain.len() - 1;
        let mut zones = chain;
        let mut states = vec![[opened.instant[0], opened.instant[1], 0.0]; inserted];
        zones.extend_from_slice(&opened.zones[1..]);
        states.extend_from_slice(&opened.states);
        add(zones, states, (0..inserted).collect());
    }
    Ok(found)
}

/// A cycle that can be posed: one contact zone alone is cut at V̇ = 0, and a wave with switches of
/// its own is not. `None` for one zone of any other regime.
#[allow(clippy::type_complexity)]
fn sectioned(
    wave: &Wave,
    flows: &Flows,
    mut zones: Vec<Zone>,
    mut states: Vec<[f64; 3]>,
    mut nascent: Vec<usize>,
) -> Option<(Vec<Zone>, Vec<[f64; 3]>, Vec<usize>)> {
    if zones.len() == 1 {
        if !wave.model.law.has(zones[0].regime) || zones[0].regime != Regime::Contact {
            return None;
        }
        let flow = flows.contact(Regime::Contact);
        let [y, w, duration] = states[0];
        let rising = flow
            .extremes([y, w], duration)
            .ok()?
            .into_iter()
            .filter_map(|time| flow.state([y, w], time).ok())
            .find(|state| flow.acceleration(*state) > 0.0)?;
        return Some((
            Signature::contact().0,
            vec![[rising[0], 0.0, duration]],
            Vec::new(),
        ));
    }
    let section = zones.iter().position(|zone| zone.entry == Entry::Section);
    if let Some(index) = section {
        let before = (index + zones.len() - 1) % zones.len();
        if zones[before].regime == zones[index].regime {
            states[before][2] += states[index][2];
            zones.remove(index);
            states.remove(index);
            nascent.retain(|zone| *zone != index);
            for zone in &mut nascent {
                *zone -= usize::from(*zone > index);
            }
        }
    }
    Some((zones, states, nascent))
}

/// Rotates a cycle so that it begins at a release, if there is one.
fn from_release(
    mut zones: Vec<Zone>,
    mut states: Vec<[f64; 3]>,
    nascent: Vec<usize>,
) -> (Vec<Zone>, Vec<[f64; 3]>, Vec<usize>) {
    let count = zones.len();
    // among several releases the one before the longest zones keeps the origin steady
    let start = (0..count)
        .filter(|&index| zones[index].entry == Entry::Release)
        .max_by(|&one, &other| states[one][2].total_cmp(&states[other][2]))
        .unwrap_or(0);
    zones.rotate_left(start);
    states.rotate_left(start);
    let nascent = nascent
        .into_iter()
        .map(|index| (index + count - start) % count)
        .collect();
    (zones, states, nascent)
}

/// Cuts a wave open where a margin is zero.
fn open(wave: &Wave, point: &Vector, margin: &Margin) -> Result<Option<Opened>, FlowError> {
    let count = wave.zones();
    let zones = &wave.signature.0;
    let mut states = wave.unpack(point);
    let index = margin.zone;
    let rotated = |start: usize, zones: &[Zone], states: &[[f64; 3]]| {
        let mut zones = zones.to_vec();
        let mut states = states.to_vec();
        let length = zones.len();
        zones.rotate_left(start % length);
        states.rotate_left(start % length);
        (zones, states)
    };
    Ok(Some(match margin.watch {
        Watch::Duration => {
            if count < 2 {
                return Ok(None);
            }
            let (mut zones, mut states) = rotated(index, zones, &states);
            zones.remove(0);
            let [y, w, _] = states.remove(0);
            Opened {
                zones,
                states,
                instant: [y, w],
                joined: false,
            }
        }
        Watch::Pressure | Watch::Rate | Watch::Gap => {
            // split: the second part keeps the regime, the first keeps the entry
            let zone = zones[index];
            let [y, w, duration] = states[index];
            let flows = wave.flows(point)?;
            let instant = match zone.regime {
                Regime::Separation => {
                    let [_, _, y, w] = flows.separation().state([y, w], margin.time)?;
                    [y, w]
                }
                regime => flows.contact(regime).state([y, w], margin.time)?,
            };
            states[index][2] = margin.time;
            let (mut zones, mut states) = rotated(index + 1, zones, &states);
            zones.insert(0, zone);
            states.insert(0, [instant[0], instant[1], duration - margin.time]);
            Opened {
                zones,
                states,
                instant,
                joined: true,
            }
        }
        Watch::LandingPressure | Watch::Tension | Watch::LandingRate | Watch::LowerForce => {
            let (zones, states) = rotated(index, zones, &states);
            let instant = [states[0][0], states[0][1]];
            Opened {
                zones,
                states,
                instant,
                joined: false,
            }
        }
        Watch::UpperForce | Watch::Impulse | Watch::LandingSpeed => {
            let (zones, states) = rotated(index + 1, zones, &states);
            let instant = [states[0][0], states[0][1]];
            Opened {
                zones,
                states,
                instant,
                joined: false,
            }
        }
    }))
}
