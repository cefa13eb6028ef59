//! What is zero at the entries and ends of the zones of a sequence whatever the parameter.
//!
//! A zone ends where its guard is zero, and what is zero there may stay so through the reset and along the next
//! flow. From nothing round the cycle to a fixed point all of these facts are found.

use super::forms::{Forms, Units};
use super::generic::Points;
use super::signature::{Sequence, ZonePoint};
use crate::affine::flow::ModeFlow;
use crate::affine::mode::{AffineMode, AffineSystem, Exit, Row};

/// What is known of a zone.
#[derive(Clone, Debug, PartialEq)]
pub struct ZoneFacts {
    /// Forms that are zero at its entry.
    pub zero: Forms,
    /// Forms that are zero at its end.
    pub end: Forms,
    /// Order of the zero of every guard of the mode at the entry: 0 where it is not zero, `None` where it stays so.
    pub at_entry: Vec<Option<usize>>,
    /// The same at the end, where guards of odd order fall to zero.
    pub at_end: Vec<Option<usize>>,
    /// Order of the zero at the entry that is divided out of the equation of the guard that ends the zone:
    /// as `at_entry`, but a guard of the phase alone is not divided, since no equation sets the phase at an entry.
    pub divided: usize,
    /// Where it is not the forms that tell: what does.
    pub generic: Option<Generic>,
}

/// What generic points of a zone tell where its system is not linear.
#[derive(Clone, Debug, PartialEq)]
pub struct Generic {
    /// States of which the first derivatives of the guard, as many as are divided out, each have one.
    pub pivots: Vec<usize>,
    /// The state that the surface of a sliding mode has, where the zone before slides, too, or is this one: no guard of
    /// a mode beside the surface tells that the motion lies in it.
    pub surface: Option<usize>,
    /// Points of its end.
    pub end: Points,
    /// Whether other points, at another value of the parameter, tell the same.
    pub lasts: bool,
}

impl ZoneFacts {
    /// Whether none of them changes with the parameter.
    pub fn is_constant(&self) -> bool {
        self.generic.as_ref().is_none_or(|generic| generic.lasts)
            && self.zero.are_constant()
            && self.end.are_constant()
    }

    /// The same facts at another value of the parameter.
    pub fn at(&self, system: &AffineSystem) -> ZoneFacts {
        let mut facts = self.clone();
        if let Some(generic) = &mut facts.generic {
            generic.end.complete(system);
        }
        facts
    }

    /// Whether a form is zero at the end by the structure.
    pub fn is_zero_at_end(
        &self,
        system: &AffineSystem,
        row: &Row,
        size: f64,
        units: &Units,
    ) -> bool {
        match &self.generic {
            Some(generic) => generic.end.contain(system, row, size),
            None => self.end.contain(row, size, units),
        }
    }
}

/// The exit that a zone takes; `None` also for one that is not in the system.
pub fn exit_of<'a>(system: &'a AffineSystem, sequence: &Sequence, zone: usize) -> Option<&'a Exit> {
    let zone = sequence.zone(zone);
    let way = zone.way?;
    let guard = system.modes.get(zone.mode)?.guards.get(way.guard)?;
    guard.exits.get(way.exit)
}

/// The state whose rate is zero where an orbit begins that neither switches nor is forced, where no orbit is known: the first
/// whose rate depends on the states.
pub fn section(mode: &AffineMode) -> usize {
    let matrix = &mode.matrix.at;
    let states = mode.matrix.at.nrows();
    let depends = |row: &usize| matrix.row(*row).iter().any(|c| *c != 0.0);
    (0..states).find(depends).unwrap_or(0)
}

