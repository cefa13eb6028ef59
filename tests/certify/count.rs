//! Growing eigenvalues, counted by an argument that is enclosed, against the counts of doubles; what must not be
//! counted, and what must be refused.

use brakewave::branch::run::{WaveItem, WaveRunner};
use brakewave::certify::{
    self, CertifiedPoint, Counted, GrowthCount, ProofOutcome, ProvenEigenvalue, ProvenVerdict,
    RefusedProof, WaveCondition,
};
use brakewave::interval::{Decimal, Interval};
use brakewave::orbit::EventType;
use brakewave::orbit::legs::Run as _;
use brakewave::problem;
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::stability::spectrum::{SpectrumRequest, spectrum};
use nalgebra::Complex;

use super::waves::proof;

/// The points of a problem file of which the growing eigenvalues are counted, and how many there are.
fn counted(
    name: &str,
    changes: &[(&str, &str)],
    kinds: &[EventType],
) -> Vec<(WaveItem, CertifiedPoint)> {
    let path = format!("{}/problems/{name}.ron", env!("CARGO_MANIFEST_DIR"));
    let mut text = std::fs::read_to_string(path).unwrap();
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    let problem = problem::parse(&text, name).unwrap();
    let continuation = problem.continuation(&text, name).unwrap().clone();
    let window = problem.stability.clone().unwrap_or_default().max_frequency;
    let mut branch = WaveRunner::begin(&problem, &continuation, None).unwrap();
    let mut found = Vec::new();
    while branch.progress().end.is_none() {
        for item in branch.step() {
            let wanted = |item: &WaveItem| {
                item.event
                    .as_ref()
                    .is_some_and(|event| kinds.contains(&event.kind))
            };
            if let Some(point) = Some(&item)
                .filter(|item| wanted(item))
                .and_then(|item| certify::certify(item, &text))
            {
                let growth = point.counted(window);
                found.push((item, CertifiedPoint { growth, ..point }));
            }
        }
    }
    found
}

fn growth(point: &CertifiedPoint) -> &GrowthCount {
    match point.growth.as_ref() {
        Some(Counted::Proven(growth)) => growth,
        other => panic!("{}: {other:?}", point.kind),
    }
}

const VALUES: [EventType; 2] = [EventType::UZ, EventType::EP];

/// With damping, with static friction, and through reverse slip and separation: at crossings those that stay are
/// counted, and the one that crosses is not.
#[test]
fn counts_are_those_of_doubles() {
    let crossings = [EventType::HB, EventType::UZ, EventType::EP];
    let shorter = [
        ("range: (0.00055, 0.2)", "range: (0.044, 0.2)"),
        (
            "stop_at: [0.08, 0.045, 0.02, 0.004, 0.001],",
            "stop_at: [0.08, 0.06, 0.045],",
        ),
    ];
    for (name, changes, kinds, least) in [
        ("mode4_damping", &[][..], &crossings[..], 13),
        ("mode4_static", &[], &crossings, 5),
        ("mode4_stability", &shorter, &VALUES, 5),
    ] {
        let points = counted(name, changes, kinds);
        assert!(points.len() >= least, "{name}: {}", points.len());
        for (item, point) in &points {
            let growth = growth(point);
            assert_eq!(
                Some(growth.on_circle()),
                item.point.unstable,
                "{name}: {point:?}"
            );
            let unstable = growth.on_circle() > 0;
            assert_eq!(unstable, growth.verdict == ProvenVerdict::Unstable);
            let proof = proof(point);
            // those enclosed lead, each right of its line
            assert_eq!(
                growth.leading.len(),
                proof.eigenvalues.len(),
                "{name}: {growth:?}"
            );
            for (leading, eigenvalue) in growth.leading.iter().zip(&proof.eigenvalues) {
                assert_eq!(leading.sector, eigenvalue.sector);
                assert!(leading.line < eigenvalue.growth.low);
            }
        }
    }
}

/// The wave that rings of many points show to be stable. In doubles |t| + |d| stays below 1 beyond the bound.
#[test]
fn stability_on_the_full_circle_is_proven() {
    let points = counted("ring_damped_circle", &[], &VALUES);
    let (item, point) = &points[0];
    let growth = growth(point);
    let ProvenVerdict::Stable { beyond } = growth.verdict else {
        panic!("{growth:?}");
    };
    assert_eq!(growth.counts, [0, 0, 0]);
    let (wave, unknowns) = item.wave();
    let characteristic = Characteristic::new(wave, unknowns).unwrap();
    for index in 0..2000 {
        let lambda = Complex::new(0.0, beyond * (1.0 + 0.01 * f64::from(index)));
        let [trace, determinant] = characteristic.evaluate(lambda).numbers();
        assert!(trace.norm() + determinant.norm() < 1.0, "{lambda}");
    }
    certify::verify(point, proof(point)).unwrap();
    // what is said of it otherwise: a bound that is too low, an eigenvalue too many, another window
    let changes: [fn(&mut GrowthCount); 4] = [
        |growth| growth.verdict = ProvenVerdict::Stable { beyond: 13.0 },
        |growth| growth.verdict = ProvenVerdict::Unstable,
        |growth| growth.counts[1] += 1,
        |growth| growth.mode = 2,
    ];
    for change in changes {
        let mut false_one = growth.clone();
        change(&mut false_one);
        let point = CertifiedPoint {
            growth: Some(Counted::Proven(false_one)),
            ..point.clone()
        };
        let refused = certify::verify(&point, proof(&point));
        assert_eq!(
            refused,
            Err(RefusedProof::Statement("what grows")),
            "{:?}",
            point.growth
        );
    }
}

