//! A separation zone opens like a square root.
//!
//! Just below δ_GR the pressure that contact would have near its minimum is P ≈ −ε + κx², with x the
//! time along the material point. Separation lasts from x = −√(ε/κ) until the landing of
//! m_b Ü = ε − κx², U = δ and U̇ = 0 at take-off: 4√(ε/κ). Here
//!
//! - ε = P′(δ_GR − δ), with P′ the total derivative in δ of the least pressure along the branch of
//!   waves without separation, which can be solved for on both sides of δ_GR;
//! - κ = ½P̈: with P = gδ + (D/c)V̇ and m_a V⃛ = −hV̇ where V̈ = 0, P̈ = −(D/c)hV̇/m_a = hgδ/m_a
//!   at P = 0.

use brakewave::branch::EventType;
use brakewave::branch::polish;
use brakewave::linalg::Vector;
use brakewave::tube::model::signature::Regime;
use brakewave::tube::wave::Wave;

use crate::waves::branches::{exact, fast_in_mismatch, regimes};
use crate::waves::observed;

/// Least pressure in the first zone, slip after release, of a wave without separation.
fn least_pressure(wave: &Wave, point: &Vector) -> f64 {
    let flows = wave.flows(point).expect("a frame");
    let flow = exact(flows.contact(Regime::Slip));
    let entry = wave.entry_at(point, 0);
    let duration = wave.duration_at(point, 0);
    // V̈ vanishes at release and at the minimum
    let jerk = -flow.q * entry[1];
    let times = flow.zeros(0.0, jerk, duration);
    let time = times
        .into_iter()
        .find(|time| *time > 1e-3 * duration)
        .expect("a minimum");
    let at = &flows.frame.at;
    at.g * at.mismatch + at.kappa * flow.state(entry, time)[1]
}

#[test]
fn separation_opens_like_a_square_root() {
    let case = fast_in_mismatch();
    let run = case.follow(&[]);
    let grazing = run
        .events()
        .into_iter()
        .find(|found| found.kind() == Some(EventType::GR))
        .expect("grazing");
    assert_eq!(regimes(grazing).0, "slip-reverse-stick");
    let (wave, point) = (&grazing.orbit, &grazing.node.point);
    let delta = grazing.parameter;
    let pressure_at = |mismatch: f64| {
        let guess = wave.pack(&wave.unpack(point), wave.excess_at(point), mismatch);
        let point = polish(wave, &guess).expect("the wave without separation");
        least_pressure(wave, &point)
    };
    // central difference, extrapolated: error of order step⁴ and rounding 1e-16/step
    let slope = |step: f64| {
        (pressure_at(delta * (1.0 + step)) - pressure_at(delta * (1.0 - step)))
            / (2.0 * delta * step)
    };
    let step = 1e-3;
    let slope = (4.0 * slope(step) - slope(2.0 * step)) / 3.0;
    let flows = wave.flows(point).expect("a frame");
    let at = &flows.frame.at;
    let curvature = 0.5 * at.h * at.g * delta / at.ma;
    let limit = 4.0 * (slope / curvature).sqrt();

    // δ_GR − δ falls by 4 from one wave to the next: the deviation halves
    let distances: Vec<f64> = (0..8).map(|j| 1e-4 * delta * 0.25_f64.powi(j)).collect();
    let stops: Vec<f64> = distances.iter().map(|distance| delta - distance).collect();
    let run = case.follow(&stops);
    let ratios: Vec<f64> = stops
        .iter()
        .map(|stop| {
            let found = run.user_points(*stop)[0];
            assert_eq!(found.orbit.signature.zone(1).regime, Regime::Separation);
            let duration = found.orbit.duration_at(&found.node.point, 1);
            duration / (delta - stop).sqrt()
        })
        .collect();
    let deviations: Vec<f64> = ratios.iter().map(|ratio| ratio / limit - 1.0).collect();
    // in σ = √((δ_GR − δ)/δ_GR) the deviation is aσ + bσ² + …, b being about as large as a: the
    // quotient of two is 2 + (b/a)σ, and 2r(η/4) − r(η) leaves −½bσ²
    const NEXT_ORDER: f64 = 4.0;
    let sigmas = distances.iter().map(|distance| (distance / delta).sqrt());
    for ((pair, ratio), sigma) in deviations.windows(2).zip(ratios.windows(2)).zip(sigmas) {
        let quotient = pair[0] / pair[1];
        // δ is known to 1e-16 and its distance to 1e-16/σ²
        let rounding = 1e-15 / (sigma * sigma);
        assert!(
            (quotient - 2.0).abs() < NEXT_ORDER * sigma + 10.0 * rounding / pair[1].abs(),
            "{quotient}"
        );
        let extrapolated = (2.0 * ratio[1] - ratio[0]) / limit - 1.0;
        observed("square-root law, extrapolated", extrapolated.abs());
        assert!(extrapolated.abs() < NEXT_ORDER * sigma * pair[0].abs() + 10.0 * rounding);
    }
}

/// On a slow branch, m_a = 6e-5, the reverse zone before stick closes and the branch goes on without
/// it. There V̇ − 1 in the zone is far below rounding, and the unknowns are known to 1e-10 only.
#[test]
fn a_reverse_zone_closes_at_the_stiff_end() {
    use brakewave::tube::model::coefficients::Geometry;
    use brakewave::tube::model::{Model, Parameter};
    use brakewave::tube::wave::start::Which;

    use crate::waves::branches::Case;

    let geometry = Geometry {
        nu: 0.02598376296329008,
        xi: 1.9376882497130952,
        gamma: 0.22295324966867502,
    };
    let case = Case {
        model: Model::tube(geometry, 0.06574657470144922, 2.765850882606961),
        parameter: Parameter::Gamma,
        mode: 10,
        which: Which::Slow,
        range: (0.022295324966867505, 2.2295324966867502),
        up: true,
        until: Some((EventType::RV, 4)),
    };
    let run = case.follow(&[]);
    assert_eq!(run.end, None);
    let closed = run.events().into_iter().filter(|found| {
        let (before, after) = regimes(found);
        found.kind() == Some(EventType::RV)
            && before.replace("reverse-", "") == after
            && found.orbit.excess_at(&found.node.point) < 1e-4
    });
    assert!(closed.count() >= 2);
}
