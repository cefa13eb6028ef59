//! What is zero at the entries and ends of the stretches of an orbit, and what vanishes at its event.

use super::OpenOrbit;
use super::enclosure::Enclosure;
use super::exact::NamePolynomial;
use super::flow::IntervalFlow;
use super::guess::times;
use super::modes::{IntervalMode, IntervalModes, Row, through};
use super::system::{NearOrbit, OrbitCondition, OrbitSegment, OrbitSystem, SegmentEnd};
use super::zeros::{Facts, FormSource, FormZeros, InequalityEvent, VanishingForm, less, whole};
use crate::affine::orbit::Watch;
use crate::interval::Interval;
use crate::orbit::EventType;

/// Rows of a mode by the guard and the exit with which it ends.
type RowsOf<'a> =
    dyn Fn(&IntervalMode<NamePolynomial>, usize, usize) -> Vec<Row<NamePolynomial>> + 'a;

impl OrbitSystem<'_> {
    /// What is zero at the entries and ends, with what vanishes at an event.
    pub fn known(&self, vanishing: &[VanishingForm]) -> Vec<Facts> {
        let count = self.stretches.len();
        let states = self.exact.states;
        let mut facts = vec![Facts::default(); count];
        // what is zero at an event, at entries and ends
        let mut zeros = vec![[Vec::new(), Vec::new()]; count];
        for one in vanishing {
            let mode = &self.exact.modes[self.stretches[one.stretch].mode];
            zeros[one.stretch][usize::from(one.at_end)].extend(one.source.row(mode));
        }
        let event = |facts: &mut FormZeros, rows: &[Row<NamePolynomial>]| {
            rows.iter().for_each(|row| facts.insert(row, states));
        };
        for (facts, [rows, _]) in facts.iter_mut().zip(&zeros) {
            event(&mut facts.entry, rows);
        }
        loop {
            let before: usize = facts.iter().map(|facts| facts.entry.len()).sum();
            for index in 0..count {
                let OrbitSegment { mode, end, .. } = self.stretches[index];
                let mode = &self.exact.modes[mode];
                // where no time passes all that is zero at the entry is so at the end
                let mut zero = match self.closed.contains(&index) {
                    true => facts[index].entry.clone(),
                    false => facts[index].entry.along(mode, states),
                };
                let next = (index + 1) % count;
                match end {
                    SegmentEnd::Exit { guard, exit } => {
                        let row = &mode.guards[guard].row;
                        let divisor = self.divisor(index);
                        // what is divided by Tᵐ is the guard where that has a zero of order m at the entry
                        let entry = facts[index].entry.order(row, mode);
                        if entry.is_none_or(|order| order >= divisor) {
                            zero.insert(row, states);
                        }
                        if divisor > 0 && self.closed.contains(&index) {
                            zero.insert(&mode.derivative(row, divisor), states);
                        }
                        event(&mut zero, &zeros[index][1]);
                        facts[next].entry = zero.after(&mode.guards[guard].exits[exit].reset);
                    }
                    SegmentEnd::Touch { guard } => {
                        zero.insert(&mode.derivative(&mode.guards[guard].row, 1), states);
                        event(&mut zero, &zeros[index][1]);
                        facts[next].entry = zero.clone();
                    }
                    SegmentEnd::Never => facts[next].entry = FormZeros::default(),
                }
                event(&mut facts[next].entry, &zeros[next][0]);
                if self.closed.contains(&index) {
                    // what is zero at the end is so at the entry, and at the end before
                    let before = (index + count - 1) % count;
                    let rows: Vec<Row<NamePolynomial>> = zero.rows().cloned().collect();
                    if let Some(reset) = self.reset(before) {
                        let whole = whole(reset, self.exact.size());
                        zeros[before][1].extend(rows.iter().map(|row| through(row, &whole)));
                    }
                    event(&mut facts[index].entry, &rows);
                    zeros[index][0] = rows;
                }
                facts[index].end = zero;
            }
            if facts.iter().map(|facts| facts.entry.len()).sum::<usize>() <= before {
                return facts;
            }
        }
    }

    /// Divides the equations of those of these stretches that begin where their guard is zero by powers of their durations: where one
    /// has no duration the undivided equation says nothing.
    pub fn divide(&mut self, stretches: &[usize]) {
        // what is zero without their equations
        self.divided = stretches.iter().map(|index| (*index, usize::MAX)).collect();
        let facts = self.known(&[]);
        let order = |index: usize| {
            let OrbitSegment { mode, end, .. } = self.stretches[index];
            let mode = &self.exact.modes[mode];
            match end {
                SegmentEnd::Exit { guard, .. } => {
                    facts[index].entry.order(&mode.guards[guard].row, mode)
                }
                _ => None,
            }
        };
        let orders = stretches.iter().map(|index| (*index, order(*index)));
        self.divided = orders
            .filter_map(|(index, order)| Some((index, order.filter(|order| *order > 0)?)))
            .collect();
    }

    /// By which power of the duration the equation of a stretch is divided.
    pub fn divisor(&self, stretch: usize) -> usize {
        let mut divided = self.divided.iter();
        divided
            .find(|(index, _)| *index == stretch)
            .map_or(0, |(_, order)| *order)
    }

    /// Whether the parameter is stationary in the duration of a stretch where that is zero: its time is taken from the stretch
    /// before, whose guard is stationary at its end, and the states go on there as they did.
    pub fn is_stationary(&self, index: usize) -> bool {
        let count = self.stretches.len();
        let before = (index + count - 1) % count;
        let [mode, next] = [before, index].map(|at| &self.exact.modes[self.stretches[at].mode]);
        let (SegmentEnd::Exit { guard, .. }, Some(reset)) =
            (self.stretches[before].end, self.reset(before))
        else {
            return false;
        };
        let facts = &self.facts[before].end;
        let whole = whole(reset, self.exact.size());
        let goes_on = |(state, row): (usize, &Row<NamePolynomial>)| {
            let after = through(&next.matrix[state], &whole);
            facts.have(&less(&through(row, &mode.matrix), &after))
        };
        before != index
            && [before, index]
                .iter()
                .all(|index| self.divisor(*index) == 0)
            && facts.have(&mode.derivative(&mode.guards[guard].row, 1))
            && reset.iter().enumerate().all(goes_on)
    }

    /// What the switch at the end of a stretch makes of the states, if there is one.
    pub fn reset(&self, stretch: usize) -> Option<&[Row<NamePolynomial>]> {
        let OrbitSegment { mode, end, .. } = self.stretches[stretch];
        match end {
            SegmentEnd::Exit { guard, exit } => {
                Some(&self.exact.modes[mode].guards[guard].exits[exit].reset)
            }
            _ => None,
        }
    }

    /// One stretch more has no duration.
    pub fn close(&mut self, stretch: usize) {
        self.closed.push(stretch);
        self.facts = self.known(&self.vanishing);
    }

    /// One thing more vanishes.
    pub fn vanish(&mut self, vanishing: VanishingForm) {
        self.vanishing.push(vanishing);
        self.facts = self.known(&self.vanishing);
    }

    /// The type of a change of the sequence, by all that vanishes there and not on the branch, whichever of it is the condition of
    /// the event: a guard together with its rate, a condition of an exit, or else another guard at an end. Where a zone has no
    /// duration and formulas tell of none of these it is not known.
    pub fn change(&self) -> Option<EventType> {
        let OrbitCondition::Margin { watch, .. } = self.condition else {
            return None;
        };
        let vanish = |of: &RowsOf| {
            self.stretches.iter().enumerate().any(|(index, stretch)| {
                let SegmentEnd::Exit { guard, exit } = stretch.end else {
                    return false;
                };
                let rows = of(&self.exact.modes[stretch.mode], guard, exit);
                let [facts, lasting] = [&self.facts, &self.lasting].map(|all| &all[index].end);
                let mut rows = rows.iter();
                rows.any(|row| facts.have(row) && !lasting.have(row))
            })
        };
        let speed = |mode: &IntervalMode<NamePolynomial>, guard: usize, _: usize| {
            vec![mode.derivative(&mode.guards[guard].row, 1)]
        };
        let conditions = |mode: &IntervalMode<NamePolynomial>, guard: usize, exit: usize| {
            let exits = mode.guards[guard].exits.iter().take(exit + 1);
            exits.flat_map(|exit| exit.conditions.clone()).collect()
        };
        Some(if matches!(watch, Watch::Inside(_)) || vanish(&speed) {
            EventType::GR
        } else if vanish(&conditions) {
            EventType::SL
        } else if *watch != Watch::Duration
            || self.closed.iter().any(|index| self.ends_at_once(*index))
        {
            EventType::CO
        } else {
            return None;
        })
    }

    /// Whether the guard that ends a stretch is zero at its entry at the event, and not on the branch.
    fn ends_at_once(&self, index: usize) -> bool {
        let OrbitSegment { mode, end, .. } = self.stretches[index];
        let SegmentEnd::Exit { guard, .. } = end else {
            return false;
        };
        let row = &self.exact.modes[mode].guards[guard].row;
        self.facts[index].entry.have(row) && !self.lasting[index].entry.have(row)
    }

    /// What vanishes at the event.
    pub fn event(
        &self,
        near: &NearOrbit,
        modes: &IntervalModes<Enclosure>,
    ) -> Result<Option<InequalityEvent>, OpenOrbit> {
        let OrbitCondition::Margin { watch, zone, .. } = self.condition else {
            return Ok(None);
        };
        let mut at = self.stretches.iter().enumerate();
        let at = at.find(|(_, stretch)| stretch.zone == *zone);
        let Some((stretch, OrbitSegment { mode, end, .. })) = at else {
            return Err(OpenOrbit::Sequence);
        };
        let known = &self.exact.modes[*mode];
        let order = |guard: usize, zeros: &FormZeros| {
            let row = &known.guards.get(guard).ok_or(OpenOrbit::Sequence)?.row;
            zeros.order(row, known).ok_or(OpenOrbit::Sequence)
        };
        let facts = &self.facts[stretch];
        let taken = match end {
            SegmentEnd::Exit { guard, .. } => Ok(*guard),
            _ => Err(OpenOrbit::Sequence),
        };
        let (at_end, source) = match *watch {
            // the guard is stationary at the end of the first part by another equation
            Watch::Inside(guard) => (true, FormSource::Guard { guard, order: 0 }),
            Watch::Onset(guard) => {
                let order = order(guard, &facts.entry)?;
                (false, FormSource::Guard { guard, order })
            }
            Watch::End(guard) => {
                let order = order(guard, &facts.end)?;
                (true, FormSource::Guard { guard, order })
            }
            Watch::Speed => {
                let guard = taken?;
                (true, FormSource::Guard { guard, order: 1 })
            }
            Watch::Condition(index) => {
                let (guard, exit) = match end {
                    SegmentEnd::Exit { guard, exit } => (*guard, *exit),
                    _ => return Err(OpenOrbit::Sequence),
                };
                (true, FormSource::Condition { guard, exit, index })
            }
            Watch::Before(exit) => {
                let guard = taken?;
                let exits = &known.guards[guard].exits;
                let conditions = &exits.get(exit).ok_or(OpenOrbit::Sequence)?.conditions;
                let z = self.end_of(near, modes, *zone)?;
                let open = (0..conditions.len()).filter(|one| !facts.end.have(&conditions[*one]));
                let index = Self::last_to_hold(&modes.modes[*mode], (guard, exit), open, &z);
                let index = index.ok_or(OpenOrbit::Sequence)?;
                (true, FormSource::Condition { guard, exit, index })
            }
            Watch::Duration => return Ok(Some(InequalityEvent::Closed(stretch))),
        };
        let vanishing = VanishingForm {
            stretch,
            at_end,
            source,
        };
        match source.row(known) {
            Some(_) => Ok(Some(InequalityEvent::Zero(vanishing))),
            None => Err(OpenOrbit::Sequence),
        }
    }

    /// Of the conditions of an exit the one that fails most: it is the last to hold.
    fn last_to_hold(
        mode: &IntervalMode<Enclosure>,
        (guard, exit): (usize, usize),
        open: impl Iterator<Item = usize>,
        z: &[f64],
    ) -> Option<usize> {
        let value = |index: usize| {
            let source = FormSource::Condition { guard, exit, index };
            let row = source.row(mode)?;
            let terms = row.iter().zip(z).map(|(c, z)| (c.value.middle(), *z));
            let size: f64 = terms.clone().map(|(c, z)| (c * z).abs()).sum();
            Some(terms.map(|(c, z)| c * z).sum::<f64>() / size.max(f64::MIN_POSITIVE))
        };
        open.min_by(|one, other| {
            let both = [one, other].map(|index| value(*index).unwrap_or(f64::NAN));
            both[0].total_cmp(&both[1])
        })
    }

    /// z at the end of a zone in doubles.
    fn end_of(
        &self,
        near: &NearOrbit,
        modes: &IntervalModes<Enclosure>,
        zone: usize,
    ) -> Result<Vec<f64>, OpenOrbit> {
        let at = &near.zones[zone];
        let y: Vec<Interval> = at
            .state
            .iter()
            .chain([&at.phase])
            .copied()
            .map(Interval::point)
            .collect();
        let mut z: Vec<f64> = self.lift(&y).iter().map(|z| z.middle()).collect();
        let mode = near.sequence.zone(zone).mode;
        let flow = IntervalFlow::new(&modes.modes[mode].matrix);
        let time = Interval::point(at.duration);
        let halvings = flow.parts(time);
        let part = flow.part(time, halvings);
        let step = (0..halvings).fold(part, |part, _| part.doubled());
        z = times(&step, &z);
        z.iter()
            .all(|z| z.is_finite())
            .then_some(z)
            .ok_or(OpenOrbit::NotEnclosed)
    }
}
