//! A zone by Gauss–Legendre collocation on a mesh that follows the solution.
//!
//! On an interval of length h the solution is a polynomial of degree m that satisfies the equations
//! at the m Gauss points c_i; its slopes there, K_i = F(x₀ + h Σ_j a_ij K_j), are the unknowns. The
//! linear systems are block bidiagonal along the mesh: each interval is condensed to the map from
//! its left to its right end, with the derivatives carried along. At mesh points the error is O(h^{2m})
//! (de Boor and Swartz 1973). The mesh equidistributes |x⁽ᵐ⁾|^{1/m}, which the leading coefficients
//! of the slopes on the mesh before it estimate.
//!
//! The linear system of an interval is (I − hA⊗J)δK = r, J_i being the derivatives of F at Gauss point i. In sliding
//! x₀′ is affine in x₁ alone, J_i = (0 p; q_i r_i), so that δK⁰ = r⁰ + hpAδK¹ leaves half of the unknowns,
//!
//! ```text
//! δK¹_i − h Σ_j (r_i a_ij + hpq_i (A²)_ij) δK¹_j = r¹_i + hq_i Σ_j a_ij r⁰_j.
//! ```

use super::equations::VectorField;
use super::gauss::GaussRule;
use crate::tube::flow::jet::{Jet, MultiDual};
use crate::tube::flow::method::MAX_DEGREE;
use crate::tube::flow::{FlowError, Unsolved};

/// A mesh and the degree of the polynomials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mesh {
    /// Number of mesh intervals in a zone.
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

/// Slopes carried on from the interval before are taken for a first guess where their equations hold to
/// this, relative to the slopes; elsewhere the slope at the left end is.
const CARRIED: f64 = 0.1;

/// LU factors of the linear system of one interval, in storage used again for every other one.
struct Local {
    /// Column by column: L below the diagonal, whose own diagonal is one, U above it, and in its place the
    /// inverse of that of U.
    entries: Vec<f64>,
    pivots: Vec<usize>,
}

/// x − factor·y, in place.
fn subtract(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x -= factor * y);
}

/// Calls a function for a degree with that degree as a constant.
macro_rules! of_degree {
    ($degree:expr, $M:ident => $call:expr) => {
        of_degree!($degree, $M => $call, 1 2 3 4 5 6)
    };
    ($degree:expr, $M:ident => $call:expr, $($known:literal)*) => {
        match $degree.max(1) {
            $($known => {
                const $M: usize = $known;
                $call
            })*
            _ => {
                const $M: usize = MAX_DEGREE;
                $call
            }
        }
    };
}

/// Calls a function for matrices of a size with that size as a constant, so that its loops are unrolled:
/// sizes are D·m, for D = 2 or 4 equations and m ≤ [`MAX_DEGREE`] Gauss points.
macro_rules! of_size {
    ($size:expr, $N:ident => $call:expr, $otherwise:expr) => {
        of_size!($size, $N => $call, $otherwise, 2 4 6 8 10 12 14 16 20 24 28)
    };
    ($size:expr, $N:ident => $call:expr, $otherwise:expr, $($known:literal)*) => {
        match $size {
            $($known => {
                const $N: usize = $known;
                $call
            })*
            _ => $otherwise,
        }
    };
}

impl Local {
    fn new(size: usize) -> Local {
        Local {
            entries: vec![0.0; size * size],
            pivots: vec![0; size],
        }
    }

    /// Factorises in place, with partial pivoting. False when the matrix is singular.
    fn factorise(&mut self) -> bool {
        let n = self.pivots.len();
        let entries = &mut self.entries;
        of_size!(n, N => factorise(entries.as_chunks_mut::<N>().0, &mut self.pivots), false)
    }

    fn solve(&self, right: &mut [f64]) {
        let n = self.pivots.len();
        let entries = &self.entries;
        of_size!(n, N => {
            if let Some(right) = right.first_chunk_mut::<N>() {
                solve(entries.as_chunks::<N>().0, &self.pivots, right);
            }
        }, ())
    }
}

