//! What is slow of a stiff mode. Where all that is fast decays, only the first moments of a zone have the short time
//! scale: what follows is the motion of fewer components.
//!
//! With z = (z₁, z₂) and ż = Mz the slow part lies in z₂ = Xz₁, where M₂₁ + M₂₂X = X(M₁₁ + M₁₂X), and f = z₂ − Xz₁ has
//! ḟ = Ff, F = M₂₂ − XM₁₂. With YF = M₁₂ + BY, B = M₁₁ + M₁₂X, the rest is s = z₁ − Yf with ṡ = Bs.

use super::exponential::plain_propagator;
use crate::linalg::{Factors, Matrix, Vector, balance, eigenvalues};

/// Zones of fewer time scales of their mode are left as they are: what is fast takes half of them to vanish.
pub(super) const STIFF: f64 = 64.0;

/// Rates of what is slow and of what is fast differ by this factor at least: pieces get as many times longer, and
/// the equations of X and Y are solved by iterations whose errors fall by it.
pub(super) const GAP: f64 = 16.0;

/// Iterations from half of the digits to all of them, and one to see it.
const ITERATIONS: usize = 14;

/// What the last of them may change.
const SETTLED: f64 = 1e-12;

/// A fast part of so many units of rounding of the slow one, and of what it is the difference of, has vanished.
const VANISHED: f64 = 16.0 * f64::EPSILON;

/// Components of z in two groups: those that describe what is slow, and the rest.
struct Components {
    first: Vec<usize>,
    second: Vec<usize>,
    /// Columns of the flow that the first were found by.
    columns: Vec<usize>,
}

impl Components {
    /// So many that describe what is slow best by a flow after which the fast part has vanished: those that move slowly
    /// themselves are preferred.
    fn of(scaled: &Matrix, flow: &Matrix, norm: f64, slow: usize) -> Option<Components> {
        let size = scaled.nrows();
        let mut rest = flow.clone();
        for (mut row, own) in rest.row_iter_mut().zip(scaled.row_iter()) {
            row /= own.lp_norm(1) / norm + 1e-3;
        }
        let (mut first, mut columns) = (Vec::new(), Vec::new());
        for _ in 0..slow {
            let (row, column) = rest.iamax_full();
            let pivot = rest.row(row) / rest[(row, column)];
            for mut other in rest.row_iter_mut() {
                let factor = other[column];
                other -= &pivot * factor;
            }
            rest.row_mut(row).fill(0.0);
            first.push(row);
            columns.push(column);
        }
        let second: Vec<usize> = (0..size).filter(|row| !first.contains(row)).collect();
        (second.len() == size - slow).then_some(Components {
            first,
            second,
            columns,
        })
    }

    /// X to half of the digits: how the second follow from the first after the flow.
    fn slope(&self, flow: &Matrix) -> Option<Matrix> {
        let inverse = Factors::new(&part(flow, &self.first, &self.columns)).inverse()?;
        Some(part(flow, &self.second, &self.columns) * inverse)
    }
}

/// Some rows and columns of a matrix.
fn part(matrix: &Matrix, rows: &[usize], columns: &[usize]) -> Matrix {
    Matrix::from_fn(rows.len(), columns.len(), |row, column| {
        matrix[(rows[row], columns[column])]
    })
}

fn is_settled(change: f64, of: &Matrix) -> bool {
    change <= SETTLED * (1.0 + of.amax())
}

/// X, by iterations of M₂₁ + M₂₂X = X(M₁₁ + M₁₂X) from a start.
fn slow_manifold([m11, m12, m21, m22]: [&Matrix; 4], start: Matrix) -> Option<Matrix> {
    let mut x = start;
    let mut change = f64::INFINITY;
    for _ in 0..ITERATIONS {
        let residual = m22 * &x + m21 - &x * (m11 + m12 * &x);
        let step = Factors::new(&(m22 - &x * m12)).inverse()? * residual;
        change = step.amax();
        x -= step;
    }
    is_settled(change, &x).then_some(x)
}

