//! The equations of the ring, and their time steps by the three-stage Radau IIA method.

use std::f64::consts::TAU;

use super::chain::{Block, BlockFactors, ChainNodes, Stages};
use crate::tube::model::{FrictionLaw, Model};

/// Number of spacings beyond which nothing is felt within T without material damping (see the text of
/// the module).
const LEAST_REACH: usize = 12;
/// What is felt beyond the window, at most, for perturbations of order one: below rounding.
const UNFELT: f64 = 1e-17;

/// Iterations of Newton's method for a wave and for the stages of a step. Both start close.
pub(super) const MOST_ITERATIONS: usize = 12;
/// The last correction of Newton's method in units of ε, over which friction bends; what remains is
/// its square.
pub(super) const CLOSE: f64 = 1e-6;
/// Corrections of V̇ beyond which Newton's method is given up.
pub(super) const TOO_LARGE: f64 = 30.0;

/// Why one attempt of Newton's method failed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RingFailure {
    /// The time steps became too small.
    #[error("the time steps fall below {step:e}")]
    Steps {
        /// Last step tried.
        step: f64,
    },
    /// The stages of a given step were not found.
    #[error("the implicit time step of {step:e} has no solution")]
    Stages {
        /// Step.
        step: f64,
    },
    /// The iteration ended in steady sliding.
    #[error("Newton's method ends in steady sliding (V̇ has a range of {range:e})")]
    SteadySliding {
        /// Largest less least V̇.
        range: f64,
    },
    /// The iteration does not converge.
    #[error("Newton's method does not converge (last correction {correction:e})")]
    Divergence {
        /// Largest component of the last correction.
        correction: f64,
    },
}

/// V and V̇ at the points of a cell.
pub(super) type Values = Vec<[f64; 2]>;

/// Coefficients of the semi-discrete system.
#[derive(Clone, Copy, Debug)]
pub(super) struct RingEquations {
    pub(super) spacing: f64,
    /// a/Δφ².
    pub(super) tension: f64,
    pub(super) stiffness: f64,
    /// α.
    pub(super) damping: f64,
    /// β.
    pub(super) material: f64,
    /// gδ.
    pub(super) weight: f64,
    /// D/(2Δφ).
    pub(super) coupling: f64,
    pub(super) friction: f64,
    pub(super) epsilon: f64,
    /// (r − 1, v₀) of Stribeck's law: friction has the factor 1 + (r − 1)e^{−|1 − V̇|/v₀}.
    pub(super) weakening: (f64, f64),
}

/// Radau IIA with three stages: coefficients. The last row holds the weights.
pub(super) fn radau() -> Block {
    let root = 6.0_f64.sqrt();
    Block::new(
        (88.0 - 7.0 * root) / 360.0,
        (296.0 - 169.0 * root) / 1800.0,
        (-2.0 + 3.0 * root) / 225.0,
        (296.0 + 169.0 * root) / 1800.0,
        (88.0 + 7.0 * root) / 360.0,
        (-2.0 - 3.0 * root) / 225.0,
        (16.0 - root) / 36.0,
        (16.0 + root) / 36.0,
        1.0 / 9.0,
    )
}

/// Order 5: the error of two half steps is the difference from the full step over 2⁵ − 1.
const HALVED: f64 = 31.0;

/// Derivatives of the acceleration F_i(V̂_{i−1}, V̂_i, V̂_{i+1}, V̇_i) of a point at the stages of a
/// step; ∂F_i/∂V̂_i is constant.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slopes {
    /// ∂F_i/∂V̇_i.
    pub(super) rate: Stages,
    /// ∂F_i/∂V̂_{i+1}.
    pub(super) ahead: Stages,
    /// ∂F_i/∂V̂_{i−1}.
    pub(super) behind: Stages,
}

#[derive(Clone, Debug)]
pub(super) struct RingPerturbations {
    pub(super) step: f64,
    pub(super) slopes: Vec<Slopes>,
}

pub(super) struct Taken {
    pub(super) linear: RingPerturbations,
    pub(super) factors: BlockFactors,
    /// V and V̇ at the stages of each point.
    pub(super) displacement: Vec<Stages>,
    pub(super) rate: Vec<Stages>,
}

impl Taken {
    fn end(&self) -> Values {
        self.displacement
            .iter()
            .zip(&self.rate)
            .map(|(v, w)| [v[2], w[2]])
            .collect()
    }
}

/// The map of T and its derivative with respect to T.
pub(super) struct Flow {
    pub(super) end: Values,
    pub(super) by_period: Values,
    pub(super) steps: Vec<RingPerturbations>,
}

impl RingEquations {
    pub(super) fn new(model: &Model, mode: u32, points: usize, epsilon: f64) -> RingEquations {
        let parameters = model.constants();
        let coefficients = parameters.coefficients;
        let spacing = TAU / (f64::from(mode) * points as f64);
        RingEquations {
            spacing,
            tension: coefficients.a / (spacing * spacing),
            stiffness: coefficients.h,
            damping: parameters.mass_damping,
            material: parameters.stiffness_damping,
            weight: coefficients.g * parameters.mismatch,
            coupling: 0.5 * coefficients.coupling / spacing,
            friction: parameters.friction,
            epsilon,
            weakening: match model.law {
                FrictionLaw::Stribeck { ratio, velocity } => (ratio - 1.0, velocity),
                _ => (0.0, f64::INFINITY),
            },
        }
    }

