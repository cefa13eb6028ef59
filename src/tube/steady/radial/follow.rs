//! Waves and Hopf points of the tube, followed from where they are known as damping and the slope of
//! the friction law grow to what is given.

use faer::{Mat, c64};

use super::{Radial, RadialError, RadialPair, bilinear, iterate, quotient};
use crate::tube::model::Damping;
use crate::tube::steady::growth::{Hopf, SteadyFriction, eigenvalues, stiffness_at};

/// Least step of the homotopy in damping and drag, as a part of the whole.
const LEAST_STEP: f64 = 1.0 / 4096.0;
/// First and largest step of the homotopy in damping and drag.
const LARGEST_STEP: f64 = 0.125;
/// Relative size of the last correction of ω and f at a Hopf point, or of λ: convergence is quadratic,
/// so that what this correction leaves is rounding.
const HOPF_TOLERANCE: f64 = 1e-11;
/// Corrections beyond which a step of the homotopy is halved.
const MOST_CORRECTIONS: usize = 8;
/// Largest correction of ω or λ, relative, that belongs to the branch being followed.
const LARGEST_CORRECTION: f64 = 0.1;

impl Radial {
    /// The eigenvalue λ with the largest real part of a family, given by its pair for 𝒹 = 0 at the
    /// friction fS(0). The pair becomes that of this eigenvalue.
    ///
    /// # Errors
    /// When it is lost on the way from 𝒹 = 0.
    pub fn leading(
        &self,
        pair: &mut RadialPair,
        friction: f64,
        sliding: SteadyFriction,
        damping: Damping,
    ) -> Result<c64, RadialError> {
        let start = eigenvalues(pair.kappa, damping);
        let later = |one: c64, other: c64| if one.re >= other.re { one } else { other };
        if sliding.drag == 0.0 || friction == 0.0 {
            return Ok(later(start[0], start[1]));
        }
        let time = self.gamma.sqrt();
        let damping = scaled(damping, time);
        let drag = friction * sliding.drag * time;
        let friction = friction * sliding.strength;
        let reach = |start: c64| {
            let correct = |part: f64, guess: [f64; 2], near: &RadialPair| {
                self.correct_wave(guess, friction, part * drag, damping, near)
            };
            follow([start.re * time, start.im * time], [0.0; 2], pair, correct)
        };
        let lost = RadialError::Slope {
            mode: self.mode,
            drag: drag / time,
        };
        let (one, first) = reach(start[0]).ok_or(lost)?;
        let (other, second) = reach(start[1]).ok_or(lost)?;
        let [one, other] = [one, other].map(|[re, im]| c64::new(re, im) / time);
        let vectors = if one.re >= other.re { first } else { second };
        *pair = RadialPair {
            kappa: pair.kappa,
            ..vectors
        };
        Ok(later(one, other))
    }

    /// Newton's method in λ for yᵀ(A + ΓE − κB)x = 0, Γ = 𝒹λ/(1 + βλ), E = w(1)W(1).
    fn correct_wave(
        &self,
        guess: [f64; 2],
        friction: f64,
        drag: f64,
        damping: Damping,
        near: &RadialPair,
    ) -> Option<([f64; 2], RadialPair)> {
        let mut lambda = c64::new(guess[0], guess[1]);
        let mut pair = near.clone();
        let mass = self.with_friction(&self.mass, friction);
        for _ in 0..MOST_CORRECTIONS {
            let (kappa, slope) = stiffness_at(lambda, damping);
            let viscous = 1.0 + damping.stiffness * lambda;
            let stiffness = self.with_drag(friction, drag * lambda / viscous);
            pair = iterate(&stiffness, &mass, &pair, kappa)?;
            let defect = quotient(&stiffness, &mass, &pair) - kappa;
            let share = self.surface(&pair) / bilinear(&mass, &pair);
            let step = defect / (slope - drag / (viscous * viscous) * share);
            if !step.is_finite() || step.norm() > LARGEST_CORRECTION * lambda.norm() {
                return None;
            }
            lambda += step;
            if step.norm() <= HOPF_TOLERANCE * lambda.norm() {
                return Some(([lambda.re, lambda.im], pair));
            }
        }
        None
    }

    /// A(f) + ΓE.
    fn with_drag(&self, friction: f64, drag: c64) -> Mat<c64> {
        let mut matrix = self.with_friction(&self.stiffness, friction);
        matrix[(self.order - 1, self.order - 1)] += drag;
        matrix
    }

    /// yᵀEx: both displacements along the shaft at its surface.
    fn surface(&self, pair: &RadialPair) -> c64 {
        pair.left[(self.order - 1, 0)] * pair.right[(self.order - 1, 0)]
    }

    /// Hopf points of the families of least κ at f = 0, each followed from f = 0 without damping and
    /// drag as both grow to what is given. `None` where it leaves for infinite friction.
    ///
    /// # Errors
    /// As for [`Radial::lowest`].
    pub fn hopf(
        &self,
        families: usize,
        damping: Damping,
        sliding: SteadyFriction,
    ) -> Result<Vec<Option<Hopf>>, RadialError> {
        let time = self.gamma.sqrt();
        let sliding = SteadyFriction {
            drag: sliding.drag * time,
            ..sliding
        };
        let mut points: Vec<_> = self
            .scaled_lowest(0.0, families)?
            .iter()
            .map(|pair| {
                let point = self.follow_hopf(pair, scaled(damping, time), sliding)?;
                Some(Hopf {
                    omega: point.omega / time,
                    ..point
                })
            })
            .collect();
        points.resize(families.max(1), None);
        Ok(points)
    }

