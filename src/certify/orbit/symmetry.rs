//! Symmetric orbits: 2c − x half a period later, with the phase half a turn on, around a centre c.
//!
//! What vanishes at an event vanishes in both halves then, which no interval can tell. A system has the symmetry where
//! its formulas do, and an orbit where it is the only one next to its image. The centre is what makes the constants of these
//! formulas agree: the origin in most files, and another point where states are counted from elsewhere.

use super::centre::Centre;
use super::exact::NamePolynomial;
use super::fraction::Fraction;
use super::modes::{Row, added, negative};
use super::system::{OrbitSystem, SegmentEnd};
use super::zeros::{FormSource, FormZeros, VanishingForm, unit};
use crate::affine::algebra::Algebra;
use crate::affine::dual::Coefficient;
use crate::certify::krawczyk;
use crate::interval::{Interval, PI};

/// What a stretch is made of, beside that of half a period later: rates, guard and reset.
struct StretchAndImage<'s> {
    rates: [&'s [Row<NamePolynomial>]; 2],
    guards: [&'s Row<NamePolynomial>; 2],
    resets: [&'s [Row<NamePolynomial>]; 2],
}

impl OrbitSystem<'_> {
    /// Whether a component of z changes its sign half a period later, apart from the centre.
    fn turns_over(&self, column: usize) -> bool {
        let states = self.exact.states;
        // cos h(φ + π) = (−1)ʰ cos hφ
        column < states || column > states && (column - states).div_ceil(2) % 2 == 1
    }

    /// A form half a period later, around the origin.
    fn turned_over(&self, row: &[NamePolynomial]) -> Row<NamePolynomial> {
        let entries = row.iter().cloned().enumerate();
        let turned = |(column, entry): (usize, NamePolynomial)| match self.turns_over(column) {
            true => entry.negative(),
            false => entry,
        };
        entries.map(turned).collect()
    }

    /// A form half a period later, around a centre.
    fn image(&self, row: &[NamePolynomial], centre: &Centre) -> Row<NamePolynomial> {
        let mut image = self.turned_over(row);
        let constant = std::mem::take(&mut image[self.exact.states]);
        let sum = row
            .iter()
            .zip(&centre.twice)
            .fold(constant, |sum, (a, twice)| {
                let twice = NamePolynomial::of_fraction(*twice);
                sum.sum(1.0, a.clone().times(twice), 1.0)
            });
        image[self.exact.states] = sum;
        image
    }

    /// Every stretch beside that of half a period later; `None` where one of them ends without a switch, or their number is odd.
    fn pairs(&self) -> Option<Vec<StretchAndImage<'_>>> {
        let count = self.stretches.len();
        let even = count.is_multiple_of(2) && (!self.is_forced() || self.posed.periods % 2 == 1);
        let parts = |index: usize| {
            let stretch = self.stretches[index % count];
            let mode = &self.exact.modes[stretch.mode];
            let SegmentEnd::Exit { guard, exit } = stretch.end else {
                return None;
            };
            let guard = &mode.guards[guard];
            Some((&mode.matrix, &guard.row, &guard.exits[exit].reset))
        };
        let pair = |index: usize| {
            let (one, two) = (parts(index)?, parts(index + count / 2)?);
            Some(StretchAndImage {
                rates: [one.0, two.0],
                guards: [one.1, two.1],
                resets: [one.2, two.2],
            })
        };
        even.then(|| (0..count).map(pair).collect())?
    }

    /// The centre of the symmetry that the equations have, if they have one.
    pub fn centre(&self) -> Option<Centre> {
        let pairs = self.pairs()?;
        let centre = self.centre_of_constants(&pairs)?;
        let image = |row: &Row<NamePolynomial>| self.image(row, &centre);
        let rows = |[one, two]: [&[Row<NamePolynomial>]; 2], shift: &dyn Fn(usize) -> Fraction| {
            let mut rows = one.iter().zip(two).enumerate();
            one.len() == two.len()
                && rows.all(|(index, (one, two))| {
                    let mut of_one = match self.turns_over(index) {
                        true => negative(&image(one)),
                        false => image(one),
                    };
                    let place = &mut of_one[self.exact.states];
                    let by = NamePolynomial::of_fraction(shift(index));
                    *place = std::mem::take(place).sum(1.0, by, 1.0);
                    of_one == *two
                })
        };
        let holds = pairs.iter().all(|pair| {
            image(pair.guards[0]) == *pair.guards[1]
                && rows(pair.rates, &|_| Fraction::ZERO)
                && rows(pair.resets, &|state| centre.twice[state])
        });
        holds.then_some(centre)
    }

    /// The one point around which the constants of guards, rates and resets agree; where they leave a state open, it is zero there.
    fn centre_of_constants(&self, pairs: &[StretchAndImage]) -> Option<Centre> {
        let (states, size) = (self.exact.states, self.exact.size());
        let mut zeros = FormZeros::default();
        // Σ aᵢ·2cᵢ + a = 0, of a form of the states alone
        let mut add = |row: &[NamePolynomial], constant: NamePolynomial| {
            let mut equation = row.to_vec();
            equation[states..].fill(NamePolynomial::default());
            equation[states] = constant;
            // a factor of all of it may be a name
            let mut alone = equation[..states].iter();
            if let Some(by) = alone.find_map(NamePolynomial::inverse_of_term) {
                let entries = equation.into_iter();
                equation = entries.map(|entry| entry.times(by.clone())).collect();
            }
            zeros.insert(&equation, states);
        };
        for pair in pairs {
            let [one, two] = pair.guards;
            add(one, one[states].clone().sum(1.0, two[states].clone(), -1.0));
            for (one, two) in pair.rates[0].iter().zip(pair.rates[1]).take(states) {
                add(one, one[states].clone().sum(1.0, two[states].clone(), 1.0));
            }
            for (state, (one, two)) in pair.resets[0].iter().zip(pair.resets[1]).enumerate() {
                let own = added(
                    one,
                    &unit(state, size),
                    &NamePolynomial::of_fraction(-Fraction::ONE),
                );
                add(&own, one[states].clone().sum(1.0, two[states].clone(), 1.0));
            }
        }
        let origin = NamePolynomial::default();
        (0..states).for_each(|state| add(&unit(state, size), origin.clone()));
        Centre::new(zeros.values(states)?)
    }

    /// As many steps for every stretch as for its image, where the equations have the symmetry and their numbers differ.
    pub fn steps_of_both_halves(&self) -> Option<Vec<usize>> {
        let (first, second) = self.steps.split_at(self.steps.len() / 2);
        if first == second || self.centre().is_none() {
            return None;
        }
        let most: Vec<usize> = first.iter().zip(second).map(|(a, b)| *a.max(b)).collect();
        Some(most.repeat(2))
    }

    /// Where the orbit in these intervals is symmetric, what vanishes at the event vanishes in its other half.
    pub fn mirror(&mut self, middle: &[f64], x: &[Interval]) -> Option<()> {
        let count = self.stretches.len();
        let centre = self.centre()?;
        if !self.is_its_image(&centre, middle, x) {
            return None;
        }
        if let [closed] = self.closed[..] {
            self.close((closed + count / 2) % count);
            return Some(());
        }
        let vanishing = self.mirrored(&centre, *self.vanishing.first()?)?;
        self.vanish(vanishing);
        Some(())
    }

    /// What is the image of something that vanishes.
    fn mirrored(&self, centre: &Centre, event: VanishingForm) -> Option<VanishingForm> {
        let count = self.stretches.len();
        let other = (event.stretch + count / 2) % count;
        let [mode, image] =
            [event.stretch, other].map(|index| &self.exact.modes[self.stretches[index].mode]);
        let row = self.image(&event.source.row(mode)?, centre);
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
    fn is_its_image(&self, centre: &Centre, middle: &[f64], x: &[Interval]) -> bool {
        let (first, second) = self.steps.split_at(self.stretches.len() / 2);
        if first != second {
            return false;
        }
        // for every value of the parameter there is one orbit only in a box that has this one and its image
        let Ok((mut fixed, _)) = OrbitSystem::new(self.posed, self.near, self.condition) else {
            return false;
        };
        fixed.fixed = Some(x[self.parameter()]);
        let equations = |x: &[Interval]| fixed.evaluate(x);
        let image = self.half_later(centre, x);
        let both: Vec<Interval> = image.iter().zip(x).map(|(a, b)| a.hull(*b)).collect();
        krawczyk::is_only_zero(&equations, middle, &both)
    }

    /// The image of an orbit.
    fn half_later(&self, centre: &Centre, x: &[Interval]) -> Vec<Interval> {
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
                    image[to + state] = centre.image(state, x[at + state]);
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
            let centre = self.half.as_ref().filter(|_| zone >= count / 2);
            let zone = if centre.is_some() {
                zone - count / 2
            } else {
                zone
            };
            let parts = (0..self.stretches.len()).filter(|part| self.stretches[*part].zone == zone);
            let mut time = Interval::ZERO;
            let mut found = Vec::new();
            for part in parts {
                if found.is_empty() {
                    let states = x[self.node(part, 0)..][..self.exact.states].iter();
                    let image = |(state, x): (usize, &Interval)| match centre {
                        Some(centre) => centre.image(state, *x),
                        None => *x,
                    };
                    found.extend(states.enumerate().map(image));
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
        let centre = self.half.as_ref()?;
        if whole.steps != steps {
            return None;
        }
        let half = &x[..self.parameter()];
        let mut all = half.to_vec();
        all.extend_from_slice(half);
        all.push(x[self.parameter()]);
        // the first half, which stands in both places, gives the second
        let mut image = whole.half_later(centre, &all);
        image[..half.len()].copy_from_slice(half);
        Some(image)
    }
}
