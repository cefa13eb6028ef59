//! Gauss–Legendre quadrature on \[0, 1\] for collocation: points c_i, the integrals a_ij = ∫₀^{c_i} ℓ_j and b_j = ∫₀¹ ℓ_j of the
//! Lagrange polynomials, and the leading divided difference.

use std::sync::OnceLock;

use crate::tube::flow::method::MAX_DEGREE;

/// Gauss points on \[0, 1\] with the integrals of their Lagrange polynomials.
#[derive(Clone, Debug)]
pub(super) struct Gauss {
    /// a_ij = ∫₀^{c_i} ℓ_j.
    pub(super) a: Vec<Vec<f64>>,
    /// b_j = ∫₀¹ ℓ_j.
    pub(super) b: Vec<f64>,
    /// Coefficients of the leading divided difference, Σ_j d_j K_j = K⁽ᵐ⁻¹⁾/(m − 1)!.
    pub(super) leading: Vec<f64>,
    pub(super) nodes: Vec<f64>,
    /// Coefficients of ℓ_j in powers of x.
    pub(super) polynomials: Vec<Vec<f64>>,
}

impl Gauss {
    pub(super) fn new(m: usize) -> Gauss {
        // roots of the Legendre polynomial of degree m on [−1, 1] by Newton's method
        let legendre = |x: f64| {
            let (mut before, mut value) = (1.0, x);
            for n in 1..m {
                let n = n as f64;
                (before, value) = (
                    value,
                    ((2.0 * n + 1.0) * x * value - n * before) / (n + 1.0),
                );
            }
            (value, m as f64 * (x * value - before) / (x * x - 1.0))
        };
        let nodes: Vec<f64> = (0..m)
            .map(|index| {
                let turn = (index as f64 + 0.75) / (m as f64 + 0.5);
                let mut x = -(std::f64::consts::PI * turn).cos();
                for _ in 0..8 {
                    let (value, slope) = legendre(x);
                    x -= value / slope;
                }
                0.5 * (1.0 + x)
            })
            .collect();
        // ℓ_j in powers of x, integrated
        let lagrange = |j: usize| {
            let mut coefficients = vec![1.0];
            for (other, node) in nodes.iter().enumerate() {
                if other == j {
                    continue;
                }
                let scale = 1.0 / (nodes[j] - node);
                let mut next = vec![0.0; coefficients.len() + 1];
                for (power, value) in coefficients.iter().enumerate() {
                    next[power + 1] += value * scale;
                    next[power] -= value * node * scale;
                }
                coefficients = next;
            }
            coefficients
        };
        let polynomials: Vec<Vec<f64>> = (0..m).map(lagrange).collect();
        let integral = |j: usize, to: f64| {
            let sum = polynomials[j].iter().enumerate().rev();
            to * sum.fold(0.0, |sum, (power, value)| {
                sum * to + value / (power as f64 + 1.0)
            })
        };
        Gauss {
            a: nodes
                .iter()
                .map(|node| (0..m).map(|j| integral(j, *node)).collect())
                .collect(),
            b: (0..m).map(|j| integral(j, 1.0)).collect(),
            leading: polynomials.iter().map(|values| values[m - 1]).collect(),
            nodes,
            polynomials,
        }
    }

    pub(super) fn of_degree(m: usize) -> &'static Gauss {
        static TABLES: OnceLock<Vec<Gauss>> = OnceLock::new();
        let tables = TABLES.get_or_init(|| (1..=MAX_DEGREE).map(Gauss::new).collect());
        &tables[m.clamp(1, MAX_DEGREE) - 1]
    }
}

/// The same numbers for a degree known to the compiler, which unrolls the loops over Gauss points.
pub(super) struct GaussRule<const M: usize> {
    pub(super) a: [[f64; M]; M],
    /// A².
    pub(super) squared: [[f64; M]; M],
    pub(super) b: [f64; M],
    pub(super) leading: [f64; M],
    pub(super) nodes: [f64; M],
    pub(super) polynomials: [[f64; M]; M],
}

impl<const M: usize> GaussRule<M> {
    pub(super) fn new() -> GaussRule<M> {
        let gauss = Gauss::of_degree(M);
        let row = |from: &[f64]| -> [f64; M] { std::array::from_fn(|index| from[index]) };
        let a: [[f64; M]; M] = std::array::from_fn(|i| row(&gauss.a[i]));
        let squared = |i: usize, j: usize| (0..M).map(|l| a[i][l] * a[l][j]).sum();
        GaussRule {
            squared: std::array::from_fn(|i| std::array::from_fn(|j| squared(i, j))),
            a,
            b: row(&gauss.b),
            leading: row(&gauss.leading),
            nodes: row(&gauss.nodes),
            polynomials: std::array::from_fn(|j| row(&gauss.polynomials[j])),
        }
    }

    /// ℓ_j at x.
    pub(super) fn lagrange(&self, j: usize, x: f64) -> f64 {
        let powers = self.polynomials[j].iter().rev();
        powers.fold(0.0, |sum, power| sum * x + power)
    }
}
