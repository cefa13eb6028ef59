//! A wave as its perturbations see it, and the numbers that carry them.

use std::sync::Arc;

use nalgebra::Vector4;

use super::course::ZoneFriction;
use super::{C64, ONE, ZERO};
use crate::tube::model::signature::Regime;

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

/// A complex number v·e^{exponent} with its derivative in λ: exponents of both signs beyond the
/// range of double precision occur for |λ| of 10⁴.
#[derive(Clone, Copy, Debug)]
pub struct ScaledComplex {
    /// The mantissa v.
    pub value: C64,
    /// Derivative in λ, on the same scale.
    pub derivative: C64,
    /// Real exponent of the scale.
    pub exponent: f64,
}

impl ScaledComplex {
    /// 1.
    pub(super) const ONE: ScaledComplex = ScaledComplex {
        value: ONE,
        derivative: ZERO,
        exponent: 0.0,
    };

    /// 0.
    pub(super) const ZERO: ScaledComplex = ScaledComplex {
        value: ZERO,
        derivative: ZERO,
        exponent: f64::NEG_INFINITY,
    };

    /// A number of modulus one with its derivative, on the scale of the number given.
    pub(super) fn normalised(value: C64, derivative: C64) -> ScaledComplex {
        let size = value.norm();
        if !(size > 0.0 && size.is_finite()) {
            return ScaledComplex {
                value,
                derivative,
                exponent: 0.0,
            };
        }
        ScaledComplex {
            value: value / size,
            derivative: derivative / size,
            exponent: size.ln(),
        }
    }

    pub(super) fn times(self, other: ScaledComplex) -> ScaledComplex {
        ScaledComplex {
            value: self.value * other.value,
            derivative: self.derivative * other.value + self.value * other.derivative,
            exponent: self.exponent + other.exponent,
        }
    }

    /// The sum with another number.
    pub(super) fn plus(self, other: ScaledComplex) -> ScaledComplex {
        let exponent = self.exponent.max(other.exponent);
        let [one, two] = [self, other].map(|of| (of.exponent - exponent).exp());
        ScaledComplex {
            value: self.value * one + other.value * two,
            derivative: self.derivative * one + other.derivative * two,
            exponent,
        }
    }

    /// Multiplication by e^{−λT}.
    pub(super) fn delayed(self, lambda: C64, period: f64) -> ScaledComplex {
        let turn = C64::from_polar(1.0, -lambda.im * period);
        ScaledComplex {
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
    pub unit: ScaledComplex,
    /// tr M e^{−λT}, or N e^{−λT}.
    pub trace: ScaledComplex,
    /// det M e^{−2λT}, or 0.
    pub determinant: ScaledComplex,
    /// Of z_j, without stick but with material damping: what the layer at the end of a period owes
    /// to the next one.
    pub layer: Option<ScaledComplex>,
    /// An exponent common to the three.
    pub offset: f64,
}

impl Value {
    /// g and n of waves that stick.
    pub(super) fn of_stick([unit, trace]: [ScaledComplex; 2]) -> Value {
        Value {
            unit,
            trace,
            determinant: ScaledComplex::ZERO,
            layer: None,
            offset: 0.0,
        }
    }

    /// F_j and its derivative, both divided by the same positive number, so that |F_j| stays of
    /// order one wherever λ lies.
    pub fn sector(&self, z: C64) -> (C64, C64) {
        let top = self.top();
        let inverse = z.conj();
        let one = (self.unit.exponent - top).exp();
        let trace = inverse * (self.trace.exponent - top).exp();
        let determinant = inverse * inverse * (self.determinant.exponent - top).exp();
        let (f, by) = (
            self.unit.value * one - self.trace.value * trace + self.determinant.value * determinant,
            self.unit.derivative * one - self.trace.derivative * trace
                + self.determinant.derivative * determinant,
        );
        self.layer.map_or((f, by), |layer| {
            let factor = z * (layer.exponent - top).exp();
            (f + layer.value * factor, by + layer.derivative * factor)
        })
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
        let top = unit.max(self.trace.exponent).max(self.determinant.exponent);
        self.layer.map_or(top, |layer| top.max(layer.exponent))
    }

    /// |t| + |d|, and what layers add, in units of what stands for 1: below 1 there is no zero in any
    /// sector.
    pub(crate) fn size(&self) -> f64 {
        let unit = self.unit;
        let part = |scaled: &ScaledComplex| {
            modulus(scaled.value) * (scaled.exponent - unit.exponent).exp()
        };
        let layer = self.layer.as_ref().map_or(0.0, part);
        (part(&self.trace) + part(&self.determinant) + layer) / modulus(unit.value)
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

    /// |t′| + |d′|, the derivatives being those in λ.
    pub(super) fn slope(&self) -> f64 {
        let part = |scaled: &ScaledComplex| modulus(scaled.derivative) * scaled.exponent.exp();
        part(&self.trace) + part(&self.determinant)
    }
}

/// What a switch does to a perturbation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PerturbationJump {
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
    Landing(LandingJump),
    /// Take-off with material damping, σfb/a.
    Depart(f64),
    /// Landing or touch with material damping.
    Settle(Reaction),
}

/// What a landing or a touch does to a perturbation, in units of u or u′ before it; without friction in
/// the impact only `rate` and `bounce`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LandingJump {
    /// [V̇]/U̇⁻: η := η + eta·u.
    pub(super) eta: f64,
    /// η′ := η′ + rate·u, and a part of each of the following two.
    pub(super) rate: f64,
    /// slope·λu, of the changed speed of the front.
    pub(super) slope: f64,
    /// −share·u′, μ = share.
    pub(super) share: f64,
    /// V̇ comes to 1: η′ := rate·u is all.
    pub(super) arrested: bool,
    /// Ü⁺/U̇⁻: u′ := bounce·u, 0 in contact.
    pub(super) bounce: f64,
}

/// A landing without impact, or a touch: τ = −u′/Ü⁻, see [`super::boundary`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reaction {
    /// V̈⁻/Ü⁻ and V̈⁺/Ü⁻, which count where V̇ comes to 1.
    pub(super) before: f64,
    pub(super) after: f64,
    /// [V⃛ − m_aV̈/(βã) − s(U⃛ − m_bÜ/(βb̃))]/Ü⁻.
    pub(super) bend: f64,
    /// s = σfb/a.
    pub(super) share: f64,
    /// Ü⁺/Ü⁻, 0 in contact.
    pub(super) lift: f64,
    /// The reaction holds V̇ at 1.
    pub(super) arrested: bool,
}

