//! A sliding zone as power series, piece by piece: how friction varies along it.
//!
//! With x = (s − s₀)/H the coefficients of Y, W, S(W) and S′(W) follow from one another. Exponentials and
//! tanh satisfy differential equations of their own,
//!
//! ```text
//! e = (r − 1)e^{−σ(1−W)/v}:  e′ = (σ/v)W′e,   S = σ(1 + e),   dS/dW = e/v,
//! t = tanh((1 − W)/ε):       t′ = −W′(1 − t²)/ε,   S = t,       dS/dW = −(1 − t²)/ε.
//! ```

use crate::tube::flow::{Frame, Quantities};
use crate::tube::model::FrictionLaw;

pub(crate) const TERMS: usize = 27;
/// A function of x on \[0, 1\].
pub(crate) type Series = [f64; TERMS];

/// The last coefficients of a piece, relative to the largest.
const LAST: f64 = 1e-17;

/// Most pieces of a zone: where friction changes within 0.005 of V̇ = 1 a zone near it has about as many.
const MOST_PIECES: usize = 100;

/// Attempts to find a length for which the coefficients are numbers.
const MOST_ATTEMPTS: usize = 12;

#[derive(Clone, Debug)]
pub(crate) struct SlipPiece {
    /// Time from the beginning of the zone.
    pub(crate) start: f64,
    pub(crate) duration: f64,
    /// fκS.
    pub(crate) force: Series,
    /// f·dS/dW·P.
    pub(crate) drag: Series,
}

/// (1 − W)/ε beyond which tanh is ±1 to rounding, and what a piece that begins farther off keeps to: 4e⁻⁴⁴ and
/// more powers of it would not show a layer that is to come.
const FLAT: (f64, f64) = (26.0, 22.0);

struct SlipExpansion {
    /// How far W may move: infinite but where friction is flat.
    room: f64,
    y: Series,
    w: Series,
    force: Series,
    drag: Series,
}

/// n-th coefficient of a product.
fn product(one: &Series, other: &Series, n: usize) -> f64 {
    (0..=n).map(|k| one[k] * other[n - k]).sum()
}

/// n-th coefficient of w′·other.
fn along(w: &Series, other: &Series, n: usize) -> f64 {
    let terms = (0..=n).map(|k| (k as f64 + 1.0) * w[k + 1] * other[n - k]);
    terms.sum()
}

pub(crate) fn at(series: &Series, x: f64) -> f64 {
    series.iter().rev().fold(0.0, |sum, term| sum * x + term)
}

fn expand(
    of: &Quantities,
    law: FrictionLaw,
    sigma: f64,
    [y0, w0]: [f64; 2],
    h: f64,
) -> SlipExpansion {
    let (mut y, mut w, mut s, mut slope) = ([0.0; TERMS], [0.0; TERMS], [0.0; TERMS], [0.0; TERMS]);
    // e, or 1 − t²
    let mut inner = [0.0; TERMS];
    (y[0], w[0]) = (y0, w0);
    let mut room = f64::INFINITY;
    match law {
        FrictionLaw::Coulomb | FrictionLaw::Static { .. } => s[0] = sigma,
        FrictionLaw::Stribeck { ratio, velocity } => {
            inner[0] = (ratio - 1.0) * (-sigma * (1.0 - w0) / velocity).exp();
            (s[0], slope[0]) = (sigma * (1.0 + inner[0]), inner[0] / velocity);
        }
        FrictionLaw::Regularised { .. } => {
            let argument = (1.0 - w0) / of.smoothing;
            s[0] = argument.tanh();
            if argument.abs() > FLAT.0 {
                s[0] = argument.signum();
                room = (argument.abs() - FLAT.1) * of.smoothing;
            } else {
                inner[0] = argument.cosh().powi(-2);
                slope[0] = -inner[0] / of.smoothing;
            }
        }
    }
    let weight = of.g * of.mismatch;
    for n in 0..TERMS - 1 {
        let excess = if n == 0 { s[0] - 1.0 } else { s[n] };
        let pushed = of.friction * (excess * weight + of.kappa * product(&s, &w, n));
        let next = h / (n as f64 + 1.0);
        w[n + 1] = next * (pushed - of.damping * w[n] - of.h * y[n]) / of.ma;
        y[n + 1] = next * w[n];
        let turn = |scale: f64, inner: &Series| scale * along(&w, inner, n) / (n as f64 + 1.0);
        match law {
            FrictionLaw::Coulomb | FrictionLaw::Static { .. } => {}
            FrictionLaw::Stribeck { velocity, .. } => {
                inner[n + 1] = turn(sigma / velocity, &inner);
                (s[n + 1], slope[n + 1]) = (sigma * inner[n + 1], inner[n + 1] / velocity);
            }
            FrictionLaw::Regularised { .. } if room.is_finite() => {}
            FrictionLaw::Regularised { .. } => {
                s[n + 1] = turn(-1.0 / of.smoothing, &inner);
                inner[n + 1] = -product(&s, &s, n + 1);
                slope[n + 1] = -inner[n + 1] / of.smoothing;
            }
        }
    }
    let mut pressure = w.map(|w| of.kappa * w);
    pressure[0] += weight;
    SlipExpansion {
        room,
        y,
        w,
        force: s.map(|s| of.friction * of.kappa * s),
        drag: std::array::from_fn(|n| of.friction * product(&slope, &pressure, n)),
    }
}

