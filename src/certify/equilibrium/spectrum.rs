//! How many eigenvalues of an equilibrium have a positive real part.
//!
//! The linearisation is taken to coordinates of the surfaces that the mode does not leave, and modulo the critical vectors at an event, whose
//! eigenvalues 0 or ± iω are known. For what is left, A, let V be approximate eigenvectors, W about V⁻¹, and H a diagonal of signs, those of the
//! real parts. Where (WV)*H(WAV) + its adjoint is positive definite, so is PA + A*P with P = W*HW; then A has no eigenvalue
//! on the axis, and as many right of it as P has positive ones, which are those of H (A. Ostrowski, H. Schneider, J. Math.
//! Anal. Appl. 4, 1962). A Hermitian matrix is positive definite where every entry of the diagonal is larger than the sum of the moduli of
//! the others in its row.

use nalgebra::Complex;

use super::Rows;
use super::system::{EquilibriumCondition, EquilibriumSystem};
use crate::certify::orbit::flow::{product, sum};
use crate::certify::orbit::multipliers::{self, Complexes, negative, part};
use crate::interval::Interval;

/// The index of the entry that is farthest from zero.
fn pivot(vector: &[Interval]) -> Option<usize> {
    let least = |x: &Interval| match x.contains(0.0) {
        true => 0.0,
        false => x.low.abs().min(x.high.abs()),
    };
    let entries = vector.iter().enumerate();
    let largest = entries.max_by(|(_, one), (_, other)| least(one).total_cmp(&least(other)));
    largest
        .filter(|(_, x)| least(x) > 0.0)
        .map(|(index, _)| index)
}

/// row − factor·other.
fn minus(row: &mut [Interval], factor: Interval, other: &[Interval]) {
    for (x, y) in row.iter_mut().zip(other) {
        *x = *x - factor * *y;
    }
}

/// A square matrix in the coordinates of the vectors with n·v = 0 for every normal n, as many as there are of those but
/// one for each, where it leads from these to these; with vectors of them.
fn within(mut matrix: Rows, mut normals: Rows, mut vectors: Rows) -> Option<(Rows, Rows)> {
    while let Some(normal) = normals.pop() {
        let dropped = pivot(&normal)?;
        matrix.remove(dropped);
        for row in matrix.iter_mut().chain(&mut normals) {
            let factor = row[dropped] / normal[dropped];
            minus(row, factor, &normal);
            row.remove(dropped);
        }
        vectors.iter_mut().for_each(|vector| {
            vector.remove(dropped);
        });
    }
    Some((matrix, vectors))
}

/// A square matrix modulo vectors whose span it keeps.
fn modulo(mut matrix: Rows, mut vectors: Rows) -> Option<Rows> {
    while let Some(vector) = vectors.pop() {
        let dropped = pivot(&vector)?;
        let others = (0..vector.len()).filter(|row| *row != dropped);
        let pivot_row = matrix[dropped].clone();
        for row in others {
            let factor = vector[row] / vector[dropped];
            minus(&mut matrix[row], factor, &pivot_row);
            for other in &mut vectors {
                other[row] = other[row] - factor * other[dropped];
            }
        }
        matrix.remove(dropped);
        vectors.iter_mut().for_each(|other| {
            other.remove(dropped);
        });
        matrix.iter_mut().for_each(|row| {
            row.remove(dropped);
        });
    }
    Some(matrix)
}

/// Real and imaginary part of a product.
fn times([re, im]: &[Rows; 2], [other_re, other_im]: &[Rows; 2]) -> [Rows; 2] {
    [
        sum(&product(re, other_re), &negative(&product(im, other_im))),
        sum(&product(re, other_im), &product(im, other_re)),
    ]
}

