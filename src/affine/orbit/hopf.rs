//! Where an orbit shrinks to an equilibrium: the parameter at which a pair of its eigenvalues is imaginary.
//!
//! An orbit of amplitude a is off by a² there, and its equations are singular to a: the equilibrium's own are not.
//! An orbit that switches may pass such a point where the switches make no difference: all of its modes have one
//! equilibrium there, with the same derivatives, and no reset moves a state. The branch then goes through it, and the
//! orbit beyond is the one before, begun half a turn later.

use std::f64::consts::TAU;

use super::examine::Examination;
use super::layout::{AffineOrbit, ZonePoint};

use super::signature::exit_of;
use super::{Critical, OrbitTermination};
use crate::affine::mode::Exit;
use crate::continuation::Node;
use crate::continuation::locate::node_at;
use crate::continuation::walk::Segment;
use crate::continuation::zero::{Bracket, zero};
use crate::linalg::{Matrix, Vector};
use crate::orbit::EndWithin;

/// An equilibrium with a pair of eigenvalues.
struct Pair {
    state: Vec<f64>,
    /// Real part, and the size of the eigenvalues.
    growth: f64,
    size: f64,
    frequency: f64,
}

/// An equilibrium with a pair of imaginary eigenvalues.
pub(super) struct HopfPoint {
    /// The parameter there, and its error.
    pub parameter: f64,
    pub error: f64,
    state: Vec<f64>,
    frequency: f64,
}

impl AffineOrbit {
    /// The equilibrium of the first mode next to a state, and that of its pairs of eigenvalues which turns most nearly with
    /// a frequency.
    fn pair(&self, values: &[f64], state: &[f64], frequency: f64) -> Option<Pair> {
        let system = self.setting.system.at(values, &[]).ok()?;
        let rest = system.equilibrium_near(self.sequence.zone(0).mode, state)?;
        let size = rest.eigenvalues.iter().map(|one| one.norm());
        let size = size.fold(0.0, f64::max);
        let off = |one: f64| (one - frequency).abs();
        let nearest = rest.eigenvalues.iter();
        let nearest = nearest.min_by(|one, other| off(one.im).total_cmp(&off(other.im)))?;
        Some(Pair {
            growth: nearest.re,
            frequency: nearest.im,
            size,
            state: rest.state,
        })
    }

    /// Whether an orbit that is a point has a pair of imaginary eigenvalues of its own frequency.
    pub(super) fn is_hopf(&self, point: &Vector) -> bool {
        /// Real part and frequency may be off by this part of the eigenvalues: by a multiple of the square of the size,
        /// which is a millionth at most. Eigenvalues of another kind are off by all that they are.
        const NEARLY: f64 = 1e-2;
        let pair = || {
            let at = self.at(point).ok()?;
            let ZonePoint { state, .. } = at.zones.first()?;
            let frequency = TAU / at.period();
            let pair = self.pair(&self.values_at(point), state, frequency)?;
            Some(pair.growth.abs().max((pair.frequency - frequency).abs()) <= NEARLY * pair.size)
        };
        pair().unwrap_or(false)
    }

