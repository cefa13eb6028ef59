//! At a fold a real eigenvalue of sector 0 passes through the translation mode, and is no other event;
//! a real eigenvalue that crosses elsewhere is a BP.
//!
//! Real eigenvalues are counted a second way: F_j is real on the real axis in sectors 0 and k/2, and
//! changes its sign at each of them; the translation mode is divided out.

use brakewave::branch::EventType;
use brakewave::branch::run::WaveItem;
use brakewave::problem;
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::stability::spectrum::{SpectrumRequest, spectrum};

use crate::stability::observed;
use crate::stability::waves::{C64, Rows, follow, follow_from};

fn run(text: &str) -> Rows {
    let problem = problem::parse(text, "fold").expect("a problem");
    follow(&problem, text)
}

fn linearised(item: &WaveItem) -> Characteristic {
    let (wave, point) = item.wave();
    Characteristic::new(wave, point).expect("a linear law")
}

/// F_j at a real λ, without the factor that keeps it of order one.
fn real(characteristic: &Characteristic, sector: usize, lambda: f64) -> (f64, f64) {
    let z = characteristic.multiplier(sector);
    let (f, by) = characteristic.evaluate(C64::new(lambda, 0.0)).sector(z);
    (f.re, by.re)
}

/// Real eigenvalues in (0, right) by changes of sign.
fn positive(characteristic: &Characteristic, sector: usize, right: f64) -> usize {
    const SAMPLES: usize = 4000;
    // from 1e-7 of the range on, evenly in the logarithm
    let at = |index: usize| right * (-16.0 * (1.0 - index as f64 / SAMPLES as f64)).exp();
    let origin = real(characteristic, sector, 0.0);
    let mut last = if sector == 0 { origin.1 } else { origin.0 };
    let mut changes = 0;
    for index in 0..=SAMPLES {
        let (next, _) = real(characteristic, sector, at(index));
        changes += usize::from(next * last < 0.0);
        last = next;
    }
    changes
}

fn request(sector: usize) -> SpectrumRequest {
    SpectrumRequest {
        sectors: vec![sector],
        eigenvalues: 3,
        max_frequency: 1.0,
    }
}

/// The fold of a wave without stick, after which the growing real eigenvalue is 2e-3 and both it and
/// the translation mode have nearly the same eigenfunction.
#[test]
fn a_fold_without_stick_is_only_a_fold() {
    let rows = run(
        "(model: (coefficients: Geometry(nu: 0.3323, xi: 1.4708, gamma: 0.0258), \
         friction: 1.36, mismatch: 0.00332), wave: (mode: 5, start: Fast), \
         continuation: (parameter: Nu, range: (0.2, 0.34), toward: Down, max_points: 420, \
         stop_at: [0.2162], stop_after: [(event: UZ, count: 4)]), \
         stability: (sectors: Only([0]), eigenvalues: 3, max_frequency: 1.0))",
    );
    let kinds: Vec<Option<EventType>> = rows.items.iter().map(|item| item.point.kind).collect();
    assert!(!kinds.contains(&Some(EventType::BP)));
    let fold = kinds
        .iter()
        .rposition(|kind| *kind == Some(EventType::LP))
        .expect("there is a fold");
    assert_eq!(rows.items[fold].point.regimes, "slip-separation");
    let (mut before, mut after) = (0, 0);
    for (index, item) in rows.items.iter().enumerate().skip(fold - 4).take(9) {
        let characteristic = linearised(item);
        let found = spectrum(&characteristic, &request(0), None);
        assert!(found.complete);
        let values = found.sectors[0].eigenvalues.iter();
        let growing = values
            .clone()
            .filter(|one| one.im == 0.0 && one.re > found.axis);
        if index == fold {
            // the one that crosses is there, and on the axis to rounding
            assert!(values.clone().any(|one| one.value().norm() < found.axis));
            continue;
        }
        let growing = growing.count();
        assert_eq!(
            growing,
            positive(&characteristic, 0, found.right),
            "row {index}"
        );
        if index + 1 == fold {
            before = growing;
        } else if index == fold + 1 {
            after = growing;
        }
    }
    assert_eq!(after, before + 1);
    assert!(rows.notes.is_empty(), "{:?}", rows.notes);
}

