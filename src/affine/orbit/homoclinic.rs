//! The homoclinic orbit that a branch comes to, or the first of the connections in a cycle of them: where the longest stay
//! of an orbit is beside a saddle, [`crate::affine::connection`] has what leaves it and comes to the next one, and tells
//! the parameter to all digits that the stay has taken.

use super::Critical;
use super::layout::AffineOrbit;
use super::stay::{FAR, NEAR, Stay};
use super::termination::OrbitTermination;
use crate::affine::connection::{
    Connected, Connection, ConnectionScales, Passed, SaddleRest, connected,
};
use crate::continuation::Node;
use crate::linalg::Vector;
use crate::orbit::{Limit, rounding_at};

/// A connection is that of the branch where its parameter is no farther than so many times what the last turn changed:
/// what is left falls by a factor e at least in a turn, but for what is small beside that.
const BESIDE: f64 = 3.0;

/// The parameter of a connection, in its unit, is known to this, or as well as what is left tells it.
const KNOWN: f64 = 1e-6;

/// Saddles of one mode that are no farther apart than this, in units of the states, are one.
const ALIKE: f64 = 1e-6;

impl AffineOrbit {
    /// The connection beside an orbit that is long at one saddle and then at another, or again at the same.
    fn connects(&self, [from, to]: [&Stay; 2], point: &Vector, part: f64) -> Option<Connection> {
        let setting = &self.setting;
        let at = self.at(point).ok()?;
        let rest = |stay: &Stay| SaddleRest {
            mode: self.sequence.zone(stay.zone).mode,
            state: stay.rest.clone(),
        };
        let last = match (to.zone, to.place) > (from.zone, from.place) {
            true => to.zone,
            false => to.zone + self.zones(),
        };
        // an orbit without a switch is one zone
        let passed = (from.zone..last).filter_map(|zone| {
            let way = self.sequence.zone(zone).way?;
            Some(Passed {
                guard: way.guard,
                exit: way.exit,
                to: self.sequence.zone(zone + 1).mode,
            })
        });
        let scales = ConnectionScales {
            states: self.extents(point),
            time: setting.scales.time,
            tolerance: setting.system.flow_tolerance(),
        };
        let (ends, way) = ([rest(from), rest(to)], passed.collect());
        let out = (&from.leaving[..], part);
        Connection::new(&at.posed.system, ends, out, way, scales)
    }

    /// The homoclinic orbit of a stay, or the cycle of connections where there are others on the way round.
    pub(super) fn comes_to(&self, stay: Stay, node: &Node) -> OrbitTermination {
        let here = self.parameter_at(&node.point);
        let unit = self.setting.scales.parameter;
        let most = BESIDE * self.left_beside_a_saddle(node) * unit.abs();
        // a way along what is invariant is open for any value, and tells none
        let is_known = |found: &Connected| {
            let error = found.error * unit.abs();
            let off = (found.value * unit - here).abs();
            off <= most + error && error <= most.max(KNOWN * unit.abs())
        };
        let stop = |most: f64| {
            let stays = self.stays_from(&node.point, &stay, most);
            let known = self.connections(&stays, &node.point);
            let known = known.map(|(_, found)| found).find(&is_known);
            let mut others = stays.iter().filter(|other| self.is_another(other, &stay));
            OrbitTermination::Homoclinic {
                limit: known.as_ref().map(|found| found.value * unit),
                error: known.map_or(0.0, |found| found.error * unit.abs()),
                next: others.next().map(|next| next.mode.clone()),
                mode: stay.mode.clone(),
            }
        };
        // a saddle that the orbit has come less near counts where a connection needs it
        let near = stop(NEAR);
        let far = (!near.is_located()).then(|| stop(FAR));
        far.filter(OrbitTermination::is_located).unwrap_or(near)
    }

    /// Whether two stays are beside different saddles.
    fn is_another(&self, one: &Stay, other: &Stay) -> bool {
        let modes = [one, other].map(|stay| self.sequence.zone(stay.zone).mode);
        let states = one.rest.iter().zip(&other.rest);
        let mut states = states.zip(&self.setting.scales.states);
        modes[0] != modes[1]
            || states.any(|((one, other), unit)| (one - other).abs() > ALIKE * unit)
    }

