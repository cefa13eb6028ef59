//! The eigenfunction problem of a wave as a characteristic function of λ.
//!
//! V → V(θ) + e^{λt}ψ(θ). With η(s) = e^{λs}ψ(−cs), so that ∂/∂φ = −(1/c)(d/ds − λ) on η, the
//! equations along a material point are
//!
//! ```text
//! slip, reverse:  m_a η″ + (2ãλ − σfκ + α)η′ + (h − ãλ² + σfκλ)η = 0,      ã = a/c²
//! stick:          η′ = 0
//! separation:     m_b u″ + (2b̃λ + α)u′ + (g − b̃λ²)u + κ(η′ − λη) = 0,      b̃ = b/c²
//!                 m_a η″ + (2ãλ + α)η′ + (h − ãλ²)η − κ(u′ − λu) = 0
//! ```
//!
//! the first of which is (12) of Nguyen et al. (2008), time-forward (there −2λψ′ should read
//! −2cλψ′). A switch moves by τ in time when the state before it is perturbed:
//!
//! | switch | jump |
//! |---|---|
//! | arrest | η continuous, η′ := 0 |
//! | release | none; from static friction r·f > f: η′ := V̈⁺(h + rfκλ − ãλ²)η/h |
//! | reversal | η continuous, η′ := η′·V̈⁺/V̈⁻ |
//! | take-off | u = u′ = 0, η and η′ continuous |
//! | landing | τ = −u/U̇⁻; u, u′ dropped; η continuous, η′ := η′ − (V̈⁺ − V̈⁻)τ |
//! | touch | τ = −u/U̇⁻; u := 0, u′ := −Ü⁺τ, η continuous, η′ := η′ − (V̈⁺ − V̈⁻)τ |
//!
//! A stick zone forgets everything but η: with N(λ) = η at the beginning of stick for η = 1, η′ = 0
//! at release, the spectrum in Bloch sector j is N(λ)e^{−λT} = e^{2πij/k}. Without one the transfer
//! M(λ) over a period is 2 × 2 and the condition is det(M e^{−λT} − e^{2πij/k}) = 0. Both are
//!
//! ```text
//! F_j(λ) = 1 − t(λ)/z_j + d(λ)/z_j² = 0,   t = tr M e^{−λT},  d = det M e^{−2λT},  z_j = e^{2πij/k},
//! ```
//!
//! with d = 0 where there is stick. F_j tends to 1 as Re λ → ∞.

use nalgebra::{Complex, Vector4};

use super::separation::Separation;
use crate::flow::FlowError;
use crate::linalg::Vector;
use crate::model::Impact;
use crate::model::signature::{Entry, Regime};
use crate::wave::Wave;

pub(super) type C64 = Complex<f64>;

pub(super) const ZERO: C64 = C64::new(0.0, 0.0);
pub(super) const ONE: C64 = C64::new(1.0, 0.0);

/// |z|, for numbers far from the limits of double precision: a library's modulus takes a multiple of
/// the time to serve those.
pub(super) fn modulus(z: C64) -> f64 {
    z.norm_sqr().sqrt()
}

/// √z with Re √z ≥ 0, likewise, without going through the argument.
pub(super) fn square_root(z: C64) -> C64 {
    let large = (0.5 * (modulus(z) + z.re.abs())).sqrt();
    if large == 0.0 {
        return ZERO;
    }
    let small = 0.5 * z.im / large;
    if z.re >= 0.0 {
        C64::new(large, small)
    } else {
        C64::new(small.abs(), large.copysign(z.im))
    }
}

/// Why a wave has no characteristic function here.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotLinearised {
    /// The flow could not be evaluated.
    #[error("{0}")]
    Flow(#[from] FlowError),
    /// Friction that depends on the velocity: the slip zone has no constant coefficients.
    #[error(
        "the eigenfunction problem is posed for friction that does not depend on the velocity: \
         stability is undecided"
    )]
    FrictionLaw,
    /// Landing with a Coulomb impact: the jump depends on the slope of the front, which changes
    /// m_a and m_b; the first-order theory above does not cover it.
    #[error("the perturbation of a Coulomb impact is not known: stability is undecided")]
    CoulombImpact,
    /// Material damping without a stick zone.
    #[error(
        "with material damping the eigenfunction problem is posed for waves that stick: stability is \
         undecided"
    )]
    MaterialDamping,
}

