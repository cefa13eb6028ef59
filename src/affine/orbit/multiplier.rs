//! A Floquet multiplier as it is known, and what a list of them tells.

use nalgebra::Complex;

use crate::orbit::EventType;

/// A Floquet multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multiplier {
    /// Its value.
    pub value: Complex<f64>,
    /// Whether it is what it is for every orbit of its kind: 1 for the shift in time of an orbit without forcing and for a
    /// sum of states that never changes, 0 for a dimension that a sliding mode, a contact or a reset takes away.
    pub trivial: bool,
    /// Radius of a disc about it that holds the multiplier of the orbit as it is known.
    pub error: f64,
}

/// A multiplier this close to the unit circle is on it but for rounding: the events where one crosses are located to
/// about this.
const ON_CIRCLE: f64 = 1e-9;

/// A multiplier larger than this is infinite but for rounding, at a graze, where the speed of an impact is zero; unless it is known to
/// the second part of itself, as beside a saddle.
const INFINITE: f64 = 1e12;
const KNOWN: f64 = 1e-3;

impl Multiplier {
    /// Whether it is finite.
    pub fn is_finite(&self) -> bool {
        let size = self.value.norm();
        size < INFINITE || size.is_finite() && self.error <= KNOWN * size
    }

    /// Whether it is finite and not lost in its error: where a graze magnifies rounding without bound, and what follows makes
    /// it finite again, nothing is left of it.
    pub fn is_known(&self) -> bool {
        self.is_finite() && self.error <= self.value.norm().max(1.0)
    }

    /// Whether the orbit grows along it.
    pub fn is_outside(&self) -> bool {
        !self.trivial && self.value.norm() > 1.0 + ON_CIRCLE.max(self.error)
    }

    /// The same at an event of this kind: one that is this near to where it passes does pass, and the orbit may be known less well
    /// than its multipliers, as where branches cross at which a symmetry makes two of them pass at once.
    pub fn at(self, kind: Option<EventType>) -> Multiplier {
        /// Where two pass at once an orbit is known to the root of rounding.
        const PASSES: f64 = 1e-7;
        let off = match kind {
            Some(EventType::LP | EventType::BP) => (self.value - 1.0).norm(),
            Some(EventType::PD) => (self.value + 1.0).norm(),
            Some(EventType::NS) => (self.value.norm() - 1.0).abs(),
            _ => return self,
        };
        let passes = !self.trivial && off <= PASSES;
        Multiplier {
            error: self.error.max(if passes { off } else { 0.0 }),
            ..self
        }
    }

    /// Whether it may not be told from one on the unit circle.
    pub fn is_on_circle(&self) -> bool {
        !self.trivial && (self.value.norm() - 1.0).abs() <= ON_CIRCLE.max(self.error)
    }
}

/// Those that are not trivial.
pub fn own(multipliers: &[Multiplier]) -> impl Iterator<Item = &Multiplier> {
    multipliers.iter().filter(|one| !one.trivial)
}

/// Whether more than rounding tells the sign of a function of [`Monodromy::tests`]: it does not where a multiplier, or
/// the product of a pair, stays where it vanishes, as those of a motion without loss do.
pub(super) fn is_told(multipliers: &[Multiplier], test: usize) -> bool {
    /// Rounding of multipliers, a condition of many thousands included.
    const NOISE: f64 = 1e-10;
    let own: Vec<&Multiplier> = own(multipliers).collect();
    let off = |x: Complex<f64>, from: f64, error: f64| {
        (x - from).norm() > NOISE * (1.0 + x.norm()) + error
    };
    let from = |from: f64| own.iter().all(|one| off(one.value, from, one.error));
    let pair = |one: &Multiplier, two: &Multiplier| {
        let error = one.error * two.value.norm() + two.error * one.value.norm();
        off(one.value * two.value, 1.0, error)
    };
    match test {
        0 => from(-1.0),
        1 => from(1.0),
        _ => (0..own.len()).all(|j| (0..j).all(|i| pair(own[i], own[j]))),
    }
}

/// Whether there is a fold between two orbits next to one another, with these multipliers: one of those that are not trivial passes 1 at
/// a fold, so that the number of those beyond it is even before and odd after it, or the other way round. Not known where one is near 1, or
/// badly known.
pub(super) fn turns(multipliers: [&[Multiplier]; 2]) -> Option<bool> {
    /// A multiplier that is farther from 1: of one that is nearer neither side is told.
    const NEAR: f64 = 1e-6;
    let [before, after] = multipliers.map(|all| own(all).collect::<Vec<_>>());
    let is_far =
        |one: &&Multiplier| one.is_known() && (one.value - 1.0).norm() > NEAR.max(2.0 * one.error);
    let beyond = |all: &[&Multiplier]| {
        let real = all.iter().filter(|one| one.value.im == 0.0);
        real.filter(|one| one.value.re > 1.0).count()
    };
    let is_clear = !before.is_empty()
        && before.len() == after.len()
        && before.iter().chain(&after).all(is_far);
    is_clear.then(|| (beyond(&before) + beyond(&after)) % 2 == 1)
}
