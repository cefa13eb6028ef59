//! Waves with material damping β: the Hopf point, the limit β → 0, collocation of the third-order
//! equation, the friction force at the ends of stick, symmetry, and zones that open and close.

use brakewave::branch::EventType::{self, GR, RV, ST};
use brakewave::branch::orbit::{Follower, Found};
use brakewave::linalg::Vector;
use brakewave::orbit::follow::Limits;
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{CoefficientSource, Damping, Model, Parameter, signature::Regime};
use brakewave::tube::wave::Wave;
use brakewave::tube::wave::profile::sample;
use nalgebra::{DMatrix, DVector};

use crate::chebyshev::differentiation;
use crate::waves::branches::{
    Case, Run, STEPS, fast_in_mismatch, lengths, mode4, speed, to_the_end, with_material_damping,
};
use crate::waves::observed;

fn event(run: &Run, kind: EventType) -> &Found {
    run.points
        .iter()
        .find(|found| found.kind() == Some(kind))
        .expect("the branch has this event")
}

/// The slip-stick wave of mode 4 at a mismatch where it stays in contact.
fn slip_stick(beta: f64) -> (Wave, Vector) {
    let case = Case {
        model: Model {
            damping: Damping {
                mass: 0.0,
                stiffness: beta,
            },
            ..mode4(0.2)
        },
        ..fast_in_mismatch()
    };
    let found = case.follower(STEPS, &[]).here();
    (found.orbit.as_ref().clone(), found.node.point)
}

/// Branches in β end where α, β and f satisfy K(α + βK)² = k²f²D²(1 − αβ − β²K), K = ak² + h.
#[test]
fn stick_vanishes_at_the_hopf_point() {
    let mut worst = 0.0_f64;
    for (mode, alpha) in [(1, 0.0), (2, 0.0), (3, 0.05), (4, 0.0), (4, 0.1), (6, 0.0)] {
        let case = Case {
            model: Model {
                damping: Damping {
                    mass: alpha,
                    stiffness: 0.0,
                },
                ..mode4(2.0)
            },
            parameter: Parameter::StiffnessDamping,
            mode,
            range: (0.0, 1.0),
            up: true,
            ..fast_in_mismatch()
        };
        let run = case.follow(&[]);
        let end = event(&run, ST);
        let beta = end.parameter;
        let c = case.model.constants().coefficients;
        let k = f64::from(mode);
        let stiffness = c.a * k * k + c.h;
        let damping = alpha + beta * stiffness;
        let drive = k * 0.5 * c.coupling;
        let (left, right) = (
            stiffness * damping * damping,
            drive * drive * (1.0 - beta * damping),
        );
        worst = worst.max((left / right - 1.0).abs());
        // there the wave is linear, |c| = kf|D|/(k(α + βK))
        let linear = drive.abs() / (k * damping);
        worst = worst.max((speed(end).abs() / linear - 1.0).abs());
    }
    observed("ST on the Hopf point with material damping", worst);
    // the stated uncertainty of these events is 1e-15, relative to β of 1e-2
    assert!(worst < 1e-12, "{worst:e}");
}

/// β = 0 is a regular point: speed, durations and events tend to their undamped values, and the
/// differences over β to a limit, linearly in β until rounding over β takes over.
#[test]
fn the_undamped_limit_is_regular() {
    let (wave, point) = slip_stick(0.0);
    let undamped = [wave.speed_at(&point), wave.duration_at(&point, 0)];
    let slopes = |beta: f64| {
        let (wave, point) = slip_stick(beta);
        let damped = [wave.speed_at(&point), wave.duration_at(&point, 0)];
        [0, 1].map(|index| (damped[index] - undamped[index]) / beta)
    };
    let limit = slopes(1e-6);
    for beta in [1e-5, 1e-4, 1e-3] {
        for (slope, limit) in slopes(beta).into_iter().zip(limit) {
            assert!((slope - limit).abs() < 100.0 * beta * limit.abs());
        }
    }
    for beta in [1e-7, 1e-8, 1e-10] {
        for (slope, limit) in slopes(beta).into_iter().zip(limit) {
            let allowed = 100.0 * 1e-6 * limit.abs() + 1e-13 / beta;
            assert!((slope - limit).abs() < allowed, "β = {beta}");
        }
    }
    // and so are its events
    let events = |case: Case| {
        let run = case.follow(&[]);
        [RV, GR].map(|kind| event(&run, kind).parameter)
    };
    let undamped = events(fast_in_mismatch());
    let slope = |beta: f64| {
        let damped = events(with_material_damping(beta));
        [0, 1].map(|index| (damped[index] - undamped[index]) / beta)
    };
    let limit = slope(1e-5);
    for beta in [1e-4, 1e-6, 1e-8, 1e-10] {
        for (slope, limit) in slope(beta).into_iter().zip(limit) {
            // the events are known to 1e-14
            let allowed = 100.0 * beta.max(1e-5) * limit.abs() + 1e-13 / beta;
            assert!(
                (slope - limit).abs() < allowed,
                "β = {beta}: {slope} for {limit}"
            );
        }
    }
}

