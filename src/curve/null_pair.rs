//! The null vectors of a multiplier, as functions of the unknowns.

use nalgebra::Complex;

use crate::linalg::{self, Matrix, Vector};

/// The null vectors v and w of N = F_x + (μ − 1)C, real and imaginary part of each; without the latter where μ is real.
pub(super) struct NullPair {
    right: Vec<Vector>,
    left: Vec<Vector>,
}

impl NullPair {
    /// Those of a multiplier; `None` where the decomposition fails. In real numbers N = A + iB is (A, −B; B, A).
    pub fn new(by: &Matrix, closing: &Matrix, multiplier: Complex<f64>) -> Option<NullPair> {
        let count = by.nrows();
        let (by, closing) = (by.columns(0, count), closing.columns(0, count));
        let real = by + closing * (multiplier.re - 1.0);
        if multiplier.im == 0.0 {
            let linalg::Least { left, right, .. } = linalg::least(&real)?;
            return Some(NullPair {
                right: vec![right],
                left: vec![left],
            });
        }
        let imaginary = closing * multiplier.im;
        let mut both = real.clone().resize(2 * count, 2 * count, 0.0);
        both.view_mut((count, count), (count, count))
            .copy_from(&real);
        both.view_mut((count, 0), (count, count))
            .copy_from(&imaginary);
        both.view_mut((0, count), (count, count))
            .copy_from(&-imaginary);
        let linalg::Least { left, right, .. } = linalg::least(&both)?;
        let parts = |all: Vector| vec![all.rows(0, count).into(), all.rows(count, count).into()];
        Some(NullPair {
            right: parts(right),
            left: parts(left),
        })
    }

    /// wᴴMv, where `part` is the product of a part of w with M times the part of v of this number, the real one first.
    fn product(&self, part: impl Fn(&Vector, usize) -> f64) -> Complex<f64> {
        let mut sum = Complex::new(0.0, 0.0);
        for (conjugate, left) in [Complex::new(1.0, 0.0), -Complex::i()]
            .iter()
            .zip(&self.left)
        {
            for (index, factor) in [Complex::new(1.0, 0.0), Complex::i()].iter().enumerate() {
                if index < self.right.len() {
                    sum += conjugate * factor * part(left, index);
                }
            }
        }
        sum
    }

    /// ∂μ in all unknowns, from derivatives along the parts of v; `None` where the multiplier is a double one or
    /// nearly so.
    pub fn slopes(
        &self,
        closing: &Matrix,
        multiplier: Complex<f64>,
        along: impl Fn(&Vector) -> Option<[Matrix; 2]>,
    ) -> Option<Vec<Complex<f64>>> {
        /// wᴴCv of unit vectors below this is lost too far in the rounding of differences.
        const SIMPLE: f64 = 1e-2;
        let states = closing.columns(0, closing.nrows());
        let ends: Vec<Vector> = self.right.iter().map(|right| states * right).collect();
        let divisor = self.product(|left, index| left.dot(&ends[index]));
        let size: f64 = ends.iter().map(Vector::norm_squared).sum();
        if divisor.norm().is_nan() || divisor.norm() <= SIMPLE * size.sqrt() {
            return None;
        }
        let slopes: Option<Vec<[Matrix; 2]>> = self.right.iter().map(along).collect();
        let slopes = slopes?;
        let of = |column: usize| {
            let [equations, closing] = [0, 1]
                .map(|of| self.product(|left, index| left.dot(&slopes[index][of].column(column))));
            -(equations + (multiplier - 1.0) * closing) / divisor
        };
        Some((0..closing.ncols()).map(of).collect())
    }
}
