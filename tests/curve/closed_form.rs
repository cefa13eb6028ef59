//! Slip-stick waves are known in closed form, and with them three of their curves.

use std::f64::consts::PI;

use brakewave::curve::{CurvePoint, WholeCurve};
use brakewave::problem::parse;
use brakewave::tube::model::{Constants, Model, Parameter};
use brakewave::tube::wave::start::{SlipStick, Which, fold_in_friction, slip_stick};

use crate::curve::{observed, tube, unnamed};

/// Every how many points the closed form of the fold, a search, is asked for.
const OFTEN: usize = 10;

/// ζ = F/(2√(m_a h)) at the excess speed of a point.
fn shape(parameters: &Constants, excess: f64) -> f64 {
    let coefficients = parameters.coefficients;
    let ratio = 1.0 + excess;
    let kappa = coefficients.coupling.abs() / (coefficients.a.sqrt() * ratio);
    let force = parameters.friction * kappa - parameters.mass_damping;
    let mass = excess * (2.0 + excess) / (ratio * ratio);
    0.5 * force / (mass * coefficients.h).sqrt()
}

fn at(base: &Model, curve: &WholeCurve, point: &CurvePoint) -> Model {
    base.with(curve.parameters[0], point.parameters[0])
        .with(curve.parameters[1], point.parameters[1])
}

/// The slip-stick wave at a point: of fast and slow the one whose speed it has.
fn closed(model: &Model, point: &CurvePoint) -> SlipStick {
    [Which::Fast, Which::Slow]
        .into_iter()
        .map(|which| slip_stick(model, 4, which).unwrap())
        .min_by(|one, other| {
            let off = |wave: &SlipStick| (wave.speed - point.measure).abs();
            off(one).total_cmp(&off(other))
        })
        .unwrap()
}

/// Take-off of slip-stick waves lies on δ = −(D/(cg)) min V̇, fast and slow, round the fold in f.
///
/// Near the fold at f₀ the closed form knows c to ε/√(f₀ − f): below 1e-12 beyond 1e-6. At the curve's own
/// speed, where min V̇ = −e^{ζπ/η}, it holds everywhere.
#[test]
fn take_off_of_slip_stick() {
    let problem = tube(
        1.08,
        0.3,
        0.0,
        "continuation: (parameter: Mismatch, range: (0.02, 0.3), toward: Down), \
         curve: (event: GR, parameters: (Mismatch, Friction), range: ((0.01, 0.6), (0.1, 1.2)))",
    );
    let curve = unnamed(&problem);
    let base = problem.model;
    let fold = fold_in_friction(&base, 4).unwrap();
    let (mut apart, mut own, mut counts, mut spread) =
        (0.0_f64, 0.0_f64, [0, 0], (2.0_f64, 0.0_f64));
    for point in curve
        .points
        .iter()
        .filter(|point| point.before == "slip-stick")
    {
        let model = at(&base, &curve, point);
        let parameters = model.constants();
        let coefficients = parameters.coefficients;
        let [mismatch, friction] = point.parameters;
        let zeta = shape(&parameters, point.excess.unwrap());
        let rate = -(zeta * PI / (1.0 - zeta * zeta).sqrt()).exp();
        let expected = -coefficients.coupling / (point.measure * coefficients.g) * rate;
        own = own.max((mismatch / expected - 1.0).abs());
        if fold - friction > 1e-6 {
            let wave = closed(&model, point);
            let expected = -coefficients.coupling / (wave.speed * coefficients.g) * wave.least_rate;
            apart = apart.max((mismatch / expected - 1.0).abs());
            let fast = slip_stick(&model, 4, Which::Fast).unwrap();
            counts[usize::from(fast.speed != wave.speed)] += 1;
        }
        spread = (spread.0.min(friction), spread.1.max(friction));
    }
    observed("GR of slip-stick against the closed form", apart);
    observed("GR of slip-stick at the curve's own speed", own);
    assert!(counts[0] > 5 && counts[1] > 50, "{counts:?}");
    assert!(spread.0 < 0.6 && spread.1 > 1.09, "{spread:?}");
    assert!(apart < 1e-10 && own < 1e-10);
    let both = curve
        .points
        .iter()
        .find(|point| point.kind.is_some_and(|one| one.to_string() == "GR+LP"));
    let at_fold = both.unwrap().parameters[1];
    assert!((at_fold / fold - 1.0).abs() < 1e-10, "{at_fold} {fold}");
}

