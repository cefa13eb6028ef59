//! Every crossing of the imaginary axis along a branch, and the unstable count between them.
//!
//! The figures stand in the problem files and were computed by an independent program. Between
//! consecutive rows the unstable count on the full circle changes by two with every HB: in sectors
//! 0 and k/2 by a conjugate pair, in the others by an eigenvalue and its conjugate in sector k − j.
//! It may jump where the spectrum does, as the event then says, and change where an eigenvalue
//! enters or leaves the window through its upper edge, as the row then says.

use brakewave::branch::run::WaveItem;
use brakewave::branch::special::{OfWaves, Special};
use brakewave::branch::{Event, EventType, VerdictReason};
use brakewave::problem::Expectation;
use brakewave::tube::stability::spectrum::Spectrum;
use brakewave::tube::stability::track::Remark;

use crate::stability::observed;
use crate::stability::waves::{Rows, follow, problem};

/// Events located and figures known to this, relative to 1.
const BOUND: f64 = 1e-9;

/// Distance from the edge of the window at which an eigenvalue may pass it between two rows.
const EDGE: f64 = 0.5;

fn value(event: &Event, column: &str) -> f64 {
    match column {
        "omega" => event.omega.unwrap_or(f64::NAN),
        "speed" => event.speed,
        "mismatch" => event.model.mismatch,
        "friction" => event.model.friction,
        "mass_damping" => event.model.damping.mass,
        _ => unreachable!("no figure of {column}"),
    }
}

/// Largest error of an event against the figures expected.
fn distance(event: &Event, expected: &Expectation) -> f64 {
    if event.sector != expected.sector {
        return f64::INFINITY;
    }
    expected
        .numbers()
        .map(|(column, number)| (value(event, column) - number).abs() / number.abs().max(1.0))
        .fold(0.0, f64::max)
}

/// Every expected HB is found, and no other.
fn matched(name: &str, rows: &Rows, expected: &[Expectation]) {
    let mut events: Vec<&Event> = rows
        .items
        .iter()
        .filter_map(|item| item.event.as_ref())
        .filter(|event| matches!(event.kind, EventType::HB | EventType::BP))
        .collect();
    let mut worst = 0.0_f64;
    for expected in expected.iter().filter(|one| one.event == EventType::HB) {
        let (index, error) = events
            .iter()
            .map(|event| distance(event, expected))
            .enumerate()
            .min_by(|one, other| one.1.total_cmp(&other.1))
            .expect("events are left");
        assert!(error < BOUND, "{name}: {expected:?} is missed by {error:e}");
        worst = worst.max(error);
        events.remove(index);
    }
    assert!(events.is_empty(), "{name}: not expected: {events:?}");
    on_axis(name, rows);
    assert!(rows.notes.is_empty(), "{name}: {:?}", rows.notes);
    observed(&format!("crossings of {name}"), worst);
}

/// At a crossing the eigenvalue that crosses is on the imaginary axis, and no rounding of its place has it grow or decay.
fn on_axis(name: &str, rows: &Rows) {
    let mut listed = 0;
    for item in &rows.items {
        let event = item.event.as_ref();
        let crossing = event.and_then(|event| Some((event.sector?, event.omega?)));
        let Some((sector, omega)) = crossing else {
            continue;
        };
        let own = item.eigenvalues.iter().filter(|one| one.sector == sector);
        for one in own.filter(|one| (one.im - omega).abs() < BOUND && one.re.abs() < BOUND) {
            assert_eq!(one.re, 0.0, "{name}: {one:?}");
            listed += 1;
        }
    }
    assert!(listed > 0, "{name}");
}

/// The jump of the count on the full circle that an event tells of.
fn announced(item: &WaveItem, mode: usize) -> i64 {
    let Some(Special::Change(change)) = &item.special else {
        return 0;
    };
    let Some(Remark::Jump { before, after }) = &change.spectrum else {
        return 0;
    };
    let count = |side: &[(usize, usize)]| -> i64 {
        let counts = side.iter().map(|(sector, count)| {
            let twice = if *sector == 0 || 2 * sector == mode {
                1
            } else {
                2
            };
            twice * *count as i64
        });
        counts.sum()
    };
    count(after) - count(before)
}

