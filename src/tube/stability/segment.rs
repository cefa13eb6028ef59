//! A part of a sliding zone along which friction is a power series, and the numbers that perturbations are carried through it by.

use super::C64;
use crate::tube::flow::numeric::series::{Series, SlipPiece, TERMS};

/// √|Δ|s of one step at most: 2²⁹/29! is below rounding.
pub(super) const RADIANS: f64 = 2.0;

/// Terms of the power series of z.
pub(super) const ORDER: usize = TERMS + 2;

/// Perturbations larger than this are scaled down.
const LARGE: f64 = 1e60;

/// z and z′ with their derivatives in λ.
pub(super) type Pair = [[C64; 2]; 2];

/// A part of a zone over which Δ is a power series in (time − start)/duration.
#[derive(Clone, Debug)]
pub(super) struct SeriesSegment {
    pub(super) piece: SlipPiece,
    /// Δ less ãλ²/m_a²: the coefficient of λ, and what does not depend on λ.
    pub(super) linear: Series,
    pub(super) constant: Series,
    /// Bounds of these two: the sums of |term|.
    pub(super) sizes: [f64; 2],
}

impl SeriesSegment {
    /// Bound of |Δ| for |λ| ≤ `frequency`, with q.
    pub(super) fn size(&self, square: f64, frequency: f64) -> f64 {
        let [linear, constant] = self.sizes;
        frequency * (frequency * square + linear) + constant
    }
}

/// The series of the part of x from `from` on, `width` long.
pub(super) fn part(series: &Series, from: f64, width: f64) -> Series {
    let mut moved = *series;
    for first in 0..TERMS - 1 {
        for index in (first..TERMS - 1).rev() {
            moved[index] += from * moved[index + 1];
        }
    }
    let mut power = 1.0;
    moved.map(|term| {
        let term = term * power;
        power *= width;
        term
    })
}

/// Scales perturbations down that have grown large, and returns the exponent of that.
pub(super) fn scaled_down(pairs: &mut [Pair]) -> f64 {
    let size = |pair: &Pair| pair[0][0].norm_sqr().max(pair[0][1].norm_sqr());
    let size = pairs.iter().map(size).fold(0.0, f64::max).sqrt();
    if size <= LARGE {
        return 0.0;
    }
    let inverse = size.recip();
    for number in pairs.iter_mut().flatten().flatten() {
        *number *= inverse;
    }
    size.ln()
}
