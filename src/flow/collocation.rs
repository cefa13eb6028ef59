//! A zone by Gauss–Legendre collocation on a mesh that follows the solution.
//!
//! On an interval of length h the solution is a polynomial of degree m that satisfies the equations
//! at the m Gauss points c_i; its slopes there, K_i = F(x₀ + h Σ_j a_ij K_j), are the unknowns. The
//! linear systems are block bidiagonal along the mesh: each interval is condensed to the map from
//! its left to its right end, with the derivatives carried along. At mesh points the error is O(h^{2m})
//! (de Boor and Swartz 1973). The mesh equidistributes |x⁽ᵐ⁾|^{1/m}, which the leading coefficients
//! of the slopes on the mesh before it estimate.

use std::sync::OnceLock;

use super::equations::{Dual, Field};
use super::{FlowError, Jet};
use crate::linalg::{Factors, Matrix, Vector};
use crate::problem::MAX_DEGREE;

/// Gauss points on \[0, 1\] with the integrals of their Lagrange polynomials.
#[derive(Clone, Debug)]
struct Gauss {
    /// a_ij = ∫₀^{c_i} ℓ_j.
    a: Vec<Vec<f64>>,
    /// b_j = ∫₀¹ ℓ_j.
    b: Vec<f64>,
    /// Coefficients of the leading divided difference, Σ_j d_j K_j = K⁽ᵐ⁻¹⁾/(m − 1)!.
    leading: Vec<f64>,
}

impl Gauss {
    fn new(m: usize) -> Gauss {
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
        }
    }

    fn of_degree(m: usize) -> &'static Gauss {
        static TABLES: OnceLock<Vec<Gauss>> = OnceLock::new();
        let tables = TABLES.get_or_init(|| (1..=MAX_DEGREE).map(Gauss::new).collect());
        &tables[m.clamp(1, MAX_DEGREE) - 1]
    }
}

/// A mesh and the degree of the polynomials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mesh {
    /// Number of intervals.
    pub intervals: usize,
    /// Collocation points in an interval.
    pub degree: usize,
    /// How often the mesh is moved, from an equidistant one: a fixed number, so that the end of a
    /// zone remains a smooth function of its beginning.
    pub passes: usize,
}

/// Newton iterations for the slopes of one interval.
const MOST_ITERATIONS: usize = 60;

/// A correction is halved down to this fraction of itself to make the residual fall.
const SHORTEST_CORRECTION: f64 = 1e-3;

/// Last correction of the slopes, relative to the largest: rounding of a small linear system. Where only
/// a mesh is wanted it is that of the second constant, whose square is the error left.
const CORRECTION: f64 = 1e-13;
const MESH_CORRECTION: f64 = 1e-6;

/// The solution on one interval.
struct Interval<const D: usize> {
    /// x at its right end.
    end: [f64; D],
    /// Slopes at the Gauss points.
    slopes: Vec<[f64; D]>,
    /// Of the linear system of the last Newton iteration.
    factors: Factors,
}

/// x at the Gauss points, from the slopes there.
fn stages<const D: usize>(
    gauss: &Gauss,
    from: &[f64; D],
    h: f64,
    slopes: &[[f64; D]],
) -> Vec<[f64; D]> {
    let m = slopes.len();
    (0..m)
        .map(|i| {
            std::array::from_fn(|row| {
                from[row] + h * (0..m).map(|j| gauss.a[i][j] * slopes[j][row]).sum::<f64>()
            })
        })
        .collect()
}

