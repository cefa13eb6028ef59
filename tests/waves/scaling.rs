//! (γ, δ) → (s²γ, sδ) divides c by s and leaves the lengths of all zones alone: an exact symmetry
//! of the model, which the units of the program follow, so that even the steps are the same. With damping
//! (α, β) → (α/s, sβ) as well.

use brakewave::continuation::walk::End;
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{CoefficientSource, Damping, Model, Parameter};

use crate::waves::branches::{
    Case, Run, fast_in_mismatch, lengths, regimes, speed, tube, with_material_damping,
};
use crate::waves::observed;

/// A case in units of time that are s times as short.
fn in_units(case: Case, s: f64) -> Case {
    let model = case.model;
    let geometry = model.source.geometry().expect("a tube");
    let unit = unit_of(case.parameter, s);
    Case {
        model: Model {
            damping: Damping {
                mass: model.damping.mass / s,
                stiffness: model.damping.stiffness * s,
            },
            source: CoefficientSource::from(Geometry {
                gamma: s * s * geometry.gamma,
                ..geometry
            }),
            mismatch: s * model.mismatch,
            ..model
        },
        range: (unit * case.range.0, unit * case.range.1),
        ..case
    }
}

/// What a parameter is multiplied by in these units.
fn unit_of(parameter: Parameter, s: f64) -> f64 {
    match parameter {
        Parameter::Mismatch => s,
        Parameter::Xi => 1.0,
        other => panic!("no case has {other:?}"),
    }
}

fn scaled(case: Case, s: f64) -> Case {
    let range = (0.001, 0.2);
    in_units(Case { range, ..case }, s)
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
    assert_eq!(run.points[0].orbit.model.damping.stiffness, 1.0);
    observed("scaling: events at β = 1", difference(&run, &unit, 200.0));
}

/// Units that are no powers of two, so that every number is rounded differently: 10^x, |x| < 3, from a
/// sequence that fills the interval evenly.
fn some_units() -> impl Iterator<Item = f64> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    (1..).map(|index| 10.0_f64.powf(6.0 * (f64::from(index) * GOLDEN).fract() - 3.0))
}

/// Separated waves of fast branches with little damping, the layers of which differ in thickness by a
/// factor of five to ten: the branches go on to the end of their range, with the same events in any unit.
#[test]
fn branches_with_thin_layers_end_in_the_same_place() {
    let damped = |(nu, xi, friction, mismatch), mass, stiffness| Model {
        damping: Damping { mass, stiffness },
        ..tube(nu, xi, friction, mismatch)
    };
    let cases = [
        (
            damped((0.3038, 2.436, 0.08662, 0.83), 7.692e-4, 3.014e-8),
            (12, Parameter::Mismatch, 0.8),
            "GR RV",
        ),
        (
            damped((0.4357, 3.528, 0.1639, 0.15), 6.857e-3, 1.78e-5),
            (5, Parameter::Mismatch, 0.14),
            "GR",
        ),
        (
            damped((0.0, 1.881, 0.05858, 0.163), 0.0, 9.033e-7),
            (16, Parameter::Mismatch, 0.159),
            "CO RV",
        ),
        (
            damped((0.4835, 2.09, 0.1075, 0.08696), 0.0, 8.589e-3),
            (1, Parameter::Xi, 2.222),
            "",
        ),
    ];
    let mut worst = 0.0_f64;
    for ((model, (mode, parameter, last), expected), s) in cases.into_iter().zip(some_units()) {
        let first = model.value(parameter).expect("a number");
        let case = Case {
            model,
            parameter,
            mode,
            range: (first.min(last), first.max(last)),
            up: last > first,
            ..fast_in_mismatch()
        };
        let unit = case.follow(&[]);
        let found: Vec<String> = unit
            .events()
            .iter()
            .map(|found| format!("{:?}", found.kind().expect("an event")))
            .collect();
        assert_eq!(found.join(" "), expected);
        let run = in_units(case, s).follow(&[]);
        assert_eq!(unit.end, Some(End::Edge), "{model:?}");
        assert_eq!(run.end, Some(End::Edge), "{model:?} in units of {s}");
        worst = worst.max(difference(&run, &unit, s));
    }
    observed("scaling: thin layers", worst);
}

/// A layer of β = 2e-8 is thinner than the first steps into separation. Whatever rounding says of those
/// within it, as it does in the last of these units, the branch goes on beyond.
#[test]
fn separation_opens_in_any_unit() {
    let case = Case {
        model: Model {
            damping: Damping {
                mass: 0.01299,
                stiffness: 1.755e-8,
            },
            ..tube(0.1929, 2.947, 0.109, 0.6)
        },
        mode: 2,
        range: (0.57, 0.6),
        ..fast_in_mismatch()
    };
    let unit = case.follow(&[]);
    assert_eq!(unit.events().len(), 1);
    let mut worst = 0.0_f64;
    for index in [0, 1, 2, 21] {
        let s = some_units().nth(index).expect("a unit");
        let run = in_units(case, s).follow(&[]);
        assert_eq!(run.end, Some(End::Edge), "in units of {s}");
        worst = worst.max(difference(&run, &unit, s));
    }
    observed("scaling: opening beyond a thin layer", worst);
}

/// How much the events of two branches differ, relative to their units.
fn difference(run: &Run, unit: &Run, s: f64) -> f64 {
    let mut worst = 0.0_f64;
    let (events, expected) = (run.events(), unit.events());
    assert_eq!(events.len(), expected.len());
    for (one, other) in events.into_iter().zip(expected) {
        assert_eq!(one.kind(), other.kind());
        assert_eq!(regimes(one), regimes(other));
        let mut compare = |found: f64, expected: f64, unit: f64| {
            let error = (found - expected).abs() / unit;
            worst = worst.max(error);
            assert!(error < 1e-11, "{found} for {expected} at s = {s}");
        };
        let unit = unit_of(one.orbit.parameter, s);
        compare(one.parameter / unit, other.parameter, other.parameter);
        compare(speed(one) * s, speed(other), speed(other).abs());
        let zones = lengths(&one.orbit, &one.node.point);
        for (length, expected) in zones
            .into_iter()
            .zip(lengths(&other.orbit, &other.node.point))
        {
            compare(length, expected, 1.0);
        }
    }
    worst
}