    /// The Hopf point of the first mode next to an orbit, with its frequency and what is free of the parameters as it is.
    pub(super) fn hopf_point(&self, point: &Vector) -> Option<HopfPoint> {
        /// Parts of the range to either side within which it is looked for: an equilibrium solves the equations of an orbit at any value,
        /// and a step may have come to one a little way off.
        const NEAR: [f64; 5] = [1e-8, 1e-6, 1e-4, 1e-2, 1e-1];
        /// The pair has the frequency of the orbit to this part.
        const ALIKE: f64 = 0.1;
        /// Values beside it at which the growth is compared with a straight line, and how many roundings they are apart.
        const SAMPLES: i32 = 4;
        const APART: f64 = 64.0;
        let at = self.at(point).ok()?;
        let state = &at.zones.first()?.state;
        let frequency = TAU / at.period();
        let (mut values, middle) = (self.values_at(point), self.parameter_at(point));
        let mut pair = |value: f64| {
            values[self.setting.parameter] = value;
            self.pair(&values, state, frequency)
        };
        let unit = self.setting.scales.parameter.abs();
        NEAR.into_iter().find_map(|near| {
            let ends = [middle - near * unit, middle + near * unit];
            let [low, high] = ends.map(|value| pair(value).map(|pair| pair.growth));
            let (low, high) = (low?, high?);
            if low * high >= 0.0 {
                return None;
            }
            // eigenvalues have the rounding of the matrix
            let rounding = |size: f64| 8.0 * f64::EPSILON * self.states() as f64 * size;
            let growth = |value: f64| {
                let pair = pair(value).ok_or(())?;
                let vanishes = pair.growth.abs() <= rounding(pair.size);
                Ok::<_, ()>((if vanishes { 0.0 } else { pair.growth }, pair))
            };
            let bracket = Bracket::new((ends[0], low), (ends[1], high));
            let width = 4.0 * f64::EPSILON * middle.abs();
            let found = zero(bracket, width, growth).ok()?;
            let (parameter, here) = (found.place, found.found);
            if (here.frequency / frequency - 1.0).abs() > ALIKE {
                return None;
            }
            let slope = (high - low) / (ends[1] - ends[0]);
            // what of the growth is not a straight line so near is rounding
            let samples = (-SAMPLES..=SAMPLES).map(|sample| {
                let off = f64::from(sample) * APART * f64::EPSILON * unit.max(parameter.abs());
                let there = pair(parameter + off)?.growth;
                Some((there - here.growth - slope * off).abs())
            });
            let noise = samples.sum::<Option<f64>>()? / f64::from(SAMPLES);
            Some(HopfPoint {
                parameter,
                error: (2.0 * rounding(here.size) + noise) / slope.abs() + width,
                state: here.state,
                frequency: here.frequency,
            })
        })
    }

    /// The Hopf point next to an orbit that never switches and is nearly one, as an orbit of no size, and the error of the
    /// parameter there.
    pub(super) fn hopf(&self, point: &Vector) -> Option<(Vector, f64)> {
        if !self.has_own_period() {
            return None;
        }
        let hopf = self.hopf_point(point)?;
        let zone = ZonePoint::new(hopf.state, TAU / hopf.frequency, 0.0);
        Some((
            self.pack(&[zone], &self.setting.values_at(hopf.parameter)),
            hopf.error,
        ))
    }

    /// The Hopf point next to a small orbit that switches where its switches make no difference.
    pub(super) fn smooth_hopf(&self, point: &Vector) -> Option<HopfPoint> {
        if !self.has_own_period() || self.sequence.switches() == 0 {
            return None;
        }
        let hopf = self.hopf_point(point)?;
        self.is_smooth_at(&hopf)?.then_some(hopf)
    }

    /// Whether a small orbit that switches has a Hopf point next to it where its switches make no difference.
    pub fn is_smooth_near(&self, point: &Vector) -> bool {
        self.smooth_hopf(point).is_some()
    }

    /// Whether all modes of the orbit have one equilibrium at a point, with the same derivatives, and no reset moves a
    /// state.
    fn is_smooth_at(&self, point: &HopfPoint) -> Option<bool> {
        /// States in their units, and derivatives in those of the largest, are the same to this: equilibria and derivatives
        /// of formulas that are not the same to the letter differ by some roundings.
        const SAME: f64 = 1e-10;
        let setting = &self.setting;
        let system = setting.system.at(&setting.values_at(point.parameter), &[]);
        let (system, units) = (system.ok()?, &setting.scales.states);
        let n = self.states();
        let scaled = |slopes: &Matrix| {
            Matrix::from_fn(n, n, |row, column| {
                slopes[(row, column)] * units[column] / units[row]
            })
        };
        let near =
            |zone: usize| system.equilibrium_near(self.sequence.zone(zone).mode, &point.state);
        let first = scaled(&near(0)?.slopes);
        let smooth = |zone: usize| {
            let Some(own) = near(zone) else { return false };
            let mut off = own.state.iter().zip(&point.state).zip(units);
            let at_one_place = off.all(|((own, here), unit)| (own - here).abs() <= SAME * unit);
            let alike = (scaled(&own.slopes) - &first).amax() <= SAME * first.amax();
            let exit = exit_of(&system, &self.sequence, zone);
            let stays = exit.is_none_or(Exit::is_continuous);
            at_one_place && alike && stays
        };
        Some((0..self.zones()).all(smooth))
    }

