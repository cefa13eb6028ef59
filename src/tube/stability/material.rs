//! The eigenfunction problem with material damping β > 0.
//!
//! With ∂/∂φ → −(1/c)(d/ds − λ) on η = e^{λs}ψ(−cs) and V̂ = V + βV̇,
//!
//! ```text
//! slip, reverse:  η″ + αη′ + [h − σfκ(d − λ) − ã(d − λ)²](η + βη′) = 0,   d = d/ds,  ã = a/c²,
//! ```
//!
//! of third order, −βã η‴ + … . V, V̇ and V̈ are continuous, so that a front moves by τ with
//!
//! | switch | condition on the perturbation |
//! |---|---|
//! | arrest, release | η continuous, η′ = 0 (V̈ = 0); η″ = −V⃛τ is free |
//! | reversal | η and η′ continuous, τ = −η′/V̈, η″ := η″ + (V⃛⁺ − V⃛⁻)η′/V̈ |
//!
//! From release to arrest this is a boundary-value problem: η(0) = 1, η′(0) = 0, η′(T) = 0. Let v be the
//! solution with v = v′ = 0, v″ = 1 at release and w that with w = 1, w′ = w″ = 0. Then
//!
//! ```text
//! N(λ) = η(T) = n/g,   g = v′(T),   n = w v′ − w′v,
//! ```
//!
//! a quotient of entire functions: N has poles, and eigenvalues of sector j are the zeros of
//! g − n e^{−λT}/z_j (products over the slip phases where a wave sticks more than once). v is one
//! solution, on its way forward dominated by the growing layer, as it should be; n is the area spanned
//! by two, carried by the compound flow det(Φ)·Φ⁻ᵀ: neither is a difference of large numbers, for any β.
//! (Compound matrices: Ng & Reid, J. Comput. Phys. 30 (1979).) The factor e^{rT} of the layer is taken
//! out of g and n before either is formed. Waves that separate are the subject of [`super::boundary`].

use nalgebra::{Matrix3, RowVector3, Vector3};

use super::boundary::Motion;
use super::perturbation::{
    Characteristic, PerturbationJump, ScaledComplex, Value, modulus, oscillator, square_root,
};
use super::{C64, ONE, ZERO};
use crate::tube::model::signature::Regime;

/// The cubic −βã r³ + m₂r² + m₁r + m₀ of a sliding zone at one λ, split into one exponent and a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    /// Exponent that stands apart from the other two.
    r: C64,
    r_by: C64,
    /// The pair solves r² − 2pr + q = 0.
    p: C64,
    p_by: C64,
    q: C64,
    q_by: C64,
}

/// exp(As) on (η, η′, η″) and its derivative in λ, both times e^{−reference·s}.
#[derive(Clone, Copy, Debug)]
struct MaterialExponential {
    at: Matrix3<C64>,
    by: Matrix3<C64>,
}

/// The three roots of Σ c_j r^j by Cardano's formula: next to the largest of them, to rounding.
fn roots(c: [C64; 4]) -> [C64; 3] {
    let [c0, c1, c2] = [c[0], c[1], c[2]].map(|x| x / c[3]);
    let p = c2 * c2 - c1 * 3.0;
    let q = (c2 * c2 * 2.0 - c1 * 9.0) * c2 + c0 * 27.0;
    let root = square_root(q * q - p * p * p * 4.0);
    // of the two signs the one without cancellation
    let same = (q.conj() * root).re >= 0.0;
    let cube = (if same { q + root } else { q - root }) * 0.5;
    let first = C64::from_polar(modulus(cube).cbrt(), cube.arg() / 3.0);
    let third = C64::new(-0.5, 0.75_f64.sqrt());
    [first, first * third, first * third.conj()].map(|term| {
        let other = if term == ZERO { ZERO } else { p / term };
        -(c2 + term + other) / 3.0
    })
}

