//! The integral of a form over a passage through a zone, with all its derivatives.
//!
//! Where the flow ż = Mz is linear and the form is zᵀQz, its integral from z₀ over a time t is z₀ᵀG(t)z₀ with
//! G(t) = ∫₀ᵗ exp(Mᵀs) Q exp(Ms) ds, the exponential of the Kronecker sum M ⊕ M applied to Q: its series over a short time,
//! Σ Lᵏ(Q)t^{k+1}/(k+1)! with L(X) = MᵀX + XM, and then G(2t) = G(t) + exp(Mᵀt) G(t) exp(Mt), which adds and never cancels.
//! Where the mode is stiff the squares of exp(Mt) have the rounding of what decays: its value is then the sum of those over the pieces of its
//! slow part. Elsewhere the form is integrated piece by piece with the Taylor series of the flow.

use super::passage::{Integrated, Jet};
use crate::affine::dual::VARYING;
use crate::affine::exponential::{TERMS, entries, propagator};
use crate::affine::flow::Expansion;
use crate::affine::mode::{AffineMode, MatrixBy, Row};
use crate::affine::series::ORDER;
use crate::linalg::{Matrix, Vector};

/// ‖Mh‖ in the balanced norm over the first step, at most: there ‖L‖h ≤ 1, and 1/(k + 1)! is left out after so many terms as
/// of an exponential.
const FIRST: f64 = 0.5;

/// Factors of a step of the doubling: exp(Mt) and G(t), with their derivatives in the parameters on which they depend.
struct Doubling {
    flow: MatrixOf,
    gramian: MatrixOf,
}

/// A matrix with its derivatives in those parameters on which it depends.
struct MatrixOf {
    at: Matrix,
    by: [Option<Matrix>; VARYING],
}

/// Adds what is there to what is there.
fn add(sum: &mut Option<Matrix>, one: Option<Matrix>) {
    if let Some(one) = one {
        match sum {
            Some(sum) => *sum += one,
            None => *sum = Some(one),
        }
    }
}

/// MᵀX + XM for a symmetric X.
fn lyapunov(matrix: &Matrix, x: &Matrix) -> Matrix {
    let half = x * matrix;
    half.transpose() + half
}

impl Doubling {
    /// Over a time so short that the series holds.
    fn first(matrix: &MatrixBy, form: &MatrixBy, states: usize, norm: f64, time: f64) -> Doubling {
        let moving = |by: &Matrix| by.iter().any(|by| *by != 0.0);
        let slopes = matrix
            .by
            .each_ref()
            .map(|by| Some(by).filter(|by| moving(by)));
        let (at, by) = propagator(&matrix.at, slopes, states, norm, time);
        let mut term = form.at.clone();
        let mut terms: [Option<Matrix>; VARYING] = std::array::from_fn(|p| {
            let own = Some(form.by[p].clone()).filter(moving);
            own.or_else(|| slopes[p].map(|_| Matrix::zeros(term.nrows(), term.ncols())))
        });
        let mut factor = time;
        let mut gramian = MatrixOf {
            at: &term * factor,
            by: terms.each_ref().map(|by| by.as_ref().map(|by| by * factor)),
        };
        for k in 2..=TERMS + 1 {
            for (by, slope) in terms.iter_mut().zip(slopes) {
                if let Some(by) = by {
                    *by = lyapunov(&matrix.at, by);
                    if let Some(slope) = slope {
                        *by += lyapunov(slope, &term);
                    }
                }
            }
            term = lyapunov(&matrix.at, &term);
            factor *= time / f64::from(k);
            gramian.at += &term * factor;
            for (sum, by) in gramian.by.iter_mut().zip(&terms) {
                add(sum, by.as_ref().map(|by| by * factor));
            }
        }
        Doubling {
            flow: MatrixOf { at, by },
            gramian,
        }
    }

