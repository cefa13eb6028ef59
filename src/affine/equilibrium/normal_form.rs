//! The first Lyapunov coefficient of a Hopf point.
//!
//! With Aq = iωq, Aᵀp = −iωp, ⟨q, q⟩ = ⟨p, q⟩ = 1, B and C the second and third derivatives of the rates in the states
//! (Yu. A. Kuznetsov, Elements of Applied Bifurcation Theory, 5.4):
//!
//! > l₁ = 1/(2ω) Re[⟨p, C(q, q, q̄)⟩ + 2⟨p, B(q, h₁₁)⟩ + ⟨p, B(q̄, h₂₀)⟩], Ah₁₁ = −B(q, q̄), (2iω − A)h₂₀ = B(q, q).
//!
//! In a mode that slides, sticks or is closed A has further eigenvalues zero, those of the directions across the surfaces h = 0,
//! which the motion keeps: h₁₁ is then fixed by ∇h·h₁₁ = −D²h(q, q̄), and h₂₀ satisfies the same condition by itself.

use nalgebra::{Complex, DMatrix, DVector};

use super::field::{Linearised, LocalField, Of};
use super::spectrum::{critical_pair, eigenvalues};
use crate::linalg::{Matrix, Vector, balance, least_vector, solve};

type ComplexVector = DVector<Complex<f64>>;

/// An eigenvalue iω with its vector, in physical units.
pub(super) struct Eigenvector {
    pub value: Complex<f64>,
    pub right: ComplexVector,
}

/// A balanced matrix D⁻¹AD, and D.
struct Balanced {
    matrix: Matrix,
    units: Vector,
}

impl Balanced {
    fn new(matrix: &Matrix) -> Balanced {
        let (units, _) = balance(matrix, 0.0);
        let entry = |i: usize, j: usize| matrix[(i, j)] * units[j] / units[i];
        Balanced {
            matrix: Matrix::from_fn(units.len(), units.len(), entry),
            units,
        }
    }

    /// A vector with (A − λ)q = 0, and one with (Aᵀ − λ̄)p = 0.
    fn vectors(&self, value: Complex<f64>) -> Option<[ComplexVector; 2]> {
        let n = self.units.len();
        let shifted = |transposed: bool, value: Complex<f64>| {
            DMatrix::from_fn(n, n, |i, j| {
                let entry = if transposed {
                    self.matrix[(j, i)]
                } else {
                    self.matrix[(i, j)]
                };
                Complex::from(entry) - if i == j { value } else { Complex::from(0.0) }
            })
        };
        let mut right = least_vector(&shifted(false, value))?;
        let mut left = least_vector(&shifted(true, value.conj()))?;
        for index in 0..n {
            right[index] *= self.units[index];
            left[index] /= self.units[index];
        }
        Some([right, left])
    }

    /// The solution of (λ − A)h = b.
    fn resolvent(&self, value: Complex<f64>, right: &ComplexVector) -> Option<ComplexVector> {
        let n = self.units.len();
        let shifted = DMatrix::from_fn(n, n, |i, j| {
            let own = if i == j { value } else { Complex::from(0.0) };
            own - Complex::from(self.matrix[(i, j)])
        });
        let scaled = DVector::from_fn(n, |i, _| right[i] / self.units[i]);
        let solved = shifted.lu().solve(&scaled)?;
        Some(DVector::from_fn(n, |i, _| solved[i] * self.units[i]))
    }
}

impl Eigenvector {
    /// Of the complex pair of an equilibrium whose sum is next to zero.
    pub fn critical(at: &Linearised) -> Option<Eigenvector> {
        let omega = critical_pair(&eigenvalues(at))?;
        let value = Complex::new(0.0, omega);
        let [right, _] = Balanced::new(&at.slopes()).vectors(value)?;
        Some(Eigenvector { value, right })
    }
}