/// The root of Σ c_j r^j farthest from the other two, which may even coincide, and whether it is the
/// largest; to some digits at least.
fn isolated(c: [C64; 4]) -> (C64, bool) {
    // with r = −x c₂/c₃ it is x³ − x² + small·x + smaller = 0: the one root near 1 is both
    let unit = -c[2] / c[3];
    let [small, smaller] = [
        c[1] / (c[3] * unit * unit),
        c[0] / (c[3] * unit * unit * unit),
    ];
    if small.norm_sqr() < ALONE * ALONE && smaller.norm_sqr() < ALONE * ALONE {
        let mut x = ONE - small;
        for _ in 0..3 {
            let value = ((x - 1.0) * x + small) * x + smaller;
            x -= value / ((x * 3.0 - 2.0) * x + small);
        }
        return (unit * x, true);
    }
    let found = roots(c);
    let apart = |index: usize| {
        let [x, y, z] = [0, 1, 2].map(|shift| found[(index + shift) % 3]);
        (x - y).norm_sqr().min((x - z).norm_sqr())
    };
    let index = (0..3)
        .max_by(|&one, &other| apart(one).total_cmp(&apart(other)))
        .unwrap_or(0);
    let r = found[index];
    (
        r,
        found.iter().all(|other| other.norm_sqr() <= r.norm_sqr()),
    )
}

/// With coefficients below this the root x of x³ − x² + small·x + smaller lies within 0.05 of 1 and the other
/// two within 0.2 of 0, so that it is farther from them than they are from each other.
const ALONE: f64 = 0.02;

impl Characteristic {
    /// m_a, ã, h and σfκ of a sliding zone; with σ = 0 of separation without u.
    pub(super) fn tangential(&self, sigma: f64) -> [f64; 4] {
        let drive = sigma * self.friction * self.kappa;
        [self.ma, self.a, self.h, drive]
    }

    /// m_b, b̃, g and 0: of separation without η.
    pub(super) fn radial(&self) -> [f64; 4] {
        [self.mb, self.b, self.g, 0.0]
    }

    /// The exponents of a zone with these coefficients.
    pub(super) fn split(&self, lambda: C64, [mass, a, stiffness, drive]: [f64; 4]) -> Split {
        let beta = self.beta;
        let l1 = lambda * (2.0 * a) - drive;
        let l0 = lambda * drive - lambda * lambda * a + stiffness;
        let (l1_by, l0_by) = (C64::from(2.0 * a), -lambda * (2.0 * a) + drive);
        let m2 = l1 * beta + mass;
        let m1 = l1 + l0 * beta + self.damping;
        let (m2_by, m1_by) = (l1_by * beta, l1_by + l0_by * beta);
        let d = beta * a;
        let (mut r, largest) = isolated([l0, m1, m2, C64::from(-d)]);
        let slope = |r: C64| (m2 * 2.0 - r * (3.0 * d)) * r + m1;
        let r_by;
        let (a2, a1, a0, a2_by, a1_by, a0_by);
        if largest {
            // from below, which is stable for the largest root: with ρ = 1/r the quadratic factor is
            // (m₂ + ρa₁)r² + a₁r + m₀, a₁ = m₁ + ρm₀
            let mut rho = r.inv();
            for _ in 0..2 {
                let value = ((l0 * rho + m1) * rho + m2) * rho - d;
                let by = (l0 * rho * 3.0 + m1 * 2.0) * rho + m2;
                rho -= value / by;
            }
            r = rho.inv();
            let by = (l0 * rho * 3.0 + m1 * 2.0) * rho + m2;
            let rho_by = -((l0_by * rho + m1_by) * rho + m2_by) * rho / by;
            r_by = -rho_by * r * r;
            a0 = l0;
            a0_by = l0_by;
            a1 = m1 + rho * l0;
            a1_by = m1_by + rho_by * l0 + rho * l0_by;
            a2 = m2 + rho * a1;
            a2_by = m2_by + rho_by * a1 + rho * a1_by;
        } else {
            for _ in 0..2 {
                let value = ((m2 - r * d) * r + m1) * r + l0;
                r -= value / slope(r);
            }
            r_by = -((m2_by * r + m1_by) * r + l0_by) / slope(r);
            a2 = C64::from(-d);
            a2_by = ZERO;
            a1 = m2 - r * d;
            a1_by = m2_by - r_by * d;
            a0 = m1 + a1 * r;
            a0_by = m1_by + a1_by * r + a1 * r_by;
        }
        let p = -a1 / (a2 * 2.0);
        let q = a0 / a2;
        Split {
            r,
            r_by,
            p,
            p_by: -(a1_by * 0.5 + p * a2_by) / a2,
            q,
            q_by: (a0_by - q * a2_by) / a2,
        }
    }

    /// Σ over the sliding zones of ∂r/∂λ·T at λ = 0: the turning of g that is taken out of it.
    pub(super) fn material_turn(&self) -> f64 {
        if self.is_boundary_problem() {
            return self.boundary_values(ZERO).1[1].re;
        }
        self.zones
            .iter()
            .filter_map(|zone| Some((zone.regime.sliding()?, zone.duration)))
            .map(|(sigma, duration)| self.split(ZERO, self.tangential(sigma)).r_by.re * duration)
            .sum()
    }