/// Solves one interval of length h from `from`; `enough` is the last correction.
fn interval<const D: usize>(
    frozen: &impl Field<D, Dual<D>>,
    gauss: &Gauss,
    from: &[f64; D],
    h: f64,
    enough: f64,
) -> Result<Interval<D>, &'static str> {
    let m = gauss.b.len();
    // rates at the Gauss points with their derivatives in x, and the residuals of the equations
    let evaluate = |slopes: &[[f64; D]]| -> (Vec<[Dual<D>; D]>, Vector) {
        let rates: Vec<[Dual<D>; D]> = stages(gauss, from, h, slopes)
            .into_iter()
            .map(|at| {
                frozen.rate(&std::array::from_fn(|row| {
                    let mut x = Dual::constant(at[row]);
                    x.by[row] = 1.0;
                    x
                }))
            })
            .collect();
        let right = Vector::from_fn(m * D, |entry, _| {
            rates[entry / D][entry % D].value - slopes[entry / D][entry % D]
        });
        (rates, right)
    };
    let first = frozen
        .rate(&from.map(Dual::constant))
        .map(|rate| rate.value);
    let mut slopes = vec![first; m];
    let (mut rates, mut right) = evaluate(&slopes);
    let mut before = f64::INFINITY;
    for _ in 0..MOST_ITERATIONS {
        let mut matrix = Matrix::identity(m * D, m * D);
        for (i, rate) in rates.iter().enumerate() {
            for row in 0..D {
                for j in 0..m {
                    for column in 0..D {
                        matrix[(i * D + row, j * D + column)] -=
                            h * gauss.a[i][j] * rate[row].by[column];
                    }
                }
            }
        }
        let factors = Factors::new(matrix);
        let mut step = right.clone();
        if !factors.solve(&mut step) {
            return Err("the collocation matrix is singular");
        }
        // the full correction is what convergence is measured by
        let correction = step.amax();
        if !correction.is_finite() {
            return Err("the collocation equations diverge");
        }
        let size = right.norm();
        let mut factor = 1.0;
        let mut trial;
        loop {
            trial = slopes.clone();
            for (i, slope) in trial.iter_mut().enumerate() {
                for (row, value) in slope.iter_mut().enumerate() {
                    *value += factor * step[i * D + row];
                }
            }
            (rates, right) = evaluate(&trial);
            // friction that changes within ε of V̇ = 1 needs damping; at rounding nothing falls
            if right.norm() < size || factor < SHORTEST_CORRECTION {
                break;
            }
            factor *= 0.5;
        }
        let largest = trial
            .iter()
            .flatten()
            .fold(f64::MIN_POSITIVE, |size, value| size.max(value.abs()));
        let rounded = correction >= 0.5 * before && correction <= 1e3 * CORRECTION * largest;
        if factor == 1.0 || !rounded {
            slopes = trial;
        }
        // at rounding, or no longer shrinking next to it
        if correction <= enough * largest || rounded {
            return Ok(Interval {
                end: std::array::from_fn(|row| {
                    from[row] + h * (0..m).map(|j| gauss.b[j] * slopes[j][row]).sum::<f64>()
                }),
                slopes,
                factors,
            });
        }
        before = correction;
    }
    Err("Newton's method on a mesh interval does not converge")
}

/// Carries the derivatives of the start and of the zone's unknowns over a solved interval:
/// K_i′ − h Σ a_ij J_i K_j′ = J_i x₀′ + ∂F/∂(zone).
fn derivatives<const D: usize>(
    field: &impl Field<D, Jet>,
    gauss: &Gauss,
    start: &[Jet; D],
    h: f64,
    solved: &Interval<D>,
) -> Result<[Jet; D], &'static str> {
    let m = gauss.b.len();
    let from = start.map(|jet| jet.value);
    let rates: Vec<[Jet; D]> = stages(gauss, &from, h, &solved.slopes)
        .into_iter()
        .map(|at| {
            field.rate(&std::array::from_fn(|row| Jet {
                value: at[row],
                by: start[row].by,
            }))
        })
        .collect();
    let mut end: [Jet; D] = std::array::from_fn(|row| Jet {
        value: solved.end[row],
        by: start[row].by,
    });
    for index in 0..5 {
        let mut right = Vector::from_fn(m * D, |entry, _| rates[entry / D][entry % D].by[index]);
        if !solved.factors.solve(&mut right) {
            return Err("the collocation matrix is singular");
        }
        for (row, jet) in end.iter_mut().enumerate() {
            let sum: f64 = (0..m).map(|j| gauss.b[j] * right[j * D + row]).sum();
            jet.by[index] += h * sum;
        }
    }
    Ok(end)
}

