//! What singular factors of a product take away: the subspace that is left, and the factors in its coordinates.

use crate::linalg::Matrix;

/// A factor of a product, and how many of its dimensions it takes away for reasons of its own.
#[derive(Clone, Debug)]
pub struct Factor {
    /// n×n.
    pub matrix: Matrix,
    /// n less its rank.
    pub lost: usize,
    /// Bound of the norm of its own error and of what rounding leaves, relative to that of the factor that it is a part of.
    pub error: f64,
    /// That norm.
    pub size: f64,
}

/// Factors of the same product in coordinates of what it leaves of a space, and the number of its eigenvalues that are
/// zero because of what its factors take away. No factor is taken for singular that does not say so.
pub fn regular_part(factors: Vec<Factor>) -> (Vec<Factor>, usize) {
    /// What of a subspace a singular factor takes away: the subspace is known to rounding times a condition.
    const NOTHING: f64 = 1e-11;
    let Some(n) = factors.first().map(|one| one.matrix.nrows()) else {
        return (factors, 0);
    };
    if factors.iter().all(|one| one.lost == 0) {
        return (factors, 0);
    }
    let mut basis = Matrix::identity(n, n);
    loop {
        let first = basis.clone();
        let mut left = Vec::with_capacity(factors.len());
        for factor in &factors {
            if basis.ncols() == 0 {
                return (Vec::new(), n);
            }
            let image = &factor.matrix * &basis;
            let (next, coordinates) = if factor.lost == 0 {
                let parts = image.qr();
                (parts.q(), parts.r())
            } else {
                let columns = image.ncols();
                let size = factor.size;
                let parts = image.col_piv_qr();
                let mut coordinates = parts.r();
                let small = |index: usize| match columns == n {
                    true => index + factor.lost >= n,
                    false => {
                        index + factor.lost >= columns
                            && coordinates[(index, index)].abs() <= NOTHING * size
                    }
                };
                let rank = (0..columns).find(|index| small(*index)).unwrap_or(columns);
                parts.p().inv_permute_columns(&mut coordinates);
                (
                    parts.q().columns(0, rank).into_owned(),
                    coordinates.rows(0, rank).into_owned(),
                )
            };
            left.push(Factor {
                matrix: coordinates,
                lost: 0,
                ..*factor
            });
            basis = next;
        }
        if basis.ncols() == first.ncols() {
            // the last basis in coordinates of the first: both span the same
            if let Some(last) = left.last_mut() {
                last.matrix = first.tr_mul(&basis) * &last.matrix;
            }
            return (left, n - basis.ncols());
        }
    }
}