    /// g, n e^{−λT} and derivatives.
    pub(super) fn evaluate_material(&self, lambda: C64) -> Value {
        let one = ScaledComplex {
            value: ONE,
            derivative: ZERO,
            exponent: 0.0,
        };
        if self.is_boundary_problem() {
            let (values, common) = self.boundary_values(lambda);
            return self.quotient(lambda, values, common);
        }
        let (mut unit, mut trace) = (one, one);
        // what is common to both: Σ reference·T
        let (mut common, mut common_by) = (ZERO, ZERO);
        let start = || {
            (
                [Vector3::new(ZERO, ZERO, ONE), Vector3::zeros()],
                [RowVector3::new(ZERO, -ONE, ZERO), RowVector3::zeros()],
            )
        };
        let (mut v, mut area) = start();
        for zone in &self.zones {
            let Some(sigma) = zone.regime.sliding() else {
                continue;
            };
            let s = zone.duration;
            let split = self.split(lambda, self.tangential(sigma));
            let (reference, reference_by) = split.reference();
            common += reference * s;
            common_by += reference_by * s;
            let forward = split.flow(s, reference, reference_by);
            v = [forward.at * v[0], forward.at * v[1] + forward.by * v[0]];
            // det Φ·Φ⁻¹ = e^{(r + 2p)s} exp(−As), less e^{reference·s}
            let sum = split.r - reference + split.p * 2.0;
            let sum_by = split.r_by - reference_by + split.p_by * 2.0;
            let back = split.flow(-s, sum, sum_by);
            area = [area[0] * back.at, area[1] * back.at + area[0] * back.by];
            match zone.jump {
                PerturbationJump::Bend(factor) => {
                    for v in &mut v {
                        let moved = v[1] * factor;
                        v[2] += moved;
                    }
                    for area in &mut area {
                        let moved = area[2] * factor;
                        area[1] -= moved;
                    }
                }
                PerturbationJump::Arrest => {
                    unit = unit.times(ScaledComplex::normalised(v[0][1], v[1][1]));
                    trace = trace.times(ScaledComplex::normalised(area[0][2], area[1][2]));
                    (v, area) = start();
                }
                _ => {}
            }
        }
        self.quotient(lambda, Value::of_stick([unit, trace]), [common, common_by])
    }

    /// Whether waves separate, or do not stick: see [`super::boundary`].
    fn is_boundary_problem(&self) -> bool {
        let mut zones = self.zones.iter();
        !self.stick || zones.any(|zone| zone.regime == Regime::Separation)
    }

    /// g and n e^{−λT} from g and n less an exponent, given with its derivative, that is common to
    /// both; without stick likewise what stands in their place.
    pub(super) fn quotient(&self, lambda: C64, values: Value, [common, by]: [C64; 2]) -> Value {
        let (common, by) = (common - lambda * self.turn, by - self.turn);
        let turn = C64::from_polar(1.0, common.im);
        let turned = |scaled: ScaledComplex| ScaledComplex {
            value: scaled.value * turn,
            derivative: (scaled.derivative + scaled.value * by) * turn,
            exponent: scaled.exponent,
        };
        let period = self.period;
        Value {
            unit: turned(values.unit),
            trace: turned(values.trace).delayed(lambda, period),
            determinant: turned(values.determinant).delayed(lambda, 2.0 * period),
            layer: values
                .layer
                .map(|layer| turned(layer).delayed(lambda, -period)),
            offset: common.re,
        }
    }

    /// Sum and largest of the terms of the tangential equation with material damping; σfκ is 0 in separation,
    /// and taken from α is what friction gains with the velocity.
    pub(super) fn material_terms(
        &self,
        lambda: C64,
        [drive, drag]: [f64; 2],
        [u, u_rate, u_bend, eta, rate, second]: Motion,
        third: C64,
    ) -> (C64, f64) {
        let (a, beta) = (self.a, self.beta);
        // (h + σfκλ − ãλ²) + (2ãλ − σfκ)d − ãd² on η + βη′
        let hat = [
            eta + rate * beta,
            rate + second * beta,
            second + third * beta,
        ];
        let terms = [
            second,
            rate * (self.damping - drag),
            hat[0] * (lambda * drive - lambda * lambda * a + self.h),
            hat[1] * (lambda * (2.0 * a) - drive),
            -hat[2] * a,
            ((u + u_rate * beta) * lambda - u_rate - u_bend * beta) * self.kappa,
        ];
        let size = terms
            .iter()
            .fold(0.0_f64, |size, term| size.max(term.norm()));
        (terms.into_iter().sum(), size)
    }
}

