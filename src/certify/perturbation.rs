//! Where an eigenvalue crosses the imaginary axis: the equations of the wave and of an eigenfunction.
//!
//! The eigenfunction problem is that of [`crate::stability::characteristic`] at λ = iω. With ζ = e^{−λs}η and
//! υ = e^{−λs}u the condition of a Bloch sector, e^{−λT}η(T) = e^{2πij/k}η(0), has no exponential:
//! ζ(T) = e^{2πij/k}ζ(0). Unknowns are ω and (ζ, e^{−λs}η′, υ, e^{−λs}u′) at the beginning of every step; ζ = 1 at
//! the first. Where all equations have a regular zero, iω is a simple eigenvalue, and it crosses the axis
//! with a speed along the branch that is not zero: with G(s, λ) = 0 for the eigenvalue, (G_s, iG_λ) are
//! independent over the real numbers exactly if Re dλ/ds ≠ 0.

use super::flow::{DEGREE, Flow, GAP_RATE, W, Y, geometric};
use super::frame::Frame;
use super::system::{Condition, EXCESS, Evaluated, PARAMETER, SLOTS, System, TIME};
use crate::interval::{Gradient, Interval, Number, PI};
use crate::linalg::{Factors, Matrix, Vector};
use crate::model::signature::{Entry, Regime};

/// Slots beyond those of the wave: ω, and real and imaginary parts of a perturbation.
const OMEGA: usize = SLOTS;
const MODES: usize = 8;
const ALL: usize = SLOTS + 1 + MODES;
type Mixed = Gradient<Interval, ALL>;

/// Index of ζ, e^{−λs}η′, υ, e^{−λs}u′.
const ETA: usize = 0;
const ETA_RATE: usize = 1;
const RADIAL: usize = 2;
const RADIAL_RATE: usize = 3;

/// A complex number.
#[derive(Clone, Copy)]
struct Complex<N> {
    re: N,
    im: N,
}

impl<N: Number> Complex<N> {
    fn real(re: N) -> Complex<N> {
        let im = N::double(0.0);
        Complex { re, im }
    }

    fn plus(self, other: Complex<N>) -> Complex<N> {
        Complex {
            re: self.re + other.re,
            im: self.im + other.im,
        }
    }

    fn times(self, other: Complex<N>) -> Complex<N> {
        if self.im.is_zero() {
            return other.by(self.re);
        }
        if self.re.is_zero() {
            return Complex {
                re: -(self.im * other.im),
                im: self.im * other.re,
            };
        }
        Complex {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }

    fn by(self, factor: N) -> Complex<N> {
        Complex {
            re: self.re * factor,
            im: self.im * factor,
        }
    }

    fn norm(&self) -> f64 {
        (Interval::point(self.re.norm()) + Interval::point(self.im.norm())).high
    }
}

type Perturbation<N> = [Complex<N>; 4];

/// The equations of a perturbation in one regime: ẋ = Ax.
struct Linear<N> {
    /// Rows of the second derivatives of η and u; `None` without u.
    tangential: [Complex<N>; 4],
    radial: Option<[Complex<N>; 4]>,
    /// ω.
    omega: N,
    weights: [f64; 4],
}

impl<N: Number> Linear<N> {
    fn new(frame: &Frame<N>, regime: Regime, omega: N, weights: [f64; 4]) -> Option<Linear<N>> {
        let one = N::double(1.0);
        let zero = N::double(0.0);
        let twice = omega.scaled(Interval::point(2.0));
        let (stress, shear) = (one - frame.ma, one - frame.mb);
        let [g, h, kappa, damping] = [frame.g, frame.h, frame.kappa, frame.damping];
        let sigma = regime.sliding();
        if sigma.is_none() && regime != Regime::Separation {
            return None;
        }
        let complex = |re: N, im: N| Complex { re, im };
        let drag = frame.friction * kappa;
        let drag = drag.scaled(Interval::point(sigma.unwrap_or(0.0)));
        // over −m_a: h − ãλ² + σfκλ and 2ãλ − σfκ + α; then −κ(u′ − λu)
        let mass = -frame.ma.recip();
        let (joined, coupled) = match sigma {
            Some(_) => (zero, zero),
            None => (kappa * omega, -kappa),
        };
        let tangential = [
            complex(h + stress * omega * omega, drag * omega),
            complex(damping - drag, stress * twice),
            complex(zero, joined),
            complex(coupled, zero),
        ];
        // over −m_b: κ(η′ − λη), g − b̃λ², 2b̃λ + α
        let radial = [
            complex(zero, -kappa * omega),
            complex(kappa, zero),
            complex(g + shear * omega * omega, zero),
            complex(damping, shear * twice),
        ];
        let radial_mass = -frame.mb.recip();
        Some(Linear {
            tangential: tangential.map(|entry| entry.by(mass)),
            radial: (sigma.is_none()).then(|| radial.map(|entry| entry.by(radial_mass))),
            omega,
            weights,
        })
    }

