//! The equations of a wave at an event: as many as unknowns, so that a regular zero is isolated.
//!
//! Unknowns are, for each zone, (Y, W) at its entry and its duration T, and the states at the ends of the
//! steps into which it is cut; u of the excess speed e = e₀(1 + u); the continuation parameter; and the
//! time of a minimum inside a zone where that is what vanishes. The equations of the wave are those of
//! [`crate::wave`]. One more condition singles out the event. Where all of them have a regular zero, the
//! margin that vanishes does so with a slope along the branch: it changes its sign.
//!
//! A fold is a regular zero of F(x, p) = 0, F_x v = 0, ⟨ℓ, v⟩ = 1 (Moore and Spence 1980): regular
//! exactly where the fold is quadratic.

use serde::{Deserialize, Serialize};

use super::flow::{Flow, GAP, GAP_RATE, W, Y};
use super::frame::{Frame, Origin, Written};
use crate::interval::{Decimal, Gradient, Interval, Number, PI};
use crate::model::signature::{Entry, Regime, Signature};
use crate::model::{Impact, Parameter};
use crate::wave::admissibility::Watch;

/// What singles out a point of a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Condition {
    /// The parameter has a value, asked for or an end of the branch.
    Value(Decimal),
    /// The parameter is stationary along the branch.
    Fold,
    /// An eigenvalue of a Bloch sector crosses the imaginary axis.
    Crossing {
        /// Sector.
        sector: usize,
        /// Im λ.
        omega: f64,
    },
    /// A margin vanishes.
    Margin {
        /// What it measures.
        watch: Watch,
        /// Zone.
        zone: usize,
        /// Time after the entry of the zone at which a local minimum lies; 0 for other margins.
        time: f64,
    },
}

/// A model and the parameter of a branch, in decimals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Posed {
    /// Numbers of the model, but for the continuation parameter.
    pub written: Written,
    /// Law of impact.
    pub impact: Impact,
    /// Continuation parameter.
    pub parameter: Parameter,
    /// Mode k.
    pub mode: u32,
    /// Unit of the parameter where uniqueness is measured: the width of its range.
    pub unit: f64,
}

impl Posed {
    /// What does not change along a branch: the continuation parameter is put to 0.
    pub(super) fn fixed(&self) -> Posed {
        let mut fixed = self.clone();
        let Written {
            origin,
            friction,
            mismatch,
            damping,
            ..
        } = &mut fixed.written;
        let number = match (self.parameter, origin) {
            (Parameter::Friction, _) => friction,
            (Parameter::Mismatch, _) => mismatch,
            (Parameter::MassDamping, _) => damping,
            (Parameter::Nu, Origin::Geometry([nu, ..])) => nu,
            (Parameter::Xi, Origin::Geometry([_, xi, _])) => xi,
            (Parameter::Gamma, Origin::Geometry([.., gamma])) => gamma,
            _ => return fixed,
        };
        *number = Decimal::of(0.0);
        fixed
    }
}

/// The wave next to which the solution is sought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Near {
    /// Sequence of zones.
    pub signature: Signature,
    /// (Y, W, T) of each zone.
    pub zones: Vec<[f64; 3]>,
    /// e₀.
    pub excess: f64,
    /// Continuation parameter.
    pub parameter: f64,
}

/// Slots of the quantities that a step depends on: its state, its time, u and the parameter.
pub(super) const TIME: usize = 4;
pub(super) const EXCESS: usize = 5;
pub(super) const PARAMETER: usize = 6;
pub(super) const SLOTS: usize = 7;

/// Columns of the slots; none for what does not vary.
pub type Columns = [Option<usize>; SLOTS];

/// First derivatives.
type First = Gradient<Interval, SLOTS>;

/// A term of an equation.
pub(super) enum Term<N> {
    /// A function of the slots of a step.
    Local(usize, Columns, N),
    /// Minus an unknown.
    Minus(usize, usize),
}

/// Waves of more zones are not proven.
const MOST_ZONES: usize = 32;
/// More steps than this in one zone are not proven.
const MOST_STEPS: usize = 400;

/// Whether a margin is that of a minimum inside a zone.
fn is_inside(watch: Watch) -> bool {
    matches!(watch, Watch::Pressure | Watch::Rate | Watch::Gap)
}

