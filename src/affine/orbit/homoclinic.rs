//! The homoclinic orbit that a branch comes to: where what leaves a saddle along its growing direction returns to it, or
//! comes to the next one, in a cycle of such connections.
//!
//! In a linear mode the way out is straight up to the guard, and what comes back along the decaying directions has
//! nothing of the growing one. Of other modes both hold near the saddle: the way out begins there, and what comes back is
//! followed until it is there. No long stay is followed, so that the parameter has all digits that the stay has taken.

use super::ends::Stay;
use super::layout::AffineOrbit;
use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Motion, Place, Step};
use crate::affine::steady::Equilibrium;
use crate::linalg::{Least, Matrix, Vector, least};

/// Secants at most.
const SECANTS: usize = 40;

/// The first of them, in units of the parameter.
const FIRST: f64 = 1e-6;

/// A root is found where secants come down to this part of the unit.
const FOUND: f64 = 1e-10;

/// The way from saddle to saddle may last so many units of time.
const LONGEST: f64 = 10.0;

/// How near the saddle a way out begins whose mode is not linear, in units of the states. It is off by the square of
/// that, which decays until it has grown to order one.
const BEGINS: f64 = 1e-6;

/// How near what comes back is looked at, one after the other: beyond the error of the parameter there it would leave
/// again before. What is left out is the square of the distance, with the decay until there.
const NEAR: [f64; 3] = [1e-2, 1e-4, 1e-6];

/// A saddle with one growing direction.
struct Saddle {
    state: Vector,
    /// Along the growing direction, of length one in units of the states.
    right: Vector,
    /// What of a state is along it.
    left: Vector,
    growth: f64,
    /// Of the slowest decay.
    decay: f64,
}

impl Saddle {
    fn new(equilibrium: Equilibrium, units: &[f64]) -> Option<Saddle> {
        let [growing, next, ..] = equilibrium.eigenvalues[..] else {
            return None;
        };
        if growing.re <= 0.0 || growing.im != 0.0 || next.re >= 0.0 {
            return None;
        }
        let n = units.len();
        let own = equilibrium.slopes - Matrix::identity(n, n) * growing.re;
        let Least {
            mut left,
            mut right,
            ..
        } = least(&own)?;
        let sizes = right.iter().zip(units).map(|(x, unit)| (x / unit).abs());
        right /= sizes.fold(0.0, f64::max);
        left /= left.dot(&right);
        // neither turns round from one value of the parameter to the next
        if right[right.iamax()] < 0.0 {
            right.neg_mut();
            left.neg_mut();
        }
        Some(Saddle {
            state: Vector::from_vec(equilibrium.state),
            right,
            left,
            growth: growing.re,
            decay: -next.re,
        })
    }
}

impl AffineOrbit {
    /// The parameter at which an orbit leaves the saddle of one stay and comes to that of the next, near a value where
    /// it does nearly so.
    pub(super) fn connection(&self, stays: [&Stay; 2], value: f64) -> Option<f64> {
        let along =
            |value, near: &f64| self.secants(value, |value| self.comes(stays, value, *near));
        NEAR.iter().try_fold(value, along)
    }

    /// The zero of a function of the parameter next to a value.
    fn secants(&self, value: f64, function: impl Fn(f64) -> Option<f64>) -> Option<f64> {
        let unit = self.setting.scales.parameter;
        let (mut before, mut here) = (value, value + FIRST * unit);
        let mut known = function(before)?;
        for _ in 0..SECANTS {
            let off = function(here)?;
            if off == 0.0 {
                return Some(here);
            }
            let step = off * (here - before) / (off - known);
            if !step.is_finite() {
                return None;
            }
            (before, known) = (here, off);
            here -= step;
            // the error that is left is that of the step before times this one
            if step.abs() <= FOUND * unit {
                return Some(here);
            }
        }
        None
    }

