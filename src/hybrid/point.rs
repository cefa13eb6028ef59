//! What a branch of orbits is made of, as plain data.

use nalgebra::Complex;

use crate::affine::orbit::multiplier::own;
use crate::affine::orbit::{Multiplier, SlidingBifurcation};
use crate::orbit::{EventType, Stability};
use crate::problem::compare::Occurrence;

/// One accepted point of a branch: a row of `branch.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct OrbitPoint {
    /// Running number from 1.
    pub point: usize,
    /// Label of a labelled point: the key of events, multipliers and profiles.
    pub label: Option<usize>,
    /// Leg it belongs to, from 1.
    pub leg: usize,
    /// Type of a special point.
    pub kind: Option<EventType>,
    /// Names of the modes in order of time, joined by `-`, from the entry of the first mode of the file.
    pub regimes: String,
    /// Values of the parameters in the order of the file.
    pub parameters: Vec<f64>,
    /// Period.
    pub period: f64,
    /// Times of the switches since the orbit's first.
    pub switches: Vec<f64>,
    /// Least and largest value of every state.
    pub extremes: Vec<(f64, f64)>,
    /// Names and values of the monitors, of those that have one.
    pub monitors: Vec<(String, Option<f64>)>,
    /// Stability; `None` when not asked for.
    pub stable: Option<Stability>,
    /// Multipliers outside the unit circle; `None` when not asked for or without a limit.
    pub unstable: Option<usize>,
    /// All multipliers, the largest first; none when not asked for or without a limit.
    pub multipliers: Vec<Multiplier>,
    /// Newton iterations spent on the point.
    pub newton: usize,
    /// Largest relative residual of the boundary-value problem.
    pub residual: f64,
}

impl OrbitPoint {
    /// The largest multiplier that is not trivial; of several of one modulus that with the largest real part.
    pub fn leading(&self) -> Option<Complex<f64>> {
        /// Moduli and real parts that differ by less, as a part of the largest modulus, are the same: errors of multipliers are smaller.
        const SAME: f64 = 1e-9;
        let mut values = own(&self.multipliers).map(|one| one.value);
        let first = values.next()?;
        let slack = SAME * first.norm();
        let alike = values.take_while(|one| one.norm() >= first.norm() - slack);
        Some(
            alike.fold(first, |known, one| match one.re > known.re + slack {
                true => one,
                false => known,
            }),
        )
    }
}

/// A special point: a row of `events.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct OrbitEvent {
    /// Label of the point in `branch.csv`.
    pub label: usize,
    /// Type of the event.
    pub kind: EventType,
    /// Names and values of the parameters in the order of the file.
    pub parameters: Vec<(String, f64)>,
    /// Period.
    pub period: f64,
    /// Names and values of the monitors, of those that have one.
    pub monitors: Vec<(String, Option<f64>)>,
    /// The leading multiplier; `None` when not asked for or without a limit.
    pub leading: Option<Complex<f64>>,
    /// Modes before the event, along the branch.
    pub regimes_before: String,
    /// Modes after the event, along the branch.
    pub regimes_after: String,
    /// The sliding bifurcation that changes the modes, if one does.
    pub sliding: Option<SlidingBifurcation>,
    /// Bound or honest estimate of the error of the located parameter.
    pub uncertainty: f64,
    /// A short sentence.
    pub what: String,
}

impl OrbitEvent {
    /// What can be expected of it.
    pub fn occurrence(&self) -> Occurrence {
        let leading = self.leading;
        let own = [
            ("period", Some(self.period)),
            ("multiplier_re", leading.map(|value| value.re)),
            ("multiplier_im", leading.map(|value| value.im)),
        ];
        let own = own.map(|(name, value)| (name.to_owned(), value));
        let parameters = self.parameters.iter();
        let parameters = parameters.map(|(name, value)| (name.clone(), Some(*value)));
        let monitors = self.monitors.iter().cloned();
        Occurrence {
            kind: self.kind,
            label: self.label,
            sector: None,
            numbers: own.into_iter().chain(parameters).chain(monitors).collect(),
            regimes: [self.regimes_before.clone(), self.regimes_after.clone()],
        }
    }
}
