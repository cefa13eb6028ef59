//! Perturbations of sliding under friction that depends on the velocity.
//!
//! Q = fS(V̇)P makes the equation of a perturbation one with coefficients along the wave,
//!
//! ```text
//! m_a η″ + (2ãλ + α − F − E)η′ + (h − ãλ² + Fλ)η = 0,   F = fκS,   E = f·dS/dV̇·P.
//! ```
//!
//! With 2m_a p = F + E − α − 2ãλ and η = e^{∫p}z, z moves by
//!
//! ```text
//! z″ = Δz,   m_a²Δ = ãλ² + λ(ãα − F − ãE) + (α − F − E)²/4 − m_a h − ½m_a(F + E)′,
//! ```
//!
//! where ã + m_a = 1 has taken out what would cancel. Δ is a power series in time on every piece of the wave, and
//! so is z, over steps in which it turns by no more than [`RADIANS`]. Derivatives in λ are carried along.
//! Where many values of λ are needed, [`super::propagator`] expands this in λ instead.
//!
//! For |λ| → ∞ the exponents of a zone are those of its mean F and E: [`super::asymptotic`].

use super::course::ZoneFriction;
use super::perturbation::{
    Characteristic, LinearZone, PerturbationColumns, PerturbationJump, ScaledComplex,
};
use super::segment::{ORDER, Pair, RADIANS, SeriesSegment, part, scaled_down};
use super::{C64, ZERO};
use crate::tube::flow::numeric::series::TERMS;

/// Most steps of one piece: at frequencies that need more nothing is searched, and no number is given.
const MOST_STEPS: f64 = 1e4;

/// Terms of Δs² below this do not count.
const NOTHING: f64 = 1e-18;

/// Δs² and its derivative in λ as series over a step of length s.
struct SlidingStep {
    at: [C64; TERMS],
    by: [C64; TERMS],
    terms: usize,
    length: f64,
}

impl SlidingStep {
    fn carry(&self, [[z, rate], [z_by, rate_by]]: Pair) -> Pair {
        let (mut value, mut by) = ([ZERO; ORDER], [ZERO; ORDER]);
        (value[0], value[1]) = (z, rate * self.length);
        (by[0], by[1]) = (z_by, rate_by * self.length);
        for n in 0..ORDER - 2 {
            let (mut sum, mut sum_by) = (ZERO, ZERO);
            for j in 0..=n.min(self.terms - 1) {
                sum += self.at[j] * value[n - j];
                sum_by += self.at[j] * by[n - j] + self.by[j] * value[n - j];
            }
            let inverse = 1.0 / ((n as f64 + 1.0) * (n as f64 + 2.0));
            value[n + 2] = sum * inverse;
            by[n + 2] = sum_by * inverse;
        }
        [value, by].map(|series| {
            let (mut end, mut slope) = (ZERO, ZERO);
            for (n, term) in series.iter().enumerate().rev() {
                end += term;
                slope += term * n as f64;
            }
            [end, slope / self.length]
        })
    }
}

impl Characteristic {
    /// Whether friction varies along a zone.
    pub(super) fn varies(&self) -> bool {
        self.zones.iter().any(|zone| zone.course.is_some())
    }

    /// Steps that carry a perturbation over the first `length` of a segment.
    fn steps(&self, segment: &SeriesSegment, frequency: f64, length: f64) -> f64 {
        let size = segment.size(self.square(), frequency);
        (size.sqrt() * length / RADIANS).ceil().max(1.0)
    }

    /// ã/m_a², the coefficient of λ² in Δ.
    fn square(&self) -> f64 {
        self.a / (self.ma * self.ma)
    }

    /// Expands the transfers over sliding zones in λ, which pays for itself after a few values.
    pub(super) fn expand(&self) {
        for course in self.zones.iter().filter_map(|zone| zone.course.as_ref()) {
            course.expand(self.square());
        }
    }

    /// What an eigenvalue costs at a frequency, in units of those in closed form.
    pub(super) fn cost(&self, frequency: f64) -> usize {
        /// Steps that cost as much as a value in closed form, and what else is done for it.
        const STEPS: f64 = 2.0;
        let courses = self.zones.iter().filter_map(|zone| zone.course.as_ref());
        let segments = courses.flat_map(|course| &course.segments);
        let steps = segments.map(|one| self.steps(one, frequency, one.piece.duration));
        1 + (steps.sum::<f64>() / STEPS) as usize
    }

    /// Largest |E|/m_a.
    pub(super) fn steepest(&self) -> f64 {
        let courses = self.zones.iter().filter_map(|zone| zone.course.as_ref());
        courses.fold(0.0, |most, course| most.max(course.steepest))
    }