    /// |A|.
    fn norm(&self) -> f64 {
        let one = |at: usize, by: usize| {
            Interval::point(self.weights[at]) / Interval::point(self.weights[by])
        };
        let decay = Interval::point(self.omega.norm());
        let row = |at: usize, entries: &[Complex<N>; 4]| {
            let terms = entries.iter().enumerate();
            let terms = terms.map(|(by, entry)| one(at, by) * Interval::point(entry.norm()));
            terms.fold(decay, |sum, term| sum + term).high
        };
        let norm = row(ETA_RATE, &self.tangential).max((decay + one(ETA, ETA_RATE)).high);
        match &self.radial {
            None => norm,
            Some(radial) => norm
                .max(row(RADIAL_RATE, radial))
                .max((decay + one(RADIAL, RADIAL_RATE)).high),
        }
    }

    /// The perturbation after a time.
    fn advance(&self, start: Perturbation<N>, time: N) -> Perturbation<N> {
        let (mut sum, mut term) = (start, start);
        let count = if self.radial.is_some() { 4 } else { 2 };
        let dot = |row: &[Complex<N>; 4], x: &Perturbation<N>| {
            let products = row.iter().zip(x).take(count).map(|(a, x)| a.times(*x));
            products.fold(Complex::real(N::double(0.0)), Complex::plus)
        };
        for j in 0..DEGREE {
            let mut next = term;
            for next in &mut next[..count] {
                // −iω
                *next = Complex {
                    re: next.im * self.omega,
                    im: -next.re * self.omega,
                };
            }
            next[ETA] = next[ETA].plus(term[ETA_RATE]);
            next[ETA_RATE] = next[ETA_RATE].plus(dot(&self.tangential, &term));
            if let Some(radial) = &self.radial {
                next[RADIAL] = next[RADIAL].plus(term[RADIAL_RATE]);
                next[RADIAL_RATE] = next[RADIAL_RATE].plus(dot(radial, &term));
            }
            let share = time.scaled(Interval::ONE / Interval::point((j + 1) as f64));
            for index in 0..count {
                term[index] = next[index].by(share);
                sum[index] = sum[index].plus(term[index]);
            }
        }
        let sizes = term.iter().zip(self.weights);
        let sizes = sizes.map(|(x, weight)| Interval::point(x.norm()) * Interval::point(weight));
        let size = sizes.fold(0.0_f64, |size, x| size.max(x.high));
        let theta = Interval::point(self.norm()) * Interval::point(time.norm());
        let rest = Interval::point(size) * geometric(theta);
        for (index, sum) in sum.iter_mut().enumerate() {
            let bound = (rest / Interval::point(self.weights[index])).high;
            *sum = Complex {
                re: sum.re.widened(bound),
                im: sum.im.widened(bound),
            };
        }
        sum
    }
}

/// Real parts of a perturbation in a regime: two for each component that is there.
fn width(regime: Regime) -> usize {
    match regime {
        Regime::Separation => 8,
        Regime::Stick => 2,
        _ => 4,
    }
}

/// Radians of a perturbation in a zone of a regime, per unit of time.
pub fn radians(frame: &Frame<Interval>, flow: &Flow<Interval>, regime: Regime, omega: f64) -> f64 {
    let linear = Linear::new(frame, regime, Interval::point(omega), flow.weights());
    linear.map_or(0.0, |linear| linear.norm())
}

impl System<'_> {
    /// Sector and ω of a crossing.
    pub(super) fn crossing(&self) -> Option<(usize, f64)> {
        match self.condition {
            Condition::Crossing { sector, omega } => Some((*sector, *omega)),
            _ => None,
        }
    }