#[inline]
fn factorise<const N: usize>(columns: &mut [[f64; N]], pivots: &mut [usize]) -> bool {
    for k in 0..N {
        let diagonal = &columns[k];
        let larger = |one: usize, other: usize| {
            let larger = diagonal[other].abs() > diagonal[one].abs();
            if larger { other } else { one }
        };
        let pivot = (k + 1..N).fold(k, larger);
        if diagonal[pivot] == 0.0 {
            return false;
        }
        pivots[k] = pivot;
        columns.iter_mut().for_each(|column| column.swap(k, pivot));
        let (known, rest) = columns.split_at_mut(k + 1);
        let column = &mut known[k];
        let inverse = 1.0 / column[k];
        column[k] = inverse;
        column[k + 1..]
            .iter_mut()
            .for_each(|entry| *entry *= inverse);
        // zeros above the diagonal let the whole column be subtracted at once
        let mut below = *column;
        below[..=k].fill(0.0);
        for other in rest {
            let factor = other[k];
            subtract(other, factor, &below);
        }
    }
    true
}

#[inline]
fn solve<const N: usize>(columns: &[[f64; N]], pivots: &[usize], right: &mut [f64; N]) {
    for (row, pivot) in pivots.iter().enumerate() {
        right.swap(row, *pivot);
    }
    for (k, column) in columns.iter().enumerate() {
        let factor = right[k];
        subtract(&mut right[k + 1..], factor, &column[k + 1..]);
    }
    for (k, column) in columns.iter().enumerate().rev() {
        right[k] *= column[k];
        let factor = right[k];
        subtract(&mut right[..k], factor, &column[..k]);
    }
}

/// LU factors of the linear system of a chain, in the slopes of x₁ alone.
struct ChainFactors<const M: usize> {
    columns: [[f64; M]; M],
    pivots: [usize; M],
    /// hq_i.
    coupling: [f64; M],
    /// hp.
    slope: f64,
}

/// The solution on the intervals of a mesh, one after the other.
struct Solver<'a, const D: usize, const M: usize, F> {
    frozen: &'a F,
    rule: &'a GaussRule<M>,
    /// x at the right end of the interval solved last.
    end: [f64; D],
    /// Slopes at its Gauss points.
    slopes: [[f64; D]; M],
    /// Its length; zero before the first.
    length: f64,
    /// Of the linear system of the last Newton iteration, where F is no chain.
    local: Local,
    /// The same where it is one.
    chain: ChainFactors<M>,
    trial: [[f64; D]; M],
    /// Rates at the Gauss points with their derivatives in x, and the residuals of the equations.
    rates: [[MultiDual<D>; D]; M],
    right: [[f64; D]; M],
    step: [[f64; D]; M],
}

fn largest(numbers: &[f64]) -> f64 {
    let numbers = numbers.iter();
    numbers.fold(0.0, |size: f64, number| size.max(number.abs()))
}

fn square(numbers: &[f64]) -> f64 {
    numbers.iter().map(|number| number * number).sum()
}

impl<'a, const D: usize, const M: usize, F: VectorField<D, MultiDual<D>>> Solver<'a, D, M, F> {
    fn new(frozen: &'a F, rule: &'a GaussRule<M>) -> Self {
        Solver {
            frozen,
            rule,
            end: [0.0; D],
            slopes: [[0.0; D]; M],
            length: 0.0,
            local: Local::new(if F::IS_CHAIN { 0 } else { M * D }),
            chain: ChainFactors {
                columns: [[0.0; M]; M],
                pivots: [0; M],
                coupling: [0.0; M],
                slope: 0.0,
            },
            trial: [[0.0; D]; M],
            rates: [[MultiDual::constant(0.0); D]; M],
            right: [[0.0; D]; M],
            step: [[0.0; D]; M],
        }
    }

