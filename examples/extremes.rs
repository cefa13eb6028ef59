//! An atlas of extremes: what comes out at the ends of the ranges of every parameter.
//!
//!     cargo run --release --example extremes
//!
//! prints the table of docs/accuracy.md. Each wave is solved, or refused with a reason, and its error
//! measured by something that does not share its difficulty: the closed form in 200 binary digits
//! where the wave is slip-stick, the exact scaling of the model, or a second method.

use brakewave::branch::conditioning::conditioning;
use brakewave::branch::first_wave::first_wave;
use brakewave::continuation::newton::{self, Equations, Fixed};
use brakewave::continuation::{Node, Steps};
use brakewave::linalg::Vector;
use brakewave::tube::flow::method::Method;
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{FrictionLaw, Model, Parameter};
use brakewave::tube::wave::start::{self, Which, fold_in_friction, least_mismatch, slip_stick};
use brakewave::tube::wave::{Wave, precise};

const STEPS: Steps = Steps {
    ds: 0.005,
    ds_min: 1e-12,
    ds_max: 0.01,
    tolerance: 1e-10,
};

fn tube(nu: f64, xi: f64, gamma: f64, friction: f64) -> Model {
    Model::tube(Geometry { nu, xi, gamma }, friction, 1.0)
}

/// A mismatch at which the wave is slip-stick.
fn in_contact(model: &Model, mode: u32, which: Which) -> Result<Model, String> {
    let closed = slip_stick(model, mode, which).map_err(|reason| reason.to_string())?;
    let least = least_mismatch(model, &closed).abs();
    Ok(model.with(Parameter::Mismatch, 1.5 * least))
}

/// A wave with the number of Newton iterations from its own solution moved by 1e-8.
struct Solved {
    wave: Wave,
    node: Node,
}

fn solve(model: &Model, mode: u32, which: Which) -> Result<Solved, String> {
    let width = model.mismatch.abs();
    let (wave, point) = first_wave(model, Parameter::Mismatch, mode, which, width, STEPS)
        .map_err(|reason| reason.to_string())?;
    iterate(wave, &point)
}

fn iterate(wave: Wave, point: &Vector) -> Result<Solved, String> {
    let last = wave.unknowns() - 1;
    let mut fixed = Fixed {
        index: last,
        value: point[last],
    };
    let mut guess = point.clone();
    for index in 0..last {
        guess[index] *= 1.0 + if index % 2 == 0 { 1e-8 } else { -1e-8 };
    }
    let settings = newton::Settings {
        most_iterations: 30,
        halvings: 10,
        ..newton::Settings::default()
    };
    let solution = newton::solve(&wave, &mut fixed, &guess, &settings)
        .map_err(|failure| format!("Newton: {failure}"))?;
    let mut tangent = Vector::zeros(last + 1);
    tangent[last] = 1.0;
    Ok(Solved {
        node: Node {
            point: solution.point,
            tangent,
            newton: solution.iterations,
            residual: solution.residual,
        },
        wave,
    })
}

/// Error of e (relative), T1 and T2 (in periods) against the closed form with many digits.
fn by_closed_form(model: &Model, mode: u32, which: Which, solved: &Solved) -> Result<f64, String> {
    let closed = slip_stick(model, mode, which).map_err(|reason| reason.to_string())?;
    let exact = precise::slip_stick(model, mode, &closed).ok_or("no digits")?;
    let zones = solved.wave.unpack(&solved.node.point);
    let period = exact.slip + exact.stick;
    let excess = solved.wave.excess_at(&solved.node.point);
    Ok((excess / exact.excess - 1.0)
        .abs()
        .max((zones[0].duration - exact.slip).abs() / period)
        .max((zones[1].duration - exact.stick).abs() / period))
}

/// Difference from the same wave by collocation.
fn by_collocation(solved: &Solved) -> Result<f64, String> {
    let method = Method::Collocation {
        intervals: 40,
        degree: 4,
    };
    let other = iterate(solved.wave.clone().with_method(method), &solved.node.point)?;
    let speed =
        solved.wave.excess_at(&other.node.point) / solved.wave.excess_at(&solved.node.point);
    Ok((&other.node.point - &solved.node.point)
        .amax()
        .max((speed - 1.0).abs()))
}

fn row(what: &str, result: Result<(Solved, &str, f64), String>) {
    match result {
        Ok((solved, measure, error)) => {
            let zones = solved.wave.unpack(&solved.node.point);
            let shortest = zones
                .iter()
                .fold(f64::INFINITY, |least, zone| least.min(zone.duration));
            let expected = conditioning(&solved.wave, &solved.node)
                .map_or(f64::NAN, |conditioning| conditioning.expected_error);
            println!(
                "| {what} | {} | {:.1e} | {shortest:.1e} | {error:.1e} by {measure} | {expected:.0e} | {} |",
                solved.wave.signature,
                solved.wave.excess_at(&solved.node.point),
                solved.node.newton
            );
        }
        Err(reason) => println!("| {what} | refused: {reason} | | | | | |"),
    }
}

/// A slip-stick wave against the closed form.
fn slip_stick_row(what: &str, model: &Model, mode: u32, which: Which) {
    row(
        what,
        in_contact(model, mode, which).and_then(|model| {
            let solved = solve(&model, mode, which)?;
            let error = by_closed_form(&model, mode, which, &solved)?;
            Ok((solved, "closed form", error))
        }),
    );
}

/// Any wave against collocation.
fn two_methods_row(what: &str, model: &Model, mode: u32, which: Which) {
    row(
        what,
        solve(model, mode, which).and_then(|solved| {
            let error = by_collocation(&solved)?;
            Ok((solved, "two methods", error))
        }),
    );
}

