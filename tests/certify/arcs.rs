//! Arcs between special points, and leading eigenvalues.

use brakewave::certify::{
    self, ArcOutcome, CertifiedPoint, ProofOutcome, WaveCondition, WaveProof,
};
use brakewave::interval::{Decimal, Interval};
use brakewave::orbit::EventType;
use brakewave::tube::model::Parameter;
use brakewave::tube::wave::admissibility::WaveWatch;
use brakewave::tube::wave::start::Which;

use super::waves::{has, mismatch_of_pressure, points, points_of, proof, slip_stick_at};

/// Every stretch between the special points of a branch, and their types.
fn stretches(points: &[CertifiedPoint]) -> Vec<(EventType, ArcOutcome)> {
    let both = points.windows(2);
    let stretch = |both: &[CertifiedPoint]| (both[1].kind, both[1].stretch(&both[0]).unwrap());
    both.map(stretch).collect()
}

/// Between the special points of slip-stick branches there is no other: in the mismatch, where the wave itself
/// stays the same, in the friction on both sides of the fold, and to where the stick zone vanishes.
#[test]
fn arcs_of_slip_stick_waves_are_proven() {
    for (name, wanted) in [("mode4_friction", 5), ("mode4_damping", 4)] {
        let points = points_of(name, &[]);
        for (kind, stretch) in &stretches(&points[..=wanted]) {
            assert!(
                matches!(stretch, ArcOutcome::Proven),
                "{name} {kind}: {stretch:?}"
            );
        }
        let (last, regimes) = (
            &points[wanted],
            proof(&points[wanted]).near.signature.to_string(),
        );
        assert_eq!(regimes, "slip-stick");
        assert!(matches!(last.kind, EventType::GR | EventType::ST));
    }
}

/// A whole branch: reverse slip opens (RV), separation opens (GR), zones give way to others (CO), stick vanishes
/// (ST). All regimes are what they are said to be, and there is no other event.
#[test]
fn a_branch_is_proven_through_changes_of_regime() {
    for (name, kinds) in [
        ("mode4_mismatch", "RV UZ GR UZ CO UZ UZ CO UZ ST EP"),
        ("mode8_reverse", "RV UZ GR CO EP"),
    ] {
        let stretches = stretches(&points_of(name, &[]));
        let found: Vec<String> = stretches.iter().map(|(kind, _)| kind.to_string()).collect();
        assert_eq!(found.join(" "), kinds, "{name}");
        for (kind, stretch) in &stretches {
            assert!(
                matches!(stretch, ArcOutcome::Proven),
                "{name} {kind}: {stretch:?}"
            );
        }
    }
}

/// What a certificate says of the wave beyond an event is proven, not believed.
#[test]
fn a_false_wave_beyond_an_event_is_not_proven() {
    let points = points_of("mode8_reverse", &[]);
    let arc = |change: &dyn Fn(&mut WaveProof), from: usize| {
        let mut before = points[from].clone();
        if let ProofOutcome::Proven(proof) = &mut before.outcome {
            change(proof);
        }
        points[from + 1].stretch(&before).unwrap()
    };
    let beyond = |index: usize| proof(&points[index]).beyond.clone().unwrap();
    // RV, GR, CO
    for from in [1, 3, 4] {
        assert!(matches!(arc(&|_| {}, from), ArcOutcome::Proven));
        // beyond RV its own condition is true, too: that the reverse slip which lasts no time is about to begin
        let elsewhere = proof(&points[from.max(3)]).condition.clone();
        let falsified: [&dyn Fn(&mut WaveProof); 5] = [
            &|proof| proof.beyond = None,
            &|proof| proof.beyond.as_mut().unwrap().near.excess *= 1.5,
            &|proof| proof.beyond.as_mut().unwrap().near.zones[0][2] *= 0.5,
            &|proof| {
                let beyond = proof.beyond.as_mut().unwrap();
                beyond.near.signature.0.rotate_left(1);
            },
            &|proof| proof.beyond.as_mut().unwrap().condition = elsewhere.clone(),
        ];
        for (index, change) in falsified.into_iter().enumerate() {
            let stretch = arc(change, from);
            assert!(
                matches!(stretch, ArcOutcome::Open(_)),
                "{from} {index}: {stretch:?}"
            );
        }
        for other in [1, 3, 4].into_iter().filter(|other| *other != from) {
            let stretch = arc(&|proof| proof.beyond = Some(beyond(other)), from);
            assert!(
                matches!(stretch, ArcOutcome::Open(_)),
                "{from} {other}: {stretch:?}"
            );
        }
        // the event left out, and what lies beyond it attached to the point before
        let over = points[from + 1].stretch(&points[from - 1]).unwrap();
        assert!(matches!(over, ArcOutcome::Open(_)), "{from}: {over:?}");
        let mut before = points[from - 1].clone();
        if let ProofOutcome::Proven(proof) = &mut before.outcome {
            proof.beyond = Some(beyond(from));
        }
        // the arc begins with what is beyond, which is proven, or not, with its point
        let refused = certify::verify(&before, proof(&before));
        assert!(refused.is_err(), "{from}");
    }
    // a zone that the signature has not
    let closed = |proof: &mut WaveProof| {
        proof.condition = WaveCondition::Margin {
            watch: WaveWatch::Duration,
            zone: 99,
            time: 0.0,
        };
    };
    for from in [0, 3] {
        let mut before = points[from].clone();
        if let ProofOutcome::Proven(proof) = &mut before.outcome {
            closed(proof);
        }
        assert!(certify::verify(&before, proof(&before)).is_err(), "{from}");
    }
}

