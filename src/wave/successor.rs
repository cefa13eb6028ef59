//! The signature that follows an event, by the rules of the switching table.
//!
//! At an event one zone has no length, or one zone is about to be split, or the table decides
//! otherwise at one switch. In each case the wave is cut open at that instant, between a zone
//! `before` and a zone `after` it, and every chain of zones that the switching table allows from
//! one to the other is a candidate: the new zones start with no length. Whether a candidate solves
//! its equations at the event, and whether it is admissible a step further on, decides; there is
//! no list of known sequences.

use crate::flow::{FlowError, Slide, SlidingFlow};
use crate::linalg::Vector;
use crate::model::signature::{Entry, Regime, Signature, Zone, paths};

use super::admissibility::{Margin, Watch};
use super::{Flows, Wave, ZoneUnknowns};

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
    /// (Y, W, T, G) of each.
    states: Vec<ZoneUnknowns>,
    /// (Y, W) at the instant.
    instant: [f64; 2],
    /// V̈ there, with material damping.
    acceleration: f64,
    /// The zones on both sides are two parts of one: nothing new needs no switch.
    joined: bool,
}

/// Every candidate for the signature beyond an event.
pub(crate) fn candidates(
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
    let mut add = |zones: Vec<Zone>, states: Vec<ZoneUnknowns>, nascent: Vec<usize>| {
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
        found.push(Candidate {
            wave: candidate,
            point,
            nascent,
        });
    };
    let count = opened.zones.len();
    let (first, last) = (opened.zones[0], opened.zones[count - 1]);
    // both sides in the same regime: they may become one zone
    if first.regime == last.regime && count > 1 && !opened.joined {
        let mut zones = opened.zones[1..].to_vec();
        let mut states = opened.states[1..].to_vec();
        let merged = states.len() - 1;
        states[merged][2] += opened.states[0][2];
        states[merged][3] = opened.states[0][3];
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
        if !chain.iter().all(|zone| wave.has(zone.regime)) {
            continue;
        }
        let inserted = chain.len() - 1;
        let [y, w] = opened.instant;
        let mut states: Vec<ZoneUnknowns> = chain[..inserted]
            .iter()
            .map(|zone| {
                let layer = nascent_layer(&flows, zone.regime, [y, w], opened.acceleration);
                [y, w, 0.0, layer]
            })
            .collect();
        let mut zones = chain;
        zones.extend_from_slice(&opened.zones[1..]);
        states.extend_from_slice(&opened.states);
        add(zones, states, (0..inserted).collect());
    }
    Ok(found)
}

/// G of a zone that has no length yet and is entered with this V̈.
fn nascent_layer(flows: &Flows, regime: Regime, instant: [f64; 2], acceleration: f64) -> f64 {
    match (regime, flows.contact(regime)) {
        (Regime::Slip | Regime::Reverse, SlidingFlow::Material(flow)) => {
            flow.layer_of(instant, acceleration)
        }
        _ => 0.0,
    }
}

/// A cycle that can be posed: one contact zone alone is cut at V̇ = 0, and a wave with switches of
/// its own is not. `None` for one zone of any other regime.
#[allow(clippy::type_complexity)]
fn sectioned(
    wave: &Wave,
    flows: &Flows,
    mut zones: Vec<Zone>,
    mut states: Vec<ZoneUnknowns>,
    mut nascent: Vec<usize>,
) -> Option<(Vec<Zone>, Vec<ZoneUnknowns>, Vec<usize>)> {
    if zones.len() == 1 {
        if !wave.model.law.has(zones[0].regime) || zones[0].regime != Regime::Contact {
            return None;
        }
        let flow = flows.contact(Regime::Contact);
        let [y, w, duration, layer] = states[0];
        let slide = Slide {
            entry: [y, w],
            duration,
            layer,
        };
        let rising = flow
            .extremes(&slide)
            .ok()?
            .into_iter()
            .filter_map(|time| Some((time, flow.state(&slide, time).ok()?)))
            .find(|(time, state)| flow.acceleration(&slide, *time, *state) > 0.0)?
            .1;
        return Some((
            Signature::contact().0,
            vec![[rising[0], 0.0, duration, 0.0]],
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
    mut states: Vec<ZoneUnknowns>,
    nascent: Vec<usize>,
) -> (Vec<Zone>, Vec<ZoneUnknowns>, Vec<usize>) {
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
    let flows = wave.flows(point)?;
    let entered = |index: usize| wave.entry_acceleration(&flows, point, index).value;
    let rotated = |start: usize, zones: &[Zone], states: &[ZoneUnknowns]| {
        let mut zones = zones.to_vec();
        let mut states = states.to_vec();
        let length = zones.len();
        zones.rotate_left(start % length);
        states.rotate_left(start % length);
        (zones, states)
    };
    Ok(Some(match margin.watch {
        Watch::Coupling => return Ok(None),
        Watch::Duration => {
            if count < 2 {
                return Ok(None);
            }
            let (mut zones, mut states) = rotated(index, zones, &states);
            zones.remove(0);
            let [y, w, ..] = states.remove(0);
            Opened {
                zones,
                states,
                instant: [y, w],
                acceleration: entered(index),
                joined: false,
            }
        }
        Watch::Pressure | Watch::Rate | Watch::Gap => {
            // split: the second part keeps the regime, the first keeps the entry
            let zone = zones[index];
            let slide = wave.slide_at(point, index);
            let (instant, acceleration) = match zone.regime {
                Regime::Separation => {
                    let [_, _, y, w] = flows.separation().state(slide.entry, margin.time)?;
                    ([y, w], 0.0)
                }
                regime => {
                    let flow = flows.contact(regime);
                    let state = flow.state(&slide, margin.time)?;
                    (state, flow.acceleration(&slide, margin.time, state))
                }
            };
            let rest = slide.duration - margin.time;
            states[index][2] = margin.time;
            if let (true, SlidingFlow::Material(flow)) = (wave.material, flows.contact(zone.regime))
            {
                states[index][3] = slide.layer * (-rest / flow.rho).exp();
            }
            let (mut zones, mut states) = rotated(index + 1, zones, &states);
            zones.insert(0, zone);
            states.insert(0, [instant[0], instant[1], rest, slide.layer]);
            Opened {
                zones,
                states,
                instant,
                acceleration,
                joined: true,
            }
        }
        Watch::LandingPressure
        | Watch::Tension
        | Watch::LandingRate
        | Watch::LowerForce
        | Watch::Release => {
            let (zones, states) = rotated(index, zones, &states);
            let instant = [states[0][0], states[0][1]];
            Opened {
                zones,
                states,
                instant,
                acceleration: entered(index),
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
                acceleration: entered(index + 1),
                joined: false,
            }
        }
    }))
}
