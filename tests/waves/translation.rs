//! A wave may be shifted along itself.
//!
//! Moving the entry state of a zone by s along its own flow and shortening the zone by s leaves
//! its end where it was. In the columns of the zone, J·(Ẏ, Ẇ, −1) with the rates at the entry is
//! therefore zero in the two matching rows of the zone's own end; in the matching rows of the zone
//! before it the entry itself appears, with −1, and in the row of the period the duration.
//!
//! Where this is so:
//!
//! - in contact and in stick always;
//! - in separation after take-off, because Ü = 0 there by P = 0: U and U̇ of the entry, which are
//!   no unknowns, move by second order only. After a touch Ü > 0, and U̇ = 0 at the entry is made
//!   by the impact: such a zone is no part of a longer one and cannot be shifted;
//! - in the switching row where the switching function is not divided by T^m, or is divided but
//!   evaluated as such a quotient (zones longer than a radian): its zero makes the divisor's
//!   derivative vanish. For shorter zones the power series leaves out the terms below T^m, which
//!   vanish at the entry of a wave but whose derivatives along the shift do not: the row is minus
//!   those, −V̈/T for m = 1 and −V⃛/T for m = 2, and −U⃛/(2T) after take-off, all at the entry.

use brakewave::continuation::newton::Equations;
use brakewave::linalg::Matrix;
use brakewave::tube::flow::jet::{DURATION, ENTRY_W, ENTRY_Y, Jet};
use brakewave::tube::model::signature::{Regime, ZoneEntry};
use brakewave::tube::wave::Wave;

use crate::waves::branches::{
    Case, STEPS, exact, fast_in_friction, fast_in_mismatch, slow_in_mismatch, specimens,
    with_coulomb_impact, with_the_shaft,
};
use crate::waves::observed;

/// Operations behind one derivative.
const OPERATIONS: f64 = 256.0;

fn check(name: &str, case: &Case) {
    let mut worst = 0.0_f64;
    let mut zones = 0;
    let mut short = 0;
    for (wave, point) in specimens(case, STEPS) {
        let count = wave.zones();
        let unknowns = wave.unknowns();
        let posed = wave.at(&point).expect("a frame");
        let flows = &posed.flows;
        let at = &flows.frame.at;
        let scales = &wave.scales;
        let mut matrix = Matrix::zeros(unknowns - 1, unknowns);
        wave.evaluate(&point, &mut vec![0.0; unknowns - 1], &mut matrix)
            .expect("the equations can be evaluated");
        for index in 0..count {
            let zone = wave.signature.zone(index);
            let entry = wave.entry_at(&point, index);
            let duration = wave.duration_at(&point, index);
            // V̈, and V⃛ or U⃛, at the entry
            let (acceleration, jerk) = match zone.regime {
                Regime::Stick | Regime::Contact => (0.0, 0.0),
                Regime::Slip | Regime::Reverse => {
                    let flow = exact(flows.contact(zone.regime));
                    let acceleration = flow.acceleration(entry);
                    (
                        acceleration,
                        2.0 * flow.p * acceleration - flow.q * entry[1],
                    )
                }
                Regime::Separation => {
                    let tangential = entry[0] + flows.frame.steady().value;
                    // U̇ = 0; and m_b U⃛ = −gU̇ − αÜ − κV̈ with Ü = 0
                    let acceleration = -(at.damping * entry[1] + at.h * tangential) / at.ma;
                    (acceleration, -at.kappa * acceleration / at.mb)
                }
            };
            if zone.entry == ZoneEntry::Touch {
                continue;
            }
            zones += 1;
            let shift = [
                entry[1] / scales.time,
                acceleration / scales.rate,
                -1.0 / scales.time,
            ];
            // entries of the row may be small by cancellation: its largest one counts
            let along = |row: usize| -> (f64, f64) {
                let entries = [0, 1, 2].map(|j| matrix[(row, 3 * index + j)]);
                let largest = entries
                    .iter()
                    .fold(0.0_f64, |size, entry| size.max(entry.abs()));
                let longest = shift
                    .iter()
                    .fold(0.0_f64, |size, part| size.max(part.abs()));
                let sum = entries
                    .iter()
                    .zip(shift)
                    .map(|(entry, part)| entry * part)
                    .sum();
                (sum, largest * longest)
            };
            let mut compare = |row: usize, expected: f64, extra: f64| {
                let (sum, size) = along(row);
                let size = size + expected.abs() + extra;
                let error = (sum - expected).abs();
                if size > 0.0 {
                    worst = worst.max(error / size);
                }
                assert!(
                    error <= OPERATIONS * f64::EPSILON * size,
                    "{} zone {index} row {row}: {sum} for {expected}, of {size}",
                    wave.signature
                );
            };
            // one zone that follows itself does not occur: the rows are distinct
            let before = 3 * ((index + count - 1) % count);
            for row in 0..3 * count {
                if row / 3 == index {
                    continue;
                }
                let expected = match row.checked_sub(before) {
                    Some(offset @ (0 | 1)) => -shift[offset],
                    _ => 0.0,
                };
                compare(row, expected, 0.0);
            }
            let own = 3 * index;
            compare(own, 0.0, 0.0);
            compare(own + 1, 0.0, 0.0);
            let period = wave.speed_at(&point).abs() * f64::from(wave.mode) / std::f64::consts::TAU;
            compare(3 * count, -period, 0.0);
            if duration == 0.0 {
                continue;
            }
            let (dropped, divided) = dropped(&wave, index, acceleration, jerk, duration);
            let is_short = divided && is_series(flows, zone.regime, duration);
            short += usize::from(is_short);
            let expected = if is_short { -dropped } else { 0.0 };
            // the end is at the zero of the switching function to rounding of the point, and V̈
            // of the entry is known to rounding of its terms: both appear over powers of T
            let left = if divided {
                let end = posed.zone_end(index).expect("an end");
                let rates = match zone.regime {
                    Regime::Slip | Regime::Reverse => {
                        let flow = exact(flows.contact(zone.regime));
                        (2.0 * flow.p * entry[1]).abs()
                            + flow.q * (entry[0].abs() + flow.shift.value.abs())
                    }
                    _ => 0.0,
                };
                let order = wave.order_at_entry(zone.entry) as i32;
                sizes(&end.switching, &entry, duration) / duration.abs()
                    + rates * (scales.time / duration.abs()).powi(order)
            } else {
                0.0
            };
            compare(own + 2, expected, left);
        }
    }
    assert!(zones > 0);
    observed(
        &format!("{name}: translation, {zones} zones, {short} short"),
        worst,
    );
}