/// An arc that leaves out a point at which the regimes change, or a fold, is not proven.
#[test]
fn an_arc_over_an_event_is_not_proven() {
    // from f = 0.2 to the second wave at the same f, beyond the fold
    let points = points_of("mode4_friction", &[]);
    let fold = points
        .iter()
        .position(|point| point.kind == EventType::LP)
        .unwrap();
    let over = points[fold + 1].stretch(&points[fold - 1]).unwrap();
    assert!(matches!(over, ArcOutcome::Open(_)), "{over:?}");
    // the slip-stick wave satisfies its equations on either side of GR, but not its inequalities
    let near = |which, mismatch| slip_stick_at(which, mismatch).unwrap();
    let take_off = mismatch_of_pressure(0.0);
    let (above, far) = (
        near(Which::Slow, take_off * (1.0 + 1e-9)),
        near(Which::Slow, take_off * 1.5),
    );
    let point = |proof: WaveProof| CertifiedPoint {
        label: 1,
        kind: EventType::UZ,
        parameter: Parameter::Mismatch,
        leg: 0,
        outcome: ProofOutcome::Proven(Box::new(proof)),
        arc: None,
        growth: None,
    };
    let honest = point(above.clone()).stretch(&point(far.clone()));
    assert!(matches!(honest, Some(ArcOutcome::Proven)), "{honest:?}");
    // ends are taken to be proven: a false one is refused by itself, and an arc to it by its inequalities
    let mut beyond = above.clone();
    beyond.near.parameter = take_off * (1.0 - 1e-3);
    beyond.condition = WaveCondition::Value(Decimal::of(beyond.near.parameter));
    assert!(certify::verify(&point(beyond.clone()), &beyond).is_err());
    let past = point(beyond).stretch(&point(above));
    assert!(
        matches!(&past, Some(ArcOutcome::Open(reason)) if reason.contains("P > 0 in zone 0")),
        "{past:?}"
    );
}

/// Leading eigenvalues at user points, against figures of an independent program with 13 digits.
#[test]
fn leading_eigenvalues_are_proven() {
    let stop = "stop_at: [0.08, 0.045, 0.02, 0.004, 0.001],";
    let changes = [
        ("range: (0.00055, 0.2)", "range: (0.044, 0.2)"),
        (stop, "stop_at: [0.08, 0.045],"),
    ];
    for (sector, reference) in [
        (
            0,
            [
                [0.04965063748184, 2.541566892289],
                [0.028543473561, 2.554582046982],
                [-0.06560045252819, 9.948578715806],
            ],
        ),
        (
            1,
            [
                [0.1279698868278, 1.319591652955],
                [0.1002644739858, 1.320228603567],
                [0.01308361440521, -0.4349184283147],
            ],
        ),
    ] {
        let points = points("mode4_stability", &changes, Some(sector));
        let valued =
            |point: &&CertifiedPoint| matches!(proof(point).condition, WaveCondition::Value(_));
        let valued: Vec<&CertifiedPoint> = points.iter().filter(valued).collect();
        for (point, [re, im]) in valued.iter().zip(reference) {
            let honest = proof(point);
            let found = honest.eigenvalues[0];
            assert_eq!(found.sector, sector);
            assert!(has(found.growth, re, 2e-12), "{re}: {found:?}");
            assert!(has(found.omega, im, 2e-12), "{im}: {found:?}");
            assert!(found.growth.width() < 1e-10 && found.omega.width() < 1e-10);
            assert_eq!(honest.is_unstable(), re > 0.0);
            assert_eq!(certify::verify(point, honest), Ok(()));
            let mut other = honest.clone();
            other.eigenvalues[0].growth = Interval::point(re + 1e-6);
            assert!(certify::verify(point, &other).is_err());
        }
    }
}
