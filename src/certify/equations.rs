//! The equations of a wave at an event, term by term, and its margins at the ends of zones.

use super::flow::{ACCELERATION, JERK, WHOLE};
use super::flow::{GAP, GAP_RATE, RegimeFlow, W, Y};
use super::frame::IntervalFrame;
use super::system::{Columns, EXCESS, PARAMETER, SLOTS, TIME, WaveCondition, WaveSystem};
use crate::interval::{Gradient, Interval, Number, PI};
use crate::tube::model::Impact;
use crate::tube::model::signature::{Regime, ZoneEntry};
use crate::tube::wave::admissibility::WaveWatch;

type First = Gradient<Interval, SLOTS>;

/// A term of an equation.
pub(super) enum EquationTerm<N> {
    /// A function of the slots of a step.
    Local(usize, Columns, N),
    Minus(usize, usize),
}

/// Residual and its derivatives, row by row.
pub struct Evaluated {
    pub residual: Vec<Interval>,
    pub jacobian: Vec<Vec<Interval>>,
}

impl WaveSystem<'_> {
    /// W after the switch at the end of a zone, from W before it.
    fn rate_after<N: Number>(&self, frame: &IntervalFrame<N>, end: &[N; 4], zone: usize) -> N {
        let next = self.near.signature.zone(zone + 1);
        match (next.entry, self.posed.impact) {
            (
                ZoneEntry::Arrest
                | ZoneEntry::Release
                | ZoneEntry::Reversal
                | ZoneEntry::ArrestedLanding,
                _,
            ) => N::double(1.0),
            (ZoneEntry::Landing | ZoneEntry::Touch, Impact::Coulomb) => {
                let impulse = self.impulse(frame, end[GAP_RATE]);
                if next.regime == Regime::Reverse {
                    end[W] + impulse
                } else {
                    end[W] - impulse
                }
            }
            _ => end[W],
        }
    }

    /// The margin of a condition at the ends of a zone, from the state just after its entry and just before
    /// its end.
    fn edge<N: Number>(
        &self,
        frame: &IntervalFrame<N>,
        watch: WaveWatch,
        zone: usize,
        entry: &[N; 4],
        end: &[N; 4],
    ) -> Option<N> {
        let pressure = frame.weight + frame.kappa * entry[W];
        let force = frame.weight + frame.kappa;
        let excess = |y: N| frame.h * (y - frame.release);
        Some(match watch {
            WaveWatch::LandingRate => {
                let lag = entry[W] - N::double(1.0);
                if self.near.signature.zone(zone).regime == Regime::Reverse {
                    lag
                } else {
                    -lag
                }
            }
            WaveWatch::LandingPressure => pressure,
            WaveWatch::Tension => -pressure,
            // Q + rfP at W = 1
            WaveWatch::LowerForce => {
                excess(entry[Y]) + (frame.static_friction * force).scaled(Interval::point(2.0))
            }
            WaveWatch::UpperForce if self.is_layered(zone) => -end[ACCELERATION],
            WaveWatch::UpperForce => excess(end[Y]),
            WaveWatch::Release if self.is_layered(zone) => -entry[JERK],
            WaveWatch::LandingSpeed => -end[GAP_RATE],
            WaveWatch::Impulse => {
                let lag = end[W] - N::double(1.0);
                let lag = if lag.value().middle() < 0.0 {
                    lag
                } else {
                    -lag
                };
                lag - self.impulse(frame, end[GAP_RATE])
            }
            _ => return None,
        })
    }

    /// A margin at the ends of a zone at values of the unknowns.
    pub fn edge_at<N: Number>(
        &self,
        frame: &IntervalFrame<N>,
        x: &[N],
        watch: WaveWatch,
        zone: usize,
    ) -> Option<N> {
        let (entry, _) = self.step_at(x, zone, 0);
        let entry = self.entered(frame, zone, entry);
        let end = self.end_of_zone(frame, x, zone);
        self.edge(frame, watch, zone, &entry, &end)
    }

    /// All terms of the equations, with the slots of steps from `local`.
    pub(super) fn terms<N: Number>(
        &self,
        frame: &IntervalFrame<N>,
        local: impl Fn(&Columns) -> [N; SLOTS],
    ) -> Option<Vec<EquationTerm<N>>> {
        let zones = self.near.zones.len();
        let mut terms = Vec::new();
        let mut row = 0;
        let [_, parameter] = self.tail();
        let period = self.waves - 2 - usize::from(self.minimum.is_some());
        let wanted = match &self.condition {
            WaveCondition::Margin { watch, zone, .. } => Some((*watch, *zone)),
            _ => None,
        };
        let one = N::double(1.0);
        for zone in 0..zones {
            let next = self.near.signature.zone(zone + 1).entry;
            let flow = self.flow(frame, zone);
            let steps = self.steps[zone];
            let share = Interval::ONE / Interval::point(steps as f64);
            for step in 0..steps {
                let columns = self.columns(zone, step, self.duration(zone));
                let slots = local(&columns);
                let given = [slots[0], slots[1], slots[2], slots[3]];
                let state = self.smooth(frame, zone, step, given);
                let time = slots[TIME].scaled(share);
                let series = flow.as_ref().map(|flow| flow.series(state));
                let end = match &series {
                    Some(series) => series.state(time),
                    None => [state[Y] + time, state[W], state[GAP], state[GAP_RATE]],
                };
                let end = match step + 1 == steps {
                    true => self.moving(frame, zone, end, N::double(0.0)),
                    false => end,
                };
                let mut put = |row, value| terms.push(EquationTerm::Local(row, columns, value));
                if let (Some((watch, at)), true) = (wanted, self.minimum.is_none()) {
                    let at_end = matches!(
                        watch,
                        WaveWatch::UpperForce | WaveWatch::LandingSpeed | WaveWatch::Impulse
                    );
                    if at == zone && step == if at_end { steps - 1 } else { 0 } {
                        let value = if watch == WaveWatch::Duration {
                            slots[TIME]
                        } else {
                            let entry = self.entered(frame, zone, given);
                            self.edge(frame, watch, zone, &entry, &end)?
                        };
                        put(self.waves - 1, value);
                    }
                }
                if step + 1 < steps {
                    let dimension = flow.as_ref().map_or(2, RegimeFlow::dimension);
                    let node = self.columns(zone, step + 1, self.duration(zone));
                    for (component, value) in end.iter().enumerate().take(dimension) {
                        terms.push(EquationTerm::Local(row, columns, *value));
                        terms.push(EquationTerm::Minus(row, node[component]?));
                        row += 1;
                    }
                    continue;
                }
                let following = (zone + 1) % zones;
                let follower = self.first[following];
                put(row, end[Y]);
                put(row + 1, self.rate_after(frame, &end, zone));
                let order = if steps == 1 { self.order(zone) } else { 0 };
                let regime = self.near.signature.zone(zone).regime;
                let layered = self.is_layered(zone);
                let released = series.is_none() && self.is_layered(following);
                put(
                    row + 2,
                    match (&series, regime, next) {
                        (None, ..) if released => N::double(0.0),
                        (None, ..) => end[Y] - frame.release,
                        (Some(series), Regime::Separation, _) => series.at(GAP, time, order),
                        (Some(_), _, ZoneEntry::TakeOff) => frame.weight + frame.kappa * end[W],
                        (Some(_), ..) if order == 0 || layered => end[W] - one,
                        (Some(series), ..) => series.at(W, time, order),
                    },
                );
                // Σ T|c| − 2π/k
                put(period, slots[TIME] * frame.speed);
                if layered {
                    put(row + 3, end[ACCELERATION]);
                }
                // V̈ is continuous, and 0 in stick
                if released || layered && self.is_layered(following) {
                    let columns = self.columns(following, 0, self.duration(following));
                    let slots = local(&columns);
                    let state = [slots[0], slots[1], slots[2], slots[3]];
                    let entry = self.entered(frame, following, state);
                    let row = row + 2 + usize::from(layered);
                    terms.push(EquationTerm::Local(row, columns, -entry[ACCELERATION]));
                }
                terms.push(EquationTerm::Minus(row, follower));
                terms.push(EquationTerm::Minus(row + 1, follower + 1));
                row += self.head(zone);
            }
        }
        let wavelength = PI * Interval::point(2.0) / Interval::point(f64::from(self.posed.mode));
        terms.push(EquationTerm::Local(
            period,
            [None; SLOTS],
            -N::constant(wavelength),
        ));
        match (&self.condition, self.minimum) {
            (WaveCondition::Value(value), _) => {
                let mut columns = [None; SLOTS];
                columns[PARAMETER] = Some(parameter);
                let there = local(&columns)[PARAMETER] - N::constant(value.interval());
                terms.push(EquationTerm::Local(self.waves - 1, columns, there));
            }
            (WaveCondition::Margin { watch, zone, .. }, Some(step)) => {
                let columns = self.columns(*zone, step, self.waves - 3);
                let slots = local(&columns);
                let flow = self.flow(frame, *zone)?;
                let state = [slots[0], slots[1], slots[2], slots[3]];
                let state = self.smooth(frame, *zone, step, state);
                let there = flow.series(state).state(slots[TIME]);
                let rate = flow.derivative(there, true);
                let left = self.left(*zone, step, there[WHOLE]) - slots[TIME];
                let moving = self.moving(frame, *zone, there, left);
                let (value, slope) = match (watch, self.layered(frame, *zone)) {
                    (WaveWatch::Pressure, Some(layered)) => {
                        let [_, w, acceleration, jerk] = moving;
                        (
                            frame.weight + frame.kappa * (w + layered.beta * acceleration),
                            acceleration + layered.beta * jerk,
                        )
                    }
                    (_, Some(_)) => (moving[W] - one, moving[ACCELERATION]),
                    (watch, None) => match watch {
                        WaveWatch::Gap => (there[GAP], rate[GAP]),
                        WaveWatch::Pressure => (frame.weight + frame.kappa * there[W], rate[W]),
                        _ => (there[W] - one, rate[W]),
                    },
                };
                terms.push(EquationTerm::Local(self.waves - 2, columns, value));
                terms.push(EquationTerm::Local(self.waves - 1, columns, slope));
            }
            _ => {}
        }
        Some(terms)
    }

    /// Residual and derivatives over intervals of the unknowns.
    pub fn evaluate(&self, x: &[Interval]) -> Option<Evaluated> {
        match &self.condition {
            WaveCondition::Fold => self.fold_at(x),
            WaveCondition::Crossing { .. } => self.crossing_at(x),
            _ => self.waves_into(x, self.waves),
        }
    }

    /// The equations of the wave, and those conditions that need no further unknowns, as the first of `size`.
    pub(super) fn waves_into(&self, x: &[Interval], size: usize) -> Option<Evaluated> {
        let [excess, parameter] = self.tail();
        let frame = self.frame(
            First::variable(x[excess], EXCESS),
            First::variable(x[parameter], PARAMETER),
        )?;
        let terms = self.terms(&frame, |columns| {
            std::array::from_fn(|slot| match columns[slot] {
                Some(column) => First::variable(x[column], slot),
                None => First::double(0.0),
            })
        })?;
        let mut evaluated = Evaluated::zero(size);
        for term in terms {
            match term {
                EquationTerm::Local(row, columns, value) => {
                    evaluated.add(row, value.value, columns.into_iter().zip(value.by));
                }
                EquationTerm::Minus(row, column) => evaluated.subtract(row, column, x),
            }
        }
        Some(evaluated)
    }
}

impl Evaluated {
    pub(super) fn zero(n: usize) -> Evaluated {
        Evaluated {
            residual: vec![Interval::ZERO; n],
            jacobian: vec![vec![Interval::ZERO; n]; n],
        }
    }

    pub(super) fn add(
        &mut self,
        row: usize,
        value: Interval,
        by: impl Iterator<Item = (Option<usize>, Interval)>,
    ) {
        self.residual[row] = self.residual[row] + value;
        for (column, by) in by {
            if let Some(column) = column {
                let entry = &mut self.jacobian[row][column];
                *entry = *entry + by;
            }
        }
    }

    pub(super) fn subtract(&mut self, row: usize, column: usize, x: &[Interval]) {
        self.residual[row] = self.residual[row] - x[column];
        let entry = &mut self.jacobian[row][column];
        *entry = *entry - Interval::ONE;
    }
}