/// The system of one event.
pub struct System<'a> {
    posed: &'a Posed,
    /// The wave next to which the solution is sought.
    pub near: &'a Near,
    /// What singles out the point.
    pub(super) condition: &'a Condition,
    /// Sign of c.
    direction: f64,
    /// Steps of each zone.
    steps: Vec<usize>,
    /// First unknown of each zone.
    first: Vec<usize>,
    /// Number of unknowns without the direction of a fold.
    waves: usize,
    /// Step in which the minimum lies.
    minimum: Option<usize>,
    /// ℓ of a fold.
    weights: Vec<f64>,
}

/// Residual and its derivatives, row by row.
pub struct Evaluated {
    /// Residual.
    pub residual: Vec<Interval>,
    /// Its derivatives.
    pub jacobian: Vec<Vec<Interval>>,
}

impl<'a> System<'a> {
    /// The system and a first guess of its unknowns; `None` where the equations here do not serve.
    pub fn new(
        posed: &'a Posed,
        near: &'a Near,
        condition: &'a Condition,
    ) -> Option<(System<'a>, Vec<f64>)> {
        System::cut(posed, near, condition, None)
    }

    /// The same, with the zones cut into so many steps.
    pub(super) fn cut(
        posed: &'a Posed,
        near: &'a Near,
        condition: &'a Condition,
        into: Option<&[usize]>,
    ) -> Option<(System<'a>, Vec<f64>)> {
        let zones = near.zones.len();
        if zones == 0 || zones > MOST_ZONES || zones != near.signature.len() {
            return None;
        }
        let point = |value| Interval::point(value);
        let frame = |direction| {
            let (value, excess) = (point(near.parameter), point(near.excess));
            posed
                .written
                .frame(posed.parameter, value, excess, direction)
        };
        let direction = frame(1.0)?.kappa.middle().signum();
        let frame = frame(direction)?;
        let mut system = System {
            posed,
            near,
            condition,
            direction,
            steps: Vec::with_capacity(zones),
            first: Vec::with_capacity(zones),
            waves: 0,
            minimum: None,
            weights: Vec::new(),
        };
        let mut guess = Vec::new();
        for (zone, [y, w, duration]) in near.zones.iter().enumerate() {
            system.first.push(guess.len());
            guess.extend([*y, *w, *duration]);
            let mut steps = 1;
            if let Some(flow) = system.flow(&frame, zone) {
                let radians = (flow.norm() * duration.abs()).ceil();
                if radians.is_nan() || radians > MOST_STEPS as f64 {
                    return None;
                }
                steps = match into {
                    Some(steps) => steps[zone],
                    None => (radians as usize).max(1) * system.finer(zone),
                };
                let step = duration / steps as f64;
                let mut state = [point(*y), point(*w), Interval::ZERO, Interval::ZERO];
                for _ in 1..steps {
                    state = flow.series(state).state(point(step));
                    state = state.map(|x| point(x.middle()));
                    guess.extend(state[..flow.dimension()].iter().map(|x| x.middle()));
                }
            }
            system.steps.push(steps);
        }
        if let Condition::Margin { watch, zone, time } = condition {
            let duration = near.zones.get(*zone)?[2];
            if is_inside(*watch) {
                let steps = system.steps[*zone];
                let step = duration / steps as f64;
                let index = ((time / step).floor().max(0.0) as usize).min(steps - 1);
                system.minimum = Some(index);
                guess.push(time - index as f64 * step);
            }
        }
        guess.extend([0.0, near.parameter]);
        system.waves = guess.len();
        if *condition == Condition::Fold {
            let direction = system.fold_direction(&guess)?;
            let size: f64 = direction.iter().map(|v| v * v).sum();
            system.weights = direction.iter().map(|v| v / size).collect();
            guess.extend(direction);
        }
        guess.extend(system.crossing_near(&guess)?);
        Some((system, guess))
    }

    /// A zone that is touched inside is cut so finely that the touch and the ends lie in different steps.
    fn finer(&self, index: usize) -> usize {
        match self.condition {
            Condition::Margin { watch, zone, .. } if *zone == index && is_inside(*watch) => 4,
            _ => 1,
        }
    }

