//! A motion that returns as a guess of an orbit, from which Newton's method sets out.

use super::Wanted;
use super::failure::NoStart;
use super::unknowns::pose;
use crate::affine::motion::{Moment, Switching};
use crate::affine::orbit::layout::{AffineOrbit, ZonePoint};
use crate::affine::orbit::multiplier::Multiplier;
use crate::affine::orbit::signature::{Way, Zone};
use crate::continuation::newton::Settings;
use crate::linalg::Vector;

/// Newton's method from a guess, or from a motion that has returned to rounding.
pub(super) const FROM_A_GUESS: Settings = Settings {
    tolerance: 1e-10,
    most_iterations: 40,
    halvings: 12,
    polish: 1,
};

/// The same from a motion that has nearly returned: within [`NEARLY`](super::returns::NEARLY) of an orbit it is quadratic at once, or there is none.
const FROM_NEARBY: Settings = Settings {
    most_iterations: 12,
    halvings: 2,
    ..FROM_A_GUESS
};

/// Zones of a motion that returns: where they begin, how they end, how long they last. None where it never switches.
pub(super) struct OrbitGuess {
    pub zones: Vec<(Moment, Switching, f64)>,
    /// Where a motion that never switches begins, at phase 0 with a forcing, and how long it takes until it is back.
    pub whole: Option<(Moment, f64)>,
    pub periods: u32,
    /// Where it has returned nearly only: after how many tries, and by how much it is off then.
    pub nearly: Option<(u32, f64)>,
}

impl OrbitGuess {
    /// That of a motion that never switches without forcing.
    pub fn unswitched(place: Moment, period: f64) -> OrbitGuess {
        OrbitGuess {
            zones: Vec::new(),
            whole: Some((place, period)),
            periods: 1,
            nearly: None,
        }
    }

    /// The guards of two switches in one instant, each with its mode.
    pub fn at_once(&self) -> Option<[(usize, usize); 2]> {
        /// Part of the period that rounding may part them by.
        const ROUNDING: f64 = 1e-12;
        let period: f64 = self.zones.iter().map(|(.., duration)| duration).sum();
        let count = self.zones.len();
        let short = |(.., duration): &(Moment, Switching, f64)| *duration <= ROUNDING * period;
        let zone = self.zones.iter().position(short).filter(|_| count > 1)?;
        Some([zone + count - 1, zone].map(|zone| {
            let (_, switching, _) = &self.zones[zone % count];
            (switching.from, switching.guard)
        }))
    }

    /// The orbit next to it.
    pub fn orbit(
        &self,
        wanted: &Wanted,
        settings: &Settings,
    ) -> Result<(AffineOrbit, Vector), NoStart> {
        let zones = self.zones.iter().map(|(place, switching, duration)| {
            let way = Way {
                guard: switching.guard,
                exit: switching.exit,
            };
            zone(wanted, place, Some(way), *duration)
        });
        let whole = self.whole.iter();
        let whole = whole.map(|(place, duration)| zone(wanted, place, None, *duration));
        pose(wanted, zones.chain(whole).collect(), self.periods, settings)
    }

    /// The orbit next to it, which attracts the motion where that has returned nearly only: otherwise it came close by chance.
    pub fn attracting(&self, wanted: &Wanted) -> Result<(AffineOrbit, Vector), NoStart> {
        let Some((tried, off)) = self.nearly else {
            return self.orbit(wanted, &FROM_A_GUESS);
        };
        let by_chance = NoStart::NotPeriodic {
            periods: tried,
            off,
            looks: None,
        };
        let orbit = self.orbit(wanted, &FROM_NEARBY);
        let (orbit, point) = orbit.map_err(|reason| match reason {
            NoStart::Newton(_) | NoStart::Inadmissible(_) => by_chance.clone(),
            reason => reason,
        })?;
        let multipliers = orbit.multipliers(&point).unwrap_or_default();
        match multipliers.iter().any(Multiplier::is_outside) {
            true => Err(by_chance),
            false => Ok((orbit, point)),
        }
    }
}

fn zone(wanted: &Wanted, place: &Moment, way: Option<Way>, duration: f64) -> (Zone, ZonePoint) {
    let name = wanted.system.mode_name(place.mode).into_owned();
    let zone = Zone::new(place.mode, way, name);
    let point = ZonePoint::new(place.state.clone(), duration, place.phase);
    (zone, point)
}