/// Reverse slip opens on δ = −(α + fD/c + h(F/h − T2))/(2fg), with damping and without.
#[test]
fn reverse_slip_of_slip_stick() {
    for damping in [0.0, 0.02] {
        let problem = tube(
            0.5,
            0.3,
            damping,
            "continuation: (parameter: Mismatch, range: (0.02, 0.3), toward: Down), \
             curve: (event: RV, parameters: (Mismatch, Friction), range: ((0.01, 0.6), (0.1, 1.2)))",
        );
        let curve = unnamed(&problem);
        let base = problem.model;
        let (mut worst, mut spread) = (0.0_f64, (2.0_f64, 0.0_f64));
        for point in &curve.points {
            if point.before != "slip-stick" {
                continue;
            }
            let model = at(&base, &curve, point);
            let wave = closed(&model, point);
            let parameters = model.constants();
            let coefficients = parameters.coefficients;
            let f = parameters.friction;
            let expected = -(damping
                + f * coefficients.coupling / wave.speed
                + coefficients.h * (wave.release - wave.stick))
                / (2.0 * f * coefficients.g);
            worst = worst.max((point.parameters[0] / expected - 1.0).abs());
            spread = (spread.0.min(f), spread.1.max(f));
        }
        observed("RV of slip-stick against the closed form", worst);
        assert!(spread.0 < 0.2 && spread.1 > 1.0, "{spread:?}");
        assert!(worst < 1e-10);
    }
}

/// On the fold of undamped slip-stick waves ζ = F/(2√(m_a h)) is one number whatever the tube, and
/// f·k|D|/h another; the fold itself is where the least length of the closed form is the wavelength.
#[test]
fn folds_of_undamped_waves_share_their_shape() {
    let mut shapes = Vec::new();
    for (second, range) in [
        ("Nu", "(0.05, 0.4)"),
        ("Xi", "(1.3, 1.9)"),
        ("Gamma", "(0.8, 1.6)"),
    ] {
        let problem = tube(
            0.2,
            0.5,
            0.0,
            &format!(
                "continuation: (parameter: Friction, range: (0.2, 3.0), toward: Up), curve: \
                 (event: LP, parameters: (Friction, {second}), range: ((0.2, 3.0), {range}))"
            ),
        );
        let curve = unnamed(&problem);
        let base = problem.model;
        let (mut fold, mut residual) = (0.0_f64, 0.0_f64);
        let mut values = (f64::INFINITY, 0.0_f64);
        for (index, point) in curve.points.iter().enumerate() {
            assert_eq!(point.before, "slip-stick");
            let model = at(&base, &curve, point);
            let parameters = model.constants();
            let coefficients = parameters.coefficients;
            let size = parameters.friction * coefficients.coupling.abs() / coefficients.h;
            shapes.push((shape(&parameters, point.excess.unwrap()), size));
            if index % OFTEN == 0 {
                let expected = fold_in_friction(&model, 4).unwrap();
                fold = fold.max((point.parameters[0] / expected - 1.0).abs());
            }
            residual = residual.max(point.residual);
            values = (
                values.0.min(point.parameters[1]),
                values.1.max(point.parameters[1]),
            );
        }
        observed(
            &format!("LP in (f, {second}) against the least length"),
            fold,
        );
        observed("residual of its equations", residual);
        assert!(fold < 1e-10 && residual < 1e-11);
        assert!(
            curve.points.len() > 20 && values.1 - values.0 > 0.1,
            "{values:?}"
        );
    }
    let (shape, size) = shapes[0];
    let off = |value: f64, first: f64| (value / first - 1.0).abs();
    let worst = shapes
        .iter()
        .map(|(one, _)| off(*one, shape))
        .fold(0.0, f64::max);
    let sizes = shapes
        .iter()
        .map(|(_, one)| off(*one, size))
        .fold(0.0, f64::max);
    println!("ζ = {shape:.13}, f|D|/h = {size:.13}");
    observed("ζ along all folds", worst);
    observed("f|D|/h along all folds", sizes);
    // speeds are known to the tolerance of the corrections, f to its square
    assert!(worst < 1e-10 && sizes < 1e-10);
}