/// A complex number v·e^{exponent} with its derivative in λ: exponents of both signs beyond the
/// range of double precision occur for |λ| of 10⁴.
#[derive(Clone, Copy, Debug)]
pub struct Scaled {
    /// v.
    pub value: C64,
    /// Derivative, on the same scale.
    pub derivative: C64,
    /// Real exponent of the scale.
    pub exponent: f64,
}

impl Scaled {
    pub(super) fn times(self, other: Scaled) -> Scaled {
        Scaled {
            value: self.value * other.value,
            derivative: self.derivative * other.value + self.value * other.derivative,
            exponent: self.exponent + other.exponent,
        }
    }

    /// Multiplication by e^{−λT}.
    pub(super) fn delayed(self, lambda: C64, period: f64) -> Scaled {
        let turn = C64::from_polar(1.0, -lambda.im * period);
        Scaled {
            value: self.value * turn,
            derivative: (self.derivative - self.value * period) * turn,
            exponent: self.exponent - lambda.re * period,
        }
    }

    /// The number itself; infinite or zero beyond the range of double precision.
    pub fn number(self) -> C64 {
        self.value * self.exponent.exp()
    }
}

/// t(λ) and d(λ), and what stands in the place of 1 where they have a common denominator.
#[derive(Clone, Copy, Debug)]
pub struct Value {
    /// 1, or g(λ) with material damping.
    pub unit: Scaled,
    /// tr M e^{−λT}, or N e^{−λT}.
    pub trace: Scaled,
    /// det M e^{−2λT}, or 0.
    pub determinant: Scaled,
    /// An exponent common to the three.
    pub offset: f64,
}

impl Value {
    /// F_j and its derivative, both divided by the same positive number, so that |F_j| stays of
    /// order one wherever λ lies.
    pub fn sector(&self, z: C64) -> (C64, C64) {
        let top = self.top();
        let inverse = z.conj();
        let one = (self.unit.exponent - top).exp();
        let trace = inverse * (self.trace.exponent - top).exp();
        let determinant = inverse * inverse * (self.determinant.exponent - top).exp();
        (
            self.unit.value * one - self.trace.value * trace + self.determinant.value * determinant,
            self.unit.derivative * one - self.trace.derivative * trace
                + self.determinant.derivative * determinant,
        )
    }

    /// t and d in units of what stands for 1.
    pub fn numbers(&self) -> [C64; 2] {
        let unit = self.unit;
        [self.trace, self.determinant]
            .map(|scaled| scaled.value / unit.value * (scaled.exponent - unit.exponent).exp())
    }

    /// The exponent that [`Value::sector`] takes out, besides the offset.
    pub fn top(&self) -> f64 {
        let unit = self.unit.exponent;
        unit.max(self.trace.exponent).max(self.determinant.exponent)
    }

    /// |t| + |d| in units of what stands for 1: below 1 there is no zero in any sector.
    pub fn size(&self) -> f64 {
        let unit = self.unit;
        let part =
            |scaled: &Scaled| modulus(scaled.value) * (scaled.exponent - unit.exponent).exp();
        (part(&self.trace) + part(&self.determinant)) / modulus(unit.value)
    }

    /// |t| + |d|, or (|t′| + |d′|)/τ if that is more, divided by what [`Value::sector`] divides by.
    pub(super) fn scaled_size(&self, delay: f64) -> f64 {
        let top = self.top();
        let (trace, determinant) = (&self.trace, &self.determinant);
        let scales = [trace, determinant].map(|scaled| (scaled.exponent - top).exp());
        let size = modulus(trace.value) * scales[0] + modulus(determinant.value) * scales[1];
        let slope =
            modulus(trace.derivative) * scales[0] + modulus(determinant.derivative) * scales[1];
        size.max(slope / delay)
    }

    /// |t′| + |d′|.
    pub(super) fn slope(&self) -> f64 {
        let part = |scaled: &Scaled| modulus(scaled.derivative) * scaled.exponent.exp();
        part(&self.trace) + part(&self.determinant)
    }
}