    /// 2p of a course at F + E = `pushed`.
    fn growth(&self, pushed: f64, lambda: C64) -> C64 {
        (C64::from(pushed - self.damping) - lambda * (2.0 * self.a)) / self.ma
    }

    /// ∫2p over the first `duration` of a course, with its derivative.
    fn gained(&self, course: &ZoneFriction, duration: f64, lambda: C64) -> [C64; 2] {
        let gained = self.growth(0.0, lambda) * duration + course.pushed(duration) / self.ma;
        [gained, C64::from(-2.0 * self.a / self.ma * duration)]
    }

    /// The determinant of the transfer of (η, η′) through a zone and the switch at its end.
    pub(super) fn wronskian(
        &self,
        course: &ZoneFriction,
        zone: &LinearZone,
        lambda: C64,
    ) -> ScaledComplex {
        let [gained, by] = self.gained(course, zone.duration, lambda);
        let ratio = match zone.jump {
            PerturbationJump::Reversal(ratio) => ratio,
            _ => 1.0,
        };
        let value = C64::from_polar(1.0, gained.im) * ratio;
        ScaledComplex {
            value,
            derivative: value * by,
            exponent: gained.re,
        }
    }

    /// Carries perturbations through the first `duration` of a zone.
    pub(super) fn follow(
        &self,
        course: &ZoneFriction,
        lambda: C64,
        duration: f64,
        state: &mut PerturbationColumns,
        count: usize,
    ) {
        let p_at = |time: f64| {
            let [force, drag] = course.at(time);
            self.growth(force + drag, lambda) * 0.5
        };
        let p_by = -self.a / self.ma;
        let p = p_at(0.0);
        let mut pairs: [Pair; 2] = [[[ZERO; 2]; 2]; 2];
        for (column, pair) in pairs.iter_mut().enumerate().take(count) {
            let (at, by) = (&state.columns[column], &state.by[column]);
            *pair = [
                [at[2], at[3] - p * at[2]],
                [by[2], by[3] - p * by[2] - at[2] * p_by],
            ];
        }
        let pairs = &mut pairs[..count];
        state.exponent += course
            .propagate(lambda, duration, pairs)
            .unwrap_or_else(|| self.carry(course, lambda, duration, pairs));
        let p = p_at(duration);
        let [loss, loss_by] = self.gained(course, duration, lambda).map(|x| x * 0.5);
        let turn = C64::from_polar(1.0, loss.im);
        state.exponent += loss.re;
        for (column, [[z, rate], [z_by, rate_by]]) in pairs.iter().copied().enumerate() {
            let slope = rate + p * z;
            let by = z_by + loss_by * z;
            let slope_by = rate_by + p * z_by + z * p_by + loss_by * slope;
            (state.columns[column][2], state.columns[column][3]) = (z * turn, slope * turn);
            (state.by[column][2], state.by[column][3]) = (by * turn, slope_by * turn);
        }
    }

    /// Carries z and z′ with their derivatives through the first `duration` of a course, step by step. Returns the
    /// exponent that is taken out of them.
    fn carry(&self, course: &ZoneFriction, lambda: C64, duration: f64, pairs: &mut [Pair]) -> f64 {
        let square = self.square();
        let mut exponent = 0.0;
        for segment in &course.segments {
            let piece = &segment.piece;
            let length = (duration - piece.start).min(piece.duration);
            if length <= 0.0 {
                break;
            }
            let steps = self.steps(segment, lambda.norm(), length);
            if steps.is_nan() || steps > MOST_STEPS {
                pairs.fill([[C64::from(f64::NAN); 2]; 2]);
                break;
            }
            let width = length / piece.duration / steps;
            let seconds = length / steps;
            for index in 0..steps as usize {
                let from = width * index as f64;
                let [linear, constant] =
                    [&segment.linear, &segment.constant].map(|series| part(series, from, width));
                let scale = seconds * seconds;
                let mut at: [C64; TERMS] =
                    std::array::from_fn(|n| (lambda * linear[n] + constant[n]) * scale);
                let mut by: [C64; TERMS] = std::array::from_fn(|n| C64::from(linear[n] * scale));
                at[0] += lambda * lambda * (square * scale);
                by[0] += lambda * (2.0 * square * scale);
                let counts = |n: &usize| at[*n].norm_sqr() + by[*n].norm_sqr() > NOTHING * NOTHING;
                let terms = (0..TERMS).rev().find(counts).map_or(1, |last| last + 1);
                let step = SlidingStep {
                    at,
                    by,
                    terms,
                    length: seconds,
                };
                for pair in pairs.iter_mut() {
                    *pair = step.carry(*pair);
                }
                exponent += scaled_down(pairs);
            }
        }
        exponent
    }
}
