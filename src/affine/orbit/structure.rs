//! What is zero at the entries and ends of the zones of a sequence whatever the parameter.
//!
//! A zone ends where its guard is zero, and what is zero there may stay so through the reset and along the next
//! flow. From nothing round the cycle to a fixed point all of these facts are found.

use super::conserved::Conserved;
use super::forms::{Forms, Rates, Units};
use super::generic::Points;
use super::signature::{Sequence, ZonePoint, exit_of};
use crate::affine::flow::ModeFlow;
use crate::affine::mode::{AffineMode, AffineSystem, Exit, Guard, Row};
use crate::affine::slots::Slots;

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
    /// Whether this is the zone after which one round finds all forms: what is zero at the next entry does not depend on
    /// what is zero at its own.
    pub forgets: bool,
}

/// What generic points of a zone tell where its system is not linear.
#[derive(Clone, Debug, PartialEq)]
pub struct Generic {
    /// States of which the first derivatives of the guard, as many as are divided out, each have one.
    pub pivots: Vec<usize>,
    /// The surfaces in which the motion lies although no guard of another mode tells it, each with a state that it gives: that of a
    /// sliding mode where the zone before slides, too, or is this one, and those that contacts hold in every zone, where the
    /// orbit begins.
    pub surfaces: Vec<(usize, usize)>,
    /// What sums of states differ by from those that are kept, where the orbit begins, each with a state that it gives.
    pub sums: Vec<(Row, usize)>,
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

    /// The components of the forms at the entry and at the end.
    fn pivots(&self) -> (&[usize], &[usize]) {
        (&self.zero.pivots, &self.end.pivots)
    }

    fn pivots_are_of(&self, (zero, end): &(Forms, Forms)) -> bool {
        self.pivots() == (&zero.pivots, &end.pivots)
    }

    /// The same facts with other values of the forms.
    fn with(&self, (zero, end): (Forms, Forms)) -> ZoneFacts {
        ZoneFacts {
            zero,
            end,
            at_entry: self.at_entry.clone(),
            at_end: self.at_end.clone(),
            generic: None,
            ..*self
        }
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

/// The state whose rate is zero where an orbit begins that neither switches nor is forced, where no orbit is known: the first
/// whose rate depends on the states.
pub fn section(mode: &AffineMode) -> usize {
    let matrix = &mode.matrix.at;
    let states = mode.matrix.at.nrows();
    let depends = |row: &usize| matrix.row(*row).iter().any(|c| *c != 0.0);
    (0..states).find(depends).unwrap_or(0)
}

/// Forms that are zero at the entries and at the ends of the zones of a sequence.
struct Zeros<'a> {
    system: &'a AffineSystem,
    sequence: &'a Sequence,
    conserved: &'a Conserved,
    units: &'a Units<'a>,
    /// Of every mode, once it is asked for.
    rates: Slots<Rates>,
    entries: Vec<Forms>,
    ends: Vec<Forms>,
}

impl<'a> Zeros<'a> {
    /// Nothing but what sliding modes have from their entries to their ends, since they lie in their surfaces, and what is
    /// kept of the start.
    fn new(
        system: &'a AffineSystem,
        (sequence, conserved): (&'a Sequence, &'a Conserved),
        units: &'a Units<'a>,
    ) -> Zeros<'a> {
        let count = sequence.len();
        let mut zeros = Zeros {
            system,
            sequence,
            conserved,
            units,
            rates: Slots::new(system.modes.len()),
            entries: vec![Forms::default(); count],
            ends: vec![Forms::default(); count],
        };
        zeros.entries = (0..count).map(|zone| zeros.of_surface(zone)).collect();
        zeros
    }