    /// How much of the growing direction of the second saddle is in what leaves the first and comes there.
    fn comes(&self, [from, to]: [&Stay; 2], value: f64, near: f64) -> Option<f64> {
        let values = self.setting.values_at(value);
        let system = self.setting.system.at(&values, &[]).ok()?;
        let number = |stay: &Stay| self.sequence.zone(stay.zone).mode;
        let saddle = |stay: &Stay| {
            let equilibrium = system.equilibrium_near(number(stay), &stay.rest)?;
            Saddle::new(equilibrium, &self.setting.scales.states)
        };
        let mut motion = self.way_out(&system, from.zone, &saddle(from)?)?;
        let to_zone = if to.zone > from.zone {
            to.zone
        } else {
            to.zone + self.zones()
        };
        for zone in from.zone + 1..to_zone {
            self.takes(&mut motion, zone, 0.0)?;
        }
        let saddle = saddle(to)?;
        let is_linear = system.modes[number(to)].field.is_exact;
        let time = if is_linear {
            0.0
        } else {
            -near.ln() / saddle.decay
        };
        let until = motion.place().time + time;
        if !is_linear && !matches!(motion.step(until).ok()?, Step::Reached) {
            return None;
        }
        let back = Vector::from_column_slice(&motion.place().state) - &saddle.state;
        // as much as it had of it when it came
        Some(saddle.left.dot(&back) * (-saddle.growth * time).exp())
    }

    /// What leaves a saddle along its growing direction, just after the switch that ends its zone.
    fn way_out<'a>(
        &self,
        system: &'a AffineSystem,
        zone: usize,
        saddle: &Saddle,
    ) -> Option<Motion<'a>> {
        let n = self.states();
        let longest = self.setting.scales.time;
        let number = self.sequence.zone(zone).mode;
        let mode = system.modes.get(number)?;
        let begins = |mode, state: Vec<f64>| {
            let place = Place {
                time: 0.0,
                phase: 0.0,
                mode,
                state,
            };
            Motion::new(system, place, longest)
        };
        if mode.field.is_exact {
            let way = self.sequence.zone(zone).way?;
            let guard = mode.guards.get(way.guard)?;
            let mut z = system.lift(number, saddle.state.as_slice(), 0.0);
            let reach = -guard.row.at.dot(&z) / guard.row.at.rows(0, n).dot(&saddle.right);
            z.rows_mut(0, n).axpy(reach, &saddle.right, 1.0);
            let reset = &guard.exits.get(way.exit)?.reset.at;
            let state = (reset * z).iter().copied().collect();
            return Some(begins(self.sequence.zone(zone + 1).mode, state));
        }
        [BEGINS, -BEGINS].into_iter().find_map(|off| {
            let state = &saddle.state + &saddle.right * off;
            let mut motion = begins(number, state.iter().copied().collect());
            self.takes(&mut motion, zone, -BEGINS.ln() / saddle.growth)?;
            Some(motion)
        })
    }

    /// Follows a motion through a zone of the orbit, which may last so much more; `None` where it does not end as that
    /// does.
    fn takes(&self, motion: &mut Motion, zone: usize, more: f64) -> Option<()> {
        let until = motion.place().time + LONGEST * self.setting.scales.time + more;
        let Step::Switched(switching) = motion.step(until).ok()? else {
            return None;
        };
        let way = self.sequence.zone(zone).way?;
        let next = self.sequence.zone(zone + 1).mode;
        let taken = (switching.guard, switching.exit, switching.to);
        (taken == (way.guard, way.exit, next)).then_some(())
    }
}

#[cfg(test)]
mod tests {
    use crate::affine::orbit::AffineOrbit;
    use crate::affine::orbit::ends::Stay;
    use crate::affine::orbit::start::{Beginning, Search, Wanted, first};
    use crate::affine::system::{Source, System};
    use ron::extensions::Extensions;

