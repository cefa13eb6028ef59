//! Margins: smooth functions of the unknowns that are positive while a sequence of zones holds.

use serde::{Deserialize, Serialize};

use super::layout::{AffineOrbit, OrbitAt, ZonePoint};
use super::passage::{Jet, Passage};
use super::setting::OrbitFailure;
use super::signature::exit_of;
use crate::affine::mode::{AffineMode, Exit, Row};
use crate::linalg::Vector;
use crate::orbit::located::AT_ZERO;
use crate::orbit::{MarginFunction, WITHOUT_LENGTH};

/// What a margin measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Watch {
    /// Duration of the zone.
    Duration,
    /// A guard just after the entry: its first derivative that is not zero there by the structure.
    Onset(usize),
    /// The least local minimum of a guard within the zone.
    Inside(usize),
    /// Another guard than the one that ends the zone, at the end.
    End(usize),
    /// How fast the guard that ends the zone falls there.
    Speed,
    /// A condition of the exit taken, by its number.
    Condition(usize),
    /// An exit before the one taken, by its number: how far one of its conditions fails.
    Before(usize),
}

/// A margin: positive while the sequence holds. Scaled to order one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Margin {
    /// What it measures.
    pub watch: Watch,
    /// Zone.
    pub zone: usize,
    /// Time after the entry of the zone at which a local minimum lies; 0 for other margins.
    pub time: f64,
    /// Its value.
    pub value: f64,
    /// Its derivatives in the scaled unknowns, summed up by their index.
    #[serde(skip)]
    pub gradient: Vec<(usize, f64)>,
}

/// What an exit before the one taken needs in order to fail.
enum Earlier {
    /// It cannot.
    Holds,
    /// This is positive.
    Fails(Jet, f64),
}

impl OrbitAt<'_> {
    /// How long the orbit is.
    pub(crate) fn period(&self) -> f64 {
        self.zones.iter().map(|zone| zone.duration).sum()
    }

    /// Mode of a zone.
    pub(super) fn mode(&self, zone: usize) -> &AffineMode {
        &self.posed.system.modes[self.orbit.sequence.zone(zone).mode]
    }

    /// A margin of a zone from a jet times a factor.
    pub(super) fn margin(
        &self,
        watch: Watch,
        zone: usize,
        time: f64,
        jet: &Jet,
        factor: f64,
    ) -> Margin {
        let mut gradient = Vec::with_capacity(self.orbit.width() + 2);
        let mut add = |column: usize, by: f64| gradient.push((column, by));
        self.spread(zone, jet, factor, &mut add);
        Margin {
            watch,
            zone,
            time,
            value: factor * jet.value,
            gradient,
        }
    }

    /// What is watched at the entry and the end of a zone.
    pub(super) fn edges(&self, zone: usize) -> Vec<Watch> {
        let facts = &self.posed.facts[zone];
        let way = self.orbit.sequence.zone(zone).way;
        let mut watched = vec![Watch::Duration];
        let moving = |orders: &[Option<usize>]| -> Vec<usize> {
            let orders = orders.iter().enumerate();
            orders
                .filter(|(_, order)| order.is_some())
                .map(|(guard, _)| guard)
                .collect()
        };
        // an orbit without switches has no entry
        let Some(way) = way else {
            return watched;
        };
        watched.extend(moving(&facts.at_entry).into_iter().map(Watch::Onset));
        watched.push(Watch::Speed);
        let others = moving(&facts.at_end)
            .into_iter()
            .filter(|guard| *guard != way.guard);
        watched.extend(others.map(Watch::End));
        watched.extend((0..way.exit).map(Watch::Before));
        let exit = exit_of(&self.posed.system, &self.orbit.sequence, zone);
        let conditions = exit.map_or(&[][..], |exit| &exit.conditions);
        let open =
            (0..conditions.len()).filter(|index| !self.is_zero_at_end(zone, &conditions[*index]));
        watched.extend(open.map(Watch::Condition));
        watched
    }

    /// Whether a form is zero at the end of a zone by the structure.
    fn is_zero_at_end(&self, zone: usize, row: &Row) -> bool {
        let units = self.orbit.units();
        let size = units.size(row);
        let system = &self.posed.system;
        self.posed.facts[zone].is_zero_at_end(system, row, size, &units)
    }

    /// Order of the zero at the entry that is divided out of the equation of the guard that ends a zone: one of several shots is
    /// not short.
    pub(super) fn divided(&self, zone: usize) -> usize {
        match self.orbit.shots(zone) {
            1 => self.posed.facts[zone].divided,
            _ => 0,
        }
    }

    /// A margin at the entry or the end of a zone of these shots; `None` where it can never be positive.
    pub(super) fn edge(&self, watch: Watch, zone: usize, shots: &[Passage]) -> Option<Margin> {
        let (first, passage) = shots.first().zip(shots.last())?;
        let orbit = self.orbit;
        let time = orbit.setting.scales.time;
        let facts = &self.posed.facts[zone];
        let guards = &self.mode(zone).guards;
        let way = orbit.sequence.zone(zone).way;
        let exit = exit_of(&self.posed.system, &orbit.sequence, zone);
        let (jet, factor) = match watch {
            Watch::Duration => {
                return Some(Margin {
                    watch,
                    zone,
                    time: 0.0,
                    value: self.zones[zone].duration / time,
                    gradient: vec![(orbit.width() * zone + orbit.states(), 1.0)],
                });
            }
            Watch::Onset(guard) | Watch::Inside(guard) => {
                let row = &guards[guard].row;
                let order = facts.at_entry[guard].unwrap_or(0);
                let factor = time.powi(order as i32) / orbit.size(row);
                let mut jets = first.derivatives_at_entry(row, order, 1);
                (jets.pop()?, factor)
            }
            Watch::End(guard) => {
                let row = &guards[guard].row;
                let order = facts.at_end[guard].unwrap_or(0);
                let factor = (-time).powi(order as i32) / orbit.size(row);
                (passage.derivative_at_end(row, order), factor)
            }
            Watch::Speed => {
                let way = way?;
                let row = &guards[way.guard].row;
                let order = self.divided(zone);
                let [_, rate] = passage.divided(row, order);
                (rate, -time.powi(order as i32 + 1) / orbit.size(row))
            }
            Watch::Condition(index) => {
                let row = exit?.conditions.get(index)?;
                (passage.at_end(row), orbit.size(row).recip())
            }
            Watch::Before(exit) => {
                let conditions = &guards[way?.guard].exits[exit].conditions;
                match self.earlier(zone, conditions, passage) {
                    Earlier::Holds => return None,
                    Earlier::Fails(jet, factor) => (jet, factor),
                }
            }
        };
        Some(self.margin(watch, zone, 0.0, &jet, factor))
    }

    /// The derivative of a guard just after the entry that follows the one of its margin, scaled as that.
    fn onset_rate(&self, guard: usize, zone: usize) -> Result<Option<f64>, OrbitFailure> {
        let passage = self.shot(zone, 0, self.share(zone))?;
        let row = &self.mode(zone).guards[guard].row;
        let order = self.posed.facts[zone].at_entry[guard].unwrap_or(0) + 1;
        let factor = self.orbit.setting.scales.time.powi(order as i32) / self.orbit.size(row);
        let jet = passage.derivatives_at_entry(row, order, 1).pop();
        Ok(jet.map(|jet| factor * jet.value))
    }

    /// Of the conditions of an exit that must not be taken the one that fails most.
    fn earlier(&self, zone: usize, conditions: &[Row], passage: &Passage) -> Earlier {
        let open = conditions
            .iter()
            .filter(|row| !self.is_zero_at_end(zone, row));
        let failing = open.map(|row| (passage.at_end(row), -self.orbit.size(row).recip()));
        let value = |(jet, factor): &(Jet, f64)| jet.value * factor;
        let most = failing.max_by(|one, other| value(one).total_cmp(&value(other)));
        most.map_or(Earlier::Holds, |(jet, factor)| Earlier::Fails(jet, factor))
    }

    /// The margin of a local minimum of a guard at a time after the entry: its derivative in the place of the
    /// minimum is zero.
    pub(super) fn inside(
        &self,
        guard: usize,
        zone: usize,
        time: f64,
    ) -> Result<Margin, OrbitFailure> {
        let row = &self.mode(zone).guards[guard].row;
        let jet = Jet {
            by_time: 0.0,
            ..self.passage(zone, time)?.at_end(row)
        };
        let factor = self.orbit.size(row).recip();
        Ok(self.margin(Watch::Inside(guard), zone, time, &jet, factor))
    }

    /// A margin that was seen nearby.
    pub(super) fn again(&self, seen: &Margin) -> Result<Margin, OrbitFailure> {
        if let Watch::Inside(guard) = seen.watch {
            return self.inside_again(guard, seen.zone, seen.time);
        }
        let margin = self.edge(seen.watch, seen.zone, &self.shots_of(seen.zone)?);
        Ok(margin.unwrap_or_else(|| seen.clone()))
    }
}

