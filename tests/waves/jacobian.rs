//! The Jacobian of the boundary-value problem equals central differences, for every regime, every
//! switch and every continuation parameter, down to zones that have no length yet.
//!
//! With D(s) = (R(x + s) − R(x − s))/2s the extrapolated quotient (4D(s) − D(2s))/3 has an error of
//! order s⁴, far below the one that |D(2s) − D(s)|/3 estimates for D(s) itself. The estimate does
//! not know the Jacobian, so it can serve as its allowed error. To it comes rounding: of each
//! residual some operations times ε times the size Σ|∂R/∂x||x| of what was added up, over s.

use std::collections::BTreeSet;

use brakewave::continuation::newton::Equations;
use brakewave::linalg::{Matrix, Vector};
use brakewave::tube::model::signature::Regime;
use brakewave::tube::model::{Damping, Model, Parameter};
use brakewave::tube::wave::Wave;
use brakewave::tube::wave::WaveScales;
use brakewave::tube::wave::start::Which;

use crate::waves::branches::{
    Case, STEPS, fast_in_mismatch, slow_in_mismatch, specimens, with_coulomb_impact,
    with_material_damping, with_the_shaft,
};
use crate::waves::observed;

/// Step in scaled unknowns: ∛ε balances the two errors.
const STEP: f64 = 6e-6;

/// Operations behind one residual: series of 20 terms, or up to 40 halvings of an exponential.
const OPERATIONS: f64 = 64.0;
/// The same in separation with material damping, where U − δ over the square of the duration is formed
/// from a U that is ten times as large.
const LAYERED_OPERATIONS: f64 = 640.0;

/// The comparison is worth something only while the allowed error is below this fraction of the
/// largest entry of the row.
const MOST_ALLOWED: f64 = 1e-5;
/// The same at the stiff end, m_a near 0.01, where steps are as much shorter and rounding larger.
const MOST_ALLOWED_STIFF: f64 = 1e-3;

/// The parameters a branch can be followed in.
const PARAMETERS: [Parameter; 6] = [
    Parameter::Mismatch,
    Parameter::Friction,
    Parameter::MassDamping,
    Parameter::Gamma,
    Parameter::Nu,
    Parameter::Xi,
];

/// Every parameter, and β. Without material damping β = 0 has one side only.
const ALL_PARAMETERS: [Parameter; 7] = [
    Parameter::Mismatch,
    Parameter::Friction,
    Parameter::MassDamping,
    Parameter::StiffnessDamping,
    Parameter::Gamma,
    Parameter::Nu,
    Parameter::Xi,
];

fn residual(wave: &Wave, point: &Vector) -> Vec<f64> {
    let n = wave.unknowns();
    let mut residual = vec![0.0; n - 1];
    wave.evaluate(point, &mut residual, &mut Matrix::zeros(n - 1, n))
        .expect("the equations can be evaluated");
    residual
}

/// Largest error relative to the row, after the comparison.
fn compare(wave: &Wave, point: &Vector, most_allowed: f64) -> f64 {
    let n = wave.unknowns();
    let mut matrix = Matrix::zeros(n - 1, n);
    wave.evaluate(point, &mut vec![0.0; n - 1], &mut matrix)
        .expect("the equations can be evaluated");
    let mut worst = 0.0_f64;
    for column in 0..n {
        let quotient = |step: f64| -> Vec<f64> {
            let (mut up, mut down) = (point.clone(), point.clone());
            up[column] += step;
            down[column] -= step;
            let width = up[column] - down[column];
            residual(wave, &up)
                .into_iter()
                .zip(residual(wave, &down))
                .map(|(up, down)| (up - down) / width)
                .collect()
        };
        let (near, far) = (quotient(STEP), quotient(2.0 * STEP));
        for row in 0..n - 1 {
            let largest = matrix.row(row).amax();
            // ln(e/e₀) is near 0, but e carries the rounding of a number of its own size
            let extent = |j: usize| if j == n - 2 { 1.0 } else { point[j].abs() };
            let size: f64 = (0..n).map(|j| matrix[(row, j)].abs() * extent(j)).sum();
            let layered = wave.material && wave.signature.has(Regime::Separation);
            let operations = if layered {
                LAYERED_OPERATIONS
            } else {
                OPERATIONS
            };
            let rounding = operations * f64::EPSILON * size / STEP;
            let difference = (4.0 * near[row] - far[row]) / 3.0;
            // the derivative itself is a number in units that were taken out and put in again
            let own = 2.0 * f64::EPSILON * difference.abs();
            let allowed = (far[row] - near[row]).abs() / 3.0 + rounding + own;
            let error = (matrix[(row, column)] - difference).abs();
            let context = || {
                format!(
                    "{} in {:?}, row {row} column {column}: {} for {difference}, allowed {allowed:e}",
                    wave.signature,
                    wave.parameter,
                    matrix[(row, column)]
                )
            };
            assert!(error <= allowed, "{}", context());
            assert!(allowed <= most_allowed * largest.max(1.0), "{}", context());
            worst = worst.max(error / largest.max(1.0));
        }
    }
    worst
}

