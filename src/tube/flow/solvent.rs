//! The two growing motions of separation with material damping, as the solvent R of
//! −βB + MR + SR² + HR³ = 0: see [`super::layered`].

use nalgebra::{Matrix4, Vector4};

use super::jet::MultiDual;
use super::material::layer_time;
use super::square::Square;
use super::{Frame, Quantities};

/// Newton iterations for R from its value without coupling, and the steps in which the coupling is
/// put in where one step does not do.
const ITERATIONS: usize = 30;
const COUPLING_STEPS: [u32; 3] = [1, 8, 64];

/// The coefficients −βB, M, S, H.
pub(super) type Polynomial = [Square<2>; 4];

/// The coefficients in a frame.
pub(super) fn polynomial(frame: &Frame) -> Polynomial {
    let of = |of: fn(&Quantities) -> f64| frame.number(of);
    let beta = of(|q| q.material);
    let kappa = of(|q| q.kappa);
    let alpha = of(|q| q.damping);
    let (g, h) = (of(|q| q.g), of(|q| q.h));
    let turned = beta * kappa;
    [
        Square::diagonal(-beta * of(|q| q.radial_stress), -beta * of(|q| q.stress)),
        Square([[of(|q| q.mb), turned], [-turned, of(|q| q.ma)]]),
        Square([[alpha + beta * g, kappa], [-kappa, alpha + beta * h]]),
        Square::diagonal(g, h),
    ]
}

/// The coupling taken down to a part of it.
fn partly_coupled(of: &Polynomial, part: f64) -> [Square<0>; 4] {
    of.map(|square| {
        let mut square = square.map(|entry| MultiDual::constant(entry.value));
        square.0[0][1].value *= part;
        square.0[1][0].value *= part;
        square
    })
}

/// X with MX + S(RX + XR) + H(XR² + RXR + R²X) = right: what Newton's method and derivatives solve.
fn linearised([_, m, s, h]: &[Square<0>; 4], r: Square<0>, right: Square<0>) -> Option<Square<0>> {
    let square = r * r;
    let mut matrix = Matrix4::zeros();
    for column in 0..4 {
        let mut x = Square::<0>::unit(0.0);
        x.0[column / 2][column % 2].value = 1.0;
        let image = *m * x + *s * (r * x + x * r) + *h * (x * square + r * x * r + square * x);
        for row in 0..4 {
            matrix[(row, column)] = image.0[row / 2][row % 2].value;
        }
    }
    let right = Vector4::from_fn(|row, _| right.0[row / 2][row % 2].value);
    let x = matrix.lu().solve(&right)?;
    let entry = |row: usize| MultiDual::constant(x[row]);
    Some(Square([[entry(0), entry(1)], [entry(2), entry(3)]]))
}

/// R; `None` if Newton's method does not find a matrix whose exponents grow.
pub(super) fn solvent(of: &Polynomial) -> Option<Square<2>> {
    let value =
        |[first, m, s, h]: &[Square<0>; 4], r: Square<0>| *first + (*m + (*s + *h * r) * r) * r;
    let [first, m, s, h] = of;
    let bare = |i: usize| {
        let entry = |of: &Square<2>| of.0[i][i].value;
        Some(MultiDual::constant(layer_time(
            -entry(first),
            entry(m),
            entry(s),
            entry(h),
        )?))
    };
    let uncoupled = Square::<0>::diagonal(bare(0)?, bare(1)?);
    let found = COUPLING_STEPS.into_iter().find_map(|steps| {
        let mut r = uncoupled;
        for step in 1..=steps {
            let partly = partly_coupled(of, f64::from(step) / f64::from(steps));
            let mut last = f64::INFINITY;
            for _ in 0..ITERATIONS {
                let correction = linearised(&partly, r, value(&partly, r))?;
                r = r - correction;
                let moved = correction.norm() / r.norm();
                // quadratic until rounding stops it
                if correction.norm() == 0.0 || moved < 1e-8 && moved >= 0.5 * last {
                    break;
                }
                last = moved;
            }
            if last.is_nan() || last > 1e-8 && last.is_finite() {
                return None;
            }
        }
        let [[a, b], [c, d]] = r.0.map(|row| row.map(|entry| entry.value));
        // β < 0, where a step may end that passes β = 0: R goes on smoothly, with its sign
        let forwards = if first.0[0][0].value > 0.0 { -1.0 } else { 1.0 };
        let grow = forwards * (a + d) > 0.0 && a * d - b * c > 0.0;
        (grow || first.norm() == 0.0).then_some(r)
    })?;
    let full = partly_coupled(of, 1.0);
    // the derivatives: those of the coefficients at R held fixed
    let mut r = found.map(|entry| MultiDual::<2>::constant(entry.value));
    let fixed = *first + (*m + (*s + *h * r) * r) * r;
    for index in 0..2 {
        let moved = linearised(
            &full,
            found,
            fixed.map(|entry| MultiDual::constant(-entry.by[index])),
        )?;
        for i in 0..2 {
            for j in 0..2 {
                r.0[i][j].by[index] = moved.0[i][j].value;
            }
        }
    }
    Some(r)
}
