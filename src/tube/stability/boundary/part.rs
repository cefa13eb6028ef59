//! One zone of the boundary-value problem: its motions e^{rs}, at its entry and at its end.

use super::{C64, ComplexDual, LinearZone};
use crate::tube::model::signature::Regime;
use crate::tube::stability::dual::inverse;

/// Forms in η, η′ and u′, and the like.
pub(super) const U: usize = 0;
pub(super) const U_RATE: usize = 1;
pub(super) const U_BEND: usize = 2;
pub(super) const ETA: usize = 3;
pub(super) const RATE: usize = 4;
pub(super) const BEND: usize = 5;
/// u″ − m_b u′/(βb̃) and η″ − m_a η′/(βã): what the layers leave of their second derivatives.
pub(super) const U_LEFT: usize = 6;
pub(super) const LEFT: usize = 7;

/// A motion (u, η) = shape·e^{rs} of a zone.
#[derive(Clone, Copy)]
pub(super) struct MotionShape {
    pub(super) r: ComplexDual,
    pub(super) shape: [ComplexDual; 2],
    /// r − m_b/(βb̃) and r − m_a/(βã).
    pub(super) apart: [ComplexDual; 2],
    /// Where s is zero: at the entry, or at the end.
    pub(super) origin: f64,
}

/// An exponent that grows by more than this over a zone is counted from its end.
pub(super) const GROWTH: f64 = 3.0;

impl MotionShape {
    pub(super) fn at(&self, time: f64) -> [ComplexDual; 8] {
        // the derivatives of the fastest motions stay of order one
        let size = self.r.at.norm_sqr().max(1.0).recip();
        let factor = (self.r * (time - self.origin)).exp() * size;
        let [u, eta] = self.shape.map(|shape| shape * factor);
        let [u_rate, rate] = [u * self.r, eta * self.r];
        let [u_left, left] = [u_rate * self.apart[0], rate * self.apart[1]];
        let [u_bend, bend] = [u_rate * self.r, rate * self.r];
        [u, u_rate, u_bend, eta, rate, bend, u_left, left]
    }
}

/// One zone with its motions, at its entry and at its end.
pub(super) struct ZoneMotions {
    pub(super) zone: LinearZone,
    pub(super) shapes: Vec<MotionShape>,
    pub(super) entry: Vec<[ComplexDual; 8]>,
    pub(super) exit: Vec<[ComplexDual; 8]>,
    /// Motions that stand in the place of the brief shapes: which those are, and of how much of each.
    mixed: (Vec<usize>, Vec<Vec<ComplexDual>>),
}

/// Exponents r with |r|T below this hardly differ over a zone.
const BRIEF: f64 = 1.0;

/// Terms of a power series of e^{rT}: 1/21! is left.
const TERMS: usize = 21;

impl ZoneMotions {
    pub(super) fn new(zone: &LinearZone, shapes: Vec<MotionShape>) -> ZoneMotions {
        let at = |time: f64| shapes.iter().map(|shape| shape.at(time)).collect();
        let (entry, exit) = (at(0.0), at(zone.duration));
        let mut part = ZoneMotions {
            zone: zone.clone(),
            entry,
            exit,
            shapes,
            mixed: (Vec::new(), Vec::new()),
        };
        part.mix();
        part
    }

    /// Where a zone is brief against all its exponents, or all but those of the layers, unit motions of
    /// (u, u′, u″, η, η′, η″), or of (u, u′, η, η′), replace e^{rs}, whose small differences they are:
    /// what they leave behind is summed as power series, from u, u′ and η, η′ as they begin.
    fn mix(&mut self) {
        let (shapes, time) = (&self.shapes, self.zone.duration);
        let brief = |index: &usize| shapes[*index].r.at.norm() * time <= BRIEF;
        let indices: Vec<usize> = (0..shapes.len()).filter(brief).collect();
        let parts = if self.zone.regime == Regime::Separation {
            2
        } else {
            1
        };
        let order = indices.len() / parts;
        if order < 2 || indices.len() != order * parts {
            return;
        }
        // (part, derivative) of each unit motion
        let units: Vec<(usize, usize)> = (2 - parts..2)
            .flat_map(|part| (0..order).map(move |derivative| (part, derivative)))
            .collect();
        let rows = units.iter().map(|(part, derivative)| {
            let of = |index: &usize| self.entry[*index][3 * part + derivative];
            indices.iter().map(of).collect()
        });
        let Some(shares) = inverse(rows.collect()) else {
            return;
        };
        let slowest = indices
            .iter()
            .map(|index| &shapes[*index])
            .min_by(|one, other| one.r.at.norm_sqr().total_cmp(&other.r.at.norm_sqr()));
        let limit = slowest.map_or([0.0; 2], |slow| {
            slow.apart.map(|apart| (slow.r - apart).at.re)
        });
        let bare = self.entry.clone();
        for (column, unit) in units.iter().enumerate() {
            let mut ends = [[ComplexDual::constant(0.0); 8]; 2];
            for part in 2 - parts..2 {
                // of what share of each shape, and its derivatives at the entry
                let mut left: Vec<ComplexDual> = indices
                    .iter()
                    .zip(&shares)
                    .map(|(index, share)| bare[*index][3 * part] * share[column])
                    .collect();
                let mut derivatives = Vec::with_capacity(TERMS + 3);
                for derivative in 0..TERMS + 3 {
                    derivatives.push(if derivative < order {
                        ComplexDual::constant(f64::from(u8::from((part, derivative) == *unit)))
                    } else {
                        left.iter()
                            .fold(ComplexDual::constant(0.0), |sum, one| sum + *one)
                    });
                    for (one, index) in left.iter_mut().zip(&indices) {
                        *one = *one * shapes[*index].r;
                    }
                }
                for (end, time) in ends.iter_mut().zip([0.0, time]) {
                    for derivative in 0..3 {
                        let terms = derivatives[derivative..].iter().take(TERMS).enumerate();
                        let sum = terms
                            .rev()
                            .fold(ComplexDual::constant(0.0), |sum, (n, term)| {
                                sum * (time / (n as f64 + 1.0)) + *term
                            });
                        end[3 * part + derivative] = sum;
                    }
                    end[U_LEFT + part] = end[3 * part + 2] - end[3 * part + 1] * limit[part];
                }
            }
            [self.entry[indices[column]], self.exit[indices[column]]] = ends;
        }
        self.mixed = (indices, shares);
    }

    /// How much there is of each shape, from the amplitudes of the motions.
    pub(super) fn shares(&self, amplitudes: &[C64]) -> Vec<C64> {
        let mut shares = amplitudes.to_vec();
        let (indices, of) = &self.mixed;
        for (index, row) in indices.iter().zip(of) {
            let columns = indices.iter().zip(row);
            shares[*index] = columns
                .map(|(column, of)| of.at * amplitudes[*column])
                .sum();
        }
        shares
    }
}
