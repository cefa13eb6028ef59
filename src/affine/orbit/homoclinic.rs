//! The homoclinic orbit that a branch comes to: where what leaves a saddle along its growing direction returns to it.
//!
//! In a linear mode the way out is straight up to the guard, and what comes back along the decaying directions has
//! nothing of the growing one. No long stay is followed, so that the parameter has all digits that the stay has taken.

use super::layout::AffineOrbit;
use crate::affine::motion::{Motion, Place, Step};
use crate::linalg::{Least, Matrix, Vector, least};

/// Secants at most.
const SECANTS: usize = 40;

/// The first of them, in units of the parameter.
const FIRST: f64 = 1e-6;

/// A root is found where secants come down to this part of the unit.
const FOUND: f64 = 1e-10;

/// The way back may last so many units of time.
const LONGEST: f64 = 10.0;

impl AffineOrbit {
    /// The parameter of the homoclinic orbit next to a value where a zone is a stay beside a saddle.
    pub(super) fn homoclinic(&self, zone: usize, value: f64) -> Option<f64> {
        let unit = self.setting.scales.parameter;
        let (mut before, mut here) = (value, value + FIRST * unit);
        let mut known = self.returns(zone, before)?;
        for _ in 0..SECANTS {
            let off = self.returns(zone, here)?;
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

    /// How much of the way out of the saddle of a zone, from its growing direction to the guard, is in what comes back.
    fn returns(&self, zone: usize, value: f64) -> Option<f64> {
        let n = self.states();
        let values = self.setting.values_at(value);
        let system = self.setting.system.at(&values, &[]).ok()?;
        let number = self.sequence.zone(zone).mode;
        let mode = system
            .modes
            .get(number)
            .filter(|mode| mode.field.is_exact)?;
        let saddle = system.equilibria(number).ok()?.into_iter().next()?;
        let [growing, next, ..] = saddle.eigenvalues[..] else {
            return None;
        };
        if growing.re <= 0.0 || growing.im != 0.0 || next.re >= 0.0 {
            return None;
        }
        let own = mode.matrix.at.view((0, 0), (n, n)) - Matrix::identity(n, n) * growing.re;
        let Least { left, right, .. } = least(&own)?;
        let way = self.sequence.zone(zone).way?;
        let guard = mode.guards.get(way.guard)?;
        let mut z = system.lift(number, &saddle.state, 0.0);
        let reach = -guard.row.at.dot(&z) / guard.row.at.rows(0, n).dot(&right);
        z.rows_mut(0, n).axpy(reach, &right, 1.0);
        let reset = &guard.exits.get(way.exit)?.reset.at;
        let place = Place {
            time: 0.0,
            phase: 0.0,
            mode: self.sequence.zone(zone + 1).mode,
            state: (reset * z).iter().copied().collect(),
        };
        let longest = self.setting.scales.time;
        let mut motion = Motion::new(&system, place, longest);
        for other in zone + 1..zone + self.zones() {
            let Step::Switched(switching) = motion.step(LONGEST * longest).ok()? else {
                return None;
            };
            let way = self.sequence.zone(other).way?;
            let next = self.sequence.zone(other + 1).mode;
            let taken = (switching.guard, switching.exit, switching.to);
            if taken != (way.guard, way.exit, next) {
                return None;
            }
        }
        let back = Vector::from_column_slice(&motion.place().state);
        let off = left.dot(&(back - Vector::from_vec(saddle.state)));
        Some(off / (left.dot(&right) * reach))
    }
}

#[cfg(test)]
mod tests {
    use crate::affine::orbit::start::{Beginning, Search, Wanted, first};
    use crate::affine::system::{Source, System};
    use ron::extensions::Extensions;

    /// The homoclinic orbit of the sequence that a motion settles on, next to a value of the parameter, in the zones
    /// of a mode.
    fn found(text: &str, parameter: &str, state: &[f64], saddle: &str, value: f64) -> Option<f64> {
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
            mode: wanted.system.mode("upper").unwrap(),
            state: state.to_vec(),
            phase: 0.0,
        };
        let (orbit, _) = first(&wanted, &beginning, Search::Settles(200.0)).unwrap();
        let mut zones = 0..orbit.zones();
        let zone = zones.find(|zone| orbit.sequence.zone(*zone).name == saddle)?;
        orbit.homoclinic(zone, value)
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
}