    /// First unknown of the perturbation at the beginning of a step.
    fn perturbation(&self, zone: usize, step: usize) -> usize {
        let parts = |zone: usize| width(self.near.signature.zone(zone).regime);
        let before: usize = (0..zone).map(|zone| parts(zone) * self.steps(zone)).sum();
        self.waves() + 1 + before + parts(zone) * step
    }

    /// ω and the eigenfunction next to a wave in doubles: the linear equations without those of ζ at the
    /// end of the period, and ζ = 1 at its beginning.
    pub(super) fn eigenfunction(&self, guess: &[f64]) -> Option<Vec<f64>> {
        let (_, omega) = self.crossing()?;
        let first = self.waves() + 1;
        let zones = self.near.zones.len();
        let count = self.perturbation(zones, 0) - first;
        let mut x: Vec<Interval> = guess.iter().copied().map(Interval::point).collect();
        x.push(Interval::point(omega));
        x.resize(first + count, Interval::ZERO);
        let Evaluated { jacobian, .. } = self.crossing_at(&x)?;
        let top = self.waves() - 1;
        // the equations whose unknown is ζ at the first step come last of the wave's perturbation
        let closing = self.closing_row(zones) - top;
        let rows: Vec<usize> = (0..count + 2)
            .filter(|row| *row != closing && *row != closing + 1)
            .collect();
        let matrix = Matrix::from_fn(count, count, |i, j| {
            jacobian[top + rows[i]][first + j].middle()
        });
        let mut right = Vector::zeros(count);
        right[count - 2] = -1.0;
        let factors = Factors::new(matrix);
        factors.solve(&mut right).then(|| {
            std::iter::once(omega)
                .chain(right.iter().copied())
                .collect()
        })
    }

    /// Row of the equation that ends in ζ at the beginning of the first zone.
    fn closing_row(&self, zones: usize) -> usize {
        let first = width(self.near.signature.zone(0).regime);
        self.waves() - 1 + (self.perturbation(zones, 0) - self.waves() - 1) - first
    }