impl Split {
    /// The exponent of largest real part, with its derivative.
    fn reference(&self) -> (C64, C64) {
        let root = square_root(self.p * self.p - self.q);
        // ∂r/∂λ of a member of the pair: 2r r′ − 2p′r − 2pr′ + q′ = 0
        let member = |r: C64| {
            let by = (self.p_by * r * 2.0 - self.q_by) / ((r - self.p) * 2.0);
            (r, if by.is_finite() { by } else { self.p_by })
        };
        [
            (self.r, self.r_by),
            member(self.p + root),
            member(self.p - root),
        ]
        .into_iter()
        .max_by(|one, other| one.0.re.total_cmp(&other.0.re))
        .unwrap_or((self.r, self.r_by))
    }

    /// exp(As) e^{shift·|s|}, the shift being −reference for s > 0 and the one given for s < 0.
    fn flow(&self, s: f64, shift: C64, shift_by: C64) -> MaterialExponential {
        let sign = if s > 0.0 { -1.0 } else { 1.0 };
        let (move_by, moved) = (shift_by * (sign * s.abs()), shift * (sign * s.abs()));
        let delta = self.p * self.p - self.q;
        let delta_by = self.p * self.p_by * 2.0 - self.q_by;
        let (slow, slow_by, exponent) =
            oscillator([self.p, self.q, delta], [self.p_by, self.q_by, delta_by], s);
        let factor = {
            let size = exponent + moved.re;
            C64::from_polar(size.exp(), moved.im)
        };
        let m = slow.map(|row| row.map(|x| x * factor));
        let m_by: [[C64; 2]; 2] = std::array::from_fn(|i| {
            std::array::from_fn(|j| (slow_by[i][j] + slow[i][j] * move_by) * factor)
        });
        let (r, r_by) = (self.r, self.r_by);
        let e = (r * s + moved).exp();
        let e_by = e * (r_by * s + move_by);
        let (p, q) = (self.p, self.q);
        let (p_by, q_by) = (self.p_by, self.q_by);
        let apart = r * r - p * r * 2.0 + q;
        let apart_by = r * r_by * 2.0 - (p_by * r + p * r_by) * 2.0 + q_by;
        let inverse = apart.inv();
        // the response to v″ = 1, and its slope
        let response = |e: C64, e_by: C64, row: usize| {
            let value = (e - m[row][0] - r * m[row][1]) * inverse;
            let by = (e_by - m_by[row][0] - r_by * m[row][1] - r * m_by[row][1] - value * apart_by)
                * inverse;
            (value, by)
        };
        let (k0, k0_by) = response(e, e_by, 0);
        let (k1, k1_by) = response(r * e, r_by * e + r * e_by, 1);
        let row = |k: C64, m: [C64; 2]| [m[0] + q * k, m[1] - p * k * 2.0, k];
        let row_by = |k: C64, k_by: C64, m_by: [C64; 2]| {
            [
                m_by[0] + q_by * k + q * k_by,
                m_by[1] - (p_by * k + p * k_by) * 2.0,
                k_by,
            ]
        };
        let (first, second) = (row(k0, m[0]), row(k1, m[1]));
        let (first_by, second_by) = (row_by(k0, k0_by, m_by[0]), row_by(k1, k1_by, m_by[1]));
        let z = [q, -p * 2.0, ONE];
        let z_by = [q_by, -p_by * 2.0, ZERO];
        let at = Matrix3::from_fn(|i, j| match i {
            0 => first[j],
            1 => second[j],
            _ => p * second[j] * 2.0 - q * first[j] + e * z[j],
        });
        let by = Matrix3::from_fn(|i, j| match i {
            0 => first_by[j],
            1 => second_by[j],
            _ => {
                (p_by * second[j] + p * second_by[j]) * 2.0 - q_by * first[j] - q * first_by[j]
                    + e_by * z[j]
                    + e * z_by[j]
            }
        });
        MaterialExponential { at, by }
    }

    pub(super) fn roots(&self) -> [C64; 3] {
        let root = square_root(self.p * self.p - self.q);
        let aligned = self.p.re * root.re + self.p.im * root.im >= 0.0;
        let larger = if aligned {
            self.p + root
        } else {
            self.p - root
        };
        [self.r, larger, self.q / larger]
    }
}