    /// The flow of a zone; none in stick.
    pub(super) fn flow<N: Number>(&self, frame: &Frame<N>, zone: usize) -> Option<Flow<N>> {
        match self.near.signature.zone(zone).regime {
            Regime::Separation => Some(Flow::separation(frame)),
            regime => regime.sliding().map(|sigma| Flow::contact(frame, sigma)),
        }
    }

    /// Order of the zero just after the entry of a zone: of W − 1 in sliding, of U − δ in separation.
    pub fn order(&self, zone: usize) -> usize {
        match self.near.signature.zone(zone).entry {
            Entry::TakeOff => 3,
            Entry::Release if self.posed.written.ratio.is_some() => 1,
            Entry::Release | Entry::Touch => 2,
            Entry::Reversal | Entry::ArrestedLanding => 1,
            Entry::Arrest | Entry::Landing | Entry::Section => 0,
        }
    }

    /// Whether static friction holds more than kinetic friction does.
    pub fn sticks(&self) -> bool {
        self.posed.written.ratio.is_some()
    }

    /// ℓ of a fold.
    pub(super) fn normal(&self) -> &[f64] {
        &self.weights
    }

    /// Law of impact.
    pub fn impact(&self) -> Impact {
        self.posed.impact
    }

    /// Mode k.
    pub fn mode(&self) -> u32 {
        self.posed.mode
    }

    /// Number of steps of a zone.
    pub fn steps(&self, zone: usize) -> usize {
        self.steps[zone]
    }

    /// Column of the duration of a zone.
    pub fn duration(&self, zone: usize) -> usize {
        self.first[zone] + 2
    }

    /// Columns of u and of the parameter.
    pub fn tail(&self) -> [usize; 2] {
        [self.waves - 2, self.waves - 1]
    }

    /// Number of unknowns of the wave itself: those of a fold direction come after them.
    pub fn waves(&self) -> usize {
        self.waves
    }

    /// Whether an unknown is V̇ or U̇.
    pub fn is_rate(&self, index: usize) -> bool {
        let zone = self
            .first
            .iter()
            .rposition(|first| *first <= index)
            .unwrap_or(0);
        match index - self.first[zone] {
            1 => true,
            offset if offset >= 3 && index + 2 < self.waves => (offset - 3) % 2 == 1,
            _ => false,
        }
    }

    /// The condition, with the time of a minimum as it is at values of the unknowns.
    pub fn located(&self, x: &[f64]) -> Condition {
        let mut located = self.condition.clone();
        if let Condition::Crossing { omega, .. } = &mut located {
            *omega = x[self.waves];
        }
        if let (Condition::Margin { zone, time, .. }, Some(step)) = (&mut located, self.minimum) {
            let share = step as f64 / self.steps[*zone] as f64;
            *time = share * x[self.duration(*zone)] + x[self.waves - 3];
        }
        located
    }

    /// The wave at values of the unknowns.
    pub fn refined(&self, x: &[f64]) -> Near {
        let [excess, parameter] = self.tail();
        Near {
            signature: self.near.signature.clone(),
            zones: self
                .first
                .iter()
                .map(|at| [x[*at], x[at + 1], x[at + 2]])
                .collect(),
            excess: self.near.excess * (1.0 + x[excess]),
            parameter: x[parameter],
        }
    }

    pub(super) fn columns(&self, zone: usize, step: usize, time: usize) -> Columns {
        let [excess, parameter] = self.tail();
        let mut columns = [None; SLOTS];
        let width = match self.near.signature.zone(zone).regime {
            Regime::Separation if step > 0 => 4,
            _ => 2,
        };
        let first = match step {
            0 => self.first[zone],
            _ => self.first[zone] + 3 + width * (step - 1),
        };
        for (slot, column) in columns[..width].iter_mut().enumerate() {
            *column = Some(first + slot);
        }
        columns[TIME] = Some(time);
        columns[EXCESS] = Some(excess);
        columns[PARAMETER] = Some(parameter);
        columns
    }