/// What a switch does to a perturbation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Jump {
    /// Release, or nothing to do.
    None,
    /// η′ := factor·(h + rfκλ − ãλ²)η: release from static friction.
    StaticRelease(f64),
    /// η′ := 0.
    Arrest,
    /// η′ := ratio·η′.
    Reversal(f64),
    /// η″ := η″ + factor·η′: reversal with material damping.
    Bend(f64),
    /// u := u′ := 0.
    TakeOff,
    /// η′ := η′ + factor·u, then u := u′ := 0.
    Landing(f64),
    /// η′ := η′ + tangential·u, u′ := radial·u, then u := 0.
    Touch { tangential: f64, radial: f64 },
}

/// One zone with the switch at its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinearZone {
    pub(super) regime: Regime,
    pub(super) duration: f64,
    pub(super) jump: Jump,
}

/// The linearised wave.
#[derive(Clone, Debug)]
pub struct Characteristic {
    /// Zones from just after a release, or from the beginning of a contact zone.
    pub(super) zones: Vec<LinearZone>,
    /// Whether there is a stick zone.
    pub(super) stick: bool,
    /// Period T of a material point.
    pub period: f64,
    /// Mode k.
    pub mode: u32,
    /// e = |c|/√a − 1.
    pub(super) excess: f64,
    pub(super) ma: f64,
    pub(super) mb: f64,
    pub(super) a: f64,
    pub(super) b: f64,
    pub(super) kappa: f64,
    pub(super) g: f64,
    pub(super) h: f64,
    pub(super) friction: f64,
    /// Friction coefficient in stick.
    pub(super) static_friction: f64,
    pub(super) damping: f64,
    /// β.
    pub(super) beta: f64,
    /// Turning of g at λ = 0 that is taken out of it.
    pub(super) turn: f64,
}

/// Perturbations (u, u′, η, η′) with their derivatives in λ, up to two of them, times e^{exponent}.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub(super) columns: [Vector4<C64>; 2],
    pub(super) by: [Vector4<C64>; 2],
    pub(super) exponent: f64,
}

impl State {
    /// Keeps the mantissas near one.
    fn normalise(&mut self, count: usize) {
        let size = self.columns[..count]
            .iter()
            .flat_map(|column| column.iter())
            .fold(0.0_f64, |size, x| size.max(x.norm_sqr()));
        if size > 1e100 || size < 1e-100 && size > 0.0 {
            let shift = 0.5 * size.ln();
            let factor = (-shift).exp();
            for column in 0..count {
                self.columns[column] *= C64::from(factor);
                self.by[column] *= C64::from(factor);
            }
            self.exponent += shift;
        }
    }
}

/// Up to this |√Δ s| the power series of C, S and ∂S/∂Δ are used.
const SERIES_LIMIT: f64 = 0.7;
const SERIES_TERMS: usize = 10;

