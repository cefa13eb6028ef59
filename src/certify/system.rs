//! The equations of a wave at an event: as many as unknowns, so that a regular zero is isolated.
//!
//! Unknowns are, for each zone, (Y, W) at its entry and its duration T, and the states at the ends of the
//! steps into which it is cut; u of the excess speed e = e₀(1 + u); the continuation parameter; and the
//! time of a minimum inside a zone where that is what vanishes. The equations of the wave are those of
//! [`crate::tube::wave`]. One more condition singles out the event. Where all of them have a regular zero, the
//! margin that vanishes does so with a slope along the branch: it changes its sign.
//!
//! A fold is a regular zero of F(x, p) = 0, F_x v = 0, ⟨ℓ, v⟩ = 1 (Moore and Spence 1980): regular
//! exactly where the fold is quadratic.

use serde::{Deserialize, Serialize};

use super::flow::{AMPLITUDE, RegimeFlow, WHOLE};
use super::frame::{IntervalFrame, WrittenCoefficients, WrittenModel};
use crate::interval::{Decimal, Interval, Number};
use crate::linalg::Vector;
use crate::tube::flow::Slide;
use crate::tube::model::signature::{Regime, Signature, ZoneEntry};
use crate::tube::model::{Impact, Parameter};
use crate::tube::wave::Wave;
use crate::tube::wave::admissibility::{RegimeMargin, WaveWatch};

/// What singles out a point of a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum WaveCondition {
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
        watch: WaveWatch,
        /// Zone.
        zone: usize,
        /// Time after the entry of the zone at which a local minimum lies; 0 for other margins.
        time: f64,
    },
}

impl WaveCondition {
    /// Whether growing eigenvalues are counted there: not where the spectrum may jump, or λ = 0 is double.
    pub(super) fn is_counted(&self) -> bool {
        matches!(
            self,
            WaveCondition::Value(_) | WaveCondition::Crossing { .. }
        )
    }
}

impl From<RegimeMargin> for WaveCondition {
    fn from(margin: RegimeMargin) -> WaveCondition {
        let RegimeMargin {
            watch, zone, time, ..
        } = margin;
        WaveCondition::Margin { watch, zone, time }
    }
}

/// A model and the parameter of a branch, in decimals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PosedWave {
    /// Numbers of the model, but for the continuation parameter.
    pub written: WrittenModel,
    /// Law of impact.
    pub impact: Impact,
    /// Continuation parameter.
    pub parameter: Parameter,
    /// Mode k.
    pub mode: u32,
    /// Unit of the parameter where uniqueness is measured: the width of its range.
    pub unit: f64,
}

impl PosedWave {
    /// What does not change along a branch: the continuation parameter is put to 0.
    pub(super) fn fixed(&self) -> PosedWave {
        let mut fixed = self.clone();
        let WrittenModel {
            origin,
            friction,
            mismatch,
            damping,
            material,
            ..
        } = &mut fixed.written;
        let mut none = Decimal::of(0.0);
        let number = match (self.parameter, origin) {
            (Parameter::Friction, _) => friction,
            (Parameter::Mismatch, _) => mismatch,
            (Parameter::MassDamping, _) => damping,
            (Parameter::StiffnessDamping, _) => material.as_mut().unwrap_or(&mut none),
            (Parameter::Nu, WrittenCoefficients::Geometry([nu, ..])) => nu,
            (Parameter::Xi, WrittenCoefficients::Geometry([_, xi, _])) => xi,
            (Parameter::Gamma, WrittenCoefficients::Geometry([.., gamma])) => gamma,
            _ => return fixed,
        };
        *number = Decimal::of(0.0);
        fixed
    }
}

/// The wave next to which the solution is sought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NearWave {
    /// Sequence of zones.
    pub signature: Signature,
    /// (Y, W, T) of each zone.
    pub zones: Vec<[f64; 3]>,
    /// With material damping V̈ of the layer at the end of each zone.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<f64>,
    /// e₀.
    pub excess: f64,
    /// Continuation parameter.
    pub parameter: f64,
}