/// Size of the terms of a jet.
fn sizes(jet: &Jet, entry: &[f64; 2], duration: f64) -> f64 {
    (jet.by[ENTRY_Y] * entry[0]).abs()
        + (jet.by[ENTRY_W] * entry[1]).abs()
        + (jet.by[DURATION] * duration).abs()
}

/// Whether the switching function of a zone is evaluated by its power series: below one radian,
/// the norm of the flow times the duration.
fn is_series(flows: &brakewave::tube::wave::Flows, regime: Regime, duration: f64) -> bool {
    let norm = if regime == Regime::Separation {
        flows.separation().norm()
    } else {
        let flow = exact(flows.contact(regime));
        flow.q.sqrt() + 2.0 * flow.p.abs()
    };
    norm * duration <= 1.0
}

/// Derivative along the shift of the terms that the series of the switching function leaves out,
/// in its units, and whether the function is divided by a power of the duration at all.
fn dropped(wave: &Wave, index: usize, acceleration: f64, jerk: f64, duration: f64) -> (f64, bool) {
    let zone = wave.signature.zone(index);
    let next = wave.signature.zone(index + 1).entry;
    let time = wave.scales.time;
    match (zone.regime, zone.entry) {
        (Regime::Stick, _) => (0.0, false),
        (Regime::Separation, _) => (time * time * jerk / (2.0 * duration), true),
        _ if next == ZoneEntry::TakeOff => (0.0, false),
        (_, ZoneEntry::Reversal | ZoneEntry::ArrestedLanding) => {
            (time * acceleration / duration, true)
        }
        // V̈ = 0 at a release, but for rounding
        (_, ZoneEntry::Release) => (
            time * time * (acceleration / (duration * duration) + jerk / duration),
            true,
        ),
        _ => (0.0, false),
    }
}

#[test]
fn zones_may_be_shifted_along_themselves() {
    check("fast", &fast_in_mismatch());
    check("friction", &fast_in_friction());
    check("slow", &slow_in_mismatch());
    check("with the shaft", &with_the_shaft());
    check("Coulomb impact", &with_coulomb_impact());
}
