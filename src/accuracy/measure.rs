//! What every rung of a ladder is measured by, whatever its branch is of.

use std::time::Instant;

use super::rung::{Rung, RungRow};
use nalgebra::Complex;

use crate::branch::run::RunError;
use crate::discretised;
use crate::hybrid::NoFirstPoint;
use crate::orbit::EventType;
use crate::orbit::legs::{Run, RunEnd};
use crate::problem::Continuation;
use crate::tube::flow::Unsolved;

/// A branch that is followed by several methods.
pub(crate) trait MeasuredFamily {
    /// What is compared at a value of the parameter that every method meets exactly.
    type Compared;

    /// Rungs from coarse to fine within each method.
    fn ladder(&self) -> Vec<Rung>;

    /// The rung that all are compared with.
    fn reference(&self) -> Rung;

    /// What that is, for a reader.
    fn remark(&self) -> &'static str;

    /// Follows the branch on a rung, until its end or a time.
    ///
    /// # Errors
    /// When it does not begin, or not end in time.
    fn follow(
        &self,
        rung: Rung,
        until: Option<Instant>,
    ) -> Result<MeasuredBranch<Self::Compared>, Missed>;

    /// Measures a rung against the reference.
    ///
    /// # Errors
    /// When it has no answer.
    fn row(
        &self,
        rung: Rung,
        reference: &MeasuredBranch<Self::Compared>,
        repeats: Repeats,
    ) -> Result<RungRow, Missed>;
}

/// A branch followed by one method.
pub(crate) struct MeasuredBranch<C> {
    pub points: usize,
    pub events: Vec<(EventType, f64)>,
    /// At user points and at the ends of the range.
    pub compared: Vec<C>,
    pub failed: Option<String>,
}

impl<C> MeasuredBranch<C> {
    /// Takes every step of a branch. `see` has the type of a special point and the parameter, `keep` what is compared.
    ///
    /// # Errors
    /// When it does not end in time.
    pub(crate) fn collect<R: Run>(
        mut branch: R,
        until: Option<Instant>,
        see: impl Fn(&R::Item) -> Option<(EventType, f64)>,
        keep: impl Fn(&R::Item) -> Option<C>,
    ) -> Result<MeasuredBranch<C>, Missed> {
        let mut followed = MeasuredBranch {
            points: 0,
            events: Vec::new(),
            compared: Vec::new(),
            failed: None,
        };
        while branch.progress().end.is_none() {
            in_time(until)?;
            for item in branch.step() {
                followed.points += 1;
                match see(&item) {
                    Some((EventType::UZ | EventType::EP, _)) => {
                        followed.compared.extend(keep(&item));
                    }
                    Some((EventType::MX, _)) | None => {}
                    Some(event) => followed.events.push(event),
                }
            }
        }
        if let Some(RunEnd::Failed(reason)) = &branch.progress().end {
            followed.failed = Some(reason.to_string());
        }
        Ok(followed)
    }

    /// The row of a rung that took so long, with the errors of its events.
    pub(crate) fn row(&self, rung: Rung, reference: &MeasuredBranch<C>, seconds: f64) -> RungRow {
        let mut row = RungRow {
            points: self.points,
            events_found: self.events.len(),
            failure: self.failed.clone(),
            ..RungRow::failed(rung, reference.events.len(), None)
        };
        let both = || reference.events.iter().zip(&self.events);
        let same = reference.events.len() == self.events.len()
            && both().all(|(one, other)| one.0 == other.0);
        if same {
            row.event_error = worst(both().map(|(one, other)| (other.1 / one.1 - 1.0).abs()));
        } else if row.failure.is_none() {
            row.failure = Some("not the events of the reference".into());
        }
        row.took(seconds)
    }
}

/// Why a method has no answer.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Missed {
    /// The branch does not begin.
    #[error("{0}")]
    Run(#[from] RunError),
    /// The branch of orbits does not begin.
    #[error("{0}")]
    Orbit(#[from] NoFirstPoint),
    /// The ring is not solved.
    #[error("{0}")]
    Ring(#[from] discretised::Error),
    /// An orbit is not integrated.
    #[error("{0}")]
    Unsolved(#[from] Unsolved),
    #[error("the time is over")]
    Time,
}

/// A branch with a few user points if it has none.
pub(super) fn with_stops<P: Clone>(continuation: &Continuation<P>) -> Continuation<P> {
    let mut continuation = continuation.clone();
    if continuation.stop_at.is_empty() {
        let (low, high) = continuation.range;
        continuation.stop_at = [0.25, 0.5, 0.75]
            .map(|share| (low + share * (high - low)).into())
            .to_vec();
    }
    continuation
}

/// Whether a time has come; there may be none.
pub(super) fn in_time(until: Option<Instant>) -> Result<(), Missed> {
    match until {
        Some(until) if Instant::now() >= until => Err(Missed::Time),
        _ => Ok(()),
    }
}

/// Largest of the errors, if there is any.
pub(super) fn worst(errors: impl Iterator<Item = f64>) -> Option<f64> {
    errors.reduce(f64::max)
}

/// Largest distance of the reference's eigenvalues, list by list, from the nearest found.
pub(super) fn eigenvalue_error(
    reference: &[Vec<Complex<f64>>],
    found: &[Vec<Complex<f64>>],
) -> Option<f64> {
    worst(reference.iter().zip(found).flat_map(|(one, other)| {
        one.iter().filter_map(|value| {
            other
                .iter()
                .map(|candidate| (candidate - value).norm())
                .reduce(f64::min)
        })
    }))
}

/// How often a rung is repeated, and for how long at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Repeats {
    pub most: usize,
    /// Seconds after which no further one begins.
    pub seconds: f64,
    /// When no work of any kind goes on.
    pub until: Option<Instant>,
}

/// Runs a piece of work repeatedly; the median time and the first result.
pub(super) fn timed<T>(
    repeats: Repeats,
    work: impl Fn() -> Result<T, Missed>,
) -> Result<(f64, T), Missed> {
    let begun = Instant::now();
    let first = work()?;
    let mut times = vec![begun.elapsed().as_secs_f64()];
    while times.len() < repeats.most && begun.elapsed().as_secs_f64() < repeats.seconds {
        let start = Instant::now();
        if work().is_err() {
            break;
        }
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Ok((times[times.len() / 2], first))
}

/// Measures one rung against the reference; none if the time does not suffice.
pub(crate) fn measure<S: MeasuredFamily>(
    subject: &S,
    rung: Rung,
    reference: &MeasuredBranch<S::Compared>,
    repeats: Repeats,
) -> Option<RungRow> {
    match subject.row(rung, reference, repeats) {
        Err(Missed::Time) => None,
        Err(error) => Some(RungRow::failed(
            rung,
            reference.events.len(),
            Some(error.to_string()),
        )),
        Ok(row) => Some(row),
    }
}
