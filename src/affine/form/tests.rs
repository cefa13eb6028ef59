//! Forms against the expressions that they stand for.

use super::*;
use crate::affine::expression::{Expression, ExpressionFlaw, Wrong};

/// States x, v; parameters p = 0.7 and q = 1.3, which vary.
fn form(text: &str) -> Result<Form, ExpressionFlaw> {
    Expression::read(text)?.evaluate(&|name| match name {
        "x" => Some(Form::state(0)),
        "v" => Some(Form::state(1)),
        "p" => Some(Form::constant(Dual::parameter(0.7, Some(0)))),
        "q" => Some(Form::constant(Dual::parameter(1.3, Some(1)))),
        "phase" => Some(Form::phase()),
        _ => None,
    })
}

/// Value and derivatives in p and q of a form at a state and a phase.
fn value(form: &Form, states: [f64; 2], phase: f64) -> Dual {
    let mut sum = form.constant;
    for (term, state) in form.states.iter().zip(states) {
        sum = sum.sum(1.0, *term, state);
    }
    for (h, [c, s]) in form.harmonics.iter().enumerate() {
        let angle = (h + 1) as f64 * phase;
        sum = sum.sum(1.0, *c, angle.cos()).sum(1.0, *s, angle.sin());
    }
    sum
}

#[test]
fn a_form_is_its_expression() {
    // for every expression its value as a function of x, v, φ, p, q, in plain arithmetic
    type Direct = fn([f64; 5]) -> f64;
    let cases: [(&str, Direct); 6] = [
        ("p*x - 2*v/q + 3", |[x, v, _, p, q]| {
            p * x - 2.0 * v / q + 3.0
        }),
        ("p*cos(phase)^3 - x", |[x, _, f, p, _]| {
            p * f.cos().powi(3) - x
        }),
        ("sin(2*phase - q)*cos(phase)*p", |[_, _, f, p, q]| {
            (2.0 * f - q).sin() * f.cos() * p
        }),
        ("(1 - cos(3*phase))*(q + sin(phase))", |[_, _, f, _, q]| {
            (1.0 - (3.0 * f).cos()) * (q + f.sin())
        }),
        ("-(x - v)*exp(p*q)*tanh(q) + p^q", |[x, v, _, p, q]| {
            -(x - v) * (p * q).exp() * q.tanh() + p.powf(q)
        }),
        ("cos(q - 2*phase) + abs(p - q)*x", |[x, _, f, p, q]| {
            (q - 2.0 * f).cos() + (p - q).abs() * x
        }),
    ];
    for (text, direct) in cases {
        let form = form(text).unwrap().settled().unwrap();
        for phase in [0.0, 0.9, -2.2, 4.0] {
            let point = [0.4, -1.1, phase, 0.7, 1.3];
            let found = value(&form, [0.4, -1.1], phase);
            assert!((found.value - direct(point)).abs() < 1e-14, "{text}");
            for (p, index) in [(0, 3), (1, 4)] {
                let shifted = |shift: f64| {
                    let mut point = point;
                    point[index] += shift;
                    direct(point)
                };
                // central difference: error h²/6 of third derivatives of order ten, and 1e-16/h
                let difference = (shifted(1e-5) - shifted(-1e-5)) / 2e-5;
                assert!((found.by[p] - difference).abs() < 1e-8, "{text}, {p}");
            }
        }
    }
}

#[test]
fn what_has_no_value_is_refused_with_its_place() {
    for (text, obstacle, span) in [
        ("cos(0.5*phase)", Obstacle::Phase, 4..13),
        ("1 + phase*x", Obstacle::Phase, 4..11),
        ("exp(phase)", Obstacle::Phase, 0..10),
        ("1/(p - p)", Obstacle::NotFinite, 0..9),
        ("ln(p - 1)", Obstacle::NotFinite, 0..9),
    ] {
        let flaw = form(text).unwrap_err();
        assert_eq!(
            (flaw.wrong, flaw.span),
            (Wrong::Obstacle(obstacle), span),
            "{text}"
        );
    }
    assert_eq!(
        form("phase + x").unwrap().settled().err(),
        Some(Obstacle::Phase)
    );
}
