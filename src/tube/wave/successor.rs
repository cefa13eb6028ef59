//! The signature that follows an event, by the rules of the switching table.
//!
//! At an event one zone has no length, or one zone is about to be split, or the table decides
//! otherwise at one switch. In each case the wave is cut open at that instant, between a zone
//! `before` and a zone `after` it, and every chain of zones that the switching table allows from
//! one to the other is a candidate: the new zones start with no length. Whether a candidate solves
//! its equations at the event, and whether it is admissible a step further on, decides; there is
//! no list of known sequences.

use crate::linalg::Vector;
use crate::tube::flow::{FlowError, Slide, SlidingFlow};
use crate::tube::model::signature::{Regime, Signature, WaveZone, ZoneEntry, paths};

use super::admissibility::{RegimeMargin, WaveWatch};
use super::{Flows, Wave, WaveAt};
use crate::orbit::Candidate;

/// New zones tried at one event: two suffice for every codimension-one event of the table, since
/// one instant can pass at most through reverse and stick on its way between two others.
const LONGEST_CHAIN: usize = 2;

/// A zone of a cycle that may become a wave.
#[derive(Clone, Copy)]
struct CycleZone {
    zone: WaveZone,
    slide: Slide,
    /// Whether it has no length yet.
    nascent: bool,
}

/// A wave cut open at one instant.
struct CutWave {
    /// From just after the instant to just before it.
    zones: Vec<CycleZone>,
    /// (Y, W) at the instant.
    instant: [f64; 2],
    /// V̈ there, with material damping.
    acceleration: f64,
    /// The zones on both sides are two parts of one: nothing new needs no switch.
    joined: bool,
}

impl CutWave {
    /// The cycle with the zones of a chain in the cut: all but the last have no length yet.
    fn with_chain(&self, flows: &Flows, chain: &[WaveZone]) -> Result<Vec<CycleZone>, FlowError> {
        let inserted = chain.len() - 1;
        let entry = self.instant;
        let nascent = |zone: &WaveZone| {
            let [layer, radial] = nascent_layers(flows, zone.regime, entry, self.acceleration)?;
            Ok(CycleZone {
                zone: *zone,
                slide: Slide {
                    entry,
                    duration: 0.0,
                    layer,
                    radial,
                },
                nascent: true,
            })
        };
        let nascent: Result<_, FlowError> = chain[..inserted].iter().map(nascent).collect();
        let mut cycle: Vec<CycleZone> = nascent?;
        cycle.extend_from_slice(&self.zones);
        cycle[inserted].zone = chain[inserted];
        Ok(cycle)
    }
}

/// Every candidate for the signature beyond an event.
pub fn candidates(
    wave: &Wave,
    point: &Vector,
    margin: &RegimeMargin,
) -> Result<Vec<Candidate<Wave>>, FlowError> {
    let Some(opened) = open(wave, point, margin)? else {
        return Ok(Vec::new());
    };
    let excess = wave.excess_at(point);
    let parameter = wave.parameter_at(point);
    let flows = wave.flows(point)?;
    let mut found = Vec::new();
    let mut add = |zones: Vec<CycleZone>| {
        // one zone alone has no switch that could fix its phase
        let Some(zones) = sectioned(wave, &flows, zones).map(from_beginning) else {
            return;
        };
        let signature = Signature(zones.iter().map(|part| part.zone).collect());
        if signature.is_rotation_of(&wave.signature) {
            return;
        }
        let candidate = wave.with_signature(signature);
        let slides: Vec<Slide> = zones.iter().map(|part| part.slide).collect();
        found.push(Candidate {
            point: candidate.pack(&slides, excess, parameter),
            nascent: (0..zones.len())
                .filter(|index| zones[*index].nascent)
                .collect(),
            orbit: candidate,
        });
    };
    let zones = &opened.zones;
    let count = zones.len();
    let (first, last) = (zones[0], zones[count - 1]);
    // both sides in the same regime: they may become one zone
    if first.zone.regime == last.zone.regime && count > 1 && !opened.joined {
        let mut zones = zones[1..].to_vec();
        let merged = &mut zones[count - 2].slide;
        *merged = Slide {
            entry: merged.entry,
            duration: merged.duration + first.slide.duration,
            ..first.slide
        };
        // the merged zone closes the cycle
        zones.rotate_right(1);
        add(zones);
    }
    // a contact zone that is left alone closes on itself
    if count == 1 && first.zone.regime == Regime::Contact && !opened.joined {
        add(zones.clone());
    }
    let (from, to) = (last.zone.regime, first.zone.regime);
    for chain in paths(from, to, LONGEST_CHAIN, wave.impact()) {
        if !chain.iter().all(|zone| wave.model.law.has(zone.regime)) {
            continue;
        }
        add(opened.with_chain(&flows, &chain)?);
    }
    Ok(found)
}

/// G and G_U of a zone that has no length yet and is entered with this V̈, and Ü = 0.
fn nascent_layers(
    flows: &Flows,
    regime: Regime,
    instant: [f64; 2],
    acceleration: f64,
) -> Result<[f64; 2], FlowError> {
    Ok(match regime {
        Regime::Stick => [0.0; 2],
        Regime::Separation => match flows.separation().layered()? {
            Some(flow) => flow.layers_of(instant, acceleration),
            None => [0.0; 2],
        },
        regime => match flows.contact(regime) {
            SlidingFlow::Material(flow) => [flow.layer_of(instant, acceleration), 0.0],
            _ => [0.0; 2],
        },
    })
}