    /// x at Gauss point `i`, from the slopes at all of them.
    fn stage(&self, from: &[f64; D], h: f64, slopes: &[[f64; D]; M], i: usize) -> [f64; D] {
        std::array::from_fn(|row| {
            let pairs = self.rule.a[i].iter().zip(slopes);
            from[row] + h * pairs.map(|(a, slope)| a * slope[row]).sum::<f64>()
        })
    }

    /// Rates and residuals at the trial slopes.
    fn evaluate(&mut self, from: &[f64; D], h: f64) {
        for i in 0..M {
            let at = self.stage(from, h, &self.trial, i);
            let rate = self.frozen.rate(&std::array::from_fn(|row| {
                let mut x = MultiDual::constant(at[row]);
                x.by[row] = 1.0;
                x
            }));
            let pairs = rate.iter().zip(&self.trial[i]);
            for (right, (rate, trial)) in self.right[i].iter_mut().zip(pairs) {
                *right = rate.value - trial;
            }
            self.rates[i] = rate;
        }
    }

    /// Solves the next interval, of length h; `enough` is the last correction.
    fn interval(&mut self, h: f64, enough: f64) -> Result<(), Unsolved> {
        let from = self.end;
        if !self.carry_on(&from, h) {
            let first = self.frozen.rate(&from.map(MultiDual::constant));
            self.trial.fill(first.map(|rate| rate.value));
            self.evaluate(&from, h);
        }
        self.correct(&from, h, enough)
    }

    /// Takes the polynomial of the interval before, carried on into one of length h, for a guess.
    fn carry_on(&mut self, from: &[f64; D], h: f64) -> bool {
        let rule = self.rule;
        if self.length == 0.0 {
            return false;
        }
        for (trial, node) in self.trial.iter_mut().zip(&rule.nodes) {
            let x = 1.0 + node * h / self.length;
            *trial = [0.0; D];
            for (j, slope) in self.slopes.iter().enumerate() {
                subtract(trial, -rule.lagrange(j, x), slope);
            }
        }
        self.evaluate(from, h);
        square(self.right.as_flattened()) <= CARRIED * CARRIED * square(self.trial.as_flattened())
    }

    /// Factorises I − hA⊗J. False when it is singular.
    fn factorise(&mut self, h: f64) -> bool {
        if F::IS_CHAIN {
            return self.factorise_chain(h);
        }
        let columns = self.local.entries.chunks_exact_mut(M * D);
        for (index, column) in columns.enumerate() {
            let (j, by) = (index / D, index % D);
            let rows = column.chunks_exact_mut(D).zip(&self.rates);
            for ((rows, rates), a) in rows.zip(&self.rule.a) {
                for (entry, rate) in rows.iter_mut().zip(rates) {
                    *entry = -h * a[j] * rate.by[by];
                }
            }
            column[index] += 1.0;
        }
        self.local.factorise()
    }

    /// The same for the slopes of x₁ alone.
    fn factorise_chain(&mut self, h: f64) -> bool {
        let GaussRule { a, squared, .. } = self.rule;
        let chain = &mut self.chain;
        chain.slope = h * self.rates[0][0].by[1];
        for i in 0..M {
            let [first, own] = [0, 1].map(|by| h * self.rates[i][1].by[by]);
            let both = chain.slope * first;
            chain.coupling[i] = first;
            for j in 0..M {
                chain.columns[j][i] = -(own * a[i][j] + both * squared[i][j]);
            }
            chain.columns[i][i] += 1.0;
        }
        factorise(&mut chain.columns, &mut chain.pivots)
    }

    /// Solves the factorised system with `step` on its right side.
    fn solve(&mut self) {
        if !F::IS_CHAIN {
            self.local.solve(self.step.as_flattened_mut());
            return;
        }
        let (a, chain) = (&self.rule.a, &self.chain);
        let mut own: [f64; M] = std::array::from_fn(|i| {
            let pairs = a[i].iter().zip(&self.step);
            let first: f64 = pairs.map(|(a, step)| a * step[0]).sum();
            self.step[i][1] + chain.coupling[i] * first
        });
        solve(&chain.columns, &chain.pivots, &mut own);
        for (i, step) in self.step.iter_mut().enumerate() {
            let pairs = a[i].iter().zip(&own);
            step[0] += chain.slope * pairs.map(|(a, own)| a * own).sum::<f64>();
            step[1] = own[i];
        }
    }