/// The slip zone by spectral collocation of −βãV⃛ + (m_a − βfκ)V̈ + (α + βh − fκ)V̇ + hY = 0 with
/// V̇ = 1 at both ends and V̈ = 0 at release: V̈ = 0 at arrest and Y(0) = Y(T1) + T2 come out.
#[test]
fn collocation_finds_the_same_wave() {
    let (mut worst, mut bend) = (0.0_f64, 0.0_f64);
    // points that resolve the layer to rounding; more would only add to that of the derivatives
    for (beta, n) in [(3e-3, 72), (6e-3, 56), (1.1e-2, 40)] {
        let (wave, point) = slip_stick(beta);
        let model = wave.model_at(&point);
        let c = model.constants().coefficients;
        let speed = wave.speed_at(&point);
        let (slip, stick) = (wave.duration_at(&point, 0), wave.duration_at(&point, 1));
        let ratio = c.a / (speed * speed);
        let drive = model.friction * c.coupling / speed;
        let d = differentiation(n, slip);
        let d2 = &d * &d;
        let mut matrix = &d2 * &d * (-beta * ratio)
            + &d2 * (1.0 - ratio - beta * drive)
            + &d * (beta * c.h - drive)
            + DMatrix::identity(n + 1, n + 1) * c.h;
        let mut right = DVector::zeros(n + 1);
        // the first point is the end of the zone, the last its beginning
        for (row, condition, value) in [
            (0, d.row(0).clone_owned(), 1.0),
            (n, d.row(n).clone_owned(), 1.0),
            (n - 1, d2.row(n).clone_owned(), 0.0),
        ] {
            matrix.set_row(row, &condition);
            right[row] = value;
        }
        let y = matrix.lu().solve(&right).expect("a regular problem");
        let entry = wave.entry_at(&point, 0)[0];
        worst = worst.max((y[0] + stick - y[n]).abs());
        bend = bend
            .max((y[n] - entry).abs())
            .max((d2.row(0) * &y)[0].abs());
    }
    observed("material damping against spectral collocation: V", worst);
    observed(
        "material damping against spectral collocation: V̈ at arrest",
        bend,
    );
    assert!(worst < 1e-11, "{worst:e}");
    // rounding of V in the second derivative, N⁴ε/T² of it
    assert!(bend < 1e-6, "{bend:e}");
}

/// At the ends of stick the friction force jumps: Q ≤ fP just before release, |Q| ≤ fP after arrest,
/// and fP − Q at release falls like β.
#[test]
fn friction_force_at_the_ends_of_stick() {
    let gap = |beta: f64| {
        let (wave, point) = slip_stick(beta);
        let samples = sample(&wave, &point, 400).expect("samples");
        let stick: Vec<_> = samples
            .iter()
            .filter(|sample| sample.regime == Regime::Stick.name())
            .collect();
        let friction = wave.model.friction;
        for sample in &samples {
            let bound = friction * sample.pressure;
            assert!(sample.pressure > 0.0 && sample.shear.abs() <= bound * (1.0 + 1e-14));
        }
        let last = stick[stick.len() - 1];
        friction * last.pressure - last.shear
    };
    let slopes = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6].map(|beta| gap(beta) / beta);
    assert!(slopes.iter().all(|slope| *slope > 0.0));
    for pair in slopes[1..].windows(2) {
        assert!((pair[0] / pair[1] - 1.0).abs() < 0.1, "{slopes:?}");
    }
}

/// (γ, δ, β) → (s²γ, sδ, sβ) scales time by s and leaves the lengths of all zones alone.
#[test]
fn scaled_waves_are_the_same() {
    let scaled = |s: f64| Case {
        model: Model {
            source: CoefficientSource::from(Geometry {
                nu: 0.3,
                xi: 1.5,
                gamma: s * s,
            }),
            mismatch: 0.2 * s,
            damping: Damping {
                mass: 0.0,
                stiffness: 1e-3 * s,
            },
            ..mode4(0.2)
        },
        range: (0.05 * s, 0.2 * s),
        ..fast_in_mismatch()
    };
    let unit = scaled(1.0).follow(&[]);
    let mut worst = 0.0_f64;
    // s = 1000: β = 1
    for s in [1e-3, 30.0, 1e3] {
        let run = scaled(s).follow(&[]);
        assert_eq!(run.events().len(), unit.events().len());
        for (one, other) in run.events().into_iter().zip(unit.events()) {
            assert_eq!(one.kind(), other.kind());
            worst = worst
                .max((one.parameter / s / other.parameter - 1.0).abs())
                .max((speed(one) * s / speed(other) - 1.0).abs());
            let own = lengths(&one.orbit, &one.node.point);
            for (length, expected) in own
                .into_iter()
                .zip(lengths(&other.orbit, &other.node.point))
            {
                worst = worst.max((length - expected).abs());
            }
        }
    }
    observed("scaling with material damping", worst);
    assert!(worst < 1e-11, "{worst:e}");
}

/// A reverse zone that opened on the way down closes at the same place on the way up, also where it
/// opens inside a layer of a hundred-millionth of the period.
#[test]
fn there_and_back() {
    let mut worst = 0.0_f64;
    for beta in [2e-3, 1e-4, 1e-6, 1e-8] {
        let case = with_material_damping(beta);
        let case = Case {
            range: (0.06, case.range.1),
            ..case
        };
        let run = case.follow(&[]);
        let last = run.points.last().expect("points");
        assert_eq!(last.orbit.signature.to_string(), "slip-reverse-stick");
        let settings = Limits {
            range: case.range,
            stop_at: Vec::new(),
            steps: STEPS,
        };
        let wave = last.orbit.as_ref().clone();
        let follower = Follower::new(wave, &last.node.point, true, settings).expect("a start");
        let back = to_the_end(follower, None);
        let (there, again) = (event(&run, RV).parameter, event(&back, RV).parameter);
        worst = worst.max((there / again - 1.0).abs());
        let (first, again) = (&run.points[0], back.points.last().expect("points"));
        assert_eq!(first.orbit.signature, again.orbit.signature);
        worst = worst.max((&first.node.point - &again.node.point).amax());
    }
    observed("material damping: there and back", worst);
    assert!(worst < 1e-10, "{worst:e}");
}