/// A cycle that can be posed: one contact zone alone is cut at V̇ = 0, and a wave with switches of
/// its own is not. `None` for one zone of any other regime.
fn sectioned(wave: &Wave, flows: &Flows, mut zones: Vec<CycleZone>) -> Option<Vec<CycleZone>> {
    if let [part] = zones[..] {
        if !wave.model.law.has(part.zone.regime) || part.zone.regime != Regime::Contact {
            return None;
        }
        let flow = flows.contact(Regime::Contact);
        let slide = part.slide;
        let rising = flow
            .extremes(&slide)
            .ok()?
            .into_iter()
            .filter_map(|time| Some((time, flow.state(&slide, time).ok()?)))
            .find(|(time, state)| flow.acceleration(&slide, *time, *state) > 0.0)?
            .1;
        return Some(vec![CycleZone {
            zone: Signature::contact().zone(0),
            slide: Slide::bare([rising[0], 0.0], slide.duration),
            nascent: false,
        }]);
    }
    let section = |part: &CycleZone| part.zone.entry == ZoneEntry::Section;
    if let Some(index) = zones.iter().position(section) {
        let before = (index + zones.len() - 1) % zones.len();
        if zones[before].zone.regime == zones[index].zone.regime {
            zones[before].slide.duration += zones[index].slide.duration;
            zones.remove(index);
        }
    }
    Some(zones)
}

/// Rotates a cycle so that it begins where its name does.
fn from_beginning(mut zones: Vec<CycleZone>) -> Vec<CycleZone> {
    let signature = Signature(zones.iter().map(|part| part.zone).collect());
    // where the cycle repeats itself the longest zone keeps the origin steady
    let start = signature
        .beginnings()
        .into_iter()
        .max_by(|&one, &other| {
            let [one, other] = [one, other].map(|index| zones[index].slide.duration);
            one.total_cmp(&other)
        })
        .unwrap_or(0);
    zones.rotate_left(start);
    zones
}

/// Cuts a wave open where a margin is zero.
fn open(wave: &Wave, point: &Vector, margin: &RegimeMargin) -> Result<Option<CutWave>, FlowError> {
    let zones = wave.signature.0.iter().zip(wave.unpack(point));
    let zones: Vec<CycleZone> = zones
        .map(|(&zone, slide)| CycleZone {
            zone,
            slide,
            nascent: false,
        })
        .collect();
    let count = zones.len();
    let index = margin.zone;
    let at = wave.at(point)?;
    // at the beginning of a zone
    let at_entry = |index: usize, mut zones: Vec<CycleZone>| {
        zones.rotate_left(index % count);
        let [_, acceleration] = at.entry_acceleration(index)?;
        Ok::<_, FlowError>(CutWave {
            instant: zones[0].slide.entry,
            zones,
            acceleration: acceleration.value,
            joined: false,
        })
    };
    Ok(Some(match margin.watch {
        WaveWatch::Coupling => return Ok(None),
        WaveWatch::Duration => {
            if count < 2 {
                return Ok(None);
            }
            let mut opened = at_entry(index, zones)?;
            opened.zones.remove(0);
            opened
        }
        WaveWatch::Pressure | WaveWatch::Rate | WaveWatch::Gap => {
            split(&at, zones, index, margin.time)?
        }
        WaveWatch::LandingPressure
        | WaveWatch::Tension
        | WaveWatch::LandingRate
        | WaveWatch::LowerForce
        | WaveWatch::Release => at_entry(index, zones)?,
        WaveWatch::UpperForce | WaveWatch::Impulse | WaveWatch::LandingSpeed => {
            at_entry(index + 1, zones)?
        }
    }))
}

/// Cuts a zone in two at a time: the second part keeps the regime, the first keeps the entry.
fn split(
    at: &WaveAt,
    mut zones: Vec<CycleZone>,
    index: usize,
    time: f64,
) -> Result<CutWave, FlowError> {
    let flows = &at.flows;
    let count = zones.len();
    let zone = zones[index].zone;
    let slide = at.slide(index);
    let (instant, acceleration) = match zone.regime {
        Regime::Separation => {
            let [_, _, y, w] = flows.separation().state(&slide, time)?;
            ([y, w], 0.0)
        }
        regime => {
            let flow = flows.contact(regime);
            let state = flow.state(&slide, time)?;
            (state, flow.acceleration(&slide, time, state))
        }
    };
    let rest = slide.duration - time;
    let first = &mut zones[index].slide;
    first.duration = time;
    if zone.regime == Regime::Separation {
        if let Some(flow) = flows.separation().layered()? {
            [first.layer, first.radial] = flow.layers_at(&slide, time);
        }
    } else if let SlidingFlow::Material(flow) = flows.contact(zone.regime) {
        first.layer = slide.layer * (-rest / flow.rho).exp();
    }
    zones.rotate_left((index + 1) % count);
    let second = CycleZone {
        zone,
        slide: Slide {
            entry: instant,
            duration: rest,
            ..slide
        },
        nascent: false,
    };
    zones.insert(0, second);
    Ok(CutWave {
        zones,
        instant,
        acceleration,
        joined: true,
    })
}