/// Y, by iterations of YF = M₁₂ + BY.
fn fast_fibres(m12: &Matrix, slow: &Matrix, fast: &Matrix) -> Option<Matrix> {
    let back = Factors::new(fast).inverse()?;
    let mut y = m12 * &back;
    let mut change = f64::INFINITY;
    for _ in 0..ITERATIONS {
        let next = (m12 + slow * &y) * &back;
        change = (&next - &y).amax();
        y = next;
    }
    is_settled(change, &y).then_some(y)
}

/// A mode in a slow part and a fast one, all of which decays.
#[derive(Clone, Debug)]
pub(super) struct Splitting {
    /// Rates B of the slow part s.
    pub slow: Matrix,
    /// Their norm, balanced.
    pub norm: f64,
    /// z of s alone.
    pub along: Matrix,
    /// Rates F of the fast part f, in coordinates in which its length never grows.
    fast: Matrix,
    /// Norm of F, and the slowest decay.
    rates: (f64, f64),
    /// z of f alone.
    across: Matrix,
    slow_of: Matrix,
    fast_of: Matrix,
}

/// z beside its slow part.
#[derive(Clone, Debug)]
pub(super) struct Vanished {
    /// The slow part.
    pub slow: Vector,
    /// Bound of the length of the fast one, now and later.
    pub left_out: f64,
}

impl Splitting {
    /// Every way to split a matrix with these scales and this norm; none where zones last no longer than `longest`, a
    /// few of its time scales. The longest pieces come first.
    pub fn all(matrix: &Matrix, scales: &Vector, norm: f64, longest: f64) -> Vec<Splitting> {
        let is_finite = matrix.iter().all(|x| x.is_finite());
        if !(is_finite && norm * longest >= STIFF) {
            return Vec::new();
        }
        let entry = |row, column| matrix[(row, column)] * scales[column] / scales[row];
        let scaled = Matrix::from_fn(matrix.nrows(), matrix.ncols(), entry);
        let mut values = eigenvalues(&scaled).unwrap_or_default();
        values.sort_by(|one, other| other.norm().total_cmp(&one.norm()));
        let mut decay = f64::INFINITY;
        let mut all = Vec::new();
        for count in 1..values.len() {
            decay = decay.min(-values[count - 1].re);
            if decay > GAP * values[count].norm() {
                all.extend(Splitting::new(
                    &scaled,
                    scales,
                    (norm, longest),
                    decay,
                    count,
                ));
            }
        }
        all.reverse();
        all
    }

    /// Of so many fast components, the slowest of which decays at this rate.
    fn new(
        scaled: &Matrix,
        scales: &Vector,
        (norm, longest): (f64, f64),
        decay: f64,
        count: usize,
    ) -> Option<Splitting> {
        let size = scaled.nrows();
        // by then what is fast has vanished: e⁻³⁶ is rounding, and what is slow has not grown much
        let flow = plain_propagator(scaled, size, norm, 36.0 / decay);
        let slowest = Components::of(scaled, &flow, norm, size - count)?;
        let Components { first, second, .. } = &slowest;
        let [m11, m12] = [first, second].map(|columns| part(scaled, first, columns));
        let [m21, m22] = [first, second].map(|columns| part(scaled, second, columns));
        let x = slow_manifold([&m11, &m12, &m21, &m22], slowest.slope(&flow)?)?;
        let (slow, fast) = (&m11 + &m12 * &x, &m22 - &x * &m12);
        // the length of f never grows where F + Fᵀ has no positive eigenvalue
        let growth = (&fast + fast.transpose()).symmetric_eigenvalues().max();
        if growth > SETTLED * norm {
            return None;
        }
        let y = fast_fibres(&m12, &slow, &fast)?;
        let (one, other) = (size - count, count);
        let [mut along, mut across] = [one, other].map(|columns| Matrix::zeros(size, columns));
        let (mut slow_of, mut fast_of) = (along.transpose(), across.transpose());
        let identity = |size: usize| Matrix::identity(size, size);
        let blocks = [
            (first, identity(one), &y),
            (second, x.clone(), &(identity(other) + &x * &y)),
        ];
        for (rows, of_slow, of_fast) in blocks {
            for (index, row) in rows.iter().enumerate() {
                along.set_row(*row, &(of_slow.row(index) * scales[*row]));
                across.set_row(*row, &(of_fast.row(index) * scales[*row]));
            }
        }
        let whole = identity(one) + &y * &x;
        let blocks = [(first, whole, -x), (second, -y, identity(other))];
        for (columns, to_slow, to_fast) in blocks {
            for (index, column) in columns.iter().enumerate() {
                slow_of.set_column(*column, &(to_slow.column(index) / scales[*column]));
                fast_of.set_column(*column, &(to_fast.column(index) / scales[*column]));
            }
        }
        let columns = fast.column_iter().map(|column| column.lp_norm(1));
        Some(Splitting {
            norm: balance(&slow, longest.recip()).1,
            rates: (columns.fold(0.0, f64::max), decay),
            slow,
            along,
            fast,
            across,
            slow_of,
            fast_of,
        })
    }

