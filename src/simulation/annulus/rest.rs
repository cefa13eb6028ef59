//! The tube at rest in steady sliding, the same all round.

use super::element::{Block, Circles};

/// K times displacements that are the same all round, on a node of a circle.
pub(super) fn alike(block: &Block, circle: usize, across: usize, fields: [&[f64]; 2]) -> [f64; 2] {
    let mut force = [0.0; 2];
    for (dr, blocks) in block.iter().enumerate() {
        let Some(other) = (circle + dr).checked_sub(1).filter(|other| *other < across) else {
            continue;
        };
        for pair in blocks {
            for (row, total) in force.iter_mut().enumerate() {
                *total += pair[row][0] * fields[0][other] + pair[row][1] * fields[1][other];
            }
        }
    }
    force
}

/// Displacements of steady sliding by circle: two systems with three diagonals, for u with u = δ
/// inside, then for v with the shear f times the pressure of u. Turning all round alike, u and v do
/// not act on each other.
pub(super) fn steady(circles: &Circles, mismatch: f64, friction: f64) -> (Vec<f64>, Vec<f64>) {
    let across = circles.radii.len() - 1;
    let entry = |circle: usize, dr: usize, field: usize| -> f64 {
        circles.blocks[circle][dr]
            .iter()
            .map(|pair| pair[field][field])
            .sum()
    };
    let mut right = vec![0.0; across];
    let mut u = vec![mismatch];
    if across > 1 {
        right[1] = -entry(1, 0, 0) * mismatch;
        u.extend(tridiagonal(
            1,
            across,
            |circle, dr| entry(circle, dr, 0),
            &right[1..],
        ));
    }
    let zeros = vec![0.0; across];
    let pressure = alike(&circles.blocks[0], 0, across, [&u, &zeros])[0];
    right.fill(0.0);
    right[0] = friction * pressure;
    let v = tridiagonal(0, across, |circle, dr| entry(circle, dr, 1), &right);
    (u, v)
}

/// Solves for the circles `from..to` by elimination; the matrix is positive definite.
fn tridiagonal(
    from: usize,
    to: usize,
    entry: impl Fn(usize, usize) -> f64,
    right: &[f64],
) -> Vec<f64> {
    let mut diagonal: Vec<f64> = (from..to).map(|circle| entry(circle, 1)).collect();
    let mut values = right.to_vec();
    for row in 1..diagonal.len() {
        let factor = entry(from + row, 0) / diagonal[row - 1];
        diagonal[row] -= factor * entry(from + row - 1, 2);
        values[row] -= factor * values[row - 1];
    }
    for row in (0..values.len()).rev() {
        if row + 1 < values.len() {
            values[row] -= entry(from + row, 2) * values[row + 1];
        }
        values[row] /= diagonal[row];
    }
    values
}
