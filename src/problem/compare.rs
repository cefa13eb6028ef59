//! Events of a branch against those that are expected of it.

use std::fmt;

use super::Expectation;
use crate::orbit::EventType;

/// An event as far as it can be expected.
#[derive(Clone, Debug, PartialEq)]
pub struct Occurrence {
    /// Its type.
    pub kind: EventType,
    /// Its label.
    pub label: usize,
    /// Bloch sector, where it has one.
    pub sector: Option<usize>,
    /// Its numbers by the names of their columns; the first of a name counts.
    pub numbers: Vec<(String, Option<f64>)>,
    /// Regimes before and after it.
    pub regimes: [String; 2],
}

impl Occurrence {
    /// A number of it by the name of its column.
    pub fn number(&self, name: &str) -> Option<f64> {
        let mut numbers = self.numbers.iter();
        numbers.find(|(known, _)| known == name)?.1
    }
}

/// One number of one expectation, compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Name of its column.
    pub name: String,
    /// The number expected.
    pub expected: f64,
    /// That of the event; none where there is no event, or it has none.
    pub found: Option<f64>,
    /// Difference admitted.
    pub tolerance: f64,
}

impl Comparison {
    /// Whether the number is as expected.
    pub fn met(&self) -> bool {
        self.difference() <= self.tolerance
    }

    /// The difference: relative, absolute where zero is expected; infinite where there is no number.
    pub fn difference(&self) -> f64 {
        match self.found {
            None => f64::INFINITY,
            Some(found) if self.expected == 0.0 => found.abs(),
            Some(found) => ((found - self.expected) / self.expected).abs(),
        }
    }
}

/// Regimes of an event that are not as expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OtherRegimes {
    /// Whether it is those before the event.
    pub before: bool,
    /// The regimes expected.
    pub expected: String,
    /// Those of the event.
    pub found: String,
}

impl fmt::Display for OtherRegimes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let OtherRegimes {
            before,
            expected,
            found,
        } = self;
        let side = if *before { "before" } else { "after" };
        write!(f, "regimes {side}: expected {expected}, found {found}")
    }
}

/// An expectation with the event it is compared with.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared<'a> {
    /// What was expected.
    pub expectation: &'a Expectation,
    /// The event; none where all that it may be are compared with others.
    pub event: Option<&'a Occurrence>,
    /// Its numbers.
    pub numbers: Vec<Comparison>,
    /// Its regimes, where they are others.
    pub regimes: Option<OtherRegimes>,
}

impl<'a> Compared<'a> {
    fn new(expectation: &'a Expectation, event: Option<&'a Occurrence>) -> Compared<'a> {
        let tolerance = expectation.tolerance;
        let compare = |(name, expected): (&str, f64)| Comparison {
            name: name.to_owned(),
            expected,
            found: event.and_then(|event| event.number(name)),
            tolerance,
        };
        Compared {
            expectation,
            event,
            numbers: expectation.numbers().map(compare).collect(),
            regimes: event.and_then(|event| regimes(expectation, event)),
        }
    }

    /// Whether the event is there and as expected.
    pub fn met(&self) -> bool {
        self.event.is_some() && self.regimes.is_none() && self.numbers.iter().all(Comparison::met)
    }

    fn distance(&self) -> f64 {
        let differences = self.numbers.iter().map(Comparison::difference);
        differences.fold(0.0, f64::max)
    }
}

fn regimes(expectation: &Expectation, event: &Occurrence) -> Option<OtherRegimes> {
    let [before, after] = &event.regimes;
    let sides = [
        (true, &expectation.regimes_before, before),
        (false, &expectation.regimes_after, after),
    ];
    let other = |(before, expected, found): (bool, &Option<String>, &String)| {
        let expected = expected.as_ref().filter(|expected| *expected != found)?;
        Some(OtherRegimes {
            before,
            expected: expected.clone(),
            found: found.clone(),
        })
    };
    sides.into_iter().find_map(other)
}

/// Whether an expectation may mean an event.
fn may_mean(expectation: &Expectation, event: &Occurrence) -> bool {
    let (sector, label) = (expectation.sector, expectation.label);
    event.kind == expectation.event
        && (sector.is_none() || sector == event.sector)
        && label.is_none_or(|label| label == event.label)
}

/// An event that an expectation may mean.
struct Fit {
    event: usize,
    met: bool,
    distance: f64,
}

/// Every expectation with the event it is compared with; no event serves two.
///
/// As many expectations as possible are met: an expectation gives way to another one if it finds an
/// event elsewhere (augmenting paths in a bipartite graph). Those that are left are shown with the
/// nearest event that is left.
pub fn compare<'a>(expectations: &'a [Expectation], events: &'a [Occurrence]) -> Vec<Compared<'a>> {
    let fits: Vec<Vec<Fit>> = expectations
        .iter()
        .map(|expectation| {
            let mut fits: Vec<Fit> = (0..events.len())
                .filter(|event| may_mean(expectation, &events[*event]))
                .map(|event| {
                    let compared = Compared::new(expectation, Some(&events[event]));
                    Fit {
                        event,
                        met: compared.met(),
                        distance: compared.distance(),
                    }
                })
                .collect();
            fits.sort_by(|one, other| one.distance.total_cmp(&other.distance));
            fits
        })
        .collect();
    let assigned = assign(&fits, events.len());
    let pairs = expectations.iter().zip(assigned);
    pairs
        .map(|(expectation, event)| Compared::new(expectation, event.map(|event| &events[event])))
        .collect()
}

/// The event of each expectation.
fn assign(fits: &[Vec<Fit>], events: usize) -> Vec<Option<usize>> {
    /// Finds an event for an expectation, moving others if need be.
    fn augment(
        one: usize,
        fits: &[Vec<Fit>],
        seen: &mut [bool],
        taken: &mut [Option<usize>],
    ) -> bool {
        for fit in fits[one].iter().filter(|fit| fit.met) {
            if std::mem::replace(&mut seen[fit.event], true) {
                continue;
            }
            if taken[fit.event].is_none_or(|other| augment(other, fits, seen, taken)) {
                taken[fit.event] = Some(one);
                return true;
            }
        }
        false
    }
    let mut taken: Vec<Option<usize>> = vec![None; events];
    for one in 0..fits.len() {
        augment(one, fits, &mut vec![false; events], &mut taken);
    }
    let mut assigned = vec![None; fits.len()];
    for (event, one) in taken.iter().enumerate() {
        if let Some(one) = *one {
            assigned[one] = Some(event);
        }
    }
    let mut rest: Vec<(usize, &Fit)> = (0..fits.len())
        .filter(|one| assigned[*one].is_none())
        .flat_map(|one| fits[one].iter().map(move |fit| (one, fit)))
        .collect();
    rest.sort_by(|(_, one), (_, other)| one.distance.total_cmp(&other.distance));
    for (one, fit) in rest {
        if assigned[one].is_none() && taken[fit.event].is_none() {
            assigned[one] = Some(fit.event);
            taken[fit.event] = Some(one);
        }
    }
    assigned
}