impl AffineOrbit {
    /// Whether an impact, at the end of a zone or before it, has no speed where a margin vanishes, in an orbit all of whose zones last.
    pub fn grazes_impact(&self, point: &Vector, margin: &Margin) -> bool {
        let zone = match margin.watch {
            Watch::Speed => margin.zone,
            Watch::Onset(_) => margin.zone + self.zones() - 1,
            _ => return false,
        };
        let Ok(at) = self.at(point) else {
            return false;
        };
        let lasts = |zone: &ZonePoint| zone.duration > AT_ZERO * self.setting.scales.time;
        let exit = exit_of(&at.posed.system, &self.sequence, zone);
        exit.is_some_and(|exit| !exit.is_continuous()) && at.zones.iter().all(lasts)
    }

    /// The derivative of a guard just after the entry of a zone that follows the one of its margin, scaled as that; `None` where a
    /// reset has led there, which gives the guard a speed of its own.
    pub fn onset_rate(&self, point: &Vector, guard: usize, zone: usize) -> Option<f64> {
        let at = self.at(point).ok()?;
        let exit = exit_of(&at.posed.system, &self.sequence, zone + self.zones() - 1);
        if !exit.is_some_and(Exit::is_continuous) {
            return None;
        }
        at.onset_rate(guard, zone).ok()?
    }
}

impl MarginFunction for Margin {
    fn value(&self) -> f64 {
        self.value
    }

    fn is_same(&self, other: &Margin) -> bool {
        (self.watch, self.zone) == (other.watch, other.zone)
    }

    /// A zone without length says most, then a switch without speed: where an orbit that is traversed several
    /// times grazes, every traversal touches, and the one that has touched before goes first. With the speed of a switch that
    /// of the next entry may vanish, the slip after a reset that turns it.
    fn precedence(&self) -> usize {
        match self.watch {
            Watch::Duration => WITHOUT_LENGTH,
            Watch::Speed => WITHOUT_LENGTH + 1,
            Watch::Onset(_) => WITHOUT_LENGTH + 2,
            _ => WITHOUT_LENGTH + 3,
        }
    }

    fn grazes(&self) -> bool {
        self.watch == Watch::Speed
    }
}