/// The number by an approximate basis and the inverse of that; `None` where it is not proven.
fn counted(matrix: &Rows, (vectors, inverse): &(Complexes, Complexes)) -> Option<usize> {
    let size = matrix.len();
    let parts = |of: &Complexes| [part(of, |x| x.re), part(of, |x| x.im)];
    let (right, left) = (parts(vectors), parts(inverse));
    let nothing = vec![vec![Interval::ZERO; size]; size];
    let moved = times(&left, &times(&[matrix.clone(), nothing], &right));
    let unit = times(&left, &right);
    let signs = (0..size).map(|i| moved[0][i][i].middle() > 0.0);
    let signs: Vec<bool> = signs.collect();
    let signed = |rows: &Rows| -> Rows {
        let of = |(row, sign): (&Vec<Interval>, &bool)| match sign {
            true => row.clone(),
            false => row.iter().map(|x| -*x).collect(),
        };
        rows.iter().zip(&signs).map(of).collect()
    };
    let adjoint = |[re, im]: &[Rows; 2]| {
        let entry = |rows: &Rows, i: usize, j: usize| rows[j][i];
        let of = |rows: &Rows| -> Rows {
            let row = |i| (0..size).map(|j| entry(rows, i, j)).collect();
            (0..size).map(row).collect()
        };
        [of(re), negative(&of(im))]
    };
    let form = times(&adjoint(&unit), &moved.each_ref().map(signed));
    let back = adjoint(&form);
    let [re, im] = [0, 1].map(|which: usize| sum(&form[which], &back[which]));
    let dominates = |i: usize| {
        let others = (0..size).filter(|j| *j != i);
        let off = others.fold(Interval::ZERO, |off, j| {
            let [re, im] = [re[i][j], im[i][j]].map(|x| Interval::point(x.magnitude()).square());
            off + (re + im).sqrt()
        });
        (re[i][i] - Interval::point(off.high)).is_positive()
    };
    let growing = signs.iter().filter(|sign| **sign).count();
    (0..size).all(dominates).then_some(growing)
}

/// How many eigenvalues of every matrix within intervals have a positive real part, where none has the real part zero; `None` where
/// that is not proven.
fn growing(matrix: &Rows) -> Option<usize> {
    let size = matrix.len();
    if size == 0 {
        return Some(0);
    }
    let middle = Complexes::from_fn(size, size, |i, j| Complex::new(matrix[i][j].middle(), 0.0));
    multipliers::bases(&middle).find_map(|basis| counted(matrix, &basis))
}

impl EquilibriumSystem<'_> {
    /// How many eigenvalues grow at a point, beside those that are critical there.
    pub fn growing(&self, x: &[Interval]) -> Option<usize> {
        let states = self.states();
        let critical = match self.condition {
            EquilibriumCondition::Value(_) | EquilibriumCondition::Boundary { .. } => 0,
            EquilibriumCondition::Fold => 1,
            EquilibriumCondition::Hopf { .. } => 2,
        };
        let vectors = (0..critical).map(|which| self.vector(x, which)[..states].to_vec());
        let vectors: Rows = vectors.collect();
        let (matrix, normals) = self.motion(x)?;
        let (matrix, vectors) = within(matrix, normals, vectors)?;
        growing(&modulo(matrix, vectors)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Matrices with known eigenvalues, blurred; one that may have an eigenvalue on the axis is not counted.
    #[test]
    fn eigenvalues_right_of_the_axis_are_counted() {
        let rows = |rows: &[&[f64]], blur: f64| -> Rows {
            let row = |row: &&[f64]| row.iter().map(|x| Interval::around(*x, blur)).collect();
            rows.iter().map(row).collect()
        };
        let of = |matrix: &[&[f64]], blur: f64| growing(&rows(matrix, blur));
        // 0.1 ± 2i beside −3, turned into one another
        let mixed: &[&[f64]] = &[&[0.1, -2.0, 5.0], &[2.0, 0.1, -7.0], &[0.0, 0.0, -3.0]];
        assert_eq!(of(mixed, 1e-9), Some(2));
        // a Jordan block of −1 of order three, in which states count for a hundred others
        let block: &[&[f64]] = &[&[-1.0, 1e2, 0.0], &[0.0, -1.0, 1e2], &[0.0, 0.0, -1.0]];
        assert_eq!(of(block, 1e-12), Some(0));
        assert_eq!(of(&[&[1e6, 0.0], &[0.0, -1e-6]], 1e-9), Some(1));
        assert_eq!(of(&[&[0.0, -1.0], &[1.0, 0.0]], 0.0), None);
        assert_eq!(of(&[&[1e-3]], 1e-2), None);
        // 0 of (1, 1, 0) and ±i of (0, 0, 1, …): what is left is 4 and −5
        let known: &[&[f64]] = &[&[1.0, -1.0, 0.0], &[-3.0, 3.0, 0.0], &[1.0, -1.0, -5.0]];
        let vector = rows(&[&[1.0, 1.0, 0.0]], 0.0);
        let rest = modulo(rows(known, 0.0), vector);
        assert_eq!(rest.and_then(|rest| growing(&rest)), Some(1));
        // within x + y + z = 0, which this keeps, it is a turn that grows
        let turn: &[&[f64]] = &[&[1.0, 0.0, -1.0], &[-1.0, 1.0, 0.0], &[0.0, -1.0, 1.0]];
        let ones = vec![Interval::ONE; 3];
        let plane = within(rows(turn, 1e-12), vec![ones], Vec::new());
        assert_eq!(plane.and_then(|(plane, _)| growing(&plane)), Some(2));
    }
}
