//! Arcs between special points, and leading eigenvalues.

use brakewave::certify::{self, Condition, Outcome, Point, Proof, Stretch};
use brakewave::interval::{Decimal, Interval};
use brakewave::model::{EventType, Parameter};
use brakewave::wave::start::Which;

use super::waves::{has, mismatch_of_pressure, points, points_of, proof, slip_stick_at};

/// Between the special points of slip-stick branches there is no other: in the mismatch, where the wave itself
/// stays the same, and in the friction on both sides of the fold.
#[test]
fn arcs_of_slip_stick_waves_are_proven() {
    for (name, signature, wanted) in [
        ("mode4_mismatch", "slip-stick", 1),
        ("mode4_friction", "slip-stick", 5),
        ("mode4_damping", "slip-stick", 3),
    ] {
        let points = points_of(name, &[]);
        let mut proven = 0;
        for both in points.windows(2) {
            let regimes = proof(&both[1]).near.signature.to_string();
            // where steady sliding has its Hopf point the parameter is stationary in the length of stick
            if regimes != signature || both[1].kind == EventType::ST {
                break;
            }
            let stretch = both[1].stretch(&both[0]).unwrap();
            assert!(matches!(stretch, Stretch::Proven(_)), "{name}: {stretch:?}");
            proven += 1;
        }
        assert_eq!(proven, wanted, "{name}");
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
    assert!(matches!(over, Stretch::Open(_)), "{over:?}");
    // the slip-stick wave satisfies its equations on either side of GR, but not its inequalities
    let near = |which, mismatch| slip_stick_at(which, mismatch).unwrap();
    let take_off = mismatch_of_pressure(0.0);
    let (above, far) = (
        near(Which::Slow, take_off * (1.0 + 1e-9)),
        near(Which::Slow, take_off * 1.5),
    );
    let point = |proof: Proof| Point {
        label: 1,
        kind: EventType::UZ,
        parameter: Parameter::Mismatch,
        leg: 0,
        outcome: Outcome::Proven(Box::new(proof)),
        arc: None,
    };
    let honest = point(above.clone()).stretch(&point(far.clone()));
    assert!(matches!(honest, Some(Stretch::Proven(_))), "{honest:?}");
    // ends are taken to be proven: a false one is refused by itself
    let mut beyond = above;
    beyond.near.parameter = take_off * (1.0 - 1e-3);
    beyond.condition = Condition::Value(Decimal::of(beyond.near.parameter));
    assert!(certify::verify(&point(beyond.clone()), &beyond).is_err());
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
        let valued = |point: &&Point| matches!(proof(point).condition, Condition::Value(_));
        let valued: Vec<&Point> = points.iter().filter(valued).collect();
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