    /// The slopes with a part of the correction.
    fn corrected(&self, factor: f64) -> [[f64; D]; M] {
        std::array::from_fn(|i| {
            std::array::from_fn(|row| self.slopes[i][row] + factor * self.step[i][row])
        })
    }

    /// Newton's method for the slopes, from those tried.
    fn correct(&mut self, from: &[f64; D], h: f64, enough: f64) -> Result<(), Unsolved> {
        self.slopes = self.trial;
        self.length = h;
        let mut before = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            if !self.factorise(h) {
                return Err(Unsolved::Singular);
            }
            self.step = self.right;
            self.solve();
            let step = self.step.as_flattened();
            // the full correction is what convergence is measured by
            let correction = largest(step);
            if !correction.is_finite() || step.iter().any(|step| step.is_nan()) {
                return Err(Unsolved::Diverges);
            }
            self.trial = self.corrected(1.0);
            let size = largest(self.trial.as_flattened()).max(f64::MIN_POSITIVE);
            // at rounding, or no longer shrinking next to it
            let rounded = correction >= 0.5 * before && correction <= 1e3 * CORRECTION * size;
            if correction <= enough * size || rounded {
                self.slopes = self.trial;
                self.end = std::array::from_fn(|row| {
                    let pairs = self.rule.b.iter().zip(&self.slopes);
                    from[row] + h * pairs.map(|(b, slope)| b * slope[row]).sum::<f64>()
                });
                return Ok(());
            }
            let residual = square(self.right.as_flattened());
            let mut factor = 1.0;
            loop {
                self.evaluate(from, h);
                // friction that changes within ε of V̇ = 1 needs damping; at rounding nothing falls
                if square(self.right.as_flattened()) < residual || factor < SHORTEST_CORRECTION {
                    break;
                }
                factor *= 0.5;
                self.trial = self.corrected(factor);
            }
            self.slopes = self.trial;
            before = correction;
        }
        Err(Unsolved::NotConverged)
    }

    /// Carries the derivatives of the start and of the zone's unknowns over the interval solved last:
    /// K_i′ − h Σ a_ij J_i K_j′ = J_i x₀′ + ∂F/∂(zone).
    fn derivatives(&mut self, field: &impl VectorField<D, Jet>, start: &[Jet; D]) -> [Jet; D] {
        let h = self.length;
        let from = start.map(|jet| jet.value);
        let mut end: [Jet; D] = std::array::from_fn(|row| Jet {
            value: self.end[row],
            by: start[row].by,
        });
        let rates: [[Jet; D]; M] = std::array::from_fn(|i| {
            let at = self.stage(&from, h, &self.slopes, i);
            field.rate(&std::array::from_fn(|row| Jet {
                value: at[row],
                by: start[row].by,
            }))
        });
        for index in 0..5 {
            self.step = rates.map(|rates| rates.map(|rate| rate.by[index]));
            self.solve();
            for (row, jet) in end.iter_mut().enumerate() {
                let pairs = self.rule.b.iter().zip(&self.step);
                jet.by[index] += h * pairs.map(|(b, slopes)| b * slopes[row]).sum::<f64>();
            }
        }
        end
    }
}