/// The first Lyapunov coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lyapunov {
    /// Its value; more than rounding tells its sign.
    Known(f64),
    /// Zero to rounding.
    Undecided(f64),
    /// The rates are affine: all cycles around the equilibrium belong to this value of the parameter.
    Vertical,
}

impl Lyapunov {
    /// Its value.
    pub fn value(self) -> f64 {
        match self {
            Lyapunov::Known(value) | Lyapunov::Undecided(value) => value,
            Lyapunov::Vertical => 0.0,
        }
    }
}

/// Second derivatives along complex directions.
struct Curvature<'a> {
    field: LocalField<'a>,
    functions: Vec<Of>,
}

impl Curvature<'_> {
    /// D²F(v, w), by the bilinear form of real and imaginary parts.
    fn of(&self, v: &ComplexVector, w: &ComplexVector) -> ComplexVector {
        let part = |vector: &ComplexVector, of: fn(&Complex<f64>) -> f64| {
            // the parameter stays
            let parts = vector.iter().map(of).chain([0.0]);
            Vector::from_iterator(vector.len() + 1, parts)
        };
        let others = [part(w, |x| x.re), part(w, |x| x.im)];
        let re = self
            .field
            .second(&self.functions, &part(v, |x| x.re), &others);
        let im = self
            .field
            .second(&self.functions, &part(v, |x| x.im), &others);
        DVector::from_fn(self.functions.len(), |row, _| {
            Complex::new(re[(row, 0)] - im[(row, 1)], re[(row, 1)] + im[(row, 0)])
        })
    }
}

/// C(q, q, q̄) = C(a, a, a) + C(a, b, b) + i(C(a, a, b) + C(b, b, b)) for q = a + ib.
fn cubic(field: &LocalField, q: &ComplexVector) -> ComplexVector {
    let part = |of: fn(&Complex<f64>) -> f64| {
        Vector::from_iterator(q.len() + 1, q.iter().map(of).chain([0.0]))
    };
    let (a, b) = (part(|x| x.re), part(|x| x.im));
    let re = field.third([&a, &a, &a]) + field.third([&a, &b, &b]);
    let im = field.third([&a, &a, &b]) + field.third([&b, &b, &b]);
    DVector::from_fn(q.len(), |row, _| Complex::new(re[row], im[row]))
}

/// h₁₁ from B(q, q̄) and, on surfaces, D²h(q, q̄).
fn mean(at: &Linearised, bent: &ComplexVector) -> Option<Vector> {
    let mut matrix = at.slopes();
    let n = matrix.nrows();
    let mut right = Vector::from_fn(n, |row, _| -bent[row].re);
    // the rates of the states that surfaces give follow from the others
    let (units, _) = balance(&matrix, 0.0);
    for (row, form) in at.surfaces(&units).given() {
        let surface = &at.surfaces[form];
        matrix.set_row(row, &surface.by.rows(0, n).transpose());
        right[row] = -bent[n + form].re;
    }
    solve(&matrix, &right)
}

/// The cycles next to a Hopf point, to second order: x + zq + z̄q̄ + h₁₁zz̄ + Re(h₂₀z²).
#[derive(Clone, Debug)]
pub(super) struct NormalForm {
    pub lyapunov: Lyapunov,
    q: ComplexVector,
    p: ComplexVector,
    h11: Vector,
    h20: ComplexVector,
}

/// The vectors of the pair, ⟨q, q⟩ = ⟨p, q⟩ = 1.
fn pair(balanced: &Balanced, omega: f64) -> Option<[ComplexVector; 2]> {
    let [mut q, mut p] = balanced.vectors(Complex::new(0.0, omega))?;
    q.unscale_mut(q.norm());
    // ⟨p, q⟩ = Σ p̄ᵢqᵢ
    let product = p.dotc(&q);
    p /= product.conj();
    Some([q, p])
}