    /// Follows a Hopf point, in units of time √γ, from the undamped family in tα, tβ, t𝒹 for t from 0
    /// to 1.
    fn follow_hopf(
        &self,
        pair: &RadialPair,
        damping: Damping,
        sliding: SteadyFriction,
    ) -> Option<Hopf> {
        let norm = |pair: &RadialPair| bilinear(&self.with_friction(&self.mass, 0.0), pair);
        // κ = κ₀ + igf: without friction the problem is self-adjoint, and g is real
        let growth = sliding.strength * (self.by_friction(pair, pair.kappa) / norm(pair)).im;
        let frequency = pair.kappa.re.max(0.0).sqrt();
        let omega = -frequency * growth.signum();
        if growth == 0.0 || !omega.is_finite() {
            return None;
        }
        if damping.mass == 0.0 && damping.stiffness == 0.0 {
            return Some(Hopf {
                friction: 0.0,
                omega,
            });
        }
        // df/dt: fg = Im κ(ω) = −ω(α + βω²) to first order
        let slope = -omega * (damping.mass + damping.stiffness * omega * omega) / growth;
        let correct = |part: f64, guess: [f64; 2], near: &RadialPair| {
            let damping = Damping {
                mass: part * damping.mass,
                stiffness: part * damping.stiffness,
            };
            let sliding = SteadyFriction {
                drag: part * sliding.drag,
                ..sliding
            };
            self.correct_hopf(guess, damping, sliding, near)
        };
        let ([friction, omega], _) = follow([0.0, omega], [slope, 0.0], pair, correct)?;
        (friction > 0.0).then_some(Hopf { friction, omega })
    }

    /// Newton's method for yᵀ(A(f) + Γ(ω, f)E − κ(ω)B(f))x = 0 in ω and f; x and y follow by inverse
    /// iteration.
    fn correct_hopf(
        &self,
        guess: [f64; 2],
        damping: Damping,
        sliding: SteadyFriction,
        near: &RadialPair,
    ) -> Option<([f64; 2], RadialPair)> {
        let [mut friction, mut omega] = guess;
        let mut pair = near.clone();
        let i = c64::new(0.0, 1.0);
        for _ in 0..MOST_CORRECTIONS {
            let lambda = i * omega;
            let (kappa, slope) = stiffness_at(lambda, damping);
            let viscous = 1.0 + damping.stiffness * lambda;
            let by_friction = sliding.drag * lambda / viscous;
            let real = friction * sliding.strength;
            let stiffness = self.with_drag(real, friction * by_friction);
            let mass = self.with_friction(&self.mass, real);
            pair = iterate(&stiffness, &mass, &pair, kappa)?;
            let norm = bilinear(&mass, &pair);
            let share = self.surface(&pair) / norm;
            let defect = quotient(&stiffness, &mass, &pair) - kappa;
            // defect + (∂/∂f) df − κ′ dω = 0, real and imaginary part
            let in_friction =
                sliding.strength * self.by_friction(&pair, kappa) / norm + by_friction * share;
            let in_omega = i * (slope - friction * sliding.drag / (viscous * viscous) * share);
            let determinant = in_friction.im * in_omega.re - in_friction.re * in_omega.im;
            let more = (defect.re * in_omega.im - defect.im * in_omega.re) / determinant;
            let turn = (defect.re * in_friction.im - defect.im * in_friction.re) / determinant;
            if !(more.is_finite() && turn.is_finite())
                || turn.abs() > LARGEST_CORRECTION * guess[1].abs()
            {
                return None;
            }
            friction += more;
            omega += turn;
            if turn.abs() <= HOPF_TOLERANCE * omega.abs()
                && more.abs() <= HOPF_TOLERANCE * friction.abs().max(f64::MIN_POSITIVE)
            {
                return Some(([friction, omega], pair));
            }
        }
        None
    }
}

/// Damping in a unit of time.
fn scaled(damping: Damping, time: f64) -> Damping {
    Damping {
        mass: damping.mass * time,
        stiffness: damping.stiffness / time,
    }
}

/// Follows two numbers and their pair for a part from 0 to 1 with a secant predictor; `slope` is the
/// derivative at the start. `correct` solves at a part from a guess.
fn follow(
    start: [f64; 2],
    slope: [f64; 2],
    pair: &RadialPair,
    correct: impl Fn(f64, [f64; 2], &RadialPair) -> Option<([f64; 2], RadialPair)>,
) -> Option<([f64; 2], RadialPair)> {
    let (mut here, mut slope, mut vectors) = (start, slope, pair.clone());
    let (mut reached, mut step) = (0.0, LARGEST_STEP);
    while reached < 1.0 {
        let next = (reached + step).min(1.0);
        let width = next - reached;
        let guess = [0, 1].map(|index| here[index] + width * slope[index]);
        match correct(next, guess, &vectors) {
            Some((point, found)) => {
                slope = [0, 1].map(|index| (point[index] - here[index]) / width);
                (here, vectors, reached) = (point, found, next);
                step = (2.0 * step).min(LARGEST_STEP);
            }
            None if step <= LEAST_STEP => return None,
            None => step *= 0.5,
        }
    }
    Some((here, vectors))
}