    fn mode(&self, zone: usize) -> &'a AffineMode {
        &self.system.modes[self.sequence.zone(zone).mode]
    }

    fn rates(&self, zone: usize) -> &Rates {
        let mode = self.sequence.zone(zone).mode;
        let make = || Rates::new(&self.mode(zone).matrix);
        self.rates.get_or_make(mode, make)
    }

    fn of_surface(&self, zone: usize) -> Forms {
        let mut forms = Forms::default();
        self.on_surface(zone, &mut forms);
        // from there they last
        if zone == 0 {
            let (mode, kept) = (self.mode(0), self.sequence.kept());
            self.conserved
                .at_beginning(mode, kept, &mut forms, self.units);
        }
        forms
    }

    fn on_surface(&self, zone: usize, forms: &mut Forms) {
        if let Some(surface) = &self.mode(zone).surface {
            forms.insert(surface, self.units);
        }
    }

    /// What is zero at the end of a zone, and at the next entry, where these are at its own entry; `None` where it has no end.
    fn through(&self, zone: usize, entry: &Forms) -> Option<(Forms, Option<Forms>)> {
        let way = self.sequence.zone(zone).way?;
        let mut end = entry.invariant(self.mode(zone), self.rates(zone), self.units);
        self.on_surface(zone, &mut end);
        end.insert(&self.mode(zone).guards[way.guard].row, self.units);
        let exit = exit_of(self.system, self.sequence, zone);
        let next = exit.map(|exit| {
            let mut next = end.after(exit, &self.system.program, self.units);
            self.on_surface(zone + 1, &mut next);
            next
        });
        Some((end, next))
    }

    /// Whether two zones are of one mode, begin with the same forms, and take the same exit: they end with the same.
    fn are_alike(&self, one: usize, other: usize) -> bool {
        let kind = |zone: usize| (self.sequence.zone(zone).mode, self.sequence.zone(zone).way);
        kind(one) == kind(other) && self.entries[one] == self.entries[other]
    }

    /// Goes through a zone, or takes over what a zone like it has led to: of a series of impacts one is gone through.
    fn go_through(&mut self, zone: usize, gone: &mut Vec<usize>) {
        let next = |zone: usize| (zone + 1) % self.entries.len();
        let led = match gone.iter().find(|known| self.are_alike(**known, zone)) {
            Some(known) => Some((
                self.ends[*known].clone(),
                Some(self.entries[next(*known)].clone()),
            )),
            None => {
                gone.push(zone);
                self.through(zone, &self.entries[zone])
            }
        };
        if let Some((end, entry)) = led {
            let next = next(zone);
            self.ends[zone] = end;
            if let Some(entry) = entry {
                self.entries[next] = entry;
            }
        }
    }

    /// Goes round until nothing more is found.
    fn find(&mut self) {
        let count = self.entries.len();
        // what begins as in the round before ends as it did there
        let mut before: Vec<Option<Forms>> = vec![None; count];
        loop {
            let size = |zeros: &Zeros| zeros.entries.iter().map(Forms::len).sum::<usize>();
            let least = size(self);
            let mut gone: Vec<usize> = Vec::new();
            for (zone, before) in before.iter_mut().enumerate() {
                if before.as_ref() == Some(&self.entries[zone]) {
                    gone.push(zone);
                } else {
                    *before = Some(self.entries[zone].clone());
                    self.go_through(zone, &mut gone);
                }
            }
            if size(self) <= least {
                break;
            }
        }
    }

    /// The components of the forms at the entry and at the end of every zone.
    fn pivots(&self) -> impl Iterator<Item = (&[usize], &[usize])> {
        let zones = self.entries.iter().zip(&self.ends);
        zones.map(|(entry, end)| (entry.pivots.as_slice(), end.pivots.as_slice()))
    }

    /// Whether what is zero at the entry after a zone does not depend on what is zero at its own.
    fn forgets(&self, zone: usize) -> bool {
        let led = self.through(zone, &self.of_surface(zone));
        let next = &self.entries[(zone + 1) % self.entries.len()];
        led.is_some_and(|(_, entry)| entry.is_some_and(|entry| entry.pivots == next.pivots))
    }

    /// The same forms in one round, from a zone on that forgets; `None` where they are not those of these pivots.
    fn again<'z>(
        &self,
        first: usize,
        mut pivots: impl Iterator<Item = (&'z [usize], &'z [usize])>,
    ) -> Option<Zeros<'a>> {
        let of = (self.sequence, self.conserved);
        let mut zeros = Zeros::new(self.system, of, self.units);
        let (count, mut gone) = (zeros.entries.len(), Vec::new());
        for zone in first..first + count {
            zeros.go_through(zone % count, &mut gone);
        }
        if let Some((end, _)) = zeros.through(first, &zeros.entries[first]) {
            zeros.ends[first] = end;
        }
        let mut own = zeros.entries.iter().zip(&zeros.ends);
        let same = own.all(|(entry, end)| {
            let known = pivots.next();
            known.is_some_and(|known| entry.pivots == known.0 && end.pivots == known.1)
        });
        same.then_some(zeros)
    }
}