impl Characteristic {
    /// Linearises a solved wave.
    pub fn new(wave: &Wave, point: &Vector) -> Result<Characteristic, NotLinearised> {
        let law = wave.model.law;
        if !law.piecewise_linear() {
            return Err(NotLinearised::FrictionLaw);
        }
        let flows = wave.flows(point)?;
        let at = flows.frame.at;
        let count = wave.zones();
        let weight = flows.frame.weight().value;
        let steady = flows.frame.steady().value;
        let impact = wave.model.impact;
        let mut zones = Vec::with_capacity(count);
        for index in 0..count {
            let zone = wave.signature.zone(index);
            let next = wave.signature.zone(index + 1);
            let end = wave.zone_end(&flows, point, index)?;
            let (y, w, radial) = (end.y.value, end.w.value, end.radial_rate.value);
            let sliding = |regime: Regime| flows.contact(regime).outer_acceleration([y, w]);
            let jump = match next.entry {
                Entry::Release if law.jumps_at_release() => Jump::StaticRelease(
                    flows.contact(Regime::Slip).outer_acceleration([y, 1.0]) / at.h,
                ),
                Entry::Release | Entry::Section => Jump::None,
                Entry::Arrest => Jump::Arrest,
                Entry::TakeOff => Jump::TakeOff,
                Entry::Reversal if at.material > 0.0 => {
                    let (slide, after) =
                        (wave.slide_at(point, index), wave.slide_at(point, index + 1));
                    let leaving = flows.contact(zone.regime);
                    let t = slide.duration;
                    let jerk = flows.contact(next.regime).jerk(&after, 0.0, after.entry)
                        - leaving.jerk(&slide, t, [y, w]);
                    Jump::Bend(jerk / leaving.acceleration(&slide, t, [y, w]))
                }
                Entry::Reversal => Jump::Reversal(sliding(next.regime) / sliding(zone.regime)),
                Entry::Landing | Entry::ArrestedLanding | Entry::Touch
                    if impact == Impact::Coulomb =>
                {
                    return Err(NotLinearised::CoulombImpact);
                }
                Entry::ArrestedLanding => return Err(NotLinearised::CoulombImpact),
                Entry::Landing => {
                    let free = (at.kappa * radial - at.damping * w - at.h * (y + steady)) / at.ma;
                    Jump::Landing((sliding(next.regime) - free) / radial)
                }
                Entry::Touch => Jump::Touch {
                    tangential: -at.kappa / at.ma,
                    radial: -(weight + at.kappa * w) / at.mb / radial,
                },
            };
            zones.push(LinearZone {
                regime: zone.regime,
                duration: wave.duration_at(point, index),
                jump,
            });
        }
        // begin behind a release, or else with a contact zone
        let release = (0..count).find(|&index| wave.signature.zone(index).entry == Entry::Release);
        if at.material > 0.0 && release.is_none() {
            return Err(NotLinearised::MaterialDamping);
        }
        let contact =
            (0..count).find(|&index| wave.signature.zone(index).regime.sliding().is_some());
        zones.rotate_left(release.or(contact).unwrap_or(0));
        let coefficients = wave.model_at(point).constants().coefficients;
        let excess = wave.excess_at(point);
        // a/c² = 1/(1 + e)²
        let a = (1.0 + excess).powi(-2);
        let mut characteristic = Characteristic {
            period: zones.iter().map(|zone| zone.duration).sum(),
            stick: release.is_some(),
            zones,
            mode: wave.mode,
            ma: at.ma,
            mb: at.mb,
            excess,
            a,
            b: coefficients.b / coefficients.a * a,
            kappa: at.kappa,
            g: at.g,
            h: at.h,
            friction: at.friction,
            static_friction: law.static_ratio() * at.friction,
            damping: at.damping,
            beta: at.material,
            turn: 0.0,
        };
        if characteristic.beta > 0.0 {
            characteristic.turn = characteristic.material_turn();
        }
        Ok(characteristic)
    }

    /// z_j = e^{2πij/k}.
    pub fn multiplier(&self, sector: usize) -> C64 {
        let turn = sector as f64 / f64::from(self.mode);
        C64::from_polar(1.0, std::f64::consts::TAU * turn)
    }

    /// t(λ) and d(λ) with derivatives.
    pub fn evaluate(&self, lambda: C64) -> Value {
        if self.beta > 0.0 {
            return self.evaluate_material(lambda);
        }
        let one = Scaled {
            value: ONE,
            derivative: ZERO,
            exponent: 0.0,
        };
        let start = |row: usize| {
            let mut column = Vector4::repeat(ZERO);
            column[row] = ONE;
            column
        };
        let mut state = State {
            columns: [start(2), start(3)],
            by: [Vector4::repeat(ZERO); 2],
            exponent: 0.0,
        };
        let none = Scaled {
            value: ZERO,
            derivative: ZERO,
            exponent: 0.0,
        };
        if self.stick {
            self.release(lambda, &mut state);
            for zone in &self.zones {
                self.cross(zone, lambda, &mut state, 1);
            }
            let trace = Scaled {
                value: state.columns[0][2],
                derivative: state.by[0][2],
                exponent: state.exponent,
            };
            return Value {
                unit: one,
                trace: trace.delayed(lambda, self.period),
                determinant: none,
                offset: 0.0,
            };
        }
        // from contact to contact, a chain of separation zones being one factor; the determinant
        // factor by factor: as a difference of products it would cancel
        let mut determinant = one;
        let mut index = 0;
        while index < self.zones.len() {
            let mut part = State {
                columns: [start(2), start(3)],
                by: [Vector4::repeat(ZERO); 2],
                exponent: 0.0,
            };
            loop {
                self.cross(&self.zones[index], lambda, &mut part, 2);
                index += 1;
                let separated = self
                    .zones
                    .get(index)
                    .is_some_and(|zone| zone.regime == Regime::Separation);
                if index == self.zones.len() || !separated {
                    break;
                }
            }
            let [one, other] = part.columns;
            let [one_by, other_by] = part.by;
            determinant = determinant.times(Scaled {
                value: one[2] * other[3] - one[3] * other[2],
                derivative: one_by[2] * other[3] + one[2] * other_by[3]
                    - one_by[3] * other[2]
                    - one[3] * other_by[2],
                exponent: 2.0 * part.exponent,
            });
            for (column, by) in state.columns.iter_mut().zip(&mut state.by) {
                let (y, w, y_by, w_by) = (column[2], column[3], by[2], by[3]);
                for row in 2..4 {
                    column[row] = one[row] * y + other[row] * w;
                    by[row] =
                        one_by[row] * y + one[row] * y_by + other_by[row] * w + other[row] * w_by;
                }
            }
            state.exponent += part.exponent;
            state.normalise(2);
        }
        let trace = Scaled {
            value: state.columns[0][2] + state.columns[1][3],
            derivative: state.by[0][2] + state.by[1][3],
            exponent: state.exponent,
        };
        Value {
            unit: one,
            offset: 0.0,
            trace: trace.delayed(lambda, self.period),
            determinant: determinant.delayed(lambda, 2.0 * self.period),
        }
    }

