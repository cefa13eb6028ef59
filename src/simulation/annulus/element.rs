//! Bilinear elements of the elastic tube in plane strain, in polar coordinates.
//!
//! The displacements u (radial) and v (tangential) are bilinear in φ and r over each element, which
//! follows the circles exactly. Strains, energy, and Hooke's law with E = 1:
//!
//! ```text
//! ε_r = ∂u/∂r,   ε_φ = (u + ∂v/∂φ)/r,   γ = (∂u/∂φ − v)/r + ∂v/∂r,
//! W = ½∫ [C(ε_r² + ε_φ²) + 2λ ε_r ε_φ + μγ²] r dr dφ,
//! C = (1−ν)/((1+ν)(1−2ν)),  λ = ν/((1+ν)(1−2ν)),  μ = 1/(2(1+ν)).
//! ```
//!
//! All elements of a circle are alike, so the stiffness of the tube is known from one element of
//! each circle: a node is coupled to its eight neighbours and itself by blocks of 2 × 2 that depend
//! on its radius only. Masses are lumped: a node has the share ∫N r dr dφ.

use crate::tube::model::coefficients::{Geometry, lame};

/// Coupling of a node to its neighbourhood: `[dr][dφ][row][column]`, offsets −1, 0, 1 stored from 0,
/// rows and columns u, v.
pub(crate) type Block = [[[[f64; 2]; 2]; 3]; 3];

/// Stiffness and masses by circle, from the inner one outwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Circles {
    /// Radii r_0 = 1 … r_m = ξ.
    pub radii: Vec<f64>,
    /// Coupling of a node of each circle.
    pub blocks: Vec<Block>,
    /// Lumped mass of a node of each circle, for γ = 1.
    pub masses: Vec<f64>,
}

/// Gauss points on (−1, 1): three integrate the element exactly in φ, and in r to order h⁶.
const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

/// Corner of an element: offsets in φ and r.
const CORNERS: [(usize, usize); 4] = [(0, 0), (1, 0), (0, 1), (1, 1)];

/// The elements of a tube with `across` elements of equal height, each of the angle `width`.
pub(crate) fn circles(geometry: &Geometry, across: usize, width: f64) -> Circles {
    let [c, lambda, mu] = lame(geometry.nu);
    let radii: Vec<f64> = (0..=across)
        .map(|j| 1.0 + (geometry.xi - 1.0) * j as f64 / across as f64)
        .collect();
    let mut blocks = vec![[[[[0.0; 2]; 2]; 3]; 3]; across + 1];
    let mut masses = vec![0.0; across + 1];
    for layer in 0..across {
        let (inner, height) = (radii[layer], radii[layer + 1] - radii[layer]);
        let mut stiffness = [[0.0; 8]; 8];
        for (s, s_weight) in GAUSS {
            for (t, t_weight) in GAUSS {
                let (x, y) = (0.5 * (1.0 + s), 0.5 * (1.0 + t));
                let r = inner + y * height;
                let weight = 0.25 * s_weight * t_weight * width * height * r;
                // strains of each unknown: u and v of every corner
                let mut strain = [[0.0; 8]; 3];
                for (corner, (dphi, dr)) in CORNERS.into_iter().enumerate() {
                    let (along, up) = (
                        if dphi == 1 { x } else { 1.0 - x },
                        if dr == 1 { y } else { 1.0 - y },
                    );
                    let shape = along * up;
                    let in_phi = if dphi == 1 { up } else { -up } / width;
                    let in_r = if dr == 1 { along } else { -along } / height;
                    let (u, v) = (2 * corner, 2 * corner + 1);
                    strain[0][u] = in_r;
                    strain[1][u] = shape / r;
                    strain[1][v] = in_phi / r;
                    strain[2][u] = in_phi / r;
                    strain[2][v] = in_r - shape / r;
                    masses[layer + dr] += shape * weight * if dphi == 0 { 2.0 } else { 0.0 };
                }
                for row in 0..8 {
                    for column in 0..8 {
                        let (p, q) = (
                            [strain[0][row], strain[1][row], strain[2][row]],
                            [strain[0][column], strain[1][column], strain[2][column]],
                        );
                        stiffness[row][column] += weight
                            * (c * (p[0] * q[0] + p[1] * q[1])
                                + lambda * (p[0] * q[1] + p[1] * q[0])
                                + mu * p[2] * q[2]);
                    }
                }
            }
        }
        // a node is each corner of some element of the circle
        for (corner, (dphi, dr)) in CORNERS.into_iter().enumerate() {
            for (other, (other_dphi, other_dr)) in CORNERS.into_iter().enumerate() {
                let block = &mut blocks[layer + dr][1 + other_dr - dr][1 + other_dphi - dphi];
                for (row, line) in block.iter_mut().enumerate() {
                    for (column, entry) in line.iter_mut().enumerate() {
                        *entry += stiffness[2 * corner + row][2 * other + column];
                    }
                }
            }
        }
    }
    Circles {
        radii,
        blocks,
        masses,
    }
}
