//! An independent integration round one period.
//!
//! Only δ and c come from the library: release resets the whole state, V = (f(gδ + D/c) − α)/h and
//! V̇ = 1, so that the wave closes if the next release comes after 2π/(k|c|). The equations of
//! motion, with ∂/∂φ = −(1/c) d/ds along the material point, and the switching conditions are
//! written down here as they stand:
//!
//! - stick: V̇ = 1, released where Q = hV + α reaches fP, P = gδ + D/c;
//! - sliding, σ = ±1: m_a V̈ = (σfD/c − α)V̇ − hV + σfgδ until V̇ = 1 — then stick if |Q| ≤ fP for
//!   Q = hV + α, or else sliding the other way — or until P = gδ + (D/c)V̇ = 0;
//! - separation: m_b Ü = −αU̇ − gU − (D/c)V̇, m_a V̈ = −αV̇ − hV + (D/c)U̇ until U = δ.
//!
//! The classical Runge–Kutta method with 20000 steps per period; within the step in which a
//! condition is passed, bisection on the length of the step.

use brakewave::tube::wave::profile::switches;

use crate::waves::branches::{fast_in_mismatch, speed};
use crate::waves::observed;
use crate::waves::tube::{Coefficients, coefficients};

const STEPS_PER_PERIOD: f64 = 20000.0;

/// V, V̇, U − δ, U̇.
type State = [f64; 4];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Regime {
    Stick,
    Slip,
    Reverse,
    Separation,
}

struct Tube {
    tube: Coefficients,
    friction: f64,
    mismatch: f64,
    kappa: f64,
    ma: f64,
    mb: f64,
}

impl Tube {
    fn pressure(&self, rate: f64) -> f64 {
        self.tube.g * self.mismatch + self.kappa * rate
    }

    fn rates(&self, regime: Regime, [v, w, gap, rise]: State) -> State {
        let Coefficients { g, h, .. } = self.tube;
        let sliding = |sigma: f64| (sigma * self.friction * self.pressure(w) - h * v) / self.ma;
        match regime {
            Regime::Stick => [1.0, 0.0, 0.0, 0.0],
            Regime::Slip => [w, sliding(1.0), 0.0, 0.0],
            Regime::Reverse => [w, sliding(-1.0), 0.0, 0.0],
            Regime::Separation => [
                w,
                (self.kappa * rise - h * v) / self.ma,
                rise,
                -(g * (self.mismatch + gap) + self.kappa * w) / self.mb,
            ],
        }
    }

    fn step(&self, regime: Regime, state: State, length: f64) -> State {
        let moved = |rates: State, length: f64| -> State {
            std::array::from_fn(|i| state[i] + length * rates[i])
        };
        let k1 = self.rates(regime, state);
        let k2 = self.rates(regime, moved(k1, 0.5 * length));
        let k3 = self.rates(regime, moved(k2, 0.5 * length));
        let k4 = self.rates(regime, moved(k3, length));
        let mean = std::array::from_fn(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
        moved(mean, length)
    }

    /// What each condition that ends a regime leaves: negative once it is met.
    fn conditions(&self, regime: Regime, [v, w, gap, _]: State) -> [f64; 2] {
        match regime {
            Regime::Stick => [self.friction * self.pressure(1.0) - self.tube.h * v, 1.0],
            Regime::Slip => [1.0 - w, self.pressure(w)],
            Regime::Reverse => [w - 1.0, self.pressure(w)],
            Regime::Separation => [gap, 1.0],
        }
    }

    /// The regime after a switch, and the state in it.
    fn next(&self, regime: Regime, met: usize, state: State) -> (Regime, State) {
        let [v, w, ..] = state;
        match (regime, met) {
            (Regime::Stick, _) => (Regime::Slip, state),
            (Regime::Slip | Regime::Reverse, 1) => (Regime::Separation, state),
            (Regime::Slip | Regime::Reverse, _) => {
                let limit = self.friction * self.pressure(1.0);
                let force = self.tube.h * v;
                let after = if force.abs() <= limit {
                    Regime::Stick
                } else if force < 0.0 {
                    Regime::Reverse
                } else {
                    Regime::Slip
                };
                (after, [v, 1.0, 0.0, 0.0])
            }
            (Regime::Separation, _) => {
                let after = if w < 1.0 {
                    Regime::Slip
                } else {
                    Regime::Reverse
                };
                (after, [v, w, 0.0, 0.0])
            }
        }
    }

    /// From release until the next one: regimes and the times of their ends.
    fn round(&self, period: f64) -> (Vec<Regime>, Vec<f64>) {
        let length = period / STEPS_PER_PERIOD;
        let release = self.friction * self.pressure(1.0) / self.tube.h;
        let (mut regime, mut state) = (Regime::Slip, [release, 1.0, 0.0, 0.0]);
        let (mut regimes, mut ends) = (vec![regime], Vec::new());
        let mut time = 0.0;
        // a condition that holds with equality at the entry is watched once it is positive
        let mut armed = [false; 2];
        while time < 1.5 * period {
            let after = self.step(regime, state, length);
            let conditions = self.conditions(regime, after);
            let Some(met) = (0..2).find(|&i| armed[i] && conditions[i] <= 0.0) else {
                for (armed, condition) in armed.iter_mut().zip(conditions) {
                    *armed |= condition > 0.0;
                }
                state = after;
                time += length;
                continue;
            };
            let (mut low, mut high) = (0.0, length);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if self.conditions(regime, self.step(regime, state, middle))[met] > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            state = self.step(regime, state, high);
            time += high;
            ends.push(time);
            if regime == Regime::Stick {
                return (regimes, ends);
            }
            (regime, state) = self.next(regime, met, state);
            regimes.push(regime);
            armed = [false; 2];
        }
        panic!("no release after {regimes:?}");
    }
}

/// The method's error is of order (rate · period/20000)⁴ ≈ (30 · 1.25/20000)⁴ ≈ 1e-11 and rounding
/// of 20000 steps 1e-13 or so; both well below 1e-9.
#[test]
fn an_integration_closes_after_one_period() {
    const ALLOWED: f64 = 1e-9;
    let values = [0.2, 0.08, 0.045, 0.02, 0.004, 0.001];
    let run = fast_in_mismatch().follow(&values[1..]);
    for value in values {
        let found = if value == 0.2 {
            &run.points[0]
        } else {
            run.user_points(value)[0]
        };
        let numbers = coefficients(0.3, 1.5, 1.0);
        let c = speed(found);
        let tube = Tube {
            tube: numbers,
            friction: 0.5,
            mismatch: found.parameter,
            kappa: numbers.coupling / c,
            ma: 1.0 - numbers.a / (c * c),
            mb: 1.0 - numbers.b / (c * c),
        };
        let period = std::f64::consts::FRAC_PI_2 / c.abs();
        let (regimes, ends) = tube.round(period);
        let names: Vec<String> = regimes
            .iter()
            .map(|regime| format!("{regime:?}").to_lowercase())
            .collect();
        assert_eq!(names.join("-"), found.orbit.signature.to_string());
        let thetas = switches(&found.orbit, &found.node.point);
        let mut worst: f64 = (ends[ends.len() - 1] / period - 1.0).abs();
        for (end, theta) in ends.iter().zip(&thetas) {
            worst = worst.max((end * c.abs() - theta).abs());
        }
        observed(&format!("integration at δ = {value}, switches"), worst);
        assert!(worst < ALLOWED);
    }
}