    /// The release before the first zone, on η = 1 and η′ = 0.
    pub(super) fn release(&self, lambda: C64, state: &mut State) {
        if let Some(zone) = self.zones.last()
            && matches!(zone.jump, Jump::StaticRelease(_))
        {
            self.jump(zone.jump, lambda, state, 1);
        }
    }

    /// Carries `count` perturbations through a zone and the switch at its end.
    pub(super) fn cross(&self, zone: &LinearZone, lambda: C64, state: &mut State, count: usize) {
        self.flow(zone, lambda, zone.duration, state, count);
        self.jump(zone.jump, lambda, state, count);
    }

    /// Carries perturbations through the first `duration` of a zone.
    pub(super) fn flow(
        &self,
        zone: &LinearZone,
        lambda: C64,
        duration: f64,
        state: &mut State,
        count: usize,
    ) {
        match zone.regime {
            Regime::Stick => {}
            Regime::Slip | Regime::Reverse | Regime::Contact => {
                let sigma = zone.regime.sliding().unwrap_or(1.0);
                let (matrix, by, exponent) = self.contact(lambda, sigma, duration);
                for column in 0..count {
                    let [_, _, y, w] = state.columns[column].data.0[0];
                    let [_, _, y_by, w_by] = state.by[column].data.0[0];
                    for row in 0..2 {
                        let [m0, m1] = matrix[row];
                        let [d0, d1] = by[row];
                        state.columns[column][2 + row] = m0 * y + m1 * w;
                        state.by[column][2 + row] = m0 * y_by + m1 * w_by + d0 * y + d1 * w;
                    }
                }
                state.exponent += exponent;
            }
            Regime::Separation => {
                self.separation().flow(lambda, duration, state, count);
            }
        }
        state.normalise(count);
    }

    fn jump(&self, jump: Jump, lambda: C64, state: &mut State, count: usize) {
        if let Jump::StaticRelease(factor) = jump {
            // the front moves by −(perturbation of Q − rfP)/h, and V̈ jumps at it
            let force = self.static_friction * self.kappa;
            let slope = (self.h + lambda * (force - lambda * self.a)) * factor;
            let slope_by = (force - lambda * (2.0 * self.a)) * factor;
            for column in 0..count {
                let (eta, eta_by) = (state.columns[column][2], state.by[column][2]);
                state.columns[column][3] = slope * eta;
                state.by[column][3] = slope * eta_by + slope_by * eta;
            }
            return;
        }
        for column in 0..count {
            for vector in [&mut state.columns[column], &mut state.by[column]] {
                let u = vector[0];
                match jump {
                    Jump::None | Jump::StaticRelease(_) | Jump::Bend(_) => {}
                    Jump::Arrest => vector[3] = ZERO,
                    Jump::Reversal(ratio) => vector[3] *= ratio,
                    Jump::TakeOff => {
                        vector[0] = ZERO;
                        vector[1] = ZERO;
                    }
                    Jump::Landing(factor) => {
                        vector[3] += u * factor;
                        vector[0] = ZERO;
                        vector[1] = ZERO;
                    }
                    Jump::Touch { tangential, radial } => {
                        vector[3] += u * tangential;
                        vector[1] = u * radial;
                        vector[0] = ZERO;
                    }
                }
            }
        }
    }

