//! Changes of signature that follow one another without end, at values of the parameter that converge.
//!
//! Where each of them adds as many zones as the one before, and the distances dₖ of successive values fall like those of
//! a geometric series, infinitely many lie before the limit: the branch never gets beyond it. The ratios rₖ = dₖ₊₁/dₖ come
//! to their own limit r geometrically, too, and the rest of the series is d·r/(1 − r) (Aitken's extrapolation). Where
//! values come to a limit like powers 1/kᵃ the ratios come to 1, and by at least half of what they lack: such a sequence is
//! not taken for one that falls geometrically, nor is one that ends after a few.

use serde::{Deserialize, Serialize};

use super::EventType;

/// Changes in a row that are alike.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cascade {
    /// Type of each.
    kind: Option<EventType>,
    /// Unknowns that each adds.
    more: usize,
    /// How many there have been.
    changes: usize,
    /// The last values of the parameter: as many as tell a limit.
    values: Vec<f64>,
}

/// The limit of a cascade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CascadeLimit {
    /// Changes seen.
    pub changes: usize,
    /// Limit of the ratio of successive distances.
    pub ratio: f64,
    /// Value of the parameter.
    pub value: f64,
    /// Its error: what the extrapolation of the ratio moves it by.
    pub error: f64,
}

/// Values that tell a limit: three ratios, and how the last two changes of the ratio compare.
const VALUES: usize = 5;

/// Fewer changes than this are no cascade.
const LEAST: usize = 8;

/// Ratios have settled where one differs from the next by no more than this.
const SETTLED: f64 = 3e-3;

/// What the ratio still lacks, as a part of what it lacks to 1: a half, where values fall like a power.
const LACKS: f64 = 0.25;

impl Cascade {
    /// Whether there has been none.
    pub fn is_empty(&self) -> bool {
        self.changes == 0
    }

    /// Takes note of a change at a value of the parameter, which adds so many unknowns.
    pub fn take(&mut self, kind: EventType, more: usize, value: f64) {
        if more == 0 || (self.kind, self.more) != (Some(kind), more) {
            *self = Cascade {
                kind: Some(kind),
                more,
                ..Cascade::default()
            };
        }
        self.changes += 1;
        self.values.push(value);
        if self.values.len() > VALUES {
            self.values.remove(0);
        }
    }

    /// Where the values converge, if they do.
    pub fn limit(&self) -> Option<CascadeLimit> {
        if self.changes < LEAST || self.more == 0 {
            return None;
        }
        let [a, b, c, d, e] = self.values[..] else {
            return None;
        };
        let distances = [b - a, c - b, d - c, e - d];
        let ratio = |index: usize| distances[index + 1] / distances[index];
        let ratios = [ratio(0), ratio(1), ratio(2)];
        let (before, change) = (ratios[1] - ratios[0], ratios[2] - ratios[1]);
        let falls = ratios.iter().all(|ratio| *ratio > 0.0 && *ratio < 1.0);
        // also where the ratio is known to rounding
        let slows = change.abs() < before.abs() || change == 0.0;
        if !falls || !slows || change.abs() > SETTLED {
            return None;
        }
        let lacks = if change == 0.0 {
            0.0
        } else {
            change * change / (before - change)
        };
        let limit = ratios[2] + lacks;
        let settled = lacks.abs() <= LACKS * (1.0 - ratios[2]) && limit > 0.0;
        let rest = |ratio: f64| distances[3] * ratio / (1.0 - ratio);
        settled.then(|| CascadeLimit {
            changes: self.changes,
            ratio: limit,
            value: e + rest(limit),
            error: (rest(limit) - rest(ratios[2])).abs(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(values: impl Iterator<Item = f64>) -> Option<CascadeLimit> {
        let mut cascade = Cascade::default();
        for value in values {
            cascade.take(EventType::GR, 6, value);
        }
        cascade.limit()
    }

    /// Values 2 − r^k(1 + s^k): the ratio comes to r like s^k.
    #[test]
    fn a_geometric_sequence_has_its_limit() {
        let of = |r: f64, s: f64| {
            limit((1..=24).map(move |k| 2.0 - r.powi(k) * (1.0 + s.powi(k)))).expect("a limit")
        };
        for (r, s) in [(0.5, 0.6), (0.81, 0.7)] {
            let limit = of(r, s);
            assert!((limit.ratio - r).abs() < 1e-3, "{limit:?}");
            assert!(
                (limit.value - 2.0).abs() <= limit.error.max(1e-12),
                "{limit:?}"
            );
        }
    }

    /// Those of powers, those that go on evenly and those that are few are none.
    #[test]
    fn other_sequences_have_none() {
        for power in [1, 2, 3] {
            for last in 8..400 {
                let values = (1..=last).map(|k| f64::from(k).powi(-power));
                assert_eq!(limit(values), None, "1/k^{power} up to {last}");
            }
        }
        assert_eq!(limit((1..50).map(f64::from)), None);
        assert_eq!(limit((1..8).map(|k| 0.5_f64.powi(k))), None);
        // one of another kind begins anew
        let mut cascade = Cascade::default();
        for k in 1..20 {
            cascade.take(EventType::GR, if k == 17 { 3 } else { 6 }, 0.5_f64.powi(k));
        }
        assert_eq!(cascade.limit(), None);
    }
}