impl NearWave {
    /// The wave by the value of its parameter.
    pub(super) fn value(&self) -> WaveCondition {
        WaveCondition::Value(Decimal::of(self.parameter))
    }

    /// A wave of a branch.
    pub(super) fn new(wave: &Wave, point: &Vector) -> NearWave {
        let zones = wave.unpack(point);
        NearWave {
            signature: wave.signature.clone(),
            zones: zones.iter().map(Slide::without_layers).collect(),
            layers: match wave.material {
                true => zones.iter().map(|zone| zone.layer).collect(),
                false => Vec::new(),
            },
            excess: wave.excess_at(point),
            parameter: wave.parameter_at(point),
        }
    }
}

/// Slots of the quantities that a step depends on: its state, its time, u and the parameter.
pub(super) const TIME: usize = 4;
pub(super) const EXCESS: usize = 5;
pub(super) const PARAMETER: usize = 6;
pub(super) const SLOTS: usize = 7;

/// Columns of the slots; none for what does not vary.
pub type Columns = [Option<usize>; SLOTS];

/// Waves of more zones are not proven.
const MOST_ZONES: usize = 32;
/// More steps than this in one zone are not proven.
const MOST_STEPS: usize = 400;

/// Whether a margin is that of a minimum inside a zone.
fn is_inside(watch: WaveWatch) -> bool {
    matches!(
        watch,
        WaveWatch::Pressure | WaveWatch::Rate | WaveWatch::Gap
    )
}

/// The system of one event.
pub struct WaveSystem<'a> {
    pub(super) posed: &'a PosedWave,
    /// The wave next to which the solution is sought.
    pub near: &'a NearWave,
    /// What singles out the point.
    pub(super) condition: WaveCondition,
    direction: f64,
    pub(super) steps: Vec<usize>,
    /// First unknown of each zone.
    pub(super) first: Vec<usize>,
    /// Number of unknowns without the direction of a fold.
    pub(super) waves: usize,
    /// Step in which the minimum lies.
    pub(super) minimum: Option<usize>,
    /// ℓ of a fold.
    weights: Vec<f64>,
}

impl<'a> WaveSystem<'a> {
    /// The system and a first guess of its unknowns; `None` where the equations here do not serve.
    pub fn new(
        posed: &'a PosedWave,
        near: &'a NearWave,
        condition: &WaveCondition,
    ) -> Option<(WaveSystem<'a>, Vec<f64>)> {
        WaveSystem::cut(posed, near, condition, None)
    }