    /// The connections from each stay to the next, and where each exists.
    fn connections<'a>(
        &'a self,
        stays: &'a [Stay],
        point: &'a Vector,
    ) -> impl Iterator<Item = (Connection, Connected)> + 'a {
        let nexts = stays.iter().cycle().skip(1);
        let pairs = stays.iter().zip(nexts);
        pairs.filter_map(|(from, to)| self.connection([from, to], point))
    }

    /// The first connection beside the longest stay of an orbit and the others, and where it exists.
    pub fn homoclinic(&self, point: &Vector) -> Option<(Connection, Connected)> {
        let stay = self.longest_stay_within(point, FAR)?;
        let stays = self.stays_from(point, &stay, NEAR);
        self.connections(&stays, point).next()
    }

    /// What a branch comes to beside a saddle: the event, with its parameter and the error of that.
    pub(super) fn limit_of(&self, stop: &OrbitTermination, node: &Node) -> Option<Limit<Critical>> {
        let (mode, next, limit, error) = match stop {
            OrbitTermination::Homoclinic {
                mode,
                next,
                limit,
                error,
            } => (mode, next, limit, error),
            OrbitTermination::Equilibrium {
                special,
                limit,
                error,
            } => {
                return Some(Limit {
                    special: special.clone(),
                    parameter: *limit,
                    uncertainty: *error,
                });
            }
            _ => return None,
        };
        let here = self.parameter_at(&node.point);
        let left = self.left_beside_a_saddle(node) * self.setting.scales.parameter;
        let (parameter, uncertainty) = match limit {
            Some(limit) => (*limit, *error),
            None => (here, left.abs() + rounding_at(self, node)),
        };
        let (mode, next) = (mode.clone(), next.clone());
        Some(Limit {
            special: Critical::Homoclinic { mode, next },
            parameter,
            uncertainty,
        })
    }

    /// The parameter at which a connection exists, next to a value, both in its unit.
    fn connected(&self, connection: &Connection, value: f64) -> Option<Connected> {
        let unit = self.setting.scales.parameter;
        let state = &connection.ends()[0].state;
        let arrival = |value: f64, turns: &[f64]| {
            let values = self.setting.values_at(value * unit);
            let system = self.setting.system.at(&values, &[]).ok()?;
            connection.arrival(&system, state, turns)
        };
        connected(value, connection.turns(), arrival)
    }

    /// The connection beside an orbit, and where it exists.
    pub(super) fn connection(
        &self,
        stays: [&Stay; 2],
        point: &Vector,
    ) -> Option<(Connection, Connected)> {
        /// The distance from the saddle, as a part of that which suits: what is left out falls to a sixteenth.
        const NEARER: f64 = 0.25;
        let near = |value: f64, part: f64| {
            let connection = self.connects(stays, point, part)?;
            let found = self.connected(&connection, value)?;
            Some((connection, found))
        };
        let value = self.parameter_at(point) / self.setting.scales.parameter;
        let (_, wide) = near(value, 1.0)?;
        let (connection, found) = near(wide.value, NEARER)?;
        let error = found.error + (wide.value - found.value).abs();
        Some((connection, Connected { error, ..found }))
    }
}

#[cfg(test)]
mod tests {
    use crate::affine::connection::Connected;
    use crate::affine::orbit::AffineOrbit;
    use crate::affine::orbit::start::{Beginning, Search, Wanted, first};
    use crate::affine::orbit::stay::Stay;
    use crate::affine::system::{Source, System};
    use crate::linalg::Vector;
    use ron::extensions::Extensions;

    /// The orbit that a motion settles on, or the one next to its beginning.
    fn orbit(
        text: &str,
        parameter: &str,
        (mode, state): (&str, &[f64]),
        search: Search,
    ) -> (AffineOrbit, Vector) {
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
        first(&wanted, &beginning, search).unwrap()
    }

    /// The parameter of the connection beside an orbit, next to a value.
    fn near(
        (orbit, point): &(AffineOrbit, Vector),
        stays: [&Stay; 2],
        value: f64,
    ) -> Option<Connected> {
        let connection = orbit.connects(stays, point, 1.0)?;
        // the range is (0, 1)
        orbit.connected(&connection, value)
    }

    /// A stay in the zone of a mode, beside the saddle that is found from a state.
    fn stay((orbit, point): &(AffineOrbit, Vector), mode: &str, rest: &[f64]) -> Stay {
        let mut zones = 0..orbit.zones();
        let zone = zones.find(|zone| orbit.sequence.zone(*zone).name == mode);
        let zone = zone.unwrap();
        // on the way out
        let at = orbit.at(point).unwrap();
        let late = std::iter::once(0.9 * at.zones[zone].duration);
        let out = at.along(zone, late).unwrap();
        Stay {
            zone,
            mode: mode.to_owned(),
            rest: rest.to_vec(),
            leaving: out[0].as_slice()[..rest.len()].to_vec(),
            place: 0,
            nearest: f64::NAN,
            time: f64::NAN,
            growth: f64::NAN,
            turn: f64::NAN,
            falls: f64::NAN,
        }
    }

    /// The homoclinic orbit of the saddle of a linear mode, next to a value of the parameter.
    fn found(
        text: &str,
        parameter: &str,
        state: &[f64],
        mode: &str,
        value: f64,
    ) -> Option<Connected> {
        let orbit = orbit(text, parameter, ("upper", state), Search::Settles(200.0));
        let stay = stay(&orbit, mode, state);
        near(&orbit, [&stay; 2], value)
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
        assert!(
            (limit.value - 0.1).abs() <= limit.error.min(1e-15),
            "{limit:?}"
        );
        // nothing rests in the other mode
        assert_eq!(found(text, "p", &[0.2, 1.0], "back", 0.12), None);
    }

    /// Chua's circuit, whose saddle turns as it decays: the figure of an independent program in 30 digits.
    #[test]
    fn the_saddle_of_a_circuit() {
        let text = include_str!("../../../problems/chua.ron");
        let limit = found(text, "alpha", &[1.8, 0.0, -1.5], "inner", 11.1013).unwrap();
        let off = (limit.value - 11.101_909_570_336_237).abs();
        assert!(off <= limit.error.min(1e-13), "{limit:?}");
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
        let limit = near(&orbit, [&plus, &minus], 0.6367).unwrap();
        let off = (limit.value - 0.636_793_235_449_374_7).abs();
        assert!(off <= limit.error.min(1e-12), "{limit:?}");
    }
}
