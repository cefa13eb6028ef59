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
//! A Coulomb impact of the sliding direction σ lets V̇ jump by [V̇] = −μU̇⁻, μ = σfm_b/m_a. The front of a
//! perturbed wave moves with c/(1 + λτ), which changes m_a and m_b by −2ãλτ and −2b̃λτ, so that of
//! m_a[V̇] = −σfm_bU̇⁻ there remains in first order, with τ = −u/U̇⁻ as above,
//!
//! ```text
//! η := η − [V̇]τ,   η′ := η′ − [V̈]τ − μ(u′ + Ü⁻τ) − 2λσf(ã − b̃)U̇⁻τ/m_a².
//! ```
//!
//! Where the impact brings V̇ to 1, V̇ = 1 is what remains: η′ := −V̈⁺τ.
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

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::course::ZoneFriction;
pub use super::perturbation::{Characteristic, ScaledComplex, Value};
use super::perturbation::{LinearZone, PerturbationColumns, PerturbationJump, oscillator};
use super::switch::jump;
use super::{C64, ZERO};
use crate::linalg::Vector;
use crate::tube::flow::numeric::series::pieces;
use crate::tube::flow::separation::SeparationFlow;
use crate::tube::flow::{FlowError, Slide, ZoneEnd};
use crate::tube::model::Impact;
use crate::tube::model::signature::{Regime, ZoneEntry};
use crate::tube::wave::{Wave, WaveAt};

/// Why a wave has no characteristic function here.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum NotLinearised {
    /// The flow could not be evaluated.
    #[error("{0}")]
    Flow(#[from] FlowError),
    /// Friction changes too sharply along a zone for a power series.
    #[error(
        "friction changes so sharply near V̇ = 1 that its perturbations cannot be followed along the \
         wave: stability is undecided; take a larger epsilon or velocity"
    )]
    Sharp,
}

/// How friction that depends on the velocity varies along a zone, and how far its method misses the end of
/// the zone, in units of V̇ and of the wave's time.
fn along(
    posed: &WaveAt,
    index: usize,
    end: &ZoneEnd,
    a: f64,
) -> Result<(Option<Arc<ZoneFriction>>, f64), NotLinearised> {
    let WaveAt { wave, flows, .. } = posed;
    let regime = wave.signature.zone(index).regime;
    let Slide {
        entry, duration, ..
    } = posed.slide(index);
    let reached = [end.y.value, end.w.value];
    let missed =
        |[y, w]: [f64; 2]| ((y - reached[0]) / wave.scales.time).abs() + (w - reached[1]).abs();
    if regime == Regime::Stick {
        return Ok((None, 0.0));
    }
    let at = flows.frame.at;
    if regime == Regime::Separation {
        let [u, rate, y, w] = SeparationFlow::new(&flows.frame).state(entry, duration)?;
        let lift = (rate - end.radial_rate.value).abs();
        let height = ((u - at.mismatch) / wave.scales.time).abs();
        return Ok((None, missed([y, w]) + lift + height));
    }
    let sigma = regime.sliding().unwrap_or(1.0);
    let (pieces, found) =
        pieces(&flows.frame, wave.model.law, sigma, entry, duration).ok_or(NotLinearised::Sharp)?;
    let course = ZoneFriction::new(pieces, [a, at.ma, at.h, at.damping]);
    Ok((Some(Arc::new(course)), missed(found)))
}

impl Characteristic {
    /// Linearises a solved wave about the solution at `point`.
    ///
    /// # Errors
    /// A flow cannot be evaluated, or friction changes too sharply along a zone for a power series.
    pub fn new(wave: &Wave, point: &Vector) -> Result<Characteristic, NotLinearised> {
        let law = wave.model.law;
        let model = wave.model_at(point);
        let undamped = model.damping.stiffness == 0.0;
        if wave.material && undamped && wave.signature.has(Regime::Separation) {
            // where β = 0 in a branch of waves with material damping, which land with Coulomb impacts there
            let mut bare = wave.clone().with_material(false);
            bare.model.impact = Impact::Coulomb;
            let (excess, parameter) = (wave.excess_at(point), wave.parameter_at(point));
            let point = bare.pack(&wave.unpack(point), excess, parameter);
            return Characteristic::new(&bare, &point);
        }
        let posed = wave.at(point)?;
        let at = posed.flows.frame.at;
        let count = wave.zones();
        let coefficients = model.constants().coefficients;
        let excess = wave.excess_at(point);
        // a/c² = 1/(1 + e)²
        let a = (1.0 + excess).powi(-2);
        let b = coefficients.b / coefficients.a * a;
        let mut zones = Vec::with_capacity(count);
        let mut defect = 0.0;
        for index in 0..count {
            let end = posed.zone_end(index)?;
            let regime = wave.signature.zone(index).regime;
            let (course, missed) = if law.piecewise_linear() {
                (None, 0.0)
            } else {
                along(&posed, index, &end, a)?
            };
            defect += missed;
            zones.push(LinearZone {
                regime,
                duration: wave.duration_at(point, index),
                jump: jump(&posed, index, &end, [a, b])?,
                course,
            });
        }
        // begin behind a release, or else with a contact zone
        let release =
            (0..count).find(|&index| wave.signature.zone(index).entry == ZoneEntry::Release);
        let contact =
            (0..count).find(|&index| wave.signature.zone(index).regime != Regime::Separation);
        zones.rotate_left(release.or(contact).unwrap_or(0));
        let mut characteristic = Characteristic {
            period: zones.iter().map(|zone| zone.duration).sum(),
            stick: release.is_some(),
            zones,
            mode: wave.mode,
            ma: at.ma,
            mb: at.mb,
            excess,
            a,
            b,
            kappa: at.kappa,
            g: at.g,
            h: at.h,
            friction: at.friction,
            static_friction: law.static_ratio() * at.friction,
            damping: at.damping,
            beta: at.material,
            turn: 0.0,
            defect,
        };
        if characteristic.beta > 0.0 {
            characteristic.turn = characteristic.material_turn();
        }
        Ok(characteristic)
    }