/// δ at which the slip-stick wave of a model ends.
fn onset(model: &Model, which: Which) -> f64 {
    slip_stick(model, 4, which).map_or(f64::NAN, |wave| least_mismatch(model, &wave))
}

fn main() {
    println!("| extreme | wave | e = \\|c\\|/√a − 1 | shortest zone | error | expected | Newton |");
    println!("|---|---|---|---|---|---|---|");
    let reference = tube(0.3, 1.5, 1.0, 0.5);
    for friction in [0.5, 0.1, 0.02, 4e-3, 1e-3] {
        let model = tube(0.3, 1.5, 1.0, friction);
        slip_stick_row(&format!("slow, f = {friction}"), &model, 4, Which::Slow);
    }
    for nu in [-0.999, 0.45, 0.499, 0.49999, 0.4999999] {
        let fold = fold_in_friction(&tube(nu, 1.5, 1.0, 1e-2), 4).unwrap_or(f64::NAN);
        let model = tube(nu, 1.5, 1.0, 0.5 * fold);
        slip_stick_row(&format!("ν = {nu}, half the fold"), &model, 4, Which::Fast);
    }
    for xi in [1.0 + 1e-6, 1.001, 1.1821, 10.0, 100.0] {
        let fold = fold_in_friction(&tube(0.3, xi, 1.0, 1e-2), 4).unwrap_or(f64::NAN);
        let model = tube(0.3, xi, 1.0, 0.5 * fold);
        slip_stick_row(&format!("ξ = {xi}, half the fold"), &model, 4, Which::Fast);
    }
    let unit = solve(&reference.with(Parameter::Mismatch, 0.045), 4, Which::Fast);
    for gamma in [1e-12, 1e-6, 1e3, 1e6] {
        let s = f64::sqrt(gamma);
        let model = Model {
            mismatch: 0.045 * s,
            ..tube(0.3, 1.5, gamma, 0.5)
        };
        let result = solve(&model, 4, Which::Fast).and_then(|solved| {
            let unit = unit.as_ref().map_err(Clone::clone)?;
            // scaled unknowns follow the symmetry exactly
            let error = (&solved.node.point - &unit.node.point)
                .rows(0, solved.wave.unknowns() - 1)
                .amax();
            Ok((solved, "scaling", error))
        });
        row(&format!("γ = {gamma:.0e}, with separation"), result);
    }
    for mismatch in [1e-3, 1e-4, 1e-6, 1e-10] {
        let model = reference.with(Parameter::Mismatch, mismatch);
        two_methods_row(&format!("δ = {mismatch:.0e}"), &model, 4, Which::Fast);
    }
    for mode in [1, 16, 64, 256] {
        let fold = fold_in_friction(&tube(0.3, 1.5, 1.0, 1e-3), mode).unwrap_or(f64::NAN);
        let model = tube(0.3, 1.5, 1.0, 0.5 * fold);
        slip_stick_row(
            &format!("k = {mode}, half the fold"),
            &model,
            mode,
            Which::Fast,
        );
    }
    let fold = fold_in_friction(&reference, 4).unwrap_or(f64::NAN);
    for friction in [
        1e-6,
        1e-3,
        fold * (1.0 - 1e-6),
        fold * (1.0 - 1e-10),
        fold * 1.01,
    ] {
        let model = tube(0.3, 1.5, 1.0, friction);
        slip_stick_row(&format!("f = {friction:.12}"), &model, 4, Which::Fast);
    }
    slip_stick_row(
        "f = 10 at ξ = 1.19",
        &tube(0.3, 1.19, 1.0, 10.0),
        4,
        Which::Fast,
    );
    let end = {
        let coefficients = reference.constants().coefficients;
        4.0 * 0.5 * coefficients.coupling.abs() / (16.0 * coefficients.a + coefficients.h).sqrt()
    };
    for short in [0.5, 1e-3, 1e-6, 1e-9, 1e-12] {
        let model = reference.with(Parameter::MassDamping, end * (1.0 - short));
        slip_stick_row(
            &format!("α = {short:.0e} short of the end"),
            &model,
            4,
            Which::Fast,
        );
    }
    // just beyond the opening of reverse slip: a zone of a length proportional to the distance
    let opening = onset(&reference, Which::Fast);
    for beyond in [1e-3, 1e-6, 1e-9, 1e-12] {
        let model = reference.with(Parameter::Mismatch, opening * (1.0 - beyond));
        two_methods_row(
            &format!("{beyond:.0e} beyond the opening of reverse slip"),
            &model,
            4,
            Which::Fast,
        );
    }
    // just beyond take-off: a zone like the square root of the distance
    let grazing = onset(&reference, Which::Slow);
    for beyond in [1e-3, 1e-6, 1e-9, 1e-12] {
        let model = reference.with(Parameter::Mismatch, grazing * (1.0 - beyond));
        two_methods_row(
            &format!("{beyond:.0e} beyond grazing, slow"),
            &model,
            4,
            Which::Slow,
        );
    }
    for epsilon in [0.2, 1e-2, 1e-3, 1e-4, 1e-5] {
        let model = Model {
            law: FrictionLaw::Regularised { epsilon },
            mismatch: 0.2,
            ..reference
        };
        let limit = start::slip_stick(&reference, 4, Which::Fast).map(|wave| wave.speed);
        let result = solve(&model, 4, Which::Fast).and_then(|solved| {
            let limit = limit.map_err(|reason| reason.to_string())?;
            let distance = (solved.wave.speed_at(&solved.node.point) / limit - 1.0).abs();
            Ok((solved, "distance from ε = 0", distance))
        });
        row(&format!("ε = {epsilon:.0e}"), result);
    }
}
