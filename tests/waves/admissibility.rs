//! At every accepted point contact and friction laws hold everywhere, and where they do not, the
//! examination says so.
//!
//! The examination proves its inequalities by other means (extrema in closed form, Bernstein
//! coefficients); dense samples must never contradict it. Samples carry the rounding of the flow:
//! of W in terms of the largest |W|, of P in terms of gδ + κ·max|W|, of U in terms of U itself.

use brakewave::branch::orbit::Found;
use brakewave::branch::polish;
use brakewave::branch::{EventType, ProfileSample};
use brakewave::continuation::newton::Equations;
use brakewave::linalg::{Matrix, Vector};
use brakewave::orbit::sign::SignVerdict;
use brakewave::tube::wave::Wave;
use brakewave::tube::wave::admissibility::{WaveWatch, examine};
use brakewave::tube::wave::profile::sample;

use crate::waves::branches::{
    Case, Run, fast_in_friction, fast_in_mismatch, slow_in_mismatch, with_coulomb_impact,
    with_the_shaft,
};
use crate::waves::observed;

/// Intervals per wavelength.
const RESOLUTION: usize = 2000;

/// Relative error of W and of forces: ε times the operations of the closed form and the condition
/// of the equations, some hundred each.
const ROUNDING: f64 = 1e-12;
/// Relative rounding of U, whose flow does not amplify.
const ROUNDING_OF_GAP: f64 = 1e-13;

/// What rounding of the unknowns themselves makes of the velocities. At the stiff end the last
/// digit of e moves V̇ by 1e-10 and more, and no solution in double precision is better: ε times
/// the sum |∂R/∂x||x| of the most sensitive equation, for each of the two ends of a zone.
fn of_the_unknowns(wave: &Wave, point: &Vector) -> f64 {
    let n = wave.unknowns();
    let mut matrix = Matrix::zeros(n - 1, n);
    wave.evaluate(point, &mut vec![0.0; n - 1], &mut matrix)
        .expect("the equations can be evaluated");
    let sizes = (matrix.abs() * point.abs()).max();
    2.0 * f64::EPSILON * sizes
}

/// The worst contradiction of one wave: relative amount by which a law is violated.
fn violation(wave: &Wave, point: &Vector) -> f64 {
    let samples = sample(wave, point, RESOLUTION).expect("a profile");
    let flows = wave.flows(point).expect("a frame");
    let at = &flows.frame.at;
    let rate = samples.iter().fold(1.0_f64, |size, sample| {
        size.max(sample.tangential_rate.abs())
    });
    let force = at.g * at.mismatch + at.kappa * rate;
    let rounding = ROUNDING + of_the_unknowns(wave, point) / rate;
    let mut worst = 0.0_f64;
    let mut check = |sample: &ProfileSample, excess: f64, allowed: f64, law: &str| {
        worst = worst.max(excess);
        assert!(
            excess <= allowed,
            "{} at δ = {}: {law} by {excess:e} at {sample:?}",
            wave.signature,
            at.mismatch
        );
    };
    // U moves with U̇ while the last digit of the time passes
    let falling = samples
        .iter()
        .fold(0.0_f64, |size, sample| size.max(sample.radial_rate.abs()));
    let period: f64 = wave.unpack(point).iter().map(|zone| zone.duration).sum();
    let gap = ROUNDING_OF_GAP + f64::EPSILON * period * falling / at.mismatch;
    for sample in &samples {
        let lag = 1.0 - sample.tangential_rate;
        check(sample, -sample.pressure / force, rounding, "P < 0");
        check(sample, 1.0 - sample.radial / at.mismatch, gap, "U < δ");
        let friction = at.friction * sample.pressure;
        check(
            sample,
            (sample.shear.abs() - friction) / force,
            rounding,
            "|Q| > fP",
        );
        let against = match sample.regime {
            "slip" => -lag,
            "reverse" => lag,
            "stick" => lag.abs(),
            _ => {
                let forces = sample.pressure.abs() + sample.shear.abs();
                check(sample, forces, 0.0, "forces without contact");
                continue;
            }
        };
        check(sample, against / rate, rounding, "V̇ on the wrong side of 1");
        // contact means U = δ, sliding means Q = ±fP
        check(
            sample,
            (sample.radial / at.mismatch - 1.0).abs(),
            0.0,
            "contact at U > δ",
        );
        let sliding = match sample.regime {
            "slip" => (sample.shear - friction).abs() / force,
            "reverse" => (sample.shear + friction).abs() / force,
            _ => 0.0,
        };
        check(sample, sliding, rounding, "sliding without full friction");
    }
    worst
}

fn check(name: &str, run: &Run) {
    let mut worst = 0.0_f64;
    for found in &run.points {
        if found.kind().is_none() {
            assert_eq!(found.examination.verdict, SignVerdict::Positive);
        }
        worst = worst.max(violation(&found.orbit, &found.node.point));
    }
    observed(
        &format!("{name}: worst sample of {} waves", run.points.len()),
        worst,
    );
}