/// Along waves without stick a real eigenvalue of sector k/2 crosses: there the period doubles. λ = 0 is
/// an eigenvalue where 1 + t(0) + d(0) = 0, which changes its sign from row to row as often as there
/// are BP, and vanishes at them.
#[test]
fn a_real_eigenvalue_that_crosses_is_found() {
    let rows = run(
        "(model: (coefficients: Geometry(nu: 0.202, xi: 1.577, gamma: 1.0), \
         friction: 0.25, mismatch: 0.0252), wave: (mode: 6, start: Fast), \
         continuation: (parameter: Friction, range: (0.2, 2.0), toward: Both, max_points: 600, \
         stop_at: [0.51], stop_after: [(event: UZ, count: 2)]), \
         stability: (sectors: Only([3]), eigenvalues: 2, max_frequency: 0.5))",
    );
    let at_zero = |item: &WaveItem| real(&linearised(item), 3, 0.0).0;
    let mut changes = 0;
    let mut last: Option<(usize, f64)> = None;
    let mut events = Vec::new();
    let mut worst = 0.0_f64;
    for item in &rows.items {
        let without_stick = !item.point.regimes.ends_with("stick");
        match item.point.kind {
            Some(EventType::BP) => {
                let event = item.event.as_ref().expect("an event");
                assert_eq!((event.sector, event.omega), (Some(3), None));
                worst = worst.max(at_zero(item).abs());
                events.push(event.model.friction);
            }
            // a zone without length
            Some(EventType::CO | EventType::GR | EventType::ST) => last = None,
            _ if without_stick => {
                let value = at_zero(item);
                let changed = |(leg, last): (usize, f64)| leg == item.leg && last * value < 0.0;
                changes += usize::from(last.is_some_and(changed));
                last = Some((item.leg, value));
            }
            _ => last = None,
        }
    }
    assert!(events.len() > 1);
    assert!(rows.notes.is_empty(), "{:?}", rows.notes);
    assert_eq!(events.len(), changes, "{events:?}");
    assert!(worst < 1e-11, "{worst:e}");
    observed("1 + t(0) + d(0) at a BP", worst);
    doubled(&rows.items);
}

/// From the first BP of the sector k/2 of mode 6 a wave of mode 3 branches off, with twice the wavelength and the regimes
/// twice. Its branch ends where it has come to another BP of that kind, traversed twice. Beside the first the
/// friction moves by the square of what the halves differ by.
fn doubled(items: &[WaveItem]) {
    let at: Vec<&WaveItem> = items
        .iter()
        .filter(|item| item.point.kind == Some(EventType::BP))
        .collect();
    let text = "(model: (coefficients: Geometry(nu: 0.202, xi: 1.577, gamma: 1.0), \
         friction: 0.25, mismatch: 0.0252), wave: (mode: 3, start: Switch(dir: \"six\", label: 1)), \
         continuation: (parameter: Friction, range: (0.2, 2.0), ds: 0.002))";
    let problem = problem::parse(text, "doubled").expect("a problem");
    let rows = follow_from(&problem, text, at[0].saved.as_ref());
    let friction = |item: &WaveItem| {
        let (wave, point) = item.wave();
        wave.parameter_at(point)
    };
    let first = friction(at[0]);
    // what the halves differ by, squared, against the way in the parameter
    let ratios: Vec<f64> = rows.items[..3]
        .iter()
        .map(|item| {
            let (wave, point) = item.wave();
            let half = 3 * wave.zones() / 2;
            let off = (0..half).map(|index| (point[index] - point[index + half]).powi(2));
            (friction(item) - first) / off.sum::<f64>()
        })
        .collect();
    assert!(ratios[0] > 0.0);
    for ratio in &ratios[1..] {
        assert!((ratio / ratios[0] - 1.0).abs() < 0.05, "{ratios:?}");
    }
    let last = rows.items.last().expect("a point");
    assert_eq!(last.point.kind, Some(EventType::BP));
    let apart = at
        .iter()
        .map(|item| (friction(item) - friction(last)).abs())
        .fold(f64::INFINITY, f64::min);
    let event = last.event.as_ref().expect("an event");
    assert!(apart <= event.uncertainty, "{apart:e}");
    let bps = rows
        .items
        .iter()
        .filter(|item| item.point.kind == Some(EventType::BP));
    assert_eq!(bps.count(), 1);
    observed("end of a doubled branch against the BP there", apart);
}