    /// State, flow and duration of a step at values of the unknowns.
    pub fn step_at<N: Number>(&self, x: &[N], zone: usize, step: usize) -> ([N; 4], N) {
        let columns = self.columns(zone, step, self.duration(zone));
        let value = |slot: usize| columns[slot].map_or(N::double(0.0), |column| x[column]);
        let share = Interval::ONE / Interval::point(self.steps[zone] as f64);
        ([0, 1, 2, 3].map(value), value(TIME).scaled(share))
    }

    /// The state at the minimum of an event inside a zone: its zone, its step, its time within the step.
    pub fn minimum<N: Number>(&self, x: &[N]) -> Option<(usize, usize, N)> {
        match (self.condition, self.minimum) {
            (Condition::Margin { zone, .. }, Some(step)) => Some((*zone, step, x[self.waves - 3])),
            _ => None,
        }
    }

    /// Frame and flow at values of the unknowns.
    pub fn frame_at<N: Number>(&self, x: &[N]) -> Option<Frame<N>> {
        let [excess, parameter] = self.tail();
        self.frame(x[excess], x[parameter])
    }

    pub(super) fn frame<N: Number>(&self, u: N, parameter: N) -> Option<Frame<N>> {
        let excess = (N::double(1.0) + u).scaled(Interval::point(self.near.excess));
        self.posed
            .written
            .frame(self.posed.parameter, parameter, excess, self.direction)
    }

    /// Signed speed at a frame.
    pub fn speed(&self, frame: &Frame<Interval>) -> Interval {
        frame.speed * Interval::point(self.direction)
    }

    /// Jump of W in the direction of slip that the friction of a Coulomb impact can make, f m_b U̇⁻/m_a.
    pub fn impulse<N: Number>(&self, frame: &Frame<N>, rate: N) -> N {
        frame.friction * frame.mb * frame.ma.recip() * rate
    }