    /// ∂F_i/∂V̂_i.
    pub(super) fn own(&self) -> f64 {
        -2.0 * self.tension - self.stiffness
    }

    /// Number of spacings beyond which nothing is felt within T: the least m ≥ [`LEAST_REACH`] at
    /// which e^{x − qm} falls below [`UNFELT`] for some q.
    pub(super) fn reach(&self, period: f64) -> usize {
        /// Trial values of q; the bound is flat around the best one.
        const TRIALS: [f64; 16] = [
            0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0, 7.5, 8.0,
        ];
        if self.material == 0.0 {
            return LEAST_REACH;
        }
        // friction joins neighbours, too, through the pressure
        let joined = self.tension + (self.friction * self.coupling).abs();
        let (spread, wave) = (joined * self.material * period, joined * period * period);
        let needed = TRIALS
            .map(|q| {
                let s = 4.0 * (0.5 * q).sinh().powi(2);
                let half = 0.5 * spread * s;
                (half + (half * half + wave * s).sqrt() - UNFELT.ln()) / q
            })
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        LEAST_REACH.max(needed.ceil() as usize)
    }

    /// Accelerations at the stages of point i from V̂ there and V̇, with their derivatives.
    pub(super) fn acceleration(
        &self,
        [behind, here, ahead]: [&Stages; 3],
        rate: &Stages,
    ) -> (Stages, Slopes) {
        let mut force = Stages::default();
        let mut slopes = Slopes::default();
        for stage in 0..3 {
            let (before, after) = (behind[stage], ahead[stage]);
            let pressure = self.friction * (self.weight - self.coupling * (after - before));
            let gap = 1.0 - rate[stage];
            let sign = (gap / self.epsilon).tanh();
            let (weakening, velocity) = self.weakening;
            let weakened = weakening * (-gap.abs() / velocity).exp();
            let factor = 1.0 + weakened;
            force[stage] = self.tension * (after - 2.0 * here[stage] + before)
                - self.damping * rate[stage]
                - self.stiffness * here[stage]
                + pressure * sign * factor;
            slopes.rate[stage] = -self.damping
                - pressure * (1.0 - sign) * (1.0 + sign) / self.epsilon * factor
                + pressure * sign.abs() * weakened / velocity;
            let pull = self.friction * self.coupling * sign * factor;
            slopes.ahead[stage] = self.tension - pull;
            slopes.behind[stage] = self.tension + pull;
        }
        (force, slopes)
    }

    /// Matrix of a step for the stage values of V̇:
    /// W_s − hΣA_sr[(∂F/∂W)_r W_r + (∂F/∂V̂)_r(βW_r + hΣA_rq W_q)].
    pub(super) fn factors(
        &self,
        linear: &RingPerturbations,
        nodes: ChainNodes,
    ) -> Option<BlockFactors> {
        let step = linear.step;
        let radau = radau();
        // V̂ of the stages from W
        let effective = radau * step + Block::identity() * self.material;
        let square = radau * effective * (step * self.own());
        let points = linear.slopes.len();
        let slopes = |index: usize| &linear.slopes[nodes.point(index, points)];
        let through = |slope: &Stages| {
            let weighted = Block::from_fn(|row, column| slope[row] * effective[(row, column)]);
            radau * weighted * -step
        };
        BlockFactors::new(
            nodes,
            |index| {
                let rate = &slopes(index).rate;
                Block::from_fn(|row, column| {
                    f64::from(row == column)
                        - step * radau[(row, column)] * rate[column]
                        - square[(row, column)]
                })
            },
            |index| through(&slopes(index).ahead),
            |index| through(&slopes(index).behind),
        )
    }

    pub(super) fn step(&self, from: &Values, step: f64) -> Result<Taken, RingFailure> {
        let points = from.len();
        let nodes = ChainNodes {
            first: 0,
            count: points,
            cyclic: true,
        };
        let radau = radau();
        let failure = RingFailure::Stages { step };
        let mut rate: Vec<Stages> = from.iter().map(|&[_, w]| [w; 3]).collect();
        let mut linear = RingPerturbations {
            step,
            slopes: vec![Slopes::default(); points],
        };
        let mut displacement = vec![Stages::default(); points];
        let mut effective = vec![Stages::default(); points];
        let mut right = vec![0.0; 3 * points];
        let mut close = false;
        for _ in 0..MOST_ITERATIONS {
            for ((v, w), start) in displacement.iter_mut().zip(&rate).zip(from) {
                *v = std::array::from_fn(|stage| start[0] + step * dot(&radau, stage, w));
            }
            for ((hat, v), w) in effective.iter_mut().zip(&displacement).zip(&rate) {
                *hat = std::array::from_fn(|stage| v[stage] + self.material * w[stage]);
            }
            for index in 0..points {
                let around = [
                    &effective[(index + points - 1) % points],
                    &effective[index],
                    &effective[(index + 1) % points],
                ];
                let (force, slopes) = self.acceleration(around, &rate[index]);
                linear.slopes[index] = slopes;
                for stage in 0..3 {
                    right[3 * index + stage] =
                        from[index][1] - rate[index][stage] + step * dot(&radau, stage, &force);
                }
            }
            let factors = self.factors(&linear, nodes).ok_or(failure)?;
            if close {
                return Ok(Taken {
                    linear,
                    factors,
                    displacement,
                    rate,
                });
            }
            factors.solve(&mut right, 1);
            let largest = size_of(right.iter().copied());
            if largest > TOO_LARGE {
                return Err(failure);
            }
            for (w, correction) in rate.iter_mut().zip(right.chunks_exact(3)) {
                for (w, correction) in w.iter_mut().zip(correction) {
                    *w += correction;
                }
            }
            close = largest <= CLOSE * self.epsilon;
        }
        Err(failure)
    }