fn check_case(name: &str, case: &Case) {
    check(name, &case.follow(&[]));
}

#[test]
fn samples_of_the_fast_branches_obey_the_laws() {
    check_case("fast", &fast_in_mismatch());
    check_case("friction", &fast_in_friction());
}

#[test]
fn samples_of_the_slow_branch_obey_the_laws() {
    check_case("slow", &slow_in_mismatch());
}

#[test]
fn samples_of_the_other_branches_obey_the_laws() {
    check_case("with the shaft", &with_the_shaft());
    check_case("Coulomb impact", &with_coulomb_impact());
}

/// The wave of an event's signature before it, at another parameter value.
fn beyond(found: &Found, value: f64) -> Vector {
    let (wave, point) = (&found.orbit, &found.node.point);
    let guess = wave.pack(&wave.unpack(point), wave.excess_at(point), value);
    polish(wave, &guess).expect("the equations have a solution")
}

/// Waves that solve their equations but break one law: each is refused, and for that law.
#[test]
fn planted_violations_are_refused() {
    let run = fast_in_mismatch().follow(&[]);
    let planted = [
        (EventType::RV, vec![WaveWatch::LowerForce]),
        (EventType::GR, vec![WaveWatch::Pressure]),
        // V̇ = 1 at both ends of the slip zone after landing
        (
            EventType::CO,
            vec![WaveWatch::Duration, WaveWatch::LandingRate],
        ),
    ];
    for (kind, watches) in planted {
        let found = run
            .points
            .iter()
            .find(|found| found.kind() == Some(kind))
            .expect("the event");
        for distance in [1e-2, 1e-4, 1e-6, 1e-8] {
            let point = beyond(found, found.parameter * (1.0 - distance));
            let examination = examine(&found.orbit, &point).expect("an examination");
            assert_eq!(
                examination.verdict,
                SignVerdict::Negative,
                "{kind} at {distance}"
            );
            let broken: Vec<WaveWatch> = examination
                .margins
                .iter()
                .filter(|margin| margin.jet.value <= 0.0)
                .map(|margin| margin.watch)
                .collect();
            assert_eq!(broken, watches, "{kind} at {distance}");
            // and on the other side of the event it is accepted
            let point = beyond(found, found.parameter * (1.0 + distance));
            let examination = examine(&found.orbit, &point).expect("an examination");
            assert_eq!(examination.verdict, SignVerdict::Positive);
        }
    }
}

/// Smallest and largest V of an examination against dense samples: none lies outside, and none is
/// missed by more than V can move between two samples of V̇ of different signs.
#[test]
fn extremes_of_separated_waves_are_those_of_dense_samples() {
    use brakewave::tube::model::coefficients::Geometry;
    use brakewave::tube::model::{Damping, Model, Parameter};
    use brakewave::tube::wave::start::Which;
    let slow = Case {
        model: Model::tube(
            Geometry {
                nu: -0.3,
                xi: 1.2,
                gamma: 1.0,
            },
            0.3,
            5.0,
        ),
        range: (0.05, 10.0),
        until: Some((EventType::CO, 2)),
        ..slow_in_mismatch()
    };
    let geometry = Geometry {
        nu: 0.05230307473103224,
        xi: 1.8179462776012596,
        gamma: 65.48515608566824,
    };
    let slipping = Case {
        model: Model {
            damping: Damping {
                mass: 0.004764014506631152,
                stiffness: 0.0,
            },
            ..Model::tube(geometry, 0.03865204646505325, 0.8228354272003936)
        },
        parameter: Parameter::Xi,
        mode: 12,
        which: Which::Fast,
        range: (1.4543570220810078, 2.3633301608816377),
        until: None,
        ..fast_in_mismatch()
    };
    let mut waves = 0;
    for case in [slow, slipping, slow_in_mismatch()] {
        for found in case.follow(&[]).points {
            if !found.orbit.signature.to_string().contains("separation") {
                continue;
            }
            let samples = sample(&found.orbit, &found.node.point, RESOLUTION).expect("a profile");
            let (low, high) = found.examination.tangential;
            let speed = found.orbit.speed_at(&found.node.point).abs();
            let (mut least, mut most, mut moves) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
            for pair in samples.windows(2) {
                let [v, w] = [pair[0].tangential, pair[0].tangential_rate];
                (least, most) = (least.min(v), most.max(v));
                let time = (pair[1].theta - pair[0].theta) / speed;
                if w * pair[1].tangential_rate <= 0.0 {
                    moves = moves.max(time * (w.abs() + pair[1].tangential_rate.abs()));
                }
            }
            let rounding = 1e-12 * (high - low + most.abs());
            assert!(least >= low - rounding && most <= high + rounding);
            let missed = (least - low).max(high - most);
            assert!(
                missed <= moves + rounding,
                "{} at {}: {missed:e} for {moves:e}",
                found.orbit.signature,
                found.parameter
            );
            waves += 1;
        }
    }
    observed("separated waves sampled", f64::from(waves));
    assert!(waves > 300, "{waves}");
}