/// Slip and separation without damping: V swings as a whole, with the frequency √h on the axis.
#[test]
fn a_wave_without_stick_has_an_eigenvalue_on_the_axis() {
    let changes = [(
        "stop_at: [0.08, 0.045, 0.02, 0.004, 0.001],",
        "stop_at: [],",
    )];
    let points = counted("mode4_mismatch", &changes, &[EventType::EP]);
    let (item, point) = points.last().unwrap();
    assert_eq!(item.point.regimes, "slip-separation");
    let growth = growth(point);
    let (wave, unknowns) = item.wave();
    let characteristic = Characteristic::new(wave, unknowns).unwrap();
    let constants = item.point.model.constants();
    let swing = Complex::new(0.0, constants.coefficients.h.sqrt());
    let [trace, determinant] = characteristic.evaluate(swing).numbers();
    assert!((1.0 - trace + determinant).norm() < 1e-12);
    // of those growing in doubles up to 12, sector by sector
    let request = SpectrumRequest {
        sectors: vec![0, 1, 2],
        eigenvalues: 60,
        max_frequency: 12.0,
    };
    let spectrum = spectrum(&characteristic, &request, None);
    assert_eq!(growth.on_circle(), spectrum.unstable());
}

/// The line of a leading eigenvalue behind another one, and a count that lacks one.
#[test]
fn false_counts_are_refused() {
    let changes = [
        ("stop_at: [0.05, 0.1, 0.2],", "stop_at: [0.05],"),
        ("range: (0.0, 0.4)", "range: (0.0, 0.06)"),
    ];
    let points = counted("mode4_damping", &changes, &[EventType::UZ]);
    let (_, point) = &points[0];
    assert_eq!(certify::verify(point, proof(point)), Ok(()));
    let changes: [fn(&mut GrowthCount); 3] = [
        |growth| growth.leading[0].line -= 1.0,
        |growth| growth.leading[0].sector = 2,
        |growth| growth.counts[0] -= 2,
    ];
    for change in changes {
        let mut false_one = growth(point).clone();
        change(&mut false_one);
        let point = CertifiedPoint {
            growth: Some(Counted::Proven(false_one)),
            ..point.clone()
        };
        assert!(
            certify::verify(&point, proof(&point)).is_err(),
            "{:?}",
            point.growth
        );
    }
}

/// Just before a fold a real eigenvalue is close to λ = 0: with the translation mode in its place there are as many
/// right of a line as if it led.
#[test]
fn the_translation_mode_does_not_lead() {
    let changes = [
        ("stop_at: [0.3, 0.5, 0.8],", "stop_at: [1.09],"),
        ("range: (0.2, 3.0)", "range: (0.2, 1.0905)"),
    ];
    let points = counted("mode4_friction", &changes, &[EventType::UZ]);
    let leading = |near: [f64; 2], growth: [f64; 2]| {
        let mut point = points[0].1.clone();
        let ProofOutcome::Proven(proof) = &mut point.outcome else {
            panic!("{:?}", point.outcome);
        };
        proof.eigenvalues = vec![ProvenEigenvalue {
            sector: 0,
            near,
            growth: Interval::new(growth[0], growth[1]),
            omega: Interval::new(-1e-9, 1e-9),
        }];
        match point.counted(1.0) {
            Some(Counted::Proven(growth)) => growth.leading.len(),
            other => panic!("{other:?}"),
        }
    };
    // Re λ = −0.02784299 by `spectrum`
    assert_eq!(leading([-0.027842987, 0.0], [-0.027843, -0.027842]), 1);
    assert_eq!(leading([0.0, 0.0], [-1e-9, 1e-9]), 0);
}

/// At a crossing that is not said to be one, an eigenvalue is within rounding of the axis.
#[test]
fn an_eigenvalue_next_to_the_axis_is_undecided() {
    let changes = [
        ("range: (0.0, 0.4)", "range: (0.0, 0.04)"),
        ("stop_at: [0.05, 0.1, 0.2],", ""),
    ];
    let points = counted("mode4_damping", &changes, &[EventType::HB]);
    let (_, crossing) = &points[0];
    assert_eq!(growth(crossing).counts, [4, 4, 4]);
    let found = proof(crossing).clone();
    let value = WaveCondition::Value(Decimal::of(found.near.parameter));
    let proof = certify::prove(found.posed, found.near, value, None).unwrap();
    let point = CertifiedPoint {
        kind: EventType::UZ,
        outcome: ProofOutcome::Proven(Box::new(proof)),
        ..crossing.clone()
    };
    match point.counted(12.0) {
        Some(Counted::Open(reason)) => assert!(reason.contains("of sector 1"), "{reason}"),
        other => panic!("{other:?}"),
    }
    // a window that ends next to it
    let omega = crossing_frequency(crossing);
    assert!(matches!(crossing.counted(omega), Some(Counted::Open(_))));
}

fn crossing_frequency(point: &CertifiedPoint) -> f64 {
    match proof(point).condition {
        WaveCondition::Crossing { omega, .. } => omega.abs(),
        _ => f64::NAN,
    }
}