    /// exp(As) of a sliding zone with its derivative in λ and the exponent of both.
    fn contact(&self, lambda: C64, sigma: f64, s: f64) -> ([[C64; 2]; 2], [[C64; 2]; 2], f64) {
        let drive = sigma * self.friction * self.kappa;
        let p = -(lambda * (2.0 * self.a) - drive + self.damping) / (2.0 * self.ma);
        let q = (lambda * drive - lambda * lambda * self.a + self.h) / self.ma;
        let p_by = -self.a / self.ma;
        let q_by = (-lambda * (2.0 * self.a) + drive) / self.ma;
        // p² − q by ã + m_a = 1, which takes out what cancels as c² → a
        let force = drive - self.damping;
        let linear = drive - self.a * self.damping;
        let delta = (lambda * (lambda * self.a - linear)
            + (0.25 * force * force - self.ma * self.h))
            / (self.ma * self.ma);
        let delta_by = (lambda * (2.0 * self.a) - linear) / (self.ma * self.ma);
        oscillator([p, q, delta], [C64::from(p_by), q_by, delta_by], s)
    }

    pub(super) fn separation(&self) -> Separation {
        Separation {
            ma: self.ma,
            mb: self.mb,
            a: self.a,
            b: self.b,
            kappa: self.kappa,
            g: self.g,
            h: self.h,
            damping: self.damping,
        }
    }
}

/// exp(As) of ẍ − 2pẋ + qx = 0 with its derivative in λ and the exponent of both, from p, q,
/// Δ = p² − q and their derivatives.
#[allow(clippy::type_complexity)]
pub(super) fn oscillator(
    [p, q, delta]: [C64; 3],
    [p_by, q_by, delta_by]: [C64; 3],
    s: f64,
) -> ([[C64; 2]; 2], [[C64; 2]; 2], f64) {
    let root = square_root(delta);
    let (matrix, sh, slope, exponent);
    if modulus(root) * s.abs() <= SERIES_LIMIT {
        let x = delta * (s * s);
        let (mut even, mut odd, mut third) = (ZERO, ZERO, ZERO);
        for j in (0..SERIES_TERMS).rev() {
            let n = 2.0 * j as f64;
            even = ONE + even * x / ((n + 1.0) * (n + 2.0));
            odd = ONE + odd * x / ((n + 2.0) * (n + 3.0));
            third = ONE + third * x / ((n + 2.0) * (n + 5.0));
        }
        exponent = p.re * s;
        let turn = C64::from_polar(1.0, p.im * s);
        let c = turn * even;
        sh = turn * odd * s;
        slope = turn * third * (s * s * s / 6.0);
        matrix = [[c - p * sh, sh], [-q * sh, c + p * sh]];
    } else {
        // r2 is the root of larger modulus: r1 = q/r2 does not cancel, nor do e^{r1 s} − r1 S and
        // e^{r2 s} + r1 S, as c² → a
        let aligned = p.re * root.re + p.im * root.im >= 0.0;
        let r2 = if aligned { p + root } else { p - root };
        let r1 = q / r2;
        let (e1, e2) = (r1 * s, r2 * s);
        exponent = e1.re.max(e2.re);
        let (x1, x2) = ((e1 - exponent).exp(), (e2 - exponent).exp());
        let c = (x1 + x2) * 0.5;
        sh = (x1 - x2) / (r1 - r2);
        slope = (c * s - sh) / (delta * 2.0);
        matrix = [[x1 - r1 * sh, sh], [-q * sh, x2 + r1 * sh]];
    }
    let c_by = sh * delta_by * (0.5 * s);
    let s_by = slope * delta_by;
    let grow = p_by * s;
    let by = [
        [
            matrix[0][0] * grow + c_by - p * s_by - sh * p_by,
            matrix[0][1] * grow + s_by,
        ],
        [
            matrix[1][0] * grow - q * s_by - q_by * sh,
            matrix[1][1] * grow + c_by + p * s_by + sh * p_by,
        ],
    ];
    (matrix, by, exponent)
}