/// The mesh that equidistributes |x⁽ᵐ⁾|^{1/m}, as the solution on the mesh `points` shows it.
fn adapted<const D: usize, const M: usize>(
    frozen: &impl VectorField<D, MultiDual<D>>,
    points: &[f64],
    rule: &GaussRule<M>,
) -> Result<Vec<f64>, Unsolved> {
    let count = points.len() - 1;
    let mut solver = Solver::new(frozen, rule);
    let mut derivative: Vec<[f64; D]> = Vec::with_capacity(count);
    let mut largest = [0.0_f64; D];
    for pair in points.windows(2) {
        let h = pair[1] - pair[0];
        solver.interval(h, MESH_CORRECTION)?;
        let scale = h.powi(1 - M as i32);
        derivative.push(std::array::from_fn(|row| {
            let sum: f64 = (solver.slopes.iter().zip(&rule.leading))
                .map(|(slope, factor)| factor * slope[row])
                .sum();
            sum.abs() * scale
        }));
        for (largest, value) in largest.iter_mut().zip(&solver.end) {
            *largest = largest.max(value.abs());
        }
    }
    let density: Vec<f64> = derivative
        .iter()
        .map(|values| {
            let size = values
                .iter()
                .zip(&largest)
                .map(|(value, largest)| value / largest.max(f64::MIN_POSITIVE))
                .fold(0.0, f64::max);
            size.powf(1.0 / M as f64)
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
pub(crate) fn jets<const D: usize>(
    field: &impl VectorField<D, Jet>,
    frozen: &impl VectorField<D, MultiDual<D>>,
    mesh: Mesh,
    duration: f64,
) -> Result<[Jet; D], FlowError> {
    of_degree!(mesh.degree, M => jets_of_degree::<D, M>(field, frozen, mesh))
        .map_err(|reason| FlowError::Integration { duration, reason })
}

fn jets_of_degree<const D: usize, const M: usize>(
    field: &impl VectorField<D, Jet>,
    frozen: &impl VectorField<D, MultiDual<D>>,
    mesh: Mesh,
) -> Result<[Jet; D], Unsolved> {
    let rule = GaussRule::<M>::new();
    let mut x = [Jet::default(); D];
    let mut solver = Solver::new(frozen, &rule);
    for pair in mesh_points(frozen, mesh, &rule)?.windows(2) {
        solver.interval(pair[1] - pair[0], CORRECTION)?;
        x = solver.derivatives(field, &x);
    }
    Ok(x)
}

fn mesh_points<const D: usize, const M: usize>(
    frozen: &impl VectorField<D, MultiDual<D>>,
    mesh: Mesh,
    rule: &GaussRule<M>,
) -> Result<Vec<f64>, Unsolved> {
    let count = mesh.intervals.max(1);
    let mut points: Vec<f64> = (0..=count)
        .map(|index| index as f64 / count as f64)
        .collect();
    for _ in 0..mesh.passes {
        points = adapted(frozen, &points, rule)?;
    }
    Ok(points)
}

/// The solution at the mesh points, with their τ.
pub(crate) fn at_mesh_points<const D: usize>(
    frozen: &impl VectorField<D, MultiDual<D>>,
    mesh: Mesh,
    duration: f64,
) -> Result<Vec<(f64, [f64; D])>, FlowError> {
    of_degree!(mesh.degree, M => at_mesh_points_of_degree::<D, M>(frozen, mesh))
        .map_err(|reason| FlowError::Integration { duration, reason })
}

fn at_mesh_points_of_degree<const D: usize, const M: usize>(
    frozen: &impl VectorField<D, MultiDual<D>>,
    mesh: Mesh,
) -> Result<Vec<(f64, [f64; D])>, Unsolved> {
    let rule = GaussRule::<M>::new();
    let mut solver = Solver::new(frozen, &rule);
    let mut solution = vec![(0.0, solver.end)];
    for pair in mesh_points(frozen, mesh, &rule)?.windows(2) {
        solver.interval(pair[1] - pair[0], CORRECTION)?;
        solution.push((pair[1], solver.end));
    }
    Ok(solution)
}

/// x(1) without derivatives.
pub(crate) fn values<const D: usize>(
    frozen: &impl VectorField<D, MultiDual<D>>,
    mesh: Mesh,
    duration: f64,
) -> Result<[f64; D], FlowError> {
    let solution = at_mesh_points(frozen, mesh, duration)?;
    Ok(solution.last().map_or([0.0; D], |(_, x)| *x))
}
