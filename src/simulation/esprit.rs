//! ESPRIT: a complex signal as a sum of exponentials, z_n = Σ w_m e^{λ_m nτ}.
//!
//! Every window of L samples of such a signal lies in the space spanned by the vectors
//! (1, μ, μ², …), μ = e^{λτ}. The leading left singular vectors S of the matrix of all windows span the
//! same space, which is mapped into itself when windows are shifted by a sample: with S₁ and S₂ for
//! S without its last and its first row, S₁X = S₂ in the least-squares sense, and the eigenvalues of X
//! are the μ. The weights w follow by least squares.

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

/// One of the exponentials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalExponential {
    /// λ.
    pub exponent: [f64; 2],
    /// |w e^{λt}| at the end of the signal.
    pub size: f64,
}

const WINDOW: usize = 120;

const MOST: usize = 16;

/// Singular values below this part of the largest are noise. Rounding is 1e-16 of the largest; what
/// nonlinearity and the modes left out contribute is well above it.
const NOISE: f64 = 1e-9;

/// The exponentials of a signal with the sampling time `step`, the largest at the end first. Empty when
/// there are too few samples or nothing to be found.
pub fn exponentials(signal: &[[f64; 2]], step: f64) -> Vec<SignalExponential> {
    let count = signal.len();
    let window = (count / 3).min(WINDOW);
    if window < 4 {
        return Vec::new();
    }
    let value = |index: usize| c64::new(signal[index][0], signal[index][1]);
    let windows = Mat::from_fn(window, count - window + 1, |row, column| {
        value(row + column)
    });
    let Ok(decomposition) = windows.thin_svd() else {
        return Vec::new();
    };
    let sizes = decomposition.S().column_vector();
    let largest = sizes[0].re;
    let rank = (0..window.min(MOST))
        .take_while(|index| sizes[*index].re > NOISE * largest)
        .count()
        .min(window - 1);
    if rank == 0 || !largest.is_finite() {
        return Vec::new();
    }
    let space = decomposition.U().subcols(0, rank);
    let (first, second) = (space.subrows(0, window - 1), space.subrows(1, window - 1));
    let normal = first.adjoint() * first;
    let shift = normal.partial_piv_lu().solve(&(first.adjoint() * second));
    let Ok(multipliers) = shift.eigenvalues() else {
        return Vec::new();
    };
    // powers counted from the end that is larger, so that none overflows
    let powers = Mat::from_fn(count, rank, |row, column| {
        let exponent: c64 = multipliers[column].ln();
        let from = if exponent.re > 0.0 { count - 1 } else { 0 };
        (exponent * (row as f64 - from as f64)).exp()
    });
    let right = Mat::from_fn(count, 1, |row, _| value(row));
    let normal = powers.adjoint() * &powers;
    let weights = normal.partial_piv_lu().solve(&(powers.adjoint() * &right));
    let mut found: Vec<SignalExponential> = (0..rank)
        .map(|index| {
            let exponent: c64 = multipliers[index].ln() / step;
            let end = powers[(count - 1, index)] * weights[(index, 0)];
            SignalExponential {
                exponent: [exponent.re, exponent.im],
                size: end.norm(),
            }
        })
        .filter(|one| one.size.is_finite() && one.exponent.iter().all(|x| x.is_finite()))
        .collect();
    found.sort_by(|one, other| other.size.total_cmp(&one.size));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three planted exponentials, one decaying, come back to rounding times the condition of the
    /// problem, which is about 1e4 here.
    #[test]
    fn planted_exponentials_are_found() {
        let planted = [
            ([0.3, 2.0], [1.0, 0.0]),
            ([0.25, -5.0], [0.0, 0.5]),
            ([-0.1, 7.0], [0.3, 0.1]),
        ];
        let step = 0.05;
        let signal: Vec<[f64; 2]> = (0..200)
            .map(|n| {
                let t = step * f64::from(n);
                let sum: c64 = planted
                    .iter()
                    .map(|(l, w)| c64::new(w[0], w[1]) * (c64::new(l[0], l[1]) * t).exp())
                    .sum();
                [sum.re, sum.im]
            })
            .collect();
        let found = exponentials(&signal, step);
        for (exponent, _) in planted {
            let off = found
                .iter()
                .map(|one| (one.exponent[0] - exponent[0]).hypot(one.exponent[1] - exponent[1]))
                .fold(f64::INFINITY, f64::min);
            assert!(off < 1e-10, "{exponent:?}: {off:e}");
        }
    }
}
