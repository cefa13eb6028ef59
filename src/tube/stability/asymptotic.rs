//! The spectrum at high frequency.
//!
//! For |Im λ| → ∞ the exponents of a zone are r = xλ + y + O(1/λ). With q = √a/|c|,
//!
//! ```text
//! x₁ = q/(1+q),  x₂ = −q/(1−q),   y_i = ±[(F − α)x_i − F]/(2q),   F = σfκ (0 in separation),
//! ```
//!
//! with the upper sign for i = 1. Under friction that depends on the velocity α − E stands for α, see
//! [`super::sliding`], and both are means over the zone. Separation decouples to this order: u is O(1/λ) of η, and so is what it
//! gives back at landing, with friction or without: λu is of the order of η, and η′ of that of λη.
//! Reversals multiply η′ by V̈⁺/V̈⁻ and mix the two branches. The characteristic function becomes a sum
//! of exponentials Σ a_p e^{−λτ_p} over the paths through the branches, and lim sup Re λ is the root ρ
//! of Σ |a_p| e^{−ρτ_p} = 1: attained where the delays are rationally independent, a bound always.
//!
//! Material damping β > 0 takes both branches away: r = λ ± √(λ/(ãβ)) + … and r = −1/β + …, so that
//! |N| → e^{−T_s/β}, T_s being the time out of stick, and Re λ → −T_s/(βT). What is left of the branches
//! below is their delays, which hold for |λ| ≪ 1/√(βT).

use nalgebra::Complex;

use super::perturbation::{Characteristic, LinearZone, PerturbationJump};
use crate::continuation::zero::boundary;
use crate::tube::model::signature::Regime;

/// One path: a e^{λ·advance} e^{−λT}.
#[derive(Clone, Copy, Debug)]
struct EchoPath {
    branch: usize,
    factor: f64,
    advance: f64,
}

/// The limit of t(λ) and d(λ) for large |Im λ|.
#[derive(Clone, Debug)]
pub struct HighFrequency {
    /// (a_p, τ_p) of t.
    trace: Vec<(f64, f64)>,
    /// (a, τ) of d.
    determinant: Option<(f64, f64)>,
    /// (T_s/β, T) with material damping.
    damped: Option<(f64, f64)>,
    /// A release from static friction multiplies η′ by λ² while a zone divides it by λ: N grows
    /// like λ, and Re λ without bound, like ln|λ| over the delay.
    unbounded: bool,
}

/// Two paths whose advances differ by less than this fraction of the period are one.
const SAME_DELAY: f64 = 1e-13;

impl HighFrequency {
    /// The limit for a linearised wave.
    pub fn new(characteristic: &Characteristic) -> HighFrequency {
        // q = 1/(1 + e); 1 − q would cancel as c² → a
        let excess = characteristic.excess;
        let q = 1.0 / (1.0 + excess);
        let x = [1.0 / (2.0 + excess), -1.0 / excess];
        let span = x[0] - x[1];
        // (1, slope) in the basis (1, x₁), (1, x₂)
        let split = |slope: f64| [(slope - x[1]) / span, (x[0] - slope) / span];
        let period = characteristic.period;
        let mut determinant = (1.0, 2.0 * period);
        let groups = Self::starts(characteristic.stick, split(0.0));
        let mut trace = Vec::new();
        for (start, mut paths) in groups.into_iter().enumerate() {
            let mut forgotten = false;
            for zone in &characteristic.zones {
                if zone.regime == Regime::Stick {
                    // only η is left, and release begins anew
                    paths = spread(&merge(&paths, true, period), |_| split(0.0));
                    forgotten = true;
                    continue;
                }
                let y = Self::rates(characteristic, zone, x, q);
                for path in &mut paths {
                    path.factor *= (y[path.branch] * zone.duration).exp();
                    path.advance += x[path.branch] * zone.duration;
                }
                if start == 0 {
                    determinant.0 *= ((y[0] + y[1]) * zone.duration).exp();
                    determinant.1 -= (x[0] + x[1]) * zone.duration;
                }
                if let PerturbationJump::Reversal(ratio) = zone.jump {
                    paths = spread(&paths, |path| split(ratio * x[path.branch]));
                    paths = merge(&paths, false, period);
                    if start == 0 {
                        determinant.0 *= ratio;
                    }
                }
            }
            if forgotten {
                // the last stick zone ends the period: η is what is carried over
                let sum = merge(&paths, true, period);
                trace.extend(sum.iter().map(|path| (path.factor, period - path.advance)));
            } else {
                trace.extend(
                    paths
                        .iter()
                        .filter(|path| path.branch == start)
                        .map(|path| (path.factor, period - path.advance)),
                );
            }
        }
        HighFrequency {
            trace,
            determinant: (!characteristic.stick).then_some(determinant),
            damped: (characteristic.beta > 0.0).then(|| {
                let zones = characteristic.zones.iter();
                let moving = zones.filter(|zone| zone.regime != Regime::Stick);
                let time: f64 = moving.map(|zone| zone.duration).sum();
                (time / characteristic.beta, period)
            }),
            unbounded: characteristic
                .zones
                .iter()
                .any(|zone| matches!(zone.jump, PerturbationJump::StaticRelease(_))),
        }
    }

