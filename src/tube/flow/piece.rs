//! A separation zone cut into pieces on which power series do.

use super::{Frame, Slide};
use crate::orbit::sign::{COEFFICIENTS, DEGREE, REMAINDER};

/// A piece of a zone: Taylor coefficients of U − δ and of V in the time over its length, and how much the
/// former leave out.
pub(crate) struct SeparationPiece {
    /// Its beginning after the entry.
    pub start: f64,
    pub length: f64,
    /// Of U − δ.
    pub gap: [f64; COEFFICIENTS],
    pub tangential: [f64; COEFFICIENTS],
    /// Bound of what is left out of U.
    pub remainder: f64,
}

/// The pieces of a zone without material damping, of at most one radian, `norm` being radians per unit of
/// time. U − δ has a zero of this order at the entry.
pub(super) fn undamped(
    frame: &Frame,
    norm: f64,
    slide: &Slide,
    order: usize,
) -> Vec<SeparationPiece> {
    let at = &frame.at;
    let steady = frame.steady().value;
    let radians = norm * slide.duration;
    let count = radians.ceil().max(1.0) as usize;
    let h = slide.duration / count as f64;
    // U − δ, U̇, Y, W
    let mut state = [0.0, 0.0, slide.entry[0], slide.entry[1]];
    let pieces = (0..count).map(|piece| {
        let mut gap = [0.0; COEFFICIENTS];
        let mut tangential = [0.0; COEFFICIENTS];
        gap[0] = state[0];
        gap[1] = h * state[1];
        tangential[0] = state[2] + steady;
        tangential[1] = h * state[3];
        for j in 0..DEGREE - 1 {
            let n = j as f64;
            let scale = 1.0 / ((n + 2.0) * (n + 1.0));
            let u = if j == 0 { gap[0] + at.mismatch } else { gap[j] };
            let rates = h * (n + 1.0);
            gap[j + 2] = -(rates * (at.damping * gap[j + 1] + at.kappa * tangential[j + 1])
                + at.g * h * h * u)
                * scale
                / at.mb;
            if j == 0 && piece == 0 && order == 3 {
                // P = 0 at take-off
                gap[2] = 0.0;
            }
            tangential[j + 2] = (rates * (at.kappa * gap[j + 1] - at.damping * tangential[j + 1])
                - at.h * h * h * tangential[j])
                * scale
                / at.ma;
        }
        let energy = at.g * (state[0] + at.mismatch).powi(2)
            + at.mb * state[1].powi(2)
            + at.h * (state[2] + steady).powi(2)
            + at.ma * state[3].powi(2);
        state = [
            horner(&gap, 1.0),
            horner_slope(&gap, 1.0) / h,
            horner(&tangential, 1.0) - steady,
            horner_slope(&tangential, 1.0) / h,
        ];
        SeparationPiece {
            start: piece as f64 * h,
            length: h,
            gap,
            tangential,
            remainder: REMAINDER * (radians / count as f64).powi(17) * (energy / at.g).sqrt(),
        }
    });
    pieces.collect()
}

/// A polynomial by its Taylor coefficients.
pub(crate) fn horner(taylor: &[f64; COEFFICIENTS], t: f64) -> f64 {
    taylor.iter().rev().fold(0.0, |sum, a| sum * t + a)
}

pub(crate) fn horner_slope(taylor: &[f64; COEFFICIENTS], t: f64) -> f64 {
    (1..COEFFICIENTS)
        .rev()
        .fold(0.0, |sum, j| sum * t + j as f64 * taylor[j])
}

pub(crate) fn horner_curvature(taylor: &[f64; COEFFICIENTS], t: f64) -> f64 {
    (2..COEFFICIENTS)
        .rev()
        .fold(0.0, |sum, j| sum * t + (j * (j - 1)) as f64 * taylor[j])
}