    /// The equations of the wave and of an eigenfunction at λ = iω.
    pub(super) fn crossing_at(&self, x: &[Interval]) -> Option<Evaluated> {
        let (sector, _) = self.crossing()?;
        let [excess, parameter] = self.tail();
        let omega = self.waves();
        let mut evaluated = self.waves_into(x, x.len())?;
        let frame = self.frame(
            Mixed::variable(x[excess], EXCESS),
            Mixed::variable(x[parameter], PARAMETER),
        )?;
        let frequency = Mixed::variable(x[omega], OMEGA);
        let turn =
            PI * Interval::point(2.0 * sector as f64) / Interval::point(f64::from(self.mode()));
        let multiplier = Complex {
            re: Mixed::constant(turn.cos()),
            im: Mixed::constant(-turn.sin()),
        };
        let zones = self.near.zones.len();
        let mut row = self.waves() - 1;
        for zone in 0..zones {
            let regime = self.near.signature.zone(zone).regime;
            let parts = width(regime);
            let flow = self.flow(&frame, zone);
            let linear = flow
                .as_ref()
                .and_then(|flow| Linear::new(&frame, regime, frequency, flow.weights()));
            let steps = self.steps(zone);
            let share = Interval::ONE / Interval::point(steps as f64);
            for step in 0..steps {
                let mut columns = [None; ALL];
                columns[..SLOTS].copy_from_slice(&self.columns(zone, step, self.duration(zone)));
                columns[OMEGA] = Some(omega);
                let first = self.perturbation(zone, step);
                for part in 0..parts {
                    columns[OMEGA + 1 + part] = Some(first + part);
                }
                let slot = |slot: usize| match columns[slot] {
                    Some(column) => Mixed::variable(x[column], slot),
                    None => Mixed::double(0.0),
                };
                let start: Perturbation<Mixed> = std::array::from_fn(|index| Complex {
                    re: slot(OMEGA + 1 + 2 * index),
                    im: slot(OMEGA + 2 + 2 * index),
                });
                let time = slot(TIME).scaled(share);
                let mut end = match &linear {
                    Some(linear) => linear.advance(start, time),
                    // V stays what it is: ζ turns by e^{−λT}
                    None => {
                        let (cosine, sine) = (frequency * time).circular();
                        let turned = Complex {
                            re: cosine,
                            im: -sine,
                        };
                        start.map(|x| x.times(turned))
                    }
                };
                let (next, place) = if step + 1 < steps {
                    (zone, step + 1)
                } else {
                    let state = [slot(0), slot(1), slot(2), slot(3)];
                    let there = match &flow {
                        Some(flow) => flow.series(state).state(time),
                        None => [state[Y] + time, state[W], state[2], state[3]],
                    };
                    self.jump(&frame, frequency, &mut end, &there, zone);
                    if zone + 1 == zones {
                        end = end.map(|x| x.times(multiplier));
                    }
                    ((zone + 1) % zones, 0)
                };
                let target = self.perturbation(next, place);
                for part in 0..width(self.near.signature.zone(next).regime) {
                    let value = if part % 2 == 0 {
                        end[part / 2].re
                    } else {
                        end[part / 2].im
                    };
                    evaluated.add(row, value.value, columns.into_iter().zip(value.by));
                    evaluated.subtract(row, target + part, x);
                    row += 1;
                }
            }
        }
        // ζ = 1
        let first = self.perturbation(0, 0);
        for (part, value) in [(0, Interval::ONE), (1, Interval::ZERO)] {
            evaluated.subtract(row + part, first + part, x);
            evaluated.residual[row + part] = evaluated.residual[row + part] + value;
        }
        Some(evaluated)
    }

    /// What the switch at the end of a zone does to a perturbation; see the table of
    /// [`crate::stability::characteristic`].
    fn jump(
        &self,
        frame: &Frame<Mixed>,
        omega: Mixed,
        x: &mut Perturbation<Mixed>,
        end: &[Mixed; 4],
        zone: usize,
    ) {
        let zero = Complex::real(Mixed::double(0.0));
        let next = self.near.signature.zone(zone + 1);
        let zones = self.near.zones.len();
        let rate = |zone: usize, state: [Mixed; 4], component: usize| {
            let flow = self.flow(frame, zone % zones);
            flow.map_or(Mixed::double(0.0), |flow| {
                flow.derivative(state, true)[component]
            })
        };
        let landed = [end[Y], end[W], Mixed::double(0.0), Mixed::double(0.0)];
        match next.entry {
            Entry::Arrest => x[ETA_RATE] = zero,
            Entry::Release => {
                x[ETA_RATE] = zero;
                if self.sticks() {
                    // V̈⁺(h + rfκλ − ãλ²)η/h
                    let stress = Mixed::double(1.0) - frame.ma;
                    let factor = Complex {
                        re: frame.h + stress * omega * omega,
                        im: frame.static_friction * frame.kappa * omega,
                    };
                    let jump = rate(zone + 1, landed, W) * frame.h.recip();
                    x[ETA_RATE] = x[ETA].times(factor.by(jump));
                }
            }
            Entry::Reversal => {
                let ratio = rate(zone + 1, landed, W) * rate(zone, *end, W).recip();
                x[ETA_RATE] = x[ETA_RATE].by(ratio);
            }
            Entry::TakeOff => (x[RADIAL], x[RADIAL_RATE]) = (zero, zero),
            Entry::Landing | Entry::Touch => {
                let bend = rate(zone + 1, landed, W) - rate(zone, *end, W);
                let delay = x[RADIAL].by(end[GAP_RATE].recip());
                x[ETA_RATE] = x[ETA_RATE].plus(delay.by(bend));
                x[RADIAL] = zero;
                x[RADIAL_RATE] = delay.by(rate(zone + 1, landed, GAP_RATE));
            }
            Entry::ArrestedLanding | Entry::Section => {}
        }
    }
}
