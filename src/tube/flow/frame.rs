//! The frame of a wave: the numbers of its equations, with their derivatives.

use super::FlowError;
use super::jet::{Jet, MultiDual};
use crate::tube::model::Constants;
use crate::tube::model::FrictionLaw;

/// The numbers of the equations above in a frame that moves with c, or their derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quantities {
    /// m_a = 1 − a/c².
    pub ma: f64,
    /// m_b = 1 − b/c².
    pub mb: f64,
    /// κ = D/c: in contact P = gδ + κV̇.
    pub kappa: f64,
    /// Radial stiffness g of (M).
    pub g: f64,
    /// Tangential stiffness h of (M).
    pub h: f64,
    /// Friction coefficient f of sliding.
    pub friction: f64,
    /// Mismatch δ, in units of R.
    pub mismatch: f64,
    /// Mass-proportional damping α, in units of Ω.
    pub damping: f64,
    /// Stiffness-proportional (material) damping β, in units of 1/Ω.
    pub material: f64,
    /// ã = a/c² = 1 − m_a, without the cancellation.
    pub stress: f64,
    /// b̃ = b/c² = 1 − m_b.
    pub radial_stress: f64,
    /// ε of the regularised friction law; zero for every other.
    pub smoothing: f64,
}

/// [`Quantities`] with their derivatives in ln e and in the continuation parameter.
///
/// The frame is given by its excess speed e = |c|/√a − 1 > 0. Slow waves have c² → a, where c itself
/// no longer resolves m_a; in e nothing cancels:
///
/// ```text
/// m_a = e(2 + e)/(1 + e)²,   m_b = 1 − (b/a)/(1 + e)²,   κ = D/(√a(1 + e)),   c = √a(1 + e),
/// ```
///
/// in the direction in which the wave runs: D is that of the model times the sign of c, which keeps κ
/// smooth where D passes zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The numbers themselves.
    pub at: Quantities,
    /// Their derivatives in ln e (index 0) and in the parameter (index 1).
    pub by: [Quantities; 2],
}

impl Frame {
    /// The frame of a wave of excess speed e; `derivative` is that of the parameters in the
    /// continuation parameter. Fails unless e > 0.
    pub(crate) fn new(
        parameters: &Constants,
        derivative: &Constants,
        excess: f64,
    ) -> Result<Frame, FlowError> {
        let value = &parameters.coefficients;
        let moved = &derivative.coefficients;
        // written so that NaN is refused too
        if !(excess > 0.0 && excess.is_finite()) {
            return Err(FlowError::Subsonic { excess });
        }
        let inverse = 1.0 / (1.0 + excess);
        let square = inverse * inverse;
        let ratio = value.b / value.a;
        let kappa = value.coupling / value.a.sqrt() * inverse;
        Ok(Frame {
            at: Quantities {
                ma: excess * (2.0 + excess) * square,
                mb: 1.0 - ratio * square,
                kappa,
                g: value.g,
                h: value.h,
                friction: parameters.friction,
                mismatch: parameters.mismatch,
                damping: parameters.mass_damping,
                material: parameters.stiffness_damping,
                stress: square,
                radial_stress: ratio * square,
                smoothing: parameters.smoothing,
            },
            by: [
                Quantities {
                    ma: 2.0 * excess * square * inverse,
                    mb: 2.0 * ratio * excess * square * inverse,
                    kappa: -kappa * excess * inverse,
                    stress: -2.0 * excess * square * inverse,
                    radial_stress: -2.0 * ratio * excess * square * inverse,
                    ..Quantities::default()
                },
                Quantities {
                    ma: 0.0,
                    mb: -(moved.b - ratio * moved.a) / value.a * square,
                    kappa: (moved.coupling - 0.5 * value.coupling * moved.a / value.a)
                        / value.a.sqrt()
                        * inverse,
                    g: moved.g,
                    h: moved.h,
                    friction: derivative.friction,
                    mismatch: derivative.mismatch,
                    damping: derivative.mass_damping,
                    material: derivative.stiffness_damping,
                    stress: 0.0,
                    radial_stress: (moved.b - ratio * moved.a) / value.a * square,
                    smoothing: derivative.smoothing,
                },
            ],
        })
    }

    /// A quantity with its derivatives in ln e and in the parameter.
    pub(super) fn number(&self, of: impl Fn(&Quantities) -> f64) -> MultiDual<2> {
        MultiDual {
            value: of(&self.at),
            by: [of(&self.by[0]), of(&self.by[1])],
        }
    }

    /// A quantity as a jet.
    pub(crate) fn quantity(&self, of: impl Fn(&Quantities) -> f64) -> Jet {
        Jet::lifted(self.number(of))
    }

    /// gδ, the pressure of steady sliding.
    pub(crate) fn weight(&self) -> Jet {
        self.quantity(|of| of.g) * self.quantity(|of| of.mismatch)
    }

    /// κ as a jet.
    pub(crate) fn kappa(&self) -> Jet {
        self.quantity(|of| of.kappa)
    }

    /// fgδ/h, the tangential displacement of steady sliding.
    pub fn steady(&self) -> Jet {
        let [f, g] = [self.quantity(|of| of.friction), self.quantity(|of| of.g)];
        f * g * self.quantity(|of| of.mismatch) / self.quantity(|of| of.h)
    }

    /// Y at which Q = rfP in stick, r being the static by the kinetic coefficient:
    /// hY = rfκ + (r − 1)fgδ − α − βh. Without material damping release happens there.
    pub(crate) fn release(&self, law: FrictionLaw) -> Jet {
        let r = law.static_ratio();
        let pressure = self.kappa() * r + self.weight() * (r - 1.0);
        let force = self.quantity(|of| of.friction) * pressure - self.quantity(|of| of.damping);
        force / self.quantity(|of| of.h) - self.material()
    }

    /// β as a jet.
    pub(crate) fn material(&self) -> Jet {
        self.quantity(|of| of.material)
    }

    /// Pressure in contact P = gδ + κW for a jet of W; with material damping of W + βV̈.
    pub(crate) fn pressure(&self, w: Jet) -> Jet {
        self.weight() + self.kappa() * w
    }
}