/// The mesh that equidistributes |x⁽ᵐ⁾|^{1/m}, as the solution on the mesh `points` shows it.
fn adapted<const D: usize>(
    frozen: &impl Field<D, Dual<D>>,
    points: &[f64],
    gauss: &Gauss,
) -> Result<Vec<f64>, &'static str> {
    let count = points.len() - 1;
    let m = gauss.b.len();
    let mut start = [0.0; D];
    let mut derivative: Vec<[f64; D]> = Vec::with_capacity(count);
    let mut largest = [0.0_f64; D];
    for pair in points.windows(2) {
        let h = pair[1] - pair[0];
        let step = interval(frozen, gauss, &start, h, MESH_CORRECTION)?;
        let scale = h.powi(1 - m as i32);
        derivative.push(std::array::from_fn(|row| {
            let sum: f64 = (step.slopes.iter().zip(&gauss.leading))
                .map(|(slope, factor)| factor * slope[row])
                .sum();
            sum.abs() * scale
        }));
        for (largest, value) in largest.iter_mut().zip(&step.end) {
            *largest = largest.max(value.abs());
        }
        start = step.end;
    }
    let density: Vec<f64> = derivative
        .iter()
        .map(|values| {
            let size = values
                .iter()
                .zip(&largest)
                .map(|(value, largest)| value / largest.max(f64::MIN_POSITIVE))
                .fold(0.0, f64::max);
            size.powf(1.0 / m as f64)
        })
        .collect();
    let width = |index: usize| points[index + 1] - points[index];
    let mean: f64 = (0..count).map(|index| density[index] * width(index)).sum();
    // neighbours and a floor smooth the density: the mesh then moves little from wave to wave
    let mass: Vec<f64> = (0..count)
        .map(|index| {
            let left = density[index.saturating_sub(1)];
            let right = density[(index + 1).min(count - 1)];
            let smooth = 0.25 * (left + 2.0 * density[index] + right) + 0.5 * mean;
            (smooth + f64::MIN_POSITIVE) * width(index)
        })
        .collect();
    let total: f64 = mass.iter().sum();
    let mut moved = Vec::with_capacity(count + 1);
    moved.push(0.0);
    let (mut index, mut passed) = (0, 0.0);
    for number in 1..count {
        let wanted = total * number as f64 / count as f64;
        while passed + mass[index] < wanted && index + 1 < count {
            passed += mass[index];
            index += 1;
        }
        moved.push(points[index] + width(index) * (wanted - passed) / mass[index]);
    }
    moved.push(1.0);
    Ok(moved)
}

/// x(1) of dx/dτ = F(x), x(0) = 0, with all derivatives of `field`; `frozen` is the same field
/// without derivatives.
pub fn jets<const D: usize>(
    field: &impl Field<D, Jet>,
    frozen: &impl Field<D, Dual<D>>,
    mesh: Mesh,
    duration: f64,
) -> Result<[Jet; D], FlowError> {
    let solve = || {
        let gauss = Gauss::of_degree(mesh.degree);
        let mut x = [Jet::default(); D];
        for pair in mesh_points(frozen, mesh, gauss)?.windows(2) {
            let h = pair[1] - pair[0];
            let solved = interval(frozen, gauss, &x.map(|jet| jet.value), h, CORRECTION)?;
            x = derivatives(field, gauss, &x, h, &solved)?;
        }
        Ok(x)
    };
    solve().map_err(|reason| FlowError::Integration { duration, reason })
}

fn mesh_points<const D: usize>(
    frozen: &impl Field<D, Dual<D>>,
    mesh: Mesh,
    gauss: &Gauss,
) -> Result<Vec<f64>, &'static str> {
    let count = mesh.intervals.max(1);
    let mut points: Vec<f64> = (0..=count)
        .map(|index| index as f64 / count as f64)
        .collect();
    for _ in 0..mesh.passes {
        points = adapted(frozen, &points, gauss)?;
    }
    Ok(points)
}

/// The solution at the mesh points, with their τ.
pub fn at_mesh_points<const D: usize>(
    frozen: &impl Field<D, Dual<D>>,
    mesh: Mesh,
    duration: f64,
) -> Result<Vec<(f64, [f64; D])>, FlowError> {
    let solve = || {
        let gauss = Gauss::of_degree(mesh.degree);
        let mut x = [0.0; D];
        let mut solution = vec![(0.0, x)];
        for pair in mesh_points(frozen, mesh, gauss)?.windows(2) {
            x = interval(frozen, gauss, &x, pair[1] - pair[0], CORRECTION)?.end;
            solution.push((pair[1], x));
        }
        Ok(solution)
    };
    solve().map_err(|reason| FlowError::Integration { duration, reason })
}

/// x(1) without derivatives.
pub fn values<const D: usize>(
    frozen: &impl Field<D, Dual<D>>,
    mesh: Mesh,
    duration: f64,
) -> Result<[f64; D], FlowError> {
    let solution = at_mesh_points(frozen, mesh, duration)?;
    Ok(solution.last().map_or([0.0; D], |(_, x)| *x))
}
