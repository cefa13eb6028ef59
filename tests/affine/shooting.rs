//! Orbits along which a motion grows by much: in several shots they are known as well as any other, against figures of an independent
//! program in 60 digits, a symmetry, and what carries from one set of unknowns to another.

#![allow(clippy::excessive_precision)] // figures as they are printed

use brakewave::EventType;
use brakewave::affine::closure::Prescribed;
use brakewave::affine::orbit::AffineOrbit;
use brakewave::affine::orbit::start::{Beginning, Search, Wanted, first};
use brakewave::continuation::Steps;
use brakewave::continuation::newton;
use brakewave::linalg::Vector;
use brakewave::orbit::Zones;
use brakewave::orbit::follow::{Follower, Limits, LocatedPoint};
use brakewave::orbit::special::Special;

use crate::affine::branches::follow;
use crate::affine::systems::system;

/// Wave trains of a nerve in the frame that moves with them (Rinzel and Keller 1973): over their length L a motion grows by
/// e^(1.4 L).
const NERVE: &str = r#"(
    states: ["u", "p", "w"],
    parameters: {"L": 10.0, "c": 0.32, "a": 0.15, "b": 0.05},
    modes: {
        "high": (rates: {"u": "p", "p": "c*p + u - 1 + w", "w": "b*u/c"}, until: [(zero: "u - a", to: "low")]),
        "low": (rates: {"u": "p", "p": "c*p + u + w", "w": "b*u/c"}, until: [(zero: "a - u", to: "high")]),
    },
)"#;

/// The train of a length of 10.
fn train() -> (AffineOrbit, Vector) {
    train_from(NERVE, 10.0, vec![0.15, 0.47, 0.24])
}

/// The train of this length next to states where `high` begins, and to a speed.
fn train_from(text: &str, length: f64, state: Vec<f64>) -> (AffineOrbit, Vector) {
    let system = system(text);
    let free = system.source.parameters.index("c").unwrap();
    let prescribed = Prescribed::new(&system.source, "L", free).unwrap();
    let wanted = Wanted {
        prescribed: Some(prescribed),
        ..Wanted::new(system, "L", (5.0, 31.0)).unwrap()
    };
    let beginning = Beginning {
        mode: 0,
        state,
        phase: 0.0,
    };
    first(&wanted, &beginning, Search::Guess(length)).unwrap()
}

/// Length and speed of trains, from a length down through the fold to the other branch, or up.
fn trains(up: bool, lengths: &[f64]) -> Vec<LocatedPoint<AffineOrbit>> {
    let (orbit, point) = train();
    let limits = Limits {
        stop_at: lengths.to_vec(),
        steps: Steps::default(),
        ..Limits::within((5.0, 31.0))
    };
    let all = Follower::new(orbit, &point, up, limits).unwrap().points();
    let user = |one: &LocatedPoint<AffineOrbit>| matches!(one.special, Some(Special::User(..)));
    all.filter(user).collect()
}

/// At a length of 30 a motion grows by 10¹⁸: from its entry alone no digit of the orbit would be left.
#[test]
fn long_trains_are_known_to_rounding() {
    /// A shot may lose four digits, of which 16 are there.
    const ALLOWED: f64 = 1e-12;
    const UPPER: [(f64, f64); 3] = [
        (16.0, 0.47072082230129958468),
        (20.0, 0.55633574595310983432),
        (30.0, 0.73241036857135643867),
    ];
    const LOWER: [(f64, f64); 3] = [
        (16.0, 0.21565525936823059705),
        (20.0, 0.21814442815047859239),
        (30.0, 0.21942116700479044844),
    ];
    for (up, figures) in [(true, UPPER), (false, LOWER)] {
        let found = trains(up, &figures.map(|(length, _)| length));
        assert_eq!(found.len(), figures.len());
        for (one, (length, speed)) in found.iter().zip(figures) {
            let off = one.orbit.values_at(&one.node.point)[1] / speed - 1.0;
            assert!(
                one.parameter == length && off.abs() <= ALLOWED,
                "{length}: {off:e}"
            );
            // and so are the equations in these unknowns
            let (_, residual) = newton::jacobian(one.orbit.as_ref(), &one.node.point).unwrap();
            assert!(residual <= ALLOWED, "{length}: {residual:e}");
        }
    }
}

/// A train that is found from a guess is known as well as one that is followed, from its first point on.
#[test]
fn the_first_train_is_known_to_rounding() {
    for (length, speed, state) in [
        (
            16.0,
            0.21565525936823059705,
            [0.15, 0.18496489286450214172, 0.031900766742370266536],
        ),
        (
            20.0,
            0.55633574595310983432,
            [0.15, 0.47491583864666794046, 0.19983387500299],
        ),
        // the motion from there leaves the train before it is round, and is a thousand million times as large then
        (
            20.0,
            0.21814442815047859239,
            [0.15, 0.18229648011186575091, 0.029594104033101431665],
        ),
    ] {
        let values = format!("\"L\": {length:?}, \"c\": {speed:?}");
        let text = NERVE.replace("\"L\": 10.0, \"c\": 0.32", &values);
        let (orbit, point) = train_from(&text, length, state.to_vec());
        let off = orbit.values_at(&point)[1] / speed - 1.0;
        assert!(off.abs() <= 1e-12, "{length}: {off:e}");
    }
}

