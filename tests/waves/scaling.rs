//! (γ, δ) → (s²γ, sδ) divides c by s and leaves the lengths of all zones alone: an exact symmetry
//! of the model, which the units of the program follow, so that even the steps are the same. With material
//! damping β → sβ as well.

use brakewave::model::coefficients::Geometry;
use brakewave::model::{Model, Source};

use crate::branches::{
    Case, Run, fast_in_mismatch, lengths, regimes, speed, with_material_damping,
};
use crate::observed;

fn scaled(case: Case, s: f64) -> Case {
    let mut damping = case.model.damping;
    damping.stiffness *= s;
    Case {
        model: Model {
            damping,
            source: Source::from(Geometry {
                nu: 0.3,
                xi: 1.5,
                gamma: s * s,
            }),
            mismatch: s * case.model.mismatch,
            ..case.model
        },
        range: (s * 0.001, s * 0.2),
        ..case
    }
}

/// Rounding of s²γ and sδ is all that distinguishes the branches: ε, amplified by the condition of
/// an event, which the stated uncertainty measures (1e-14 to 1e-12 relative).
#[test]
fn scaled_branches_are_the_same() {
    let unit = scaled(fast_in_mismatch(), 1.0).follow(&[]);
    let mut worst = 0.0_f64;
    for s in [1e-3, 0.1, 7.0, 1e3] {
        let run = scaled(fast_in_mismatch(), s).follow(&[]);
        assert_eq!(run.points.len(), unit.points.len(), "points at s = {s}");
        worst = worst.max(difference(&run, &unit, s));
    }
    observed("scaling: events", worst);
}

/// β = 1 is β = 0.005 of a tube with γ = 4·10⁴: slip, reverse slip, stick and separation.
#[test]
fn waves_with_much_damping_are_waves_with_little() {
    let case = with_material_damping(5e-3);
    let unit = scaled(case, 1.0).follow(&[]);
    let run = scaled(case, 200.0).follow(&[]);
    assert_eq!(run.points[0].wave.model.damping.stiffness, 1.0);
    observed("scaling: events at β = 1", difference(&run, &unit, 200.0));
}

/// How much the events of two branches differ, relative to their units.
fn difference(run: &Run, unit: &Run, s: f64) -> f64 {
    let mut worst = 0.0_f64;
    let (events, expected) = (run.events(), unit.events());
    assert_eq!(events.len(), 4);
    assert_eq!(events.len(), expected.len());
    for (one, other) in events.into_iter().zip(expected) {
        assert_eq!(one.kind(), other.kind());
        assert_eq!(regimes(one), regimes(other));
        let mut compare = |found: f64, expected: f64, unit: f64| {
            let error = (found - expected).abs() / unit;
            worst = worst.max(error);
            assert!(error < 1e-11, "{found} for {expected} at s = {s}");
        };
        compare(one.parameter / s, other.parameter, other.parameter);
        compare(speed(one) * s, speed(other), speed(other).abs());
        let zones = lengths(&one.wave, &one.node.point);
        for (length, expected) in zones
            .into_iter()
            .zip(lengths(&other.wave, &other.node.point))
        {
            compare(length, expected, 1.0);
        }
    }
    worst
}