    /// The paths that are followed from the beginning of the period: with stick both waves as one, without each by itself.
    fn starts(stick: bool, split: [f64; 2]) -> Vec<Vec<EchoPath>> {
        let starts: Vec<EchoPath> = (0..2)
            .map(|branch| EchoPath {
                branch,
                factor: if stick { split[branch] } else { 1.0 },
                advance: 0.0,
            })
            .collect();
        if stick {
            vec![starts]
        } else {
            starts.into_iter().map(|path| vec![path]).collect()
        }
    }

    /// Rates y₁ and y₂ at which friction and damping change the amplitudes of the two waves in a zone.
    fn rates(characteristic: &Characteristic, zone: &LinearZone, x: [f64; 2], q: f64) -> [f64; 2] {
        let [force, drag] = match &zone.course {
            Some(course) => [course.force, course.drag],
            None => {
                let sigma = zone.regime.sliding().unwrap_or(0.0);
                [sigma * characteristic.friction * characteristic.kappa, 0.0]
            }
        };
        let pushed = force - (characteristic.damping - drag);
        [0, 1].map(|i| {
            let sign = if i == 0 { 1.0 } else { -1.0 };
            sign * (pushed * x[i] - force) / (2.0 * q)
        })
    }

    fn terms(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.trace.iter().copied().chain(self.determinant)
    }

    /// Σ |a_p| e^{−ρτ_p}: below 1, no zero at high frequency lies to the right of ρ.
    pub(crate) fn size(&self, rho: f64) -> f64 {
        if let Some((decay, period)) = self.damped {
            return (-decay - rho * period).exp();
        }
        self.terms()
            .map(|(factor, delay)| factor.abs() * (-rho * delay).exp())
            .sum()
    }

    /// Σ |a_p| τ_p e^{−ρτ_p}, which bounds |t′| + |d′| in the limit; 0 with material damping.
    pub(super) fn slope(&self, rho: f64) -> f64 {
        if self.damped.is_some() {
            return 0.0;
        }
        self.terms()
            .map(|(factor, delay)| factor.abs() * delay * (-rho * delay).exp())
            .sum()
    }

    /// The longest delay: zeros follow one another in Im λ at 2π over it, or farther apart.
    pub fn longest_delay(&self) -> f64 {
        self.terms().map(|(_, delay)| delay).fold(0.0, f64::max)
    }

    /// t(λ) of the limit, Σ a_p e^{−λτ_p}.
    pub fn trace_at(&self, lambda: Complex<f64>) -> Complex<f64> {
        self.trace
            .iter()
            .map(|(factor, delay)| (-lambda * *delay).exp() * *factor)
            .sum()
    }

    /// ρ, the largest limit point of Re λ: infinite with static friction, NaN where a coefficient is
    /// infinite.
    pub fn limit(&self) -> f64 {
        if self.unbounded {
            return f64::INFINITY;
        }
        if let Some((decay, period)) = self.damped {
            return -decay / period;
        }
        if !self
            .terms()
            .all(|(factor, delay)| factor.is_finite() && delay > 0.0)
        {
            return f64::NAN;
        }
        /// In units of the rate of the longest delay.
        const FARTHEST: f64 = 1e6;
        let rate = self.longest_delay().recip();
        let (mut low, mut high) = (-rate, rate);
        while self.size(low) < 1.0 && low > -FARTHEST * rate {
            low *= 2.0;
        }
        while self.size(high) > 1.0 && high < FARTHEST * rate {
            high *= 2.0;
        }
        let (above, below) = boundary((low, high), 0.0, |rho| self.size(rho) <= 1.0);
        0.5 * (above + below)
    }
}

/// Paths that go on in both branches, with these parts of each.
fn spread(paths: &[EchoPath], parts: impl Fn(&EchoPath) -> [f64; 2]) -> Vec<EchoPath> {
    let mut both = Vec::with_capacity(2 * paths.len());
    for path in paths {
        for (branch, part) in parts(path).into_iter().enumerate() {
            both.push(EchoPath {
                branch,
                factor: path.factor * part,
                advance: path.advance,
            });
        }
    }
    both
}

/// Adds up paths of the same advance; of one branch, or of both where only η counts.
fn merge(paths: &[EchoPath], both: bool, period: f64) -> Vec<EchoPath> {
    let mut merged: Vec<EchoPath> = Vec::new();
    for path in paths {
        let branch = if both { 0 } else { path.branch };
        match merged.iter_mut().find(|known| {
            known.branch == branch && (known.advance - path.advance).abs() <= SAME_DELAY * period
        }) {
            Some(known) => known.factor += path.factor,
            None => merged.push(EchoPath { branch, ..*path }),
        }
    }
    merged
}