/// The facts of every zone of a sequence that the system has; its zones next to these are looked at where that is not
/// linear. Of a linear system that differs from one with `known` facts in the values of the parameter alone they are
/// of the same orders.
pub fn facts(
    system: &AffineSystem,
    sequence: &Sequence,
    units: &Units,
    zones: &[ZonePoint],
    known: Option<&[ZoneFacts]>,
) -> Vec<ZoneFacts> {
    let known = known.filter(|_| system.program.made() == 0);
    let count = sequence.len();
    let mode = |zone: usize| &system.modes[sequence.zone(zone).mode];
    // a sliding mode lies in its surface from its entry to its end
    let on_surface = |zone: usize, forms: &mut Forms| {
        if let Some(surface) = &mode(zone).surface {
            forms.insert(surface, units);
        }
    };
    let mut entries = vec![Forms::default(); count];
    for (zone, entry) in entries.iter_mut().enumerate() {
        on_surface(zone, entry);
    }
    let mut ends = vec![Forms::default(); count];
    // zones alike that begin with the same forms end with the same: of a series of impacts one is gone through
    let alike = |entries: &[Forms], one: usize, other: usize| {
        let kind = |zone: usize| (sequence.zone(zone).mode, sequence.zone(zone).way);
        kind(one) == kind(other) && entries[one] == entries[other]
    };
    // what begins as in the round before ends as it did there
    let mut known_entries: Vec<Option<Forms>> = vec![None; count];
    loop {
        let before: usize = entries.iter().map(Forms::len).sum();
        let mut gone: Vec<usize> = Vec::new();
        for zone in 0..count {
            let next = (zone + 1) % count;
            if known_entries[zone].as_ref() == Some(&entries[zone]) {
                gone.push(zone);
                continue;
            }
            known_entries[zone] = Some(entries[zone].clone());
            if let Some(known) = gone.iter().find(|known| alike(&entries, **known, zone)) {
                ends[zone] = ends[*known].clone();
                entries[next] = entries[known + 1].clone();
                continue;
            }
            let Some(way) = sequence.zone(zone).way else {
                continue;
            };
            gone.push(zone);
            let mut end = entries[zone].invariant(mode(zone), units);
            on_surface(zone, &mut end);
            end.insert(&mode(zone).guards[way.guard].row, units);
            if let Some(exit) = exit_of(system, sequence, zone) {
                entries[next] = end.after(exit, &system.program, units);
                on_surface(next, &mut entries[next]);
            }
            ends[zone] = end;
        }
        if entries.iter().map(Forms::len).sum::<usize>() <= before {
            break;
        }
    }
    let of = |index: usize| {
        let (zero, end) = (entries[index].clone(), ends[index].clone());
        let same = |known: &&ZoneFacts| {
            (&known.zero.pivots, &known.end.pivots) == (&zero.pivots, &end.pivots)
        };
        if let Some(known) = known.map(|known| &known[index]).filter(same) {
            return ZoneFacts {
                zero,
                end,
                at_entry: known.at_entry.clone(),
                at_end: known.at_end.clone(),
                divided: known.divided,
                generic: None,
            };
        }
        let AffineMode { matrix, guards, .. } = mode(index);
        if system.program.made() > 0 {
            return generic(system, sequence, index, units, zones, (zero, end));
        }
        let orders = |forms: &Forms| {
            let order = |guard| forms.order(guard, matrix, units);
            guards.iter().map(|guard| order(&guard.row)).collect()
        };
        let at_entry: Vec<Option<usize>> = orders(&zero);
        let states = |pivot: &usize| *pivot < system.states;
        let divided = sequence.zone(index).way.and_then(|way| {
            if zero.pivots.iter().all(states) {
                return at_entry[way.guard];
            }
            let set = zero.with_pivots(|pivot| states(&pivot));
            set.order(&guards[way.guard].row, matrix, units)
        });
        ZoneFacts {
            at_entry,
            at_end: orders(&end),
            divided: divided.unwrap_or(0),
            zero,
            end,
            generic: None,
        }
    };
    let mut told: Vec<(usize, ZoneFacts)> = Vec::new();
    let every = (0..count).map(|zone| {
        let mut known = told.iter();
        let linear = system.program.made() == 0;
        if let Some((_, known)) = known.find(|(known, _)| linear && alike(&entries, *known, zone)) {
            return known.clone();
        }
        told.push((zone, of(zone)));
        told[told.len() - 1].1.clone()
    });
    every.collect()
}

/// The facts of a zone by points next to it.
fn generic(
    system: &AffineSystem,
    sequence: &Sequence,
    zone: usize,
    units: &Units,
    zones: &[ZonePoint],
    (zero, end): (Forms, Forms),
) -> ZoneFacts {
    let number = sequence.zone(zone).mode;
    let mode = &system.modes[number];
    let total: f64 = zones.iter().map(|zone| zone.duration.abs()).sum();
    let at = &zones[zone];
    let phase = at.phase + system.omega.value * at.duration;
    // points are moved about a place near the end, which need not be the end itself
    let exit = exit_of(system, sequence, zone);
    let last: Vec<f64> = match exit.is_some_and(Exit::is_continuous) {
        true => zones[(zone + 1) % zones.len()].state.clone(),
        false => {
            let z = system.lift(number, &at.state, at.phase);
            let z = ModeFlow::new(mode, total).after(&z, at.duration.max(0.0));
            z.rows(0, system.states).iter().copied().collect()
        }
    };
    let points = |place, forms: &Forms| Points::new(system, number, place, forms, units);
    let (first, last) = (
        points((&at.state, at.phase), &zero),
        points((&last, phase), &end),
    );
    let [at_entry, at_end] = [&first, &last].map(|points| points.orders(system, units, total));
    let before = sequence.zone(zone + sequence.len() - 1).mode;
    let slides = system.modes[before].surface.is_some();
    let surface = mode.surface.as_ref().filter(|_| slides);
    let divided = sequence.zone(zone).way.into_iter().flat_map(|way| {
        let orders = 0..at_entry[way.guard].unwrap_or(0);
        orders.map(move |order| (&mode.guards[way.guard].row, order))
    });
    let zeros = surface.map(|row| (row, 0)).into_iter().chain(divided);
    let mut pivots = first.pivots(system, zeros, units);
    let surface = surface
        .filter(|_| !pivots.is_empty())
        .map(|_| pivots.remove(0));
    // the slopes of a derivative of a guard may come to zero elsewhere, and so may those of a guard that is curved
    let base = mode.field.base();
    let flat = |row: &Row| (base..row.at.len()).all(|c| !row.has(c));
    let flat = mode.guards.iter().all(|guard| flat(&guard.row));
    let lasts = pivots.len() <= usize::from(flat)
        && [&first, &last].iter().all(|points| points.are_whole())
        && !system.program.has_kinks();
    ZoneFacts {
        zero,
        end,
        at_entry,
        at_end,
        // a guard of the phase alone has no state
        divided: pivots.len(),
        generic: Some(Generic {
            pivots,
            surface,
            end: last,
            lasts,
        }),
    }
}