/// What an orbit in several shots keeps is the same orbit: its period, its states at any time, and that of a zone.
#[test]
fn an_orbit_in_shots_is_the_same_orbit() {
    let found = trains(true, &[16.0, 30.0]);
    for one in &found {
        let (orbit, point) = (&one.orbit, &one.node.point);
        assert!(orbit.sequence.further_shots() > 0);
        assert_eq!(orbit.signature().to_string(), "high-low");
        let cycle = orbit.cycle(point).unwrap();
        assert!((cycle.period / one.parameter - 1.0).abs() <= 1e-14);
        let saved = orbit.saved(point).unwrap();
        let text = ron::to_string(&saved).unwrap();
        let again: brakewave::affine::orbit::row::SavedOrbit = ron::from_str(&text).unwrap();
        let posed = orbit.with_sequence(again.sequence).unwrap();
        let packed = posed.pack(&again.zones, &again.values);
        assert!((&packed - point).amax() <= 1e-15 * point.amax());
        // the motion comes to the beginning of every shot, and ends where it began
        let samples = orbit.samples(point, 64).unwrap();
        let (start, end) = (&samples[0].state, &samples[samples.len() - 1].state);
        let off = start
            .iter()
            .zip(end)
            .map(|(one, other)| (one - other).abs());
        assert!(off.fold(0.0, f64::max) <= 1e-12);
    }
}

/// Derivatives of the equations in shots are those of differences, whose error is h² and 1e-16/h times the growth over a shot.
#[test]
fn derivatives_in_shots_are_those_of_differences() {
    const STEP: f64 = 1e-6;
    let found = trains(true, &[16.0]);
    let (orbit, point) = (&found[0].orbit, &found[0].node.point);
    let (matrix, _) = newton::evaluated(orbit.as_ref(), point).unwrap();
    for column in 0..point.len() {
        let at = |step: f64| {
            let mut there = point.clone();
            there[column] += step;
            newton::evaluated(orbit.as_ref(), &there).unwrap().1
        };
        let difference = (at(STEP) - at(-STEP)) / (2.0 * STEP);
        for row in 0..matrix.nrows() {
            let (own, other) = (matrix[(row, column)], difference[row]);
            let allowed = 1e-6 * matrix.row(row).amax().max(1.0);
            assert!(
                (own - other).abs() <= allowed,
                "({row}, {column}): {own} for {other}"
            );
        }
    }
}

/// A cycle of FitzHugh and Nagumo grows from its Hopf point to one of relaxation by a canard, which stays for long at what repels it.
/// The equations have the symmetry I → 2a/b − I: what is met from below is met from above.
#[test]
fn canards_come_in_pairs() {
    let text = r#"(
        states: ["v", "w"],
        parameters: {"I": 0.8, "b": 0.85, "eps": 0.08, "a": 0.7},
        modes: {"flow": (rates: {"v": "v - v^3/3 - w + I", "w": "eps*(v + a - b*w)"})},
    )"#;
    let wanted = Wanted::new(system(text), "I", (0.0, 2.0)).unwrap();
    let beginning = Beginning {
        mode: 0,
        state: vec![1.0, 0.0],
        phase: 0.0,
    };
    let (orbit, point) = first(&wanted, &beginning, Search::Settles(300.0)).unwrap();
    let events = |up: bool| {
        let (seen, _) = follow(&orbit, &point, up, (0.0, 2.0), 4000);
        let values = |kind: EventType| -> Vec<f64> {
            let own = seen.iter().filter(|one| one.kind == kind);
            own.map(|one| one.value).collect()
        };
        let (folds, hopf) = (values(EventType::LP), values(EventType::BP));
        // the current stands still to rounding for long beyond the fold
        let same = folds.iter().all(|fold| (fold - folds[0]).abs() <= 1e-12);
        assert!(same && hopf.len() == 1, "{folds:?} {hopf:?}");
        [folds[0], hopf[0]]
    };
    let ([fold, hopf], [fold_above, hopf_above]) = (events(false), events(true));
    let sum = 2.0 * 0.7 / 0.85;
    assert!(
        (fold + fold_above - sum).abs() <= 1e-13,
        "{fold} {fold_above}"
    );
    // the trace of the slopes vanishes at v² = 1 − εb
    let v = -(1.0_f64 - 0.08 * 0.85).sqrt();
    let at_hopf = (v + 0.7) / 0.85 - v + v.powi(3) / 3.0;
    assert!((hopf - at_hopf).abs() <= 1e-13, "{hopf}");
    assert!((hopf + hopf_above - sum).abs() <= 1e-13, "{hopf_above}");
}
