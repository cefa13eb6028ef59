//! How many multipliers are outside the unit circle.
//!
//! With approximate eigenvectors V of the linearised return M (or others, where these are parallel) and W next to their
//! inverse, λ is a multiplier where A − λB is singular, A = WMV, B = WV. Where on the whole circle |λ| = 1 every
//! ||aᵢᵢ| − |bᵢᵢ|| > Σ_{j≠i} |aᵢⱼ| + |bᵢⱼ|, no multiplier is on the circle, nor for any t ≤ 1 in t times what is off
//! the diagonal (S. Gershgorin 1931): so many are outside as rows have |aᵢᵢ| > |bᵢᵢ|.

use nalgebra::{Complex, DMatrix, Schur};

use super::flow::{Rows, product, sum};
use crate::interval::Interval;

/// Where eigenvectors are parallel, the vectors of the Schur form in their place, each shorter than the one before by
/// one of these ratios, which makes what is above the diagonal small.
const SHORTER: [f64; 3] = [0.1, 1e-2, 1e-3];
/// Sweeps of the iteration for a Schur form.
const SWEEPS: usize = 10_000;

/// A complex matrix in doubles.
pub type Complexes = DMatrix<Complex<f64>>;

/// Eigenvectors in columns, and the inverse of that matrix.
fn eigenvectors(matrix: &Complexes) -> Option<(Complexes, Complexes)> {
    let size = matrix.nrows();
    let schur = Schur::try_new(matrix.clone(), f64::EPSILON, SWEEPS)?;
    let (turn, upper) = schur.unpack();
    let mut vectors = Complexes::identity(size, size);
    for column in 0..size {
        for row in (0..column).rev() {
            let terms = (row + 1..=column).map(|k| upper[(row, k)] * vectors[(k, column)]);
            let sum: Complex<f64> = terms.sum();
            vectors[(row, column)] = sum / (upper[(column, column)] - upper[(row, row)]);
        }
        let norm = vectors.column(column).norm();
        vectors.column_mut(column).unscale_mut(norm);
    }
    let vectors = turn * vectors;
    let inverse = vectors.clone().try_inverse()?;
    let finite = |matrix: &Complexes| matrix.iter().all(|x| x.re.is_finite() && x.im.is_finite());
    (finite(&vectors) && finite(&inverse)).then_some((vectors, inverse))
}

/// Vectors of the Schur form in columns, each shorter than the one before, and the inverse of that matrix.
fn schur_vectors(matrix: &Complexes, ratio: f64) -> Option<(Complexes, Complexes)> {
    let schur = Schur::try_new(matrix.clone(), f64::EPSILON, SWEEPS)?;
    let (mut vectors, _) = schur.unpack();
    let mut inverse = vectors.adjoint();
    for index in 0..matrix.nrows() {
        let length = ratio.powi(index as i32);
        vectors.column_mut(index).scale_mut(length);
        inverse.row_mut(index).unscale_mut(length);
    }
    Some((vectors, inverse))
}

/// A part of a matrix of doubles.
pub fn part(matrix: &Complexes, of: impl Fn(&Complex<f64>) -> f64) -> Rows {
    let rows = matrix.row_iter();
    rows.map(|row| row.iter().map(|x| Interval::point(of(x))).collect())
        .collect()
}

/// −M.
pub fn negative(rows: &Rows) -> Rows {
    let row = |row: &Vec<Interval>| row.iter().map(|x| -*x).collect();
    rows.iter().map(row).collect()
}

fn count(matrix: &Rows, (vectors, inverse): &(Complexes, Complexes)) -> Option<usize> {
    let size = matrix.len();
    let (re, im) = (part(vectors, |x| x.re), part(vectors, |x| x.im));
    let (left_re, left_im) = (part(inverse, |x| x.re), part(inverse, |x| x.im));
    let both = |re: &Rows, im: &Rows| {
        [
            sum(&product(&left_re, re), &negative(&product(&left_im, im))),
            sum(&product(&left_re, im), &product(&left_im, re)),
        ]
    };
    let moved = both(&product(matrix, &re), &product(matrix, &im));
    let unit = both(&re, &im);
    let modulus = |parts: &[Rows; 2], i: usize, j: usize| {
        let [re, im] = [0, 1].map(|part: usize| parts[part][i][j]);
        // from below the parts need not be known apart from 0
        let least = |x: Interval| {
            if x.contains(0.0) {
                0.0
            } else {
                x.low.abs().min(x.high.abs())
            }
        };
        let low = Interval::point(least(re)).square() + Interval::point(least(im)).square();
        let high =
            Interval::point(re.magnitude()).square() + Interval::point(im.magnitude()).square();
        Interval::new(low.sqrt().low, high.sqrt().high)
    };
    let mut outside = 0;
    for i in 0..size {
        let others = (0..size).filter(|j| *j != i);
        let off = others.fold(Interval::ZERO, |sum, j| {
            sum + modulus(&moved, i, j) + modulus(&unit, i, j)
        });
        let gap = modulus(&moved, i, i) - modulus(&unit, i, i);
        let bound = Interval::point(off.high);
        match ((gap - bound).is_positive(), (-gap - bound).is_positive()) {
            (true, _) => outside += 1,
            (_, true) => {}
            _ => return None,
        }
    }
    Some(outside)
}

/// How many eigenvalues of every matrix within intervals are outside the unit circle; `None` where that is not
/// proven.
pub fn outside(matrix: &Rows) -> Option<usize> {
    let size = matrix.len();
    let middle = Complexes::from_fn(size, size, |i, j| Complex::new(matrix[i][j].middle(), 0.0));
    bases(&middle).find_map(|basis| count(matrix, &basis))
}

/// Bases in which a matrix is about diagonal, each with about the inverse of its matrix.
pub fn bases(middle: &Complexes) -> impl Iterator<Item = (Complexes, Complexes)> {
    let scaled = SHORTER
        .into_iter()
        .filter_map(|ratio| schur_vectors(middle, ratio));
    eigenvectors(middle).into_iter().chain(scaled)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Matrices with known eigenvalues, blurred: counts are of their moduli, also where 0 is defective; one whose
    /// modulus may be 1 is not counted.
    #[test]
    fn multipliers_are_counted() {
        let of = |rows: &[&[f64]], blur: f64| {
            let row = |row: &&[f64]| row.iter().map(|x| Interval::around(*x, blur)).collect();
            outside(&rows.iter().map(row).collect())
        };
        // 1.25 e^{±i·atan(3/4)} beside ½, turned into one another
        let mixed: &[&[f64]] = &[&[1.0, -0.75, 4.0], &[0.75, 1.0, -7.0], &[0.0, 0.0, 0.5]];
        assert_eq!(of(mixed, 1e-9), Some(2));
        // nilpotent, of order three
        let shift: &[&[f64]] = &[&[0.0, 3.0, 1.0], &[0.0, 0.0, -2.0], &[0.0, 0.0, 0.0]];
        assert_eq!(of(shift, 1e-13), Some(0));
        assert_eq!(of(&[&[-2.0]], 1e-3), Some(1));
        assert_eq!(of(&[&[0.0, -1.0], &[1.0, 0.0]], 0.0), None);
        assert_eq!(of(&[&[0.999]], 1e-2), None);
    }
}
