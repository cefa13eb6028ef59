//! Symmetric orbits: −x half a period later, with the phase half a turn on.
//!
//! What vanishes at an event vanishes in both halves then, which no interval can tell. A system has the symmetry where
//! its formulas do, and an orbit where it is the only one next to its image.

use super::exact::NamePolynomial;
use super::modes::Row;
use super::system::{OrbitSystem, SegmentEnd};
use super::zeros::{FormSource, VanishingForm};
use crate::affine::expression::Algebra;
use crate::certify::krawczyk;
use crate::interval::{Interval, PI};

impl OrbitSystem<'_> {
    /// Whether a component of z changes its sign half a period later.
    fn turns_over(&self, column: usize) -> bool {
        let states = self.exact.states;
        // cos h(φ + π) = (−1)ʰ cos hφ
        column < states || column > states && (column - states).div_ceil(2) % 2 == 1
    }

    /// A form half a period later.
    fn image(&self, row: &[NamePolynomial]) -> Row<NamePolynomial> {
        let entries = row.iter().cloned().enumerate();
        let turned = |(column, entry): (usize, NamePolynomial)| match self.turns_over(column) {
            true => entry.negative(),
            false => entry,
        };
        entries.map(turned).collect()
    }

    /// Rows of states half a period later.
    fn images(&self, rows: &[Row<NamePolynomial>]) -> Vec<Row<NamePolynomial>> {
        let turned = |(index, row): (usize, &Row<NamePolynomial>)| match self.turns_over(index) {
            true => super::modes::negative(&self.image(row)),
            false => self.image(row),
        };
        rows.iter().enumerate().map(turned).collect()
    }

    /// Whether the equations have the symmetry.
    pub fn is_symmetric(&self) -> bool {
        let count = self.stretches.len();
        let even = count.is_multiple_of(2) && (!self.is_forced() || self.posed.periods % 2 == 1);
        even && (0..count).all(|index| {
            let other = (index + count / 2) % count;
            let [one, two] = [index, other].map(|index| self.stretches[index]);
            let [mode, image] = [one, two].map(|one| &self.exact.modes[one.mode]);
            let ends = match (one.end, two.end) {
                (
                    SegmentEnd::Exit { guard, exit },
                    SegmentEnd::Exit {
                        guard: to,
                        exit: by,
                    },
                ) => {
                    let [one, two] = [&mode.guards[guard], &image.guards[to]];
                    self.image(&one.row) == two.row
                        && self.images(&one.exits[exit].reset) == two.exits[by].reset
                }
                _ => false,
            };
            let matrix = self.images(&mode.matrix);
            ends && matrix == image.matrix
        })
    }

    /// Where the orbit in these intervals is symmetric, what vanishes at the event vanishes in its other half.
    pub fn mirror(&mut self, middle: &[f64], x: &[Interval]) -> Option<()> {
        let count = self.stretches.len();
        if !self.is_its_image(middle, x) {
            return None;
        }
        if let [closed] = self.closed[..] {
            self.close((closed + count / 2) % count);
            return Some(());
        }
        let vanishing = self.mirrored(*self.vanishing.first()?)?;
        self.vanish(vanishing);
        Some(())
    }

    /// What is the image of something that vanishes.
    fn mirrored(&self, event: VanishingForm) -> Option<VanishingForm> {
        let count = self.stretches.len();
        let other = (event.stretch + count / 2) % count;
        let [mode, image] =
            [event.stretch, other].map(|index| &self.exact.modes[self.stretches[index].mode]);
        let row = self.image(&event.source.row(mode)?);
        let order = match event.source {
            FormSource::Guard { order, .. } => Some(order),
            FormSource::Condition { .. } => None,
        };
        let guards = (0..image.guards.len())
            .filter_map(|guard| order.map(|order| FormSource::Guard { guard, order }));
        let conditions = image.guards.iter().enumerate().flat_map(|(guard, known)| {
            let exits = known.exits.iter().enumerate();
            exits.flat_map(move |(exit, known)| {
                (0..known.conditions.len()).map(move |index| FormSource::Condition {
                    guard,
                    exit,
                    index,
                })
            })
        });
        let mut sources = guards.chain(conditions.filter(|_| order.is_none()));
        let source = sources.find(|source| source.row(image).as_ref() == Some(&row))?;
        Some(VanishingForm {
            stretch: other,
            source,
            ..event
        })
    }

    /// Whether the orbit in these intervals is symmetric.
    fn is_its_image(&self, middle: &[f64], x: &[Interval]) -> bool {
        let (first, second) = self.steps.split_at(self.stretches.len() / 2);
        if !self.is_symmetric() || first != second {
            return false;
        }
        // for every value of the parameter there is one orbit only in a box that has this one and its image
        let Ok((mut fixed, _)) = OrbitSystem::new(self.posed, self.near, self.condition) else {
            return false;
        };
        fixed.fixed = Some(x[self.parameter()]);
        let equations = |x: &[Interval]| fixed.evaluate(x);
        let image = self.half_later(x);
        let both: Vec<Interval> = image.iter().zip(x).map(|(a, b)| a.hull(*b)).collect();
        krawczyk::is_only_zero(&equations, middle, &both)
    }

    /// The image of an orbit.
    fn half_later(&self, x: &[Interval]) -> Vec<Interval> {
        let count = self.stretches.len();
        let half = PI * Interval::point(f64::from(self.posed.periods));
        let mut image = x.to_vec();
        for index in 0..count {
            let from = (index + count / 2) % count;
            // the first half is the image of the second, before whose end a period has passed
            let shift = if index < count / 2 { -half } else { half };
            for step in 0..=self.steps[index] {
                let (to, at) = (self.node(index, step), self.node(from, step));
                for state in 0..self.exact.states {
                    image[to + state] = -x[at + state];
                }
                if self.is_forced() {
                    image[to + self.exact.states] = x[at + self.exact.states] + shift;
                }
            }
            image[self.duration(index)] = x[self.duration(from)];
        }
        image
    }

    /// Whether the orbit in these intervals closes after its whole period and no part of it: where its sequence repeats itself
    /// after a part, it is elsewhere then.
    pub fn is_primitive(&self, x: &[Interval]) -> bool {
        let zones = &self.near.sequence.0;
        let count = zones.len();
        let periods = usize::try_from(self.posed.periods).unwrap_or(usize::MAX);
        if zones[0].way.is_none() {
            // without a switch the equations are those of every part
            return periods == 1;
        }
        // states and duration of a zone; those of the second half of a symmetric orbit from the first
        let of = |zone: usize| -> Vec<Interval> {
            let later = self.half && zone >= count / 2;
            let zone = if later { zone - count / 2 } else { zone };
            let parts = (0..self.stretches.len()).filter(|part| self.stretches[*part].zone == zone);
            let mut time = Interval::ZERO;
            let mut found = Vec::new();
            for part in parts {
                if found.is_empty() {
                    let state = x[self.node(part, 0)..][..self.exact.states].iter();
                    found.extend(state.map(|x| if later { -*x } else { *x }));
                }
                time = time + x[self.duration(part)];
            }
            found.push(time);
            found
        };
        (2..=count)
            .filter(|times| count.is_multiple_of(*times))
            .filter(|times| !self.is_forced() || periods.is_multiple_of(*times))
            .all(|times| {
                let on = |zone: usize| (zone + count / times) % count;
                let apart = |zone: usize| {
                    let both = of(zone).into_iter().zip(of(on(zone)));
                    both.into_iter().any(|(a, b)| !(a - b).contains(0.0))
                };
                (0..count).any(|zone| zones[zone] != zones[on(zone)] || apart(zone))
            })
    }

    /// The whole of a symmetric orbit from its half, in equations that have as many steps; `None` where they have not.
    pub fn whole(&self, x: &[Interval], whole: &OrbitSystem) -> Option<Vec<Interval>> {
        let steps = [&self.steps[..], &self.steps].concat();
        if whole.steps != steps {
            return None;
        }
        let half = &x[..self.parameter()];
        let mut all = half.to_vec();
        all.extend_from_slice(half);
        all.push(x[self.parameter()]);
        // the first half, which stands in both places, gives the second
        let mut image = whole.half_later(&all);
        image[..half.len()].copy_from_slice(half);
        Some(image)
    }
}