    /// The slow part of z where the fast one has vanished.
    pub fn vanished(&self, z: &Vector) -> Option<Vanished> {
        let (slow, fast) = (&self.slow_of * z, &self.fast_of * z);
        let rounding = VANISHED * ((self.fast_of.abs() * z.abs()).norm() + slow.norm());
        (fast.norm() <= rounding).then(|| Vanished {
            left_out: fast.norm() + rounding,
            slow,
        })
    }

    /// Bound of what a form has of a fast part of length 1.
    pub fn of_fast(&self, form: &Vector) -> f64 {
        self.across.tr_mul(form).norm()
    }

    /// Rounding of exp(Mt) per time, in units: every square of the parts doubles it, and what is fast decays.
    pub fn rounding(&self, time: f64) -> f64 {
        let (norm, decay) = self.rates;
        self.norm + norm * (-decay * time).exp()
    }

    /// exp(Mt).
    pub fn propagator(&self, time: f64) -> Matrix {
        let fast = plain_propagator(&self.fast, self.fast.nrows(), self.rates.0, time);
        let slow = plain_propagator(&self.slow, self.slow.nrows(), self.norm, time);
        &self.along * slow * &self.slow_of + &self.across * fast * &self.fast_of
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of lags: ẋ = y − x, ẏ = b(w − y), ẇ = −cw. What is slow has one component, or two.
    #[test]
    fn both_splittings_have_the_flow_of_a_chain() {
        let (b, c) = (1e3, 1e6);
        let rates = [-1.0, 1.0, 0.0, 0.0, -b, b, 0.0, 0.0, -c];
        let matrix = Matrix::from_row_slice(3, 3, &rates);
        let (scales, norm) = balance(&matrix, 0.0);
        let all = Splitting::all(&matrix, &scales, norm, 1.0);
        let sizes: Vec<usize> = all.iter().map(|way| way.slow.nrows()).collect();
        assert_eq!(sizes, [1, 2]);
        for way in &all {
            for t in [1e-4_f64, 1e-2, 1.0] {
                let of_w = b / (b - c);
                let [fast, middle] = [of_w / (1.0 - c), (1.0 - of_w) / (1.0 - b)];
                let sum = |weights: [f64; 3]| {
                    let terms = weights.iter().zip([1.0, b, c]);
                    terms.map(|(w, rate)| w * (-rate * t).exp()).sum::<f64>()
                };
                let exact = [
                    sum([1.0 - fast - middle, middle, fast]),
                    sum([0.0, 1.0 - of_w, of_w]),
                    sum([0.0, 0.0, 1.0]),
                ];
                let z = way.propagator(t) * Vector::repeat(3, 1.0);
                // every square doubles what rounding has left
                let off = (&z - Vector::from_row_slice(&exact)).amax();
                let allowed = 1e-15 * (1.0 + way.rounding(t) * t);
                assert!(off < allowed, "{t}: {off:e}");
                // by then the rates 1e6, or 1e3 too, have taken e⁻³⁷
                let dead = if way.slow.nrows() == 2 { 1e-4 } else { 1.0 };
                assert_eq!(way.vanished(&z).is_some(), t >= dead);
            }
        }
        // a motion that is not stiff stays as it is, and so does one that grows fast
        assert!(Splitting::all(&matrix, &scales, norm, 1e-5).is_empty());
        assert!(Splitting::all(&-matrix, &scales, norm, 1.0).is_empty());
    }
}
