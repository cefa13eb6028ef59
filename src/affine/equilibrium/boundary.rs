//! Guesses of the cycles that grow from a boundary equilibrium in proportion to the parameter's distance.
//!
//! At x₀, p₀ a guard g of the mode is zero; of a mode that keeps a surface, g is the guard of the mode beyond that is zero all along in it.
//! At p₀ + δ motions of two states set out from x₀ + s|δx′|∇g/|∇g|, x′ = dx/dp along the equilibria: on a ray from the boundary
//! into the mode, with lengths and ∇g in the units of the states that make ∂f/∂x of the mode balanced. Where they enter the mode
//! for the first and the second time, q along the boundary, |q₂| − |q₁| changes its sign at a cycle. Of a system of linear parts q/δ at a cycle does not depend on δ; of any other hardly, where the cycle is one that
//! grows from the equilibrium.

use super::curve::EquilibriumCurve;
use super::cycle::{CycleGuess, NoCycle};
use super::field::{Linear, Linearised};
use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Moment, Motion, Step};
use crate::continuation::Node;
use crate::linalg::{Vector, balance};

/// Distances of the parameter that are tried, as parts of its range: where the field bends, cycles are proportional to those
/// that are small enough.
const DISTANCES: [f64; 3] = [1e-3, 1e-4, 1e-5];

/// The distance beside each of them at which the cycle must be as large in proportion, and by how much it may differ.
const NEARER: f64 = 0.25;
const PROPORTIONAL: f64 = 0.1;

/// Starts on the ray: s from the first to the last, in equal ratios. A cycle is hardly ever larger than thousands of times the way of
/// its equilibrium.
const STARTS: (f64, f64, usize) = (1e-2, 1e4, 60);

/// Motions are given up after so many units of time in that of the eigenvalues: the slowest spirals of use turn in a hundred.
const LONGEST: f64 = 500.0;

/// A difference of two entries below this part of their distance is rounding.
const ROUNDED: f64 = 1e-9;

/// Bisections of s: down to a rounding of it.
const BISECTIONS: usize = 50;

/// Two entries of a mode one after the other.
struct Returned {
    /// The first of them.
    place: Moment,
    /// Both along the boundary.
    along: [f64; 2],
    /// The time between them.
    time: f64,
}

impl Returned {
    /// The sign of what the motion gains along the boundary; none where rounding decides.
    fn gain(&self) -> Option<f64> {
        let [first, second] = self.along;
        let gain = second.abs() - first.abs();
        (gain.abs() > ROUNDED * first.abs()).then_some(gain)
    }
}

/// A boundary equilibrium of two states, with the parameter at a distance from it.
struct Boundary<'a> {
    system: &'a AffineSystem,
    mode: usize,
    /// The equilibrium.
    place: [f64; 2],
    /// Units of the states.
    units: [f64; 2],
    /// ∇g/|∇g|, into the mode, in these units.
    normal: [f64; 2],
    /// |δx′| in these units.
    reach: f64,
    /// When motions are given up.
    until: f64,
}

impl Boundary<'_> {
    /// The motion from the ray at s, to its second entry of the mode.
    fn returned(&self, s: f64) -> Option<Returned> {
        let [n, m] = self.normal;
        let way = s * self.reach;
        let on_ray = |i: usize| self.place[i] + way * self.normal[i] * self.units[i];
        let state = vec![on_ray(0), on_ray(1)];
        let start = Moment {
            time: 0.0,
            phase: 0.0,
            mode: self.mode,
            state,
        };
        let mut motion = Motion::new(self.system, start, self.until);
        let first = self.entry(&mut motion)?;
        let second = self.entry(&mut motion)?;
        let along = |place: &Moment| {
            let [x, y] = [0, 1].map(|i| (place.state[i] - self.place[i]) / self.units[i]);
            n * y - m * x
        };
        Some(Returned {
            along: [along(&first), along(&second)],
            time: second.time - first.time,
            place: first,
        })
    }

    /// The next entry of the mode from another one.
    fn entry(&self, motion: &mut Motion) -> Option<Moment> {
        loop {
            match motion.step(self.until).ok()? {
                Step::Switched(switching) if switching.to == self.mode => {
                    return Some(motion.place().clone());
                }
                Step::Switched(_) => {}
                Step::Reached | Step::Section => return None,
            }
        }
    }

    /// The cycles, the smallest first.
    fn cycles(&self) -> Vec<Returned> {
        let (low, high, count) = STARTS;
        let ratio = (high / low).powf(1.0 / count as f64);
        let starts = (0..=count).map(|index| low * ratio.powf(index as f64));
        let gain = |s: f64| self.returned(s).and_then(|returned| returned.gain());
        let mut seen: Vec<(f64, Option<f64>)> = Vec::with_capacity(count + 1);
        let mut found = Vec::new();
        for s in starts {
            let returned = self.returned(s);
            let gain = returned.as_ref().and_then(Returned::gain);
            seen.push((s, gain));
            // motions that slide leave where the first did: they are on the cycle at once
            let slides = returned.filter(|_| gain.is_none() && found.is_empty());
            found.extend(slides);
        }
        let cycle = |pair: &[(f64, Option<f64>)]| {
            let [(mut low, below), (mut high, above)] = [pair[0], pair[1]];
            let (below, above) = (below?, above?);
            if below * above > 0.0 {
                return None;
            }
            for _ in 0..BISECTIONS {
                let middle = (low * high).sqrt();
                match gain(middle) {
                    Some(gain) if gain * below > 0.0 => low = middle,
                    Some(_) => high = middle,
                    None => return self.returned(middle),
                }
            }
            self.returned((low * high).sqrt())
        };
        found.extend(seen.windows(2).filter_map(cycle));
        found
    }
}