/// The facts of every zone of a sequence that the system has; its zones next to these are looked at where that is not
/// linear. Of a linear system that differs from one with `known` facts in the values of the parameter alone they are
/// of the same orders.
pub fn facts(
    system: &AffineSystem,
    (sequence, conserved): (&Sequence, &Conserved),
    units: &Units,
    zones: &[ZonePoint],
    known: Option<&[ZoneFacts]>,
) -> Vec<ZoneFacts> {
    let linear = system.program.made() == 0;
    let known = known.filter(|_| linear);
    let mut zeros = Zeros::new(system, (sequence, conserved), units);
    if let Some(known) = known
        && let Some(first) = known.iter().position(|zone| zone.forgets)
        && let Some(zeros) = zeros.again(first, known.iter().map(ZoneFacts::pivots))
    {
        let forms = zeros.entries.into_iter().zip(zeros.ends);
        let pairs = known.iter().zip(forms);
        return pairs.map(|(zone, forms)| zone.with(forms)).collect();
    }
    zeros.find();
    let count = sequence.len();
    let first = (0..count).find(|zone| linear && zeros.forgets(*zone));
    // as they are found at other values of the parameter
    let again = first.and_then(|first| zeros.again(first, zeros.pivots()));
    let first = first.filter(|_| again.is_some());
    let zeros = again.unwrap_or(zeros);
    let mut told: Vec<(usize, ZoneFacts)> = Vec::new();
    let every = (0..count).map(|zone| {
        let forms = (zeros.entries[zone].clone(), zeros.ends[zone].clone());
        let alike = |known: &&(usize, ZoneFacts)| linear && zeros.are_alike(known.0, zone);
        let known = known.map(|known| &known[zone]);
        if let Some((_, told)) = told.iter().find(alike) {
            return told.clone();
        }
        let facts = if !linear {
            let before = &zeros.ends[(zone + count - 1) % count];
            let of = (sequence, conserved);
            generic(system, of, zone, units, zones, forms, before)
        } else if let Some(known) = known.filter(|known| known.pivots_are_of(&forms)) {
            known.with(forms)
        } else {
            with_orders(&zeros, zone, forms)
        };
        told.push((zone, facts.clone()));
        facts
    });
    let mut every: Vec<ZoneFacts> = every.collect();
    for (zone, facts) in every.iter_mut().enumerate() {
        facts.forgets = first == Some(zone);
    }
    every
}

/// The facts of a zone of a linear mode.
fn with_orders(zeros: &Zeros, zone: usize, (zero, end): (Forms, Forms)) -> ZoneFacts {
    let (guards, units) = (&zeros.mode(zone).guards, zeros.units);
    let order = |forms: &Forms, guard: &Guard| forms.order(&guard.row, zeros.rates(zone), units);
    let orders = |forms: &Forms| guards.iter().map(|guard| order(forms, guard)).collect();
    let at_entry: Vec<Option<usize>> = orders(&zero);
    let states = |pivot: usize| pivot < units.states;
    let divided = zeros.sequence.zone(zone).way.and_then(|way| {
        if zero.pivots.iter().all(|pivot| states(*pivot)) {
            return at_entry[way.guard];
        }
        order(&zero.with_pivots(states), &guards[way.guard])
    });
    ZoneFacts {
        at_entry,
        at_end: orders(&end),
        divided: divided.unwrap_or(0),
        zero,
        end,
        generic: None,
        forgets: false,
    }
}

/// What each state changes by from zone to zone, or would in this one at the rate of its entry: no more than its unit, of which it may be a small
/// part where the origin is far away.
fn moved(
    system: &AffineSystem,
    mode: usize,
    units: &Units,
    (zones, zone): (&[ZonePoint], usize),
) -> Vec<f64> {
    /// No less than this part of the unit.
    const LEAST: f64 = 1e-3;
    let at = &zones[zone];
    let z = system.lift(mode, &at.state, at.phase);
    let rates = &system.modes[mode].matrix;
    let along = |state: usize| {
        let all = zones.iter().map(|zone| zone.state[state]);
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        let within = (rates.value(state, &z) * at.duration).abs();
        let unit = units.z[state];
        (high - low).max(within).clamp(LEAST * unit, unit)
    };
    (0..system.states).map(along).collect()
}

/// The time that zones take together.
fn time_of(zones: &[ZonePoint]) -> f64 {
    zones.iter().map(|zone| zone.duration.abs()).sum()
}

