//! Where an orbit that never switches shrinks to an equilibrium: the parameter at which a pair of its eigenvalues is
//! imaginary.
//!
//! An orbit of amplitude a is off by a² there, and its equations are singular to a: the equilibrium's own are not.

use std::f64::consts::TAU;

use super::layout::{AffineOrbit, ZonePoint};
use crate::continuation::zero::{Bracket, zero};
use crate::linalg::Vector;

/// An equilibrium with a pair of eigenvalues.
struct Pair {
    state: Vec<f64>,
    /// Real part, and the size of the eigenvalues.
    growth: f64,
    size: f64,
    frequency: f64,
}

impl AffineOrbit {
    /// The Hopf point next to an orbit that is nearly one, as an orbit of no size, and the error of the parameter there.
    pub(super) fn hopf(&self, point: &Vector) -> Option<(Vector, f64)> {
        /// Parts of the range to either side within which it is looked for.
        const NEAR: [f64; 4] = [1e-8, 1e-6, 1e-4, 1e-2];
        let at = self.at(point).ok()?;
        let ZonePoint {
            state, duration, ..
        } = at.zones.first()?;
        let (setting, frequency) = (&self.setting, TAU / duration);
        let mode = self.sequence.zone(0).mode;
        let pair = |value: f64| -> Option<Pair> {
            let system = setting.system.at(&setting.values_at(value), &[]).ok()?;
            let rest = system.equilibrium_near(mode, state)?;
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
        };
        let (middle, unit) = (self.parameter_at(point), setting.scales.parameter.abs());
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
            let Pair {
                state,
                size,
                frequency,
                ..
            } = found.found;
            let slope = (high - low).abs() / (ends[1] - ends[0]);
            let zone = ZonePoint {
                state,
                duration: TAU / frequency,
                phase: 0.0,
            };
            let error = 2.0 * rounding(size) / slope + width;
            Some((self.pack(&[zone], found.place), error))
        })
    }
}