    /// W after the switch at the end of a zone, from W before it.
    fn rate_after<N: Number>(&self, frame: &Frame<N>, end: &[N; 4], zone: usize) -> N {
        let next = self.near.signature.zone(zone + 1);
        match (next.entry, self.posed.impact) {
            (Entry::Arrest | Entry::Release | Entry::Reversal | Entry::ArrestedLanding, _) => {
                N::double(1.0)
            }
            (Entry::Landing | Entry::Touch, Impact::Coulomb) => {
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
        frame: &Frame<N>,
        watch: Watch,
        zone: usize,
        entry: &[N; 4],
        end: &[N; 4],
    ) -> Option<N> {
        let pressure = frame.weight + frame.kappa * entry[W];
        let force = frame.weight + frame.kappa;
        let excess = |y: N| frame.h * (y - frame.release);
        Some(match watch {
            Watch::LandingRate => {
                let lag = entry[W] - N::double(1.0);
                if self.near.signature.zone(zone).regime == Regime::Reverse {
                    lag
                } else {
                    -lag
                }
            }
            Watch::LandingPressure => pressure,
            Watch::Tension => -pressure,
            // Q + rfP at W = 1
            Watch::LowerForce => {
                excess(entry[Y]) + (frame.static_friction * force).scaled(Interval::point(2.0))
            }
            Watch::UpperForce => excess(end[Y]),
            Watch::LandingSpeed => -end[GAP_RATE],
            Watch::Impulse => {
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
        frame: &Frame<N>,
        x: &[N],
        watch: Watch,
        zone: usize,
    ) -> Option<N> {
        let (entry, _) = self.step_at(x, zone, 0);
        let (last, time) = self.step_at(x, zone, self.steps[zone] - 1);
        let end = match self.flow(frame, zone) {
            Some(flow) => flow.series(last).state(time),
            None => [entry[Y] + time, entry[W], entry[GAP], entry[GAP_RATE]],
        };
        self.edge(frame, watch, zone, &entry, &end)
    }

    /// All terms of the equations, with the slots of steps from `local`.
    pub(super) fn terms<N: Number>(
        &self,
        frame: &Frame<N>,
        local: impl Fn(&Columns) -> [N; SLOTS],
    ) -> Option<Vec<Term<N>>> {
        let zones = self.near.zones.len();
        let mut terms = Vec::new();
        let mut row = 0;
        let [_, parameter] = self.tail();
        let period = self.waves - 2 - usize::from(self.minimum.is_some());
        let wanted = match self.condition {
            Condition::Margin { watch, zone, .. } => Some((*watch, *zone)),
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
                let state = [slots[0], slots[1], slots[2], slots[3]];
                let time = slots[TIME].scaled(share);
                let series = flow.as_ref().map(|flow| flow.series(state));
                let end = match &series {
                    Some(series) => series.state(time),
                    None => [state[Y] + time, state[W], state[GAP], state[GAP_RATE]],
                };
                let mut put = |row, value| terms.push(Term::Local(row, columns, value));
                if let (Some((watch, at)), true) = (wanted, self.minimum.is_none()) {
                    let at_end = matches!(
                        watch,
                        Watch::UpperForce | Watch::LandingSpeed | Watch::Impulse
                    );
                    if at == zone && step == if at_end { steps - 1 } else { 0 } {
                        let value = if watch == Watch::Duration {
                            slots[TIME]
                        } else {
                            self.edge(frame, watch, zone, &state, &end)?
                        };
                        put(self.waves - 1, value);
                    }
                }
                if step + 1 < steps {
                    let dimension = flow.as_ref().map_or(2, Flow::dimension);
                    let node = self.columns(zone, step + 1, self.duration(zone));
                    for (component, value) in end.iter().enumerate().take(dimension) {
                        terms.push(Term::Local(row, columns, *value));
                        terms.push(Term::Minus(row, node[component]?));
                        row += 1;
                    }
                    continue;
                }
                let follower = self.first[(zone + 1) % zones];
                put(row, end[Y]);
                put(row + 1, self.rate_after(frame, &end, zone));
                let order = if steps == 1 { self.order(zone) } else { 0 };
                let regime = self.near.signature.zone(zone).regime;
                put(
                    row + 2,
                    match (&series, regime, next) {
                        (None, ..) => end[Y] - frame.release,
                        (Some(series), Regime::Separation, _) => series.at(GAP, time, order),
                        (Some(_), _, Entry::TakeOff) => frame.weight + frame.kappa * end[W],
                        (Some(_), ..) if order == 0 => end[W] - one,
                        (Some(series), ..) => series.at(W, time, order),
                    },
                );
                // Σ T|c| − 2π/k
                put(period, slots[TIME] * frame.speed);
                terms.push(Term::Minus(row, follower));
                terms.push(Term::Minus(row + 1, follower + 1));
                row += 3;
            }
        }
        let wavelength = PI * Interval::point(2.0) / Interval::point(f64::from(self.posed.mode));
        terms.push(Term::Local(period, [None; SLOTS], -N::constant(wavelength)));
        match (self.condition, self.minimum) {
            (Condition::Value(value), _) => {
                let mut columns = [None; SLOTS];
                columns[PARAMETER] = Some(parameter);
                let there = local(&columns)[PARAMETER] - N::constant(value.interval());
                terms.push(Term::Local(self.waves - 1, columns, there));
            }
            (Condition::Margin { watch, zone, .. }, Some(step)) => {
                let columns = self.columns(*zone, step, self.waves - 3);
                let slots = local(&columns);
                let flow = self.flow(frame, *zone)?;
                let state = [slots[0], slots[1], slots[2], slots[3]];
                let there = flow.series(state).state(slots[TIME]);
                let rate = flow.derivative(there, true);
                let (value, slope) = match watch {
                    Watch::Gap => (there[GAP], rate[GAP]),
                    Watch::Pressure => (frame.weight + frame.kappa * there[W], rate[W]),
                    _ => (there[W] - one, rate[W]),
                };
                terms.push(Term::Local(self.waves - 2, columns, value));
                terms.push(Term::Local(self.waves - 1, columns, slope));
            }
            _ => {}
        }
        Some(terms)
    }

    /// Residual and derivatives over intervals of the unknowns.
    pub fn evaluate(&self, x: &[Interval]) -> Option<Evaluated> {
        match self.condition {
            Condition::Fold => self.fold_at(x),
            Condition::Crossing { .. } => self.crossing_at(x),
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
                Term::Local(row, columns, value) => {
                    evaluated.add(row, value.value, columns.into_iter().zip(value.by));
                }
                Term::Minus(row, column) => evaluated.subtract(row, column, x),
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