    /// Where an orbit that switches shrinks to an equilibrium within a step; `None` where it does not.
    pub(super) fn shrinks_within(
        &self,
        step: &Segment<Examination>,
    ) -> Option<EndWithin<AffineOrbit>> {
        /// Beyond the point everything is on its other side: the rates at the first entry have turned round, to this cosine.
        const TURNED: f64 = -0.9;
        /// An orbit that sets out as far from its equilibrium as this, in units of its states, has no fold on the way left
        /// that a shorter step would show.
        const SMALL: f64 = 1e-3;
        /// How near the point an orbit is found that tells what it is: its multipliers are off by that, squared, and by
        /// rounding divided by it.
        const BESIDE: f64 = 1e-5;
        /// An orbit without switches of which a step leaves no more than this part has become an equilibrium, which solves its
        /// equations with any period: the step has left the branch. One that shrinks to a Hopf point is as large beyond it.
        const COLLAPSED: f64 = 1e-6;
        if !self.has_own_period() {
            return None;
        }
        let (units, from) = (&self.setting.scales.states, step.from);
        let (one, other) = (&step.before.rate, &step.after.rate);
        let (before, after) = (one.norm(), other.norm());
        if self.sequence.switches() == 0 {
            return (after < COLLAPSED * before).then_some(EndWithin::Far);
        }
        if one.dot(other) >= TURNED * before * after {
            return None;
        }
        let hopf = self.smooth_hopf(&from.point)?;
        // the orbit is as far from its own equilibrium as its rate says
        let rest = |point: &Vector| {
            let at = self.at(point).ok()?;
            let values = self.values_at(point);
            Some(
                self.pair(&values, &at.zones[0].state, hopf.frequency)?
                    .state,
            )
        };
        let off = |point: &Vector, rest: &[f64]| {
            let at = self.at(point).ok()?;
            let pairs = at.zones[0].state.iter().zip(rest).zip(units);
            let off = pairs.map(|((x, rest), unit)| (x - rest).abs() / unit);
            Some(off.fold(0.0, f64::max))
        };
        let size = off(&from.point, &rest(&from.point)?)?;
        // the parameter is even in the size: it goes to the point at half its slope
        let last = from.point.len() - 1;
        let s = step.ds * before / (before + after);
        let left = hopf.parameter / self.setting.scales.parameter - from.point[last];
        let expected = 0.5 * from.tangent[last] * s;
        let comes = left * expected > 0.0 && left / expected < 2.0 && expected / left < 2.0;
        if size > SMALL || !comes && size > BESIDE {
            return Some(EndWithin::Far);
        }
        let nearer = (size > BESIDE)
            .then(|| node_at(self, from, s * (1.0 - BESIDE / size), step.steps.tolerance))
            .flatten();
        let node = nearer.unwrap_or_else(|| from.clone());
        let rest = rest(&node.point)?;
        let size = off(&node.point, &rest)?;
        Some(EndWithin::At {
            s,
            node: Box::new(Node {
                point: self.shrunk_to(&hopf, &node.point, &rest, size)?,
                ..node
            }),
            special: Critical::Shrinking,
            stop: OrbitTermination::Shrinks,
            uncertainty: hopf.error,
        })
    }

    /// The orbit that stands for a Hopf point: as one of this size about its equilibrium is, but tiny.
    fn shrunk_to(
        &self,
        hopf: &HopfPoint,
        point: &Vector,
        rest: &[f64],
        size: f64,
    ) -> Option<Vector> {
        /// How large it is.
        const TINY: f64 = 1e-8;
        let at = self.at(point).ok()?;
        let period = at.period();
        let zones = at.zones.iter().map(|zone| {
            let places = zone.state.iter().zip(rest).zip(&hopf.state);
            let places = places.map(|((x, rest), here)| here + (x - rest) * TINY / size);
            let duration = zone.duration / period * (TAU / hopf.frequency);
            ZonePoint::new(places.collect(), duration, 0.0)
        });
        let zones: Vec<ZonePoint> = zones.collect();
        Some(self.pack(&zones, &self.setting.values_at(hopf.parameter)))
    }
}