/// Unstable eigenvalues on the full circle whose frequency is near the edge of the window.
fn near_edge(spectrum: &Spectrum) -> i64 {
    let near = |sector: &&brakewave::tube::stability::spectrum::Sector| -> i64 {
        let count = sector
            .eigenvalues
            .iter()
            .filter(|one| one.re > spectrum.axis)
            .filter(|one| (one.im.abs() - spectrum.max_frequency).abs() <= EDGE)
            .count();
        let twice = if spectrum.symmetric(sector.sector) {
            1
        } else {
            2
        };
        twice * count as i64
    };
    spectrum.sectors.iter().map(|sector| near(&sector)).sum()
}

/// The count between rows that are no crossings changes as the events say. Returns how many
/// changes were entries through the edge.
fn accounted(name: &str, rows: &Rows, mode: usize) -> usize {
    let mut crossed = 0;
    let mut last: Option<usize> = None;
    let mut entries = 0;
    for (index, item) in rows.items.iter().enumerate() {
        if let Some(Special::Own(OfWaves::Crossing {
            grows,
            omega: Some(_),
            ..
        })) = item.special
        {
            crossed += if grows { 2 } else { -2 };
            continue;
        }
        let count = item.point.unstable.expect("stability is asked for") as i64;
        if let Some(before) = last {
            let previous = &rows.items[before];
            let jump = announced(previous, mode);
            let old = previous.point.unstable.unwrap_or(0) as i64;
            let left = count - old - crossed - jump;
            // the row says so, and no other row does
            let mut reasons = item.point.why.iter();
            let said =
                reasons.any(|reason| matches!(reason, VerdictReason::Count { is_lost: false, .. }));
            assert_eq!(said, left != 0, "{name}: point {}", item.point.point);
            if left != 0 {
                let near = [before, index]
                    .iter()
                    .filter_map(|index| rows.spectra[*index].as_ref())
                    .map(near_edge)
                    .max()
                    .unwrap_or(0);
                assert!(
                    left.abs() <= near && left % 2 == 0,
                    "{name}: between points {} and {} ({:?}) the count goes from {old} to {count}, \
                     crossings {crossed}, jump {jump}, near the edge {near}",
                    previous.point.point,
                    item.point.point,
                    item.point.model
                );
                entries += 1;
            }
        }
        last = Some(index);
        crossed = 0;
    }
    entries
}

fn check(name: &str) -> (Rows, usize) {
    let (problem, text) = problem(name);
    let rows = follow(&problem, &text);
    matched(name, &rows, &problem.expect);
    let entries = accounted(name, &rows, problem.wave.mode as usize);
    println!("observed: {name}: {entries} entries through the edge");
    (rows, entries)
}

#[test]
fn in_the_mismatch() {
    let (rows, _) = check("mode4_stability.ron");
    let first = rows
        .items
        .iter()
        .find(|item| item.point.kind == Some(EventType::CO))
        .expect("there is a CO");
    // one pair of sector 1 and its conjugate of sector 3 are gone
    assert_eq!(announced(first, 4), -2, "{:?}", first.special);
}

#[test]
fn in_the_damping() {
    check("mode4_damping.ron");
}

#[test]
fn in_the_friction() {
    let (_, entries) = check("mode4_friction_stability.ron");
    assert!(entries > 0, "pairs enter through the edge near the fold");
}

/// At a fold one real eigenvalue of sector 0 passes through zero, next to the translation mode: it is
/// followed, and nothing is lost.
#[test]
fn folds_lose_no_eigenvalue() {
    // the second branch goes on for thousands of points
    let ends = [
        ("0.0", "max_points: 150"),
        ("0.001", "stop_after: [(event: HB, count: 1)]"),
    ];
    for (beta, end) in ends {
        let text = format!(
            "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 1.1, \
             mismatch: 5, damping: (mass: 0.05, stiffness: {beta})), \
             wave: (mode: 4, start: Fast), continuation: (parameter: Friction, \
             range: (1.1, 1.3), toward: Up, {end}), \
             stability: (sectors: Only([0]), eigenvalues: 3, max_frequency: 12.0))"
        );
        let problem = brakewave::problem::parse(&text, "fold").expect("a problem");
        let rows = follow(&problem, &text);
        let mut kinds = rows.items.iter().map(|item| item.point.kind);
        assert!(kinds.any(|kind| kind == Some(EventType::LP)));
        assert!(rows.notes.is_empty(), "β = {beta}: {:?}", rows.notes);
    }
}