/// The same wave as a problem in another parameter.
fn in_parameter(wave: &Wave, point: &Vector, parameter: Parameter) -> (Wave, Vector) {
    let model = wave.model_at(point);
    let excess = wave.excess_at(point);
    let value = model.value(parameter).expect("a tube has all parameters");
    let width = if value > 0.0 { value } else { 1.0 };
    let other = Wave::new(
        model,
        parameter,
        wave.mode,
        wave.signature.clone(),
        WaveScales::new(&model, wave.mode, excess, 1.0, width),
    );
    let other_point = other.pack(&wave.unpack(point), excess, value);
    (other, other_point)
}

fn check(name: &str, case: &Case, most_allowed: f64) -> BTreeSet<String> {
    let mut seen = BTreeSet::new();
    let mut worst = 0.0_f64;
    for (wave, point) in specimens(case, STEPS) {
        for zone in &wave.signature.0 {
            seen.insert(format!("{:?} by {:?}", zone.regime, zone.entry));
        }
        let damped = wave.model.damping.stiffness > 0.0;
        let parameters: &[Parameter] = if damped { &ALL_PARAMETERS } else { &PARAMETERS };
        for &parameter in parameters {
            let (wave, point) = in_parameter(&wave, &point, parameter);
            worst = worst.max(compare(&wave, &point, most_allowed));
        }
    }
    observed(&format!("{name}: Jacobian relative to its rows"), worst);
    seen
}

#[test]
fn derivatives_equal_differences() {
    let fast = fast_in_mismatch();
    let damped = Case {
        model: Model {
            damping: Damping {
                mass: 0.05,
                stiffness: 0.0,
            },
            ..fast.model
        },
        ..fast
    };
    let mut seen = check("fast", &fast, MOST_ALLOWED);
    seen.extend(check("damped", &damped, MOST_ALLOWED));
    seen.extend(check("with the shaft", &with_the_shaft(), MOST_ALLOWED));
    seen.extend(check(
        "Coulomb impact",
        &with_coulomb_impact(),
        MOST_ALLOWED,
    ));
    let expected: BTreeSet<String> = [
        "Slip by Release",
        "Slip by Landing",
        "Stick by Arrest",
        "Reverse by Reversal",
        "Reverse by Landing",
        "Separation by TakeOff",
        "Separation by Touch",
        "Reverse by ArrestedLanding",
        "Stick by ArrestedLanding",
    ]
    .map(String::from)
    .into();
    let missing: Vec<&String> = expected.difference(&seen).collect();
    assert!(missing.is_empty(), "not met: {missing:?} in {seen:?}");
}

/// The slow wave, where m_a = 1 − a/c² is near 0.01: a step in c acts a hundred times as strongly.
#[test]
fn derivatives_equal_differences_at_the_stiff_end() {
    let case = slow_in_mismatch();
    assert_eq!(case.which, Which::Slow);
    check("slow", &case, MOST_ALLOWED_STIFF);
}

/// Material damping. A layer thinner than the step of the differences is looked at only where no
/// zone is as short as it.
#[test]
fn derivatives_equal_differences_with_material_damping() {
    for beta in [8e-3, 1e-3, 1e-6] {
        let case = with_material_damping(beta);
        let least = if beta < 1e-4 { 0.1 } else { case.range.0 };
        let case = Case {
            range: (least, case.range.1),
            ..case
        };
        let seen = check(&format!("β = {beta}"), &case, MOST_ALLOWED);
        assert!(seen.contains("Slip by Release") && seen.contains("Stick by Arrest"));
        assert_eq!(beta == 1e-3, seen.contains("Reverse by Reversal"));
    }
}

/// Towards the Hopf point of steady sliding, where the stick zone has no length.
#[test]
fn derivatives_equal_differences_where_stick_vanishes() {
    let case = Case {
        parameter: Parameter::StiffnessDamping,
        range: (1e-3, 1.0),
        up: true,
        ..with_material_damping(1e-3)
    };
    check("β up to ST", &case, MOST_ALLOWED);
}