/// With damping the speed enters the condition of the fold by itself, and ζ moves along it.
#[test]
fn folds_of_damped_waves_do_not() {
    let problem = tube(
        0.4,
        0.5,
        0.0,
        "continuation: (parameter: Friction, range: (0.2, 3.0), toward: Up), curve: \
         (event: LP, parameters: (Friction, MassDamping), range: ((0.2, 3.0), (0.0, 0.2)))",
    );
    let curve = unnamed(&problem);
    let base = problem.model;
    let shapes: Vec<f64> = curve
        .points
        .iter()
        .map(|point| shape(&at(&base, &curve, point).constants(), point.excess.unwrap()))
        .collect();
    let (low, high) = shapes
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(low, high), one| {
            (low.min(*one), high.max(*one))
        });
    observed("ζ along folds in (f, α)", high / low - 1.0);
    assert_eq!(curve.parameters[1], Parameter::MassDamping);
    assert!(high / low - 1.0 > 1e-3);
    let worst = curve
        .points
        .iter()
        .step_by(OFTEN)
        .map(|point| {
            let expected = fold_in_friction(&at(&base, &curve, point), 4).unwrap();
            (point.parameters[0] / expected - 1.0).abs()
        })
        .fold(0.0, f64::max);
    observed("LP in (f, α) against the least length", worst);
    assert!(worst < 1e-10);
}

/// Stick vanishes on the Hopf line of steady sliding, K(α + βK)² = k²f²D²(1 − αβ − β²K), K = ak² + h, from
/// edge to edge of the plane, with either damping.
#[test]
fn stick_vanishes_on_the_hopf_line() {
    let mut worst = 0.0_f64;
    for (name, range, fixed) in [
        ("MassDamping", "(0.001, 0.5)", ""),
        (
            "StiffnessDamping",
            "(0.0001, 0.02)",
            "damping: (mass: 0.05), ",
        ),
    ] {
        let text = format!(
            "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, {fixed}\
             mismatch: 0.4), wave: (mode: 4, start: Fast), \
             continuation: (parameter: {name}, range: (0.0, 1.0), toward: Up), \
             curve: (event: ST, parameters: ({name}, Friction), range: ({range}, (0.1, 1.2))))"
        );
        let problem = parse(&text, "test").unwrap();
        let curve = unnamed(&problem);
        let base = problem.model;
        let c = base.constants().coefficients;
        let stiffness = 16.0 * c.a + c.h;
        for point in &curve.points {
            let at = at(&base, &curve, point);
            let (alpha, beta) = (at.damping.mass, at.damping.stiffness);
            let damping = alpha + beta * stiffness;
            let drive = (4.0 * at.friction * c.coupling).powi(2);
            let ratio = stiffness * damping * damping / (drive * (1.0 - beta * damping));
            worst = worst.max((ratio - 1.0).abs());
        }
        for end in [&curve.points[0], &curve.points[curve.points.len() - 1]] {
            assert!(
                end.what.contains("edge of the range"),
                "{name}: {}",
                end.what
            );
        }
    }
    observed("ST on the Hopf line", worst);
    // T2 = 0 to rounding of the wave, 1e-15, where T2² measures the distance from the line
    assert!(worst < 1e-12, "{worst:e}");
}
