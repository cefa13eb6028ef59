//! A system at one value of the parameter, with what is known there of the zones of an orbit.

use std::sync::{Arc, Mutex, PoisonError};

use super::passage::Propagators;
use super::signature::Sequence;
use super::structure::ZoneFacts;
use crate::affine::flow::ModeFlow;
use crate::affine::mode::{AffineMode, AffineSystem, Guard, MatrixBy, Row};
use crate::affine::origin::Origin;
use crate::affine::slots::Slots;
use crate::affine::stiff::STIFF;
use crate::linalg::{Matrix, Vector, balance};

/// Exponentials with the bits of their time, where there are any.
type Kept = Option<(u64, Arc<Propagators>)>;

/// The system at one value of the parameter, and what is known of the zones there.
#[derive(Debug)]
pub struct Posed {
    /// The system.
    pub system: AffineSystem,
    /// Facts of the zones.
    pub facts: Arc<Vec<ZoneFacts>>,
    balances: Slots<(Vector, f64)>,
    flows: Slots<ModeFlow>,
    /// The last exponentials of every zone that is linear, with the bits of their time.
    propagators: Mutex<Vec<Kept>>,
    /// Longest piece of a flow: the unit of time.
    longest: f64,
    /// Whether the system was led to from its origin.
    moved: bool,
}

impl Posed {
    pub(super) fn new(
        system: AffineSystem,
        facts: Arc<Vec<ZoneFacts>>,
        longest: f64,
        moved: bool,
    ) -> Posed {
        Posed {
            propagators: Mutex::new(vec![None; facts.len()]),
            facts,
            balances: Slots::new(system.modes.len()),
            flows: Slots::new(system.modes.len()),
            longest,
            moved,
            system,
        }
    }

    /// The same at another value of the parameter, with the facts that hold in the system there where any of these change
    /// with it; `None` where that takes more than other numbers.
    pub(super) fn moved_to(
        mut self,
        origin: &Origin,
        value: f64,
        changed: impl FnOnce(&AffineSystem, &[ZoneFacts]) -> Vec<ZoneFacts>,
    ) -> Option<Posed> {
        let linear = |facts: &ZoneFacts| facts.generic.is_none();
        let lasts = self.moved && self.facts.iter().all(linear);
        if !lasts || !origin.lead(&mut self.system, value) {
            return None;
        }
        if !self.facts.iter().all(ZoneFacts::is_constant) {
            self.facts = Arc::new(changed(&self.system, &self.facts));
        }
        Some(Posed::new(self.system, self.facts, self.longest, true))
    }

    /// The scales of z that balance the matrix of a mode, and its norm then.
    pub(super) fn balance(&self, mode: usize) -> &(Vector, f64) {
        self.balances.get_or_make(mode, || {
            balance(&self.system.modes[mode].matrix.at, self.longest.recip())
        })
    }

    /// The exponentials of a zone of a linear mode, up to a time after its entry.
    pub(super) fn propagators(&self, zone: usize, mode: usize, time: f64) -> Arc<Propagators> {
        let mut kept = self
            .propagators
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let bits = time.to_bits();
        match &kept[zone] {
            Some((known, propagators)) if *known == bits => propagators.clone(),
            _ => {
                let norm = self.balance(mode).1;
                let stiff = (norm * time > STIFF).then(|| self.flow(mode).split(time));
                let mode = &self.system.modes[mode];
                let own = Arc::new(Propagators::new(mode, norm, stiff.flatten(), time));
                kept[zone] = Some((bits, own.clone()));
                own
            }
        }
    }

    /// Whether what facts follow from is the same in the system at another value of the parameter, but for the values of
    /// entries that are not zero. A zero by chance is no fact, since its derivative in the parameter is none. Conditions
    /// have no part in them.
    pub(super) fn has_same_zeros(&self, other: &AffineSystem, sequence: &Sequence) -> bool {
        let known = &self.system;
        let zeros = |one: &Matrix, other: &Matrix| {
            let mut pairs = one.as_slice().iter().zip(other.as_slice());
            one.shape() == other.shape()
                && pairs.all(|(one, other)| (*one == 0.0) == (*other == 0.0))
        };
        let same_zeros = |one: &MatrixBy, other: &MatrixBy| {
            let mut slopes = one.by.iter().zip(&other.by);
            zeros(&one.at, &other.at) && slopes.all(|(one, other)| zeros(one, other))
        };
        let same_rows = |one: &Row, other: &Row| {
            let none = |one: &Vector, other: &Vector| {
                let mut pairs = one.iter().zip(other);
                pairs.all(|(one, other)| (*one == 0.0) == (*other == 0.0))
            };
            let mut slopes = one.by.iter().zip(&other.by);
            none(&one.at, &other.at) && slopes.all(|(one, other)| none(one, other))
        };
        let same_guards = |(one, other): (&Guard, &Guard)| {
            let mut exits = one.exits.iter().zip(&other.exits);
            same_rows(&one.row, &other.row)
                && one.exits.len() == other.exits.len()
                && exits.all(|(one, other)| same_zeros(&one.reset, &other.reset))
        };
        let alike = |(one, other): (&AffineMode, &AffineMode)| {
            let mut guards = one.guards.iter().zip(&other.guards);
            one.guards.len() == other.guards.len()
                && same_zeros(&one.matrix, &other.matrix)
                && guards.all(same_guards)
        };
        known.program.has_same_shape(&other.program)
            && (sequence.0.iter())
                .all(|zone| alike((&known.modes[zone.mode], &other.modes[zone.mode])))
    }

    /// Its facts for a system with the same zeros, where none of them changes with the parameter. Where guards do, a fact
    /// may come to rest at one value alone.
    pub(super) fn lasting_facts(
        &self,
        other: &AffineSystem,
        sequence: &Sequence,
    ) -> Option<Arc<Vec<ZoneFacts>>> {
        let told_by_forms = self.facts.iter().all(|facts| facts.generic.is_none());
        let mut zones = sequence.0.iter();
        let same_guards = zones.all(|zone| {
            let (one, other) = (&self.system.modes[zone.mode], &other.modes[zone.mode]);
            let mut guards = one.guards.iter().zip(&other.guards);
            guards.all(|(one, other)| one.row == other.row)
        });
        let last = same_guards && self.facts.iter().all(ZoneFacts::is_constant);
        last.then(|| match told_by_forms {
            true => self.facts.clone(),
            false => Arc::new(self.facts.iter().map(|facts| facts.at(other)).collect()),
        })
    }

    /// The flow of a mode in pieces.
    pub fn flow(&self, mode: usize) -> &ModeFlow {
        self.flows.get_or_make(mode, || {
            let balance = || self.balance(mode).clone();
            let mode = &self.system.modes[mode];
            let mut flow = ModeFlow::balanced(mode, self.longest, balance);
            flow.watch_bounds(mode);
            flow
        })
    }
}