    /// The orbit that a motion settles on, or the one next to its beginning.
    fn orbit(
        text: &str,
        parameter: &str,
        (mode, state): (&str, &[f64]),
        search: Search,
    ) -> AffineOrbit {
        #[derive(serde::Deserialize)]
        struct File {
            system: Source,
        }
        let options = ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME);
        let file: File = options.from_str(text).unwrap();
        let wanted = Wanted {
            periods: 4,
            ..Wanted::new(System::new(file.system).unwrap(), parameter, (0.0, 1.0)).unwrap()
        };
        let beginning = Beginning {
            mode: wanted.system.mode(mode).unwrap(),
            state: state.to_vec(),
            phase: 0.0,
        };
        first(&wanted, &beginning, search).unwrap().0
    }

    /// A stay in the zone of a mode, beside the saddle that is found from a state.
    fn stay(orbit: &AffineOrbit, mode: &str, rest: &[f64]) -> Stay {
        let mut zones = 0..orbit.zones();
        Stay {
            zone: zones
                .find(|zone| orbit.sequence.zone(*zone).name == mode)
                .unwrap(),
            mode: mode.to_owned(),
            rest: rest.to_vec(),
            growth: f64::NAN,
            turn: f64::NAN,
        }
    }

    /// The homoclinic orbit of the saddle of a linear mode, next to a value of the parameter.
    fn found(text: &str, parameter: &str, state: &[f64], mode: &str, value: f64) -> Option<f64> {
        let orbit = orbit(text, parameter, ("upper", state), Search::Settles(200.0));
        let stay = stay(&orbit, mode, state);
        orbit.connection([&stay; 2], value)
    }

    /// Out of the saddle at 0 along x, from (1, 0) by (1 − t, t) to the line x = p − 0.3 + 0.2y, which is met on the
    /// decaying direction x = 0 where p = 0.1.
    #[test]
    fn a_planar_saddle_in_closed_form() {
        let text = r#"(system: (
            states: ["x", "y"],
            parameters: {"p": 0.4},
            modes: {
                "upper": (rates: {"x": "x", "y": "-1.5*y"}, until: [(zero: "1 - x", to: "back")]),
                "back": (rates: {"x": "-1", "y": "1"}, until: [(zero: "x - p + 0.3 - 0.2*y", to: "upper")]),
            },
        ))"#;
        let limit = found(text, "p", &[0.2, 1.0], "upper", 0.12).unwrap();
        assert!((limit - 0.1).abs() < 1e-15, "{limit}");
        // nothing rests in the other mode
        assert_eq!(found(text, "p", &[0.2, 1.0], "back", 0.12), None);
    }

    /// Chua's circuit, whose saddle turns as it decays: the figure of an independent program in 30 digits.
    #[test]
    fn the_saddle_of_a_circuit() {
        let text = include_str!("../../../problems/chua.ron");
        let limit = found(text, "alpha", &[1.8, 0.0, -1.5], "inner", 11.1013).unwrap();
        assert!((limit - 11.101_909_570_336_237).abs() < 1e-13, "{limit}");
    }

    /// A pendulum that a relay with hysteresis pushes to and fro comes to a cycle from saddle to saddle: the figure of an
    /// independent program.
    #[test]
    fn the_saddles_of_a_pendulum() {
        let text = r#"(system: (
            states: ["x", "v"],
            parameters: {"k": 0.3},
            modes: {
                "plus": (rates: {"x": "v", "v": "k - 0.1*v - sin(x)"}, until: [(zero: "1 - x", to: "minus")]),
                "minus": (rates: {"x": "v", "v": "-k - 0.1*v - sin(x)"}, until: [(zero: "x + 1", to: "plus")]),
            },
        ))"#;
        let state = [-1.0, -1.715_588_859];
        let orbit = orbit(text, "k", ("plus", &state), Search::Guess(7.516_18));
        let stays = [("plus", -3.83), ("minus", 3.83)];
        let [plus, minus] = stays.map(|(mode, x)| stay(&orbit, mode, &[x, 0.0]));
        let limit = orbit.connection([&plus, &minus], 0.6367).unwrap();
        assert!((limit - 0.636_793_235_449_374_7).abs() < 1e-12, "{limit}");
    }
}