    /// Fractions of T at which no step errs by more than the tolerance, by step doubling.
    pub(super) fn fractions(
        &self,
        from: &Values,
        period: f64,
        tolerance: f64,
    ) -> Result<Vec<f64>, RingFailure> {
        /// Of T: fronts of ε = 1e-6 still have steps a hundred times longer.
        const SHORTEST: f64 = 1e-9;
        let mut fractions = Vec::new();
        let mut state = from.clone();
        let mut done = 0.0;
        let mut share = 0.25_f64;
        while done < 1.0 {
            // no tiny last step
            let left = 1.0 - done;
            let now = if share >= left {
                left
            } else {
                share.min(0.5 * left)
            };
            if now < SHORTEST {
                return Err(RingFailure::Steps { step: now * period });
            }
            let half = 0.5 * now * period;
            let attempt = self.step(&state, 2.0 * half).and_then(|whole| {
                let middle = self.step(&state, half)?;
                let end = self.step(&middle.end(), half)?;
                Ok((whole, end))
            });
            let Ok((whole, end)) = attempt else {
                share = 0.25 * now;
                continue;
            };
            let end = end.end();
            let whole = whole.end();
            let differences = whole
                .iter()
                .zip(&end)
                .flat_map(|(one, other)| [one[0] - other[0], one[1] - other[1]]);
            let error = size_of(differences) / HALVED;
            let advice = 0.9 * (tolerance / error.max(1e-3 * tolerance)).powf(1.0 / 6.0);
            share = now * advice.clamp(0.2, 3.0);
            if error <= tolerance {
                fractions.extend([0.5 * now; 2]);
                done = if now == left { 1.0 } else { done + now };
                state = end;
            }
        }
        Ok(fractions)
    }

    /// The map of T with given time steps.
    pub(super) fn flow(
        &self,
        from: &Values,
        period: f64,
        fractions: &[f64],
    ) -> Result<Flow, RingFailure> {
        let radau = radau();
        let points = from.len();
        let mut state = from.clone();
        let mut by_period = vec![[0.0; 2]; points];
        let mut steps = Vec::with_capacity(fractions.len());
        let own = self.own();
        for fraction in fractions {
            let step = fraction * period;
            let taken = self.step(&state, step)?;
            // the stages of V with the derivatives of W left out
            let moved: Vec<Stages> = (0..points)
                .map(|index| {
                    std::array::from_fn(|stage| {
                        by_period[index][0]
                            + (taken.displacement[index][stage] - state[index][0]) / period
                    })
                })
                .collect();
            let mut right = Vec::with_capacity(3 * points);
            for index in 0..points {
                let slopes = &taken.linear.slopes[index];
                let (behind, ahead) = ((index + points - 1) % points, (index + 1) % points);
                let force: Stages = std::array::from_fn(|stage| {
                    own * moved[index][stage]
                        + slopes.ahead[stage] * moved[ahead][stage]
                        + slopes.behind[stage] * moved[behind][stage]
                });
                for stage in 0..3 {
                    right.push(
                        by_period[index][1]
                            + (taken.rate[index][stage] - state[index][1]) / period
                            + step * dot(&radau, stage, &force),
                    );
                }
            }
            taken.factors.solve(&mut right, 1);
            for (index, rate) in right.chunks_exact(3).enumerate() {
                by_period[index] = [
                    moved[index][2] + step * dot(&radau, 2, &[rate[0], rate[1], rate[2]]),
                    rate[2],
                ];
            }
            state = taken.end();
            steps.push(taken.linear);
        }
        Ok(Flow {
            end: state,
            by_period,
            steps,
        })
    }
}

/// Largest magnitude; infinite if something is not a number.
pub(super) fn size_of(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| {
        if value.is_nan() {
            f64::INFINITY
        } else {
            f64::max(largest, value.abs())
        }
    })
}

/// Σ_r A_sr x_r.
pub(super) fn dot(radau: &Block, stage: usize, x: &Stages) -> f64 {
    radau[(stage, 0)] * x[0] + radau[(stage, 1)] * x[1] + radau[(stage, 2)] * x[2]
}