    /// The same over twice the time.
    fn doubled(self) -> Doubling {
        let Doubling { flow, gramian } = self;
        let after = &gramian.at * &flow.at;
        let at = &gramian.at + flow.at.tr_mul(&after);
        let mut by = gramian.by.clone();
        for (sum, (own, along)) in by.iter_mut().zip(gramian.by.iter().zip(&flow.by)) {
            let own = own.as_ref().map(|own| flow.at.tr_mul(&(own * &flow.at)));
            add(sum, own);
            let along = along.as_ref().map(|along| along.tr_mul(&after));
            add(sum, along.map(|along| along.transpose() + along));
        }
        let squared = flow.by.each_ref().map(|by| {
            let by = by.as_ref()?;
            Some(by * &flow.at + &flow.at * by)
        });
        Doubling {
            flow: MatrixOf {
                at: &flow.at * &flow.at,
                by: squared,
            },
            gramian: MatrixOf { at, by },
        }
    }
}

/// The integral of zᵀQz over a passage through a linear mode from z, whose matrix has this norm when it is balanced.
pub(super) fn of_square(
    mode: &AffineMode,
    form: &MatrixBy,
    norm: f64,
    entry: &Vector,
    end: &Vector,
    time: f64,
) -> Jet {
    let base = form.at.nrows();
    let part = |matrix: &Matrix| matrix.view((0, 0), (base, base)).into_owned();
    let matrix = MatrixBy {
        at: part(&mode.matrix.at),
        by: mode.matrix.by.each_ref().map(part),
    };
    let doublings = (norm * time.abs() / FIRST).log2().ceil().max(0.0);
    // what is not finite gives an integral that is not
    let first = time * (-doublings).exp2();
    let doublings = match doublings.is_finite() {
        true => doublings as u32,
        false => 0,
    };
    let first = Doubling::first(&matrix, form, mode.states, norm, first);
    let all = (0..doublings).fold(first, |one, _| one.doubled());
    let (z, last) = (entry.rows(0, base), end.rows(0, base));
    let along = &all.gramian.at * z;
    let mut by_z = Vector::zeros(entry.len());
    by_z.rows_mut(0, base).copy_from(&(&along * 2.0));
    let square = |matrix: &Matrix| z.dot(&(matrix * z));
    Jet {
        shot: 0,
        value: z.dot(&along),
        by_z,
        by_time: last.dot(&(&form.at * last)),
        by: all.gramian.by.map(|by| by.as_ref().map_or(0.0, square)),
    }
}

/// The integral of zᵀQz over a piece of a linear mode, whose polynomials are multiplied out.
pub(super) fn over_piece(form: &Matrix, expansion: &Expansion, length: f64) -> f64 {
    let mut sum = 0.0;
    for (i, j, weight) in entries(form) {
        for (k, a) in expansion.taylor(i).iter().enumerate() {
            for (l, b) in expansion.taylor(j).iter().enumerate() {
                sum += weight * a * b / (k + l + 1) as f64;
            }
        }
    }
    sum * length
}

/// The integral of a row over a passage that takes this time and is known piece by piece, the row being a part of its series;
/// `size` is the length of z.
pub(super) fn of_series(passage: &Integrated, row: &Row, size: usize, time: f64) -> Jet {
    let mut sum = Jet::nothing(size);
    for stage in &passage.stages {
        let (flow, by) = &stage.by;
        let mut weight = 1.0;
        for k in 0..=ORDER {
            weight *= stage.time.copysign(time);
            let (value, slopes, own) = stage.series.jet(row, k);
            let factor = weight / (k + 1) as f64;
            let base = slopes.rows(0, flow.nrows());
            let along = flow.tr_mul(&base) * factor;
            sum.value += factor * value;
            let mut whole = sum.by_z.rows_mut(0, flow.ncols());
            whole += along;
            for (sum, (own, by)) in sum.by.iter_mut().zip(own.iter().zip(by)) {
                *sum += factor * (own + base.dot(by));
            }
        }
    }
    sum
}
