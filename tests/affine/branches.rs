//! Branches of orbits there and back through their events, against figures of an independent program.

use std::f64::consts::TAU;

use brakewave::EventType;
use brakewave::affine::orbit::AffineOrbit;
use brakewave::continuation::Steps;
use brakewave::linalg::Vector;
use brakewave::orbit::follow::{Follower, Found, Limits};

use crate::orbits::{Reference, impact, solved};

/// An event: its type, the parameter, the sequences before and after.
pub struct Seen {
    pub kind: EventType,
    pub value: f64,
    pub what: String,
}

/// What a branch meets until its range or this many points.
pub fn follow(
    orbit: &AffineOrbit,
    point: &Vector,
    up: bool,
    range: (f64, f64),
    most: usize,
) -> (Vec<Seen>, Vec<Found<AffineOrbit>>) {
    let limits = Limits {
        range,
        stop_at: Vec::new(),
        steps: Steps {
            ds: 0.01,
            ds_min: 1e-12,
            ds_max: 0.05,
            tolerance: 1e-10,
        },
    };
    let mut follower = Follower::new(orbit.clone(), point, up, limits).unwrap();
    let (mut seen, mut all) = (Vec::new(), Vec::new());
    loop {
        let (found, end) = follower.step();
        for one in found {
            if let Some(special) = &one.special {
                seen.push(Seen {
                    kind: special.kind(),
                    value: one.parameter,
                    what: match special.after() {
                        Some(after) => format!("{} > {after}", one.orbit.sequence),
                        None => one.orbit.sequence.to_string(),
                    },
                });
            }
            all.push(one);
        }
        if end.is_some() || all.len() > most {
            return (seen, all);
        }
    }
}

fn start(reference: &Reference) -> (AffineOrbit, Vector) {
    let (orbit, guess) = reference.posed();
    let point = solved(&orbit, &guess);
    (orbit, point)
}

/// The events that a branch meets, in order: types, values and sequences.
fn meets(seen: &[Seen], expected: &[(EventType, f64, &str)], allowed: f64) {
    let list = |seen: &[Seen]| -> String {
        let lines = seen
            .iter()
            .map(|one| format!("{} {} {}\n", one.kind, one.value, one.what));
        lines.collect()
    };
    assert_eq!(seen.len(), expected.len(), "{}", list(seen));
    for (one, (kind, value, what)) in seen.iter().zip(expected) {
        assert_eq!(
            (one.kind, one.what.as_str()),
            (*kind, *what),
            "{}",
            list(seen)
        );
        let off = (one.value - value).abs();
        assert!(
            off < allowed * value.abs(),
            "{kind} at {} for {value}: {off:e}",
            one.value
        );
    }
}

use EventType::{EP, GR, LP, PD};

#[test]
fn down_to_the_fold_and_through_the_graze() {
    let (orbit, point) = start(&impact(2.0, 1.0, 0.8, 1, 0.0, &[(-2.7, TAU)]));
    let (seen, all) = follow(&orbit, &point, false, (0.05, 3.0), 500);
    let expected = [
        (LP, 0.099970753628313271803, "free"),
        (GR, 0.1, "free > free"),
        (EP, 0.05, "free"),
    ];
    meets(&seen, &expected, 1e-13);
    // beyond the graze nothing switches any more, and the amplitude is that of the linear oscillator
    let last = all.last().unwrap();
    assert_eq!(last.orbit.sequence.switches(), 0);
    let extremes = last.orbit.extremes(&last.node.point).unwrap();
    for (low, high) in extremes {
        // |G| = 10 at resonance
        assert!(
            (high - 0.5).abs() < 1e-12 && (low + 0.5).abs() < 1e-12,
            "{low} {high}"
        );
    }
    // and back
    let node = &last.node;
    let (seen, _) = follow(&last.orbit, &node.point, true, (0.04, 2.0), 500);
    let expected = [
        (GR, 0.1, "free > free"),
        (LP, 0.099970753628313271803, "free"),
        (EP, 2.0, "free"),
    ];
    meets(&seen, &expected, 1e-13);
}

#[test]
fn through_the_doubling_to_the_inner_graze() {
    let (orbit, point) = start(&impact(1.0, 0.8, 0.8, 1, 6.2, &[(-1.5, TAU / 0.8)]));
    let (seen, _) = follow(&orbit, &point, false, (0.2, 3.0), 500);
    let expected = [
        (PD, 0.5182098665978725691, "free"),
        (GR, 0.3687817782917154924, "free > free"),
        (EP, 0.2, "free"),
    ];
    meets(&seen, &expected, 1e-13);
    let (seen, all) = follow(&orbit, &point, true, (0.2, 14.0), 1000);
    let expected = [
        (GR, 2.0902833592017951225, "free > free-free"),
        (LP, 1.5051413292414020217, "free-free"),
        (PD, 13.532041105032496003, "free-free"),
        (EP, 14.0, "free-free"),
    ];
    meets(&seen, &expected, 1e-13);
    let last = all.last().unwrap();
    let (seen, _) = follow(&last.orbit, &last.node.point, false, (1.0, 15.0), 1000);
    let expected = [
        (PD, 13.532041105032496003, "free-free"),
        (LP, 1.5051413292414020217, "free-free"),
        (GR, 2.0902833592017951225, "free-free > free"),
        (EP, 1.0, "free"),
    ];
    meets(&seen, &expected, 1e-13);
}
