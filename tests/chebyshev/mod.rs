//! Spectral collocation, for tests that solve a boundary-value problem by another way.

use nalgebra::DMatrix;

/// Chebyshev's matrix of differentiation on n + 1 points of \[0, duration\], falling.
pub fn differentiation(n: usize, duration: f64) -> DMatrix<f64> {
    let x: Vec<f64> = (0..=n)
        .map(|j| (std::f64::consts::PI * j as f64 / n as f64).cos())
        .collect();
    let weight = |j: usize| {
        let end = if j == 0 || j == n { 2.0 } else { 1.0 };
        if j.is_multiple_of(2) { end } else { -end }
    };
    let mut matrix = DMatrix::zeros(n + 1, n + 1);
    for i in 0..=n {
        for j in (0..=n).filter(|j| *j != i) {
            let entry = weight(i) / weight(j) / (x[i] - x[j]);
            matrix[(i, j)] = entry;
            matrix[(i, i)] -= entry;
        }
    }
    matrix * (2.0 / duration)
}