impl EquilibriumCurve {
    /// The mode at a boundary, with the gradient of what is positive in it: the own one, or the one beyond where it keeps a surface.
    fn beside(
        &self,
        (point, at): (&Vector, &Linearised),
        guard: usize,
    ) -> Option<(usize, [f64; 2])> {
        let own = self.signature.mode;
        let gradient = |linear: &Linear| [linear.by[0], linear.by[1]];
        if at.surfaces.is_empty() {
            return Some((own, gradient(&at.guards[guard])));
        }
        // the guard of the mode beyond that is zero all along in this one
        let mut exits = self.lifted.modes[own].guards[guard].exits.iter();
        let (mode, opens) = exits.find_map(|exit| Some((exit.to, exit.tangent?.0)))?;
        let beyond = self.in_mode(mode)?.linearised(point).ok()?;
        Some((mode, gradient(beyond.guards.get(opens)?)))
    }

    /// The guard that is zero at a boundary equilibrium.
    fn vanished(&self, point: &Vector) -> Option<usize> {
        /// A guard at a located event is zero but for rounding.
        const VANISHED: f64 = 1e-9;
        let examination = self.examined(point).ok()?;
        let guards = examination.margins.iter();
        let least = guards.min_by(|one, other| one.value.abs().total_cmp(&other.value.abs()))?;
        (least.value.abs() < VANISHED).then_some(least.guard)
    }

    /// Guesses of cycles next to a boundary equilibrium, whose size is in proportion to the distance of the parameter.
    ///
    /// # Errors
    /// It is none of two states, or none grows from it.
    pub fn boundary_cycles(&self, point: &Vector) -> Result<Vec<CycleGuess>, NoCycle> {
        let at = self.linearised(point).map_err(|_| NoCycle::NoBoundary)?;
        if self.states() != 2 {
            return Err(NoCycle::NotPlanar);
        }
        let guard = self.vanished(point).ok_or(NoCycle::NoBoundary)?;
        let (mode, gradient) = self
            .beside((point, &at), guard)
            .ok_or(NoCycle::NoBoundary)?;
        let beyond = self.in_mode(mode).ok_or(NoCycle::NoBoundary)?;
        let slopes = beyond.linearised(point).map_err(|_| NoCycle::NoBoundary)?;
        let (balanced, _) = balance(&slopes.slopes(), 0.0);
        let balanced = [balanced[0], balanced[1]];
        let units = &self.setting.scales.units;
        let tangent = Node::on(self, point.clone())
            .ok_or(NoCycle::NoBoundary)?
            .tangent;
        let drift = |i: usize| tangent[i] * units[i] / (tangent[2] * units[2] * balanced[i]);
        let speed = drift(0).hypot(drift(1));
        let gradient = [0, 1].map(|i| gradient[i] * balanced[i]);
        let normal = gradient.map(|by| by / gradient[0].hypot(gradient[1]));
        let place = self.place(point);
        let mut guesses = Vec::new();
        for distance in DISTANCES {
            for side in [1.0, -1.0] {
                let cycles = |part: f64| {
                    let shift = side * distance * part * units[2];
                    let mut values = self.values_at(point);
                    values[self.setting.parameter] += shift;
                    let system = self.setting.system.at(&values, &[]);
                    let found = system.map(|system| {
                        let boundary = Boundary {
                            system: &system,
                            mode,
                            place: [place[0], place[1]],
                            units: balanced,
                            normal,
                            reach: (speed * shift).abs(),
                            until: LONGEST / self.setting.scales.rate,
                        };
                        boundary.cycles()
                    });
                    (shift, found.unwrap_or_default())
                };
                let (shift, own) = cycles(1.0);
                if own.is_empty() {
                    continue;
                }
                let (_, nearer) = cycles(NEARER);
                let proportional = own.into_iter().filter(|one| {
                    let alike = |other: &Returned| {
                        let part = other.along[0] / (NEARER * one.along[0]);
                        (part - 1.0).abs() <= PROPORTIONAL
                    };
                    nearer.iter().any(alike)
                });
                guesses.extend(proportional.map(|returned| CycleGuess {
                    mode,
                    value: place[2] + shift,
                    state: returned.place.state,
                    period: returned.time,
                    ranges: None,
                    up: shift > 0.0,
                }));
            }
            if !guesses.is_empty() {
                return Ok(guesses);
            }
        }
        Err(NoCycle::NoneGrows)
    }
}