    /// The same, with the zones cut into so many steps.
    pub(super) fn cut(
        posed: &'a PosedWave,
        near: &'a NearWave,
        condition: &WaveCondition,
        into: Option<&[usize]>,
    ) -> Option<(WaveSystem<'a>, Vec<f64>)> {
        let zones = near.zones.len();
        if zones == 0 || zones > MOST_ZONES || zones != near.signature.len() {
            return None;
        }
        let point = |value| Interval::point(value);
        let (direction, frame) = frame_near(posed, near)?;
        let mut system = WaveSystem {
            posed,
            near,
            condition: condition.clone(),
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
            let layer = match system.is_layered(zone) {
                true => *near.layers.get(zone)?,
                false => 0.0,
            };
            if system.is_layered(zone) {
                guess.push(layer);
            }
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
                let mut state = [*y, *w, 0.0, 0.0].map(point);
                if system.is_layered(zone) {
                    state = system.smooth(&frame, zone, 0, [*y, *w, layer, *duration].map(point));
                }
                for _ in 1..steps {
                    state = flow.series(state).state(point(step));
                    state = state.map(|x| point(x.middle()));
                    guess.extend(state[..flow.dimension()].iter().map(|x| x.middle()));
                }
            }
            system.steps.push(steps);
        }
        system.touch(&mut guess)?;
        guess.extend([0.0, near.parameter]);
        system.waves = guess.len();
        if *condition == WaveCondition::Fold {
            let direction = system.fold_direction(&guess)?;
            system.weights = normalising(&direction);
            guess.extend(direction);
        }
        guess.extend(system.crossing_near(&guess)?);
        Some((system, guess))
    }

    /// The step in which a margin is least, and the time from its beginning, of an event inside a zone.
    fn touch(&mut self, guess: &mut Vec<f64>) -> Option<()> {
        if let WaveCondition::Margin { watch, zone, time } = &self.condition {
            let duration = self.near.zones.get(*zone)?[2];
            if is_inside(*watch) {
                let steps = self.steps[*zone];
                let step = duration / steps as f64;
                let index = ((time / step).floor().max(0.0) as usize).min(steps - 1);
                self.minimum = Some(index);
                guess.push(time - index as f64 * step);
            }
        }
        Some(())
    }

    /// A zone that is touched inside is cut so finely that the touch and the ends lie in different steps.
    fn finer(&self, index: usize) -> usize {
        match &self.condition {
            WaveCondition::Margin { watch, zone, .. } if *zone == index && is_inside(*watch) => 4,
            _ => 1,
        }
    }

    /// The flow of a zone; none in stick.
    pub(super) fn flow<N: Number>(
        &self,
        frame: &IntervalFrame<N>,
        zone: usize,
    ) -> Option<RegimeFlow<N>> {
        match self.near.signature.zone(zone).regime {
            Regime::Separation => Some(RegimeFlow::separation(frame)),
            regime => regime
                .sliding()
                .map(|sigma| RegimeFlow::contact(frame, sigma)),
        }
    }

    /// A state of a zone a time later, without its layer.
    pub(super) fn later<N: Number>(
        &self,
        frame: &IntervalFrame<N>,
        zone: usize,
        state: [N; 4],
        time: N,
    ) -> [N; 4] {
        match self.flow(frame, zone) {
            Some(flow) => flow.series(state).state(time),
            None => {
                let [y, w, gap, rate] = state;
                [y + time, w, gap, rate]
            }
        }
    }

    /// The state at the end of a zone at values of the unknowns; with a layer (Y, W, V̈, V⃛).
    pub(super) fn end_of_zone<N: Number>(
        &self,
        frame: &IntervalFrame<N>,
        x: &[N],
        zone: usize,
    ) -> [N; 4] {
        let step = self.steps[zone] - 1;
        let (last, time) = self.step_at(x, zone, step);
        let end = self.later(frame, zone, self.smooth(frame, zone, step, last), time);
        self.moving(frame, zone, end, N::double(0.0))
    }

    /// Order of the zero just after the entry of a zone: of W − 1 in sliding, of U − δ in separation.
    pub fn order(&self, zone: usize) -> usize {
        match self.near.signature.zone(zone).entry {
            ZoneEntry::TakeOff => 3,
            ZoneEntry::Release if self.posed.written.ratio.is_some() => 1,
            ZoneEntry::Release | ZoneEntry::Touch => 2,
            ZoneEntry::Reversal | ZoneEntry::ArrestedLanding => 1,
            ZoneEntry::Arrest | ZoneEntry::Landing | ZoneEntry::Section => 0,
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

    pub fn impact(&self) -> Impact {
        self.posed.impact
    }

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
            offset if offset >= self.head(zone) && index + 2 < self.waves => {
                (offset - self.head(zone)) % 2 == 1
            }
            _ => false,
        }
    }

    /// Number of unknowns of a zone before those of its steps: Y, W, T and V̈ of its layer.
    pub(super) fn head(&self, zone: usize) -> usize {
        3 + usize::from(self.is_layered(zone))
    }

    /// The condition, with the time of a minimum as it is at values of the unknowns.
    pub fn located(&self, x: &[f64]) -> WaveCondition {
        let mut located = self.condition.clone();
        if let WaveCondition::Crossing { omega, .. } = &mut located {
            *omega = x[self.waves];
        }
        if let (WaveCondition::Margin { zone, time, .. }, Some(step)) = (&mut located, self.minimum)
        {
            let share = step as f64 / self.steps[*zone] as f64;
            *time = share * x[self.duration(*zone)] + x[self.waves - 3];
        }
        located
    }

    /// The wave at values of the unknowns.
    pub fn refined(&self, x: &[f64]) -> NearWave {
        let [excess, parameter] = self.tail();
        NearWave {
            signature: self.near.signature.clone(),
            zones: self
                .first
                .iter()
                .map(|at| [x[*at], x[at + 1], x[at + 2]])
                .collect(),
            layers: (0..self.near.layers.len())
                .map(|zone| match self.is_layered(zone) {
                    true => x[self.first[zone] + 3],
                    false => 0.0,
                })
                .collect(),
            excess: self.near.excess * (1.0 + x[excess]),
            parameter: x[parameter],
        }
    }

    /// Columns of the slots of a step.
    pub(super) fn columns(&self, zone: usize, step: usize, time: usize) -> Columns {
        let [excess, parameter] = self.tail();
        let mut columns = [None; SLOTS];
        let width = match self.near.signature.zone(zone).regime {
            Regime::Separation if step > 0 => 4,
            _ => 2,
        };
        let first = match step {
            0 => self.first[zone],
            _ => self.first[zone] + self.head(zone) + width * (step - 1),
        };
        for (slot, column) in columns[..width].iter_mut().enumerate() {
            *column = Some(first + slot);
        }
        if self.is_layered(zone) {
            columns[AMPLITUDE] = Some(self.first[zone] + 3);
            columns[WHOLE] = Some(self.duration(zone));
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
        match (&self.condition, self.minimum) {
            (WaveCondition::Margin { zone, .. }, Some(step)) => {
                Some((*zone, step, x[self.waves - 3]))
            }
            _ => None,
        }
    }

    /// Frame and flow at values of the unknowns.
    pub fn frame_at<N: Number>(&self, x: &[N]) -> Option<IntervalFrame<N>> {
        let [excess, parameter] = self.tail();
        self.frame(x[excess], x[parameter])
    }

    pub(super) fn frame<N: Number>(&self, u: N, parameter: N) -> Option<IntervalFrame<N>> {
        let excess = (N::double(1.0) + u).scaled(Interval::point(self.near.excess));
        self.posed
            .written
            .frame(self.posed.parameter, parameter, excess, self.direction)
    }

    /// Signed speed at a frame.
    pub fn speed(&self, frame: &IntervalFrame<Interval>) -> Interval {
        frame.speed * Interval::point(self.direction)
    }

    /// Jump of W in the direction of slip that the friction of a Coulomb impact can make, f m_b U̇⁻/m_a.
    pub fn impulse<N: Number>(&self, frame: &IntervalFrame<N>, rate: N) -> N {
        frame.friction * frame.mb * frame.ma.recip() * rate
    }
}

/// Weights w with ⟨w, v⟩ = 1.
fn normalising(v: &[f64]) -> Vec<f64> {
    let size: f64 = v.iter().map(|v| v * v).sum();
    v.iter().map(|v| v / size).collect()
}

/// The frame of a wave in doubles, and the direction in which it runs.
fn frame_near(posed: &PosedWave, near: &NearWave) -> Option<(f64, IntervalFrame<Interval>)> {
    let [value, excess] = [near.parameter, near.excess].map(Interval::point);
    let frame = |direction| {
        let written = &posed.written;
        written.frame(posed.parameter, value, excess, direction)
    };
    let direction = frame(1.0)?.kappa.middle().signum();
    Some((direction, frame(direction)?))
}
