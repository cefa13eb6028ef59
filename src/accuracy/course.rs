//! All rungs of a ladder one after the other, within a budget of time.

use std::time::{Duration, Instant};

use super::measure::{MeasuredBranch, MeasuredFamily, Missed, Repeats, measure};
use super::rung::{Rung, RungRow};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MeasurementLimits {
    /// Seconds for all rungs and the reference.
    pub budget: f64,
    /// Most repetitions of a rung.
    pub repeats: usize,
}

/// Measurements that are going on.
pub(crate) struct Measurements<S: MeasuredFamily> {
    subject: S,
    reference: MeasuredBranch<S::Compared>,
    ladder: Vec<Rung>,
    /// Rungs that are left, by their place on the ladder.
    left: std::vec::IntoIter<usize>,
    limits: MeasurementLimits,
    begun: Instant,
    until: Option<Instant>,
    /// The shortest time of the rung before, by method: a finer one takes no less.
    least: (&'static str, f64),
    left_out: usize,
}

impl<S: MeasuredFamily> Measurements<S> {
    /// Computes the reference for all rungs that have no row yet.
    ///
    /// # Errors
    /// When the branch does not begin, or the time does not suffice.
    pub(crate) fn begin(
        subject: S,
        rows: &[RungRow],
        limits: MeasurementLimits,
    ) -> Result<Measurements<S>, Missed> {
        let begun = Instant::now();
        let budget = Duration::try_from_secs_f64(limits.budget).ok();
        let until = budget.and_then(|budget| begun.checked_add(budget));
        let ladder = subject.ladder();
        let measured = |rung: &Rung| rows.iter().any(|row| row.is_of(*rung));
        let left: Vec<usize> = (0..ladder.len())
            .filter(|index| !measured(&ladder[*index]))
            .collect();
        Ok(Measurements {
            reference: subject.follow(subject.reference(), until)?,
            subject,
            ladder,
            left: left.into_iter(),
            limits,
            begun,
            until,
            least: ("", 0.0),
            left_out: 0,
        })
    }

    /// The rung that is next, and its place on the ladder.
    pub(crate) fn next_rung(&self) -> Option<(usize, Rung)> {
        let index = *self.left.as_slice().first()?;
        Some((index, self.ladder[index]))
    }

    /// Measures the next rung; none where the time does not suffice.
    pub(crate) fn measure_next(&mut self) -> Option<RungRow> {
        let (index, rung) = self.next_rung()?;
        self.left.next();
        let seconds = self.limits.budget - self.begun.elapsed().as_secs_f64();
        let row = if seconds <= 0.0 || self.least.0 == rung.method() && self.least.1 > seconds {
            None
        } else {
            let repeats = Repeats {
                most: self.limits.repeats,
                seconds: seconds / (self.ladder.len() - index) as f64,
                until: self.until,
            };
            let row = measure(&self.subject, rung, &self.reference, repeats);
            let took = row
                .as_ref()
                .map_or(f64::INFINITY, |row| row.seconds.unwrap_or(f64::NAN));
            self.least = (rung.method(), took);
            row
        };
        self.left_out += usize::from(row.is_none());
        row
    }

    /// Rungs for which the time did not suffice.
    pub(crate) fn left_out(&self) -> usize {
        self.left_out
    }
}
