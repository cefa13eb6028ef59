//! An orbit carried from its own equations into others, in intervals: into a sequence of other zones, or into other cuts and steps.

use super::flow::IntervalFlow;
use super::system::OrbitSystem;
use crate::interval::Interval;

/// A span of some stretches that no switch lies between.
pub struct SmoothSpan {
    pub stretches: Vec<usize>,
    /// Time at which it begins, from the entry of the first of them.
    pub from: Interval,
    /// That at which it ends, unless with the last of them.
    pub until: Option<Interval>,
}

impl SmoothSpan {
    /// All of them.
    pub fn whole(stretches: Vec<usize>) -> SmoothSpan {
        SmoothSpan {
            stretches,
            from: Interval::ZERO,
            until: None,
        }
    }
}

impl OrbitSystem<'_> {
    /// The orbit without what belongs to an event, with zones cut as in other equations: a zone that is cut here is not
    /// cut there.
    pub fn carried(&self, x: &[Interval], to: &OrbitSystem) -> Option<Vec<Interval>> {
        let own = |index: usize| {
            let zone = to.stretches[index].zone;
            let own = 0..self.stretches.len();
            let own = own.filter(|own| self.stretches[*own].zone == zone);
            SmoothSpan::whole(own.collect())
        };
        self.carried_by(x, to, &own)
    }

    /// The orbit in other equations, each stretch of which is this span of this one.
    pub fn carried_by(
        &self,
        x: &[Interval],
        to: &OrbitSystem,
        own: &dyn Fn(usize) -> SmoothSpan,
    ) -> Option<Vec<Interval>> {
        let modes = self.enclosed(x[self.parameter()]).ok()?;
        let mut parts: Vec<Vec<Interval>> = Vec::new();
        for (index, stretch) in to.stretches.iter().enumerate() {
            let mut carried = Vec::new();
            let span = own(index);
            let own = &span.stretches;
            if own.is_empty() {
                parts.push(carried);
                continue;
            }
            let time = match span.until {
                Some(until) => until,
                None => self.time(own, x),
            } - span.from;
            let flow = IntervalFlow::new(&modes.modes.get(stretch.mode)?.matrix);
            let steps = Interval::point(to.steps[index] as f64);
            for step in 0..=to.steps[index] {
                let mut rest = span.from + time * Interval::point(step as f64) / steps;
                let mut part = *own.first()?;
                for next in &own[1..] {
                    let before = x[self.duration(part)];
                    if rest.middle() > before.middle() {
                        rest = rest - before;
                        part = *next;
                    }
                }
                // from the nearest place before it
                let length = x[self.duration(part)] / Interval::point(self.steps[part] as f64);
                let node = (rest.middle() / length.middle() + 0.5).floor().max(0.0) as usize;
                let node = node.min(self.steps[part]);
                let y = &x[self.node(part, node)..][..self.width()];
                let rest = rest - length * Interval::point(node as f64);
                let halvings = flow.parts(rest);
                let whole = (0..halvings).fold(flow.part(rest, halvings), |part, _| part.doubled());
                let z = self.lift(y);
                let states = whole.at[..self.exact.states].iter();
                carried.extend(states.map(|row| super::flow::dot(row, &z)));
                if self.is_forced() {
                    carried.push(y[self.exact.states] + modes.omega.value * rest);
                }
            }
            carried.push(time);
            parts.push(carried);
        }
        to.bridge(&mut parts, x[self.parameter()])?;
        let mut carried = parts.concat();
        carried.push(x[self.parameter()]);
        Some(carried)
    }

    /// The time that some stretches take together.
    pub fn time(&self, stretches: &[usize], x: &[Interval]) -> Interval {
        let times = stretches.iter().map(|index| x[self.duration(*index)]);
        times.fold(Interval::ZERO, |sum, time| sum + time)
    }
}