/// The plane of the pair at a Hopf point of this frequency, where nothing more has a value.
pub(super) fn plane_of_pair(at: &Linearised, omega: f64) -> Option<NormalForm> {
    let slopes = at.slopes();
    let n = slopes.nrows();
    let [q, p] = pair(&Balanced::new(&slopes), omega)?;
    Some(NormalForm {
        lyapunov: Lyapunov::Undecided(f64::NAN),
        q,
        p,
        h11: Vector::zeros(n),
        h20: ComplexVector::zeros(n),
    })
}

/// The normal form at a Hopf point of this frequency. `None` where a derivative has no value.
pub(super) fn normal_form(field: LocalField, at: &Linearised, omega: f64) -> Option<NormalForm> {
    /// Roundings of the terms of the coefficient: of each product some tens.
    const ROUNDINGS: f64 = 256.0 * f64::EPSILON;
    let slopes = at.slopes();
    let n = slopes.nrows();
    let value = Complex::new(0.0, omega);
    let balanced = Balanced::new(&slopes);
    let [q, p] = pair(&balanced, omega)?;
    let mut functions: Vec<Of> = (0..n).map(Of::Rate).collect();
    functions.extend((0..at.surfaces.len()).map(Of::Surface));
    let curvature = Curvature { field, functions };
    let conjugate = q.conjugate();
    let h11 = mean(at, &curvature.of(&q, &conjugate))?;
    let bent = curvature.of(&q, &q).rows(0, n).clone_owned();
    let h20 = balanced.resolvent(2.0 * value, &bent)?;
    let rates = |bent: ComplexVector| p.dotc(&bent.rows(0, n).clone_owned());
    let terms = [
        p.dotc(&cubic(&field, &q)),
        2.0 * rates(curvature.of(&q, &h11.map(Complex::from))),
        rates(curvature.of(&conjugate, &h20)),
    ];
    let factor = 0.5 / omega;
    let coefficient = factor * terms.iter().map(|term| term.re).sum::<f64>();
    let size: f64 = terms.iter().map(|term| term.norm()).sum();
    if !coefficient.is_finite() {
        return None;
    }
    let told = coefficient.abs() > ROUNDINGS * n as f64 * size * factor;
    Some(NormalForm {
        lyapunov: match told {
            true => Lyapunov::Known(coefficient),
            false => Lyapunov::Undecided(coefficient),
        },
        q,
        p,
        h11,
        h20,
    })
}

impl NormalForm {
    /// How the real part of the pair changes along a direction of u = (x, p) on the branch: Re⟨p, B(u′, q)⟩.
    pub fn crossing_speed(&self, field: LocalField, along: &Vector) -> f64 {
        let n = self.q.len();
        let functions: Vec<Of> = (0..n).map(Of::Rate).collect();
        let part = |of: fn(&Complex<f64>) -> f64| {
            Vector::from_iterator(n + 1, self.q.iter().map(of).chain([0.0]))
        };
        let parts = [part(|x| x.re), part(|x| x.im)];
        let bent = field.second(&functions, along, &parts);
        let changed = DVector::from_fn(n, |row, _| Complex::new(bent[(row, 0)], bent[(row, 1)]));
        self.p.dotc(&changed).re
    }

    /// The amplitude |z| at which the first state to do so moves by its unit.
    pub fn unit_amplitude(&self, units: &[f64]) -> f64 {
        let moved = self.q.iter().zip(units);
        let largest = moved.fold(0.0, |most: f64, (q, unit)| most.max(2.0 * q.norm() / unit));
        1.0 / largest
    }

    /// The range of every state on a cycle of amplitude |z|, to first order.
    pub fn ranges(&self, amplitude: f64) -> Vec<f64> {
        let ranges = self.q.iter().map(|q| 4.0 * amplitude * q.norm());
        ranges.collect()
    }

    /// What a cycle of amplitude |z| differs from the equilibrium by at phase 0.
    pub fn displacement(&self, amplitude: f64) -> Vector {
        let square = amplitude * amplitude;
        Vector::from_fn(self.q.len(), |i, _| {
            2.0 * amplitude * self.q[i].re + square * (self.h11[i] + self.h20[i].re)
        })
    }
}