/// Points next to the end of a zone: they are moved about a place near it, which need not be the end itself.
fn end_points(
    system: &AffineSystem,
    sequence: &Sequence,
    zone: usize,
    units: &Units,
    zones: &[ZonePoint],
    forms: &Forms,
) -> Points {
    let (number, at) = (sequence.zone(zone).mode, &zones[zone]);
    let phase = at.phase + system.omega.value * at.duration;
    let total = time_of(zones);
    let exit = exit_of(system, sequence, zone);
    let last: Vec<f64> = match exit.is_some_and(Exit::is_continuous) {
        true => zones[(zone + 1) % zones.len()].state.clone(),
        false => {
            let z = system.lift(number, &at.state, at.phase);
            let flow = ModeFlow::new(&system.modes[number], total);
            let z = flow.after(&z, at.duration.max(0.0));
            z.rows(0, system.states).iter().copied().collect()
        }
    };
    let distances = moved(system, number, units, (zones, zone));
    Points::new(system, number, (&last, phase), forms, (units, &distances))
}

/// Orders of the guards at the entry of a zone, by points next to it. Where one is zero that is not so at all of these, it may be since the zone
/// before has ended: then the images of points next to that end tell.
fn entry_orders(
    system: &AffineSystem,
    sequence: &Sequence,
    zone: usize,
    units: &Units,
    zones: &[ZonePoint],
    (points, end_before): (&Points, &Forms),
) -> Vec<Option<usize>> {
    let (mode, at) = (sequence.zone(zone).mode, &zones[zone]);
    let total = time_of(zones);
    let mut orders = points.orders(system, units, total);
    let z = system.lift(mode, &at.state, at.phase);
    let mut guards = system.modes[mode].guards.iter().zip(&orders);
    let is_zero = guards
        .any(|(guard, order)| *order == Some(0) && points.is_zero(system, &guard.row, &z, units));
    let previous = (zone + sequence.len() - 1) % sequence.len();
    let exit = exit_of(system, sequence, previous).filter(|_| is_zero);
    if let Some(exit) = exit {
        let ends = end_points(system, sequence, previous, units, zones, end_before);
        let of_images = ends.through(system, exit).orders(system, units, total);
        for (own, of_image) in orders.iter_mut().zip(of_images) {
            *own = own.zip(of_image).map(|(one, other)| one.max(other));
        }
    }
    orders
}

/// The facts of a zone by points next to it, with what is zero at the end of the one before.
fn generic(
    system: &AffineSystem,
    (sequence, conserved): (&Sequence, &Conserved),
    zone: usize,
    units: &Units,
    zones: &[ZonePoint],
    (zero, end): (Forms, Forms),
    end_before: &Forms,
) -> ZoneFacts {
    let number = sequence.zone(zone).mode;
    let mode = &system.modes[number];
    let total = time_of(zones);
    let at = &zones[zone];
    let by = (units, &moved(system, number, units, (zones, zone))[..]);
    let first = Points::new(system, number, (&at.state, at.phase), &zero, by);
    let last = end_points(system, sequence, zone, units, zones, &end);
    let at_entry = entry_orders(system, sequence, zone, units, zones, (&first, end_before));
    let at_end = last.orders(system, units, total);
    let before = sequence.zone(zone + sequence.len() - 1).mode;
    let slides = system.modes[before].surface.is_some();
    let own = usize::from(mode.surface.is_some());
    let surfaces = mode.surfaces().enumerate();
    let surfaces: Vec<(usize, &Row)> = surfaces
        .filter(|(number, _)| match number.checked_sub(own) {
            None => slides,
            Some(held) => zone == 0 && conserved.lasts(held),
        })
        .collect();
    let divided = sequence.zone(zone).way.into_iter().flat_map(|way| {
        let orders = 0..at_entry[way.guard].unwrap_or(0);
        orders.map(move |order| (&mode.guards[way.guard].row, order))
    });
    let sums: Vec<Row> = match zone {
        0 => conserved.kept(mode, sequence.kept()).collect(),
        _ => Vec::new(),
    };
    let given = surfaces.iter().map(|(_, row)| *row).chain(&sums);
    let zeros = given.map(|row| (row, 0)).chain(divided);
    let mut states = first.pivots(system, zeros, units);
    let given = surfaces.len() + sums.len();
    let pivots = states.split_off(given.min(states.len()));
    let of_sums = states.split_off(surfaces.len().min(states.len()));
    let numbers = surfaces.into_iter().map(|(number, _)| number);
    let surfaces = numbers.zip(states).collect();
    let sums = sums.into_iter().zip(of_sums).collect();
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
            surfaces,
            sums,
            end: last,
            lasts,
        }),
        forgets: false,
    }
}