    /// z_j = e^{2πij/k}, the factor of Bloch sector j over a period.
    pub fn multiplier(&self, sector: usize) -> C64 {
        let turn = sector as f64 / f64::from(self.mode);
        C64::from_polar(1.0, std::f64::consts::TAU * turn)
    }

    /// t(λ) and d(λ) with derivatives.
    pub fn evaluate(&self, lambda: C64) -> Value {
        if self.beta > 0.0 {
            return self.evaluate_material(lambda);
        }
        let mut state = PerturbationColumns::unit();
        if self.stick {
            self.release(lambda, &mut state);
            for zone in &self.zones {
                self.cross(zone, lambda, &mut state, 1);
            }
            let trace = ScaledComplex {
                value: state.columns[0][2],
                derivative: state.by[0][2],
                exponent: state.exponent,
            };
            return Value::of_stick([ScaledComplex::ONE, trace.delayed(lambda, self.period)]);
        }
        // from contact to contact, a chain of separation zones being one factor; the determinant
        // factor by factor: as a difference of products it would cancel
        let mut determinant = ScaledComplex::ONE;
        let mut index = 0;
        while index < self.zones.len() {
            let mut part = PerturbationColumns::unit();
            loop {
                self.cross(&self.zones[index], lambda, &mut part, 2);
                index += 1;
                let next = self.zones.get(index);
                let separated = next.is_some_and(|zone| zone.regime == Regime::Separation);
                // what friction damps quickly leaves nothing of such a difference: it has its own factor
                if !separated || self.zones[index - 1].course.is_some() {
                    break;
                }
            }
            let [one, other] = part.columns;
            let [one_by, other_by] = part.by;
            let last = &self.zones[index - 1];
            determinant = determinant.times(match &last.course {
                Some(course) => self.wronskian(course, last, lambda),
                None => ScaledComplex {
                    value: one[2] * other[3] - one[3] * other[2],
                    derivative: one_by[2] * other[3] + one[2] * other_by[3]
                        - one_by[3] * other[2]
                        - one[3] * other_by[2],
                    exponent: 2.0 * part.exponent,
                },
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
        let trace = ScaledComplex {
            value: state.columns[0][2] + state.columns[1][3],
            derivative: state.by[0][2] + state.by[1][3],
            exponent: state.exponent,
        };
        Value {
            unit: ScaledComplex::ONE,
            layer: None,
            offset: 0.0,
            trace: trace.delayed(lambda, self.period),
            determinant: determinant.delayed(lambda, 2.0 * self.period),
        }
    }

    /// The release before the first zone, on η = 1 and η′ = 0.
    pub(super) fn release(&self, lambda: C64, state: &mut PerturbationColumns) {
        if let Some(zone) = self.zones.last()
            && matches!(zone.jump, PerturbationJump::StaticRelease(_))
        {
            self.jump(zone.jump, lambda, state, 1);
        }
    }

    /// Carries `count` perturbations through a zone and the switch at its end.
    pub(super) fn cross(
        &self,
        zone: &LinearZone,
        lambda: C64,
        state: &mut PerturbationColumns,
        count: usize,
    ) {
        self.flow(zone, lambda, zone.duration, state, count);
        self.jump(zone.jump, lambda, state, count);
    }

    /// Carries perturbations through the first `duration` of a zone.
    pub(super) fn flow(
        &self,
        zone: &LinearZone,
        lambda: C64,
        duration: f64,
        state: &mut PerturbationColumns,
        count: usize,
    ) {
        match zone.regime {
            Regime::Stick => {}
            Regime::Slip | Regime::Reverse | Regime::Contact if zone.course.is_some() => {
                if let Some(course) = &zone.course {
                    self.follow(course, lambda, duration, state, count);
                }
            }
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
                self.separated(lambda, duration, state, count);
            }
        }
        state.normalise(count);
    }

    fn jump(
        &self,
        jump: PerturbationJump,
        lambda: C64,
        state: &mut PerturbationColumns,
        count: usize,
    ) {
        if let PerturbationJump::StaticRelease(factor) = jump {
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
        if let PerturbationJump::Landing(landing) = jump {
            for column in 0..count {
                let (at, by) = (&mut state.columns[column], &mut state.by[column]);
                let slope = C64::from(if landing.arrested { 0.0 } else { landing.slope });
                by[3] += slope * at[0];
                for vector in [at, by] {
                    let [u, u_rate, ..] = vector.data.0[0];
                    if landing.arrested {
                        vector[3] = ZERO;
                    } else {
                        vector[3] += slope * lambda * u - u_rate * landing.share;
                    }
                    vector[3] += u * landing.rate;
                    vector[2] += u * landing.eta;
                    vector[1] = u * landing.bounce;
                    vector[0] = ZERO;
                }
            }
            return;
        }
        for column in 0..count {
            for vector in [&mut state.columns[column], &mut state.by[column]] {
                match jump {
                    PerturbationJump::Arrest => vector[3] = ZERO,
                    PerturbationJump::Reversal(ratio) => vector[3] *= ratio,
                    PerturbationJump::TakeOff => {
                        vector[0] = ZERO;
                        vector[1] = ZERO;
                    }
                    // done above, none, or of the boundary-value problem
                    _ => {}
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
}