/// How much longer a piece may be, so that its last coefficients are small; `None` unless all are numbers.
fn stretch(expansion: &SlipExpansion) -> Option<f64> {
    let order = (TERMS - 1) as f64;
    let mut longest = f64::INFINITY;
    for series in [&expansion.w, &expansion.force, &expansion.drag] {
        if !series.iter().all(|term| term.is_finite()) {
            return None;
        }
        let last = series[TERMS - 1].abs().max(series[TERMS - 2].abs());
        // the largest one at the length that results is the first, or near it
        let size = series[0].abs().max(series[1].abs());
        if last > 0.0 && size > 0.0 {
            longest = longest.min((LAST * size / last).powf(1.0 / order));
        }
    }
    Some(longest)
}

/// The pieces of a zone from its entry, and (Y, W) at its end; `None` where they are too many.
pub(crate) fn pieces(
    frame: &Frame,
    law: FrictionLaw,
    sigma: f64,
    entry: [f64; 2],
    duration: f64,
) -> Option<(Vec<SlipPiece>, [f64; 2])> {
    let mut pieces: Vec<SlipPiece> = Vec::new();
    let (mut start, mut state) = (0.0, entry);
    let mut trial = duration;
    while start < duration {
        let mut found = None;
        for _ in 0..MOST_ATTEMPTS {
            let expansion = expand(&frame.at, law, sigma, state, trial);
            if let Some(factor) = stretch(&expansion) {
                found = Some((expansion, factor));
                break;
            }
            trial *= 1e-3;
        }
        let (expansion, factor) = found?;
        let left = duration - start;
        let mut length = (trial * factor).min(left);
        let moved = |share: f64| {
            let terms = expansion.w[1..].iter().rev();
            share * terms.fold(0.0, |sum, term| sum * share + term.abs())
        };
        while moved(length / trial) > expansion.room {
            length *= 0.7;
        }
        if pieces.len() == MOST_PIECES || length.is_nan() || length <= 0.0 {
            return None;
        }
        let share = length / trial;
        let shorter = |series: &Series| -> Series {
            let mut power = 1.0;
            series.map(|term| {
                let term = term * power;
                power *= share;
                term
            })
        };
        state = [&expansion.y, &expansion.w].map(|series| at(series, share));
        pieces.push(SlipPiece {
            start,
            duration: length,
            force: shorter(&expansion.force),
            drag: shorter(&expansion.drag),
        });
        start = if length == left {
            duration
        } else {
            start + length
        };
        trial = length.min(duration);
    }
    Some((pieces, state))
}