/// One zone with the switch at its end.
#[derive(Clone, Debug)]
pub(super) struct LinearZone {
    pub(super) regime: Regime,
    pub(super) duration: f64,
    pub(super) jump: PerturbationJump,
    /// Under friction that depends on the velocity, how it varies while the zone slides.
    pub(super) course: Option<Arc<ZoneFriction>>,
}

/// The linearised wave: the constants of its perturbation equations, and its zones with their switches. Its
/// eigenvalues are the zeros of F_j(λ), [`Value::sector`] of [`Characteristic::evaluate`].
#[derive(Clone, Debug)]
pub struct Characteristic {
    /// Zones from just after a release, or from the beginning of a contact zone.
    pub(super) zones: Vec<LinearZone>,
    /// Whether there is a stick zone.
    pub(super) stick: bool,
    /// Period T of a material point, in units of 1/Ω: the sum of the durations of all zones.
    pub period: f64,
    /// Mode k: the wavelength is 2π/k, and there are k Bloch sectors.
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
    pub(super) static_friction: f64,
    pub(super) damping: f64,
    /// β.
    pub(super) beta: f64,
    /// Turning of g at λ = 0 that is taken out of it.
    pub(super) turn: f64,
    /// How far the method of a wave without a closed form misses the ends of its zones, in all.
    pub(super) defect: f64,
}

/// Perturbations (u, u′, η, η′) with their derivatives in λ, up to two of them, times e^{exponent}.
#[derive(Clone, Copy, Debug)]
pub(super) struct PerturbationColumns {
    pub(super) columns: [Vector4<C64>; 2],
    pub(super) by: [Vector4<C64>; 2],
    pub(super) exponent: f64,
}

impl PerturbationColumns {
    /// η = 1 and η′ = 1, each by itself.
    pub(super) fn unit() -> PerturbationColumns {
        let unit = |row: usize| Vector4::from_fn(|i, _| if i == row { ONE } else { ZERO });
        PerturbationColumns {
            columns: [unit(2), unit(3)],
            ..PerturbationColumns::single(Vector4::zeros())
        }
    }

    pub(super) fn single(column: Vector4<C64>) -> PerturbationColumns {
        PerturbationColumns {
            columns: [column, Vector4::zeros()],
            by: [Vector4::zeros(); 2],
            exponent: 0.0,
        }
    }

    /// Keeps the mantissas near one.
    pub(super) fn normalise(&mut self, count: usize) {
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
