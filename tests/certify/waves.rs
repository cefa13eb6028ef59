//! Special points that are proven, against figures of other origin, and points that must not be.

use brakewave::branch::run::WaveRunner;
use brakewave::certify::{
    self, CertifiedPoint, NearWave, OpenPoint, PosedWave, ProofOutcome, RefusedProof, UnprovenWave,
    WaveBeyond, WaveCondition, WaveProof, WrittenCoefficients, WrittenModel,
};
use brakewave::interval::{Decimal, Interval};
use brakewave::orbit::EventType;
use brakewave::orbit::legs::Run as _;
use brakewave::problem::{self, StabilitySection};
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::signature::{Regime, Signature, ZoneEntry};
use brakewave::tube::model::{FrictionLaw, Impact, Model, Parameter, Sectors};
use brakewave::tube::wave::admissibility::WaveWatch;
use brakewave::tube::wave::start::{Which, slip_stick};

/// The special points of a problem file, with its text changed before it is read; stability left out.
pub(crate) fn points_of(name: &str, changes: &[(&str, &str)]) -> Vec<CertifiedPoint> {
    points(name, changes, None)
}

pub(crate) fn points(
    name: &str,
    changes: &[(&str, &str)],
    sector: Option<usize>,
) -> Vec<CertifiedPoint> {
    let path = format!("{}/problems/{name}.ron", env!("CARGO_MANIFEST_DIR"));
    let mut text = std::fs::read_to_string(path).unwrap();
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    points_of_text(&text, name, sector)
}

/// The special points of a problem.
pub(crate) fn points_of_text(text: &str, name: &str, sector: Option<usize>) -> Vec<CertifiedPoint> {
    let mut problem = problem::parse(text, name).unwrap();
    problem.stability = problem
        .stability
        .zip(sector)
        .map(|(section, sector)| StabilitySection {
            sectors: Sectors::Only(vec![sector]),
            ..section
        });
    let continuation = problem.continuation(text, name).unwrap().clone();
    let mut branch = WaveRunner::begin(&problem, &continuation, None).unwrap();
    let mut points = Vec::new();
    while branch.progress().end.is_none() {
        let items = branch.step();
        points.extend(items.iter().filter_map(|item| certify::certify(item, text)));
    }
    points
}

pub(crate) fn proof(point: &CertifiedPoint) -> &WaveProof {
    match &point.outcome {
        ProofOutcome::Proven(proof) => proof,
        ProofOutcome::Open(reason) => panic!("{}: {reason}", point.kind),
    }
}

/// The proof of the event of a type, counted from 0.
pub(crate) fn event(points: &[CertifiedPoint], kind: EventType, index: usize) -> &WaveProof {
    proof(
        points
            .iter()
            .filter(|point| point.kind == kind)
            .nth(index)
            .unwrap(),
    )
}

/// A figure with more digits than a double has.
pub(crate) fn figure(text: &str) -> Interval {
    Decimal::try_from(text.to_owned()).unwrap().interval()
}

/// Whether a figure known to `error` (relative) is in an interval.
pub(crate) fn has(interval: Interval, value: f64, error: f64) -> bool {
    let slack = error * value.abs();
    value - slack <= interval.high && interval.low <= value + slack
}

/// Solved by Newton's method with 60 digits in another program.
#[test]
fn figures_of_forty_digits_lie_in_the_intervals() {
    let mismatch = points_of("mode4_mismatch", &[]);
    let friction = points_of("mode4_friction", &[]);
    for (proof, value, speed) in [
        (
            event(&mismatch, EventType::RV, 0),
            "0.09681408171599354915251712476889062689156",
            "-1.242700800630082036635088567516885131561",
        ),
        (
            event(&mismatch, EventType::GR, 0),
            "0.05022841036275642356339039313619872089423",
            "-1.247346361588719245911905702265612624684",
        ),
        (
            event(&friction, EventType::LP, 0),
            "1.091518420359109905012676946267645134902",
            "-1.121901058375943483401873589994087100528",
        ),
    ] {
        let said = &proof.statement;
        assert!(figure(value).within(said.parameter), "{value}: {said:?}");
        assert!(figure(speed).within(said.speed), "{speed}: {said:?}");
        assert!(said.parameter.width() <= 1e-12 * said.parameter.magnitude());
        assert!(said.unique > 1e-9 && said.inequalities > 8);
    }
}

/// Figures of an independent program, solved with 40 digits and printed with 16, and lengths with 12.
#[test]
fn reference_figures_lie_in_the_intervals() {
    let mismatch = points_of("mode4_mismatch", &[]);
    let slow = points_of("mode4_slow", &[]);
    let friction = points_of("mode4_friction", &[]);
    let damping = points_of("mode4_damping", &[]);
    let reference: [(&WaveProof, f64, f64, &[f64]); 12] = [
        (
            event(&mismatch, EventType::CO, 0),
            0.02348078272152996,
            -1.250230672587828,
            &[
                0.481593461853,
                0.852770689535,
                0.0,
                0.159646301817,
                0.0767858735902,
            ],
        ),
        (
            event(&mismatch, EventType::CO, 1),
            0.003810637594310301,
            -1.261910578601672,
            &[0.383706912514, 1.1064049032, 0.0, 0.0806845110781],
        ),
        (
            event(&mismatch, EventType::ST, 0),
            0.0005044760768328024,
            -1.263007784004346,
            &[0.36552057089, 1.14323348283, 0.0620422730791, 0.0],
        ),
        (
            event(&slow, EventType::GR, 0),
            0.7596640793486009,
            -1.047988020675271,
            &[0.192228841311, 1.37856748548],
        ),
        (
            event(&slow, EventType::CO, 0),
            0.6537831264648296,
            -1.047740634384199,
            &[0.120531714787, 0.0753083977401, 0.0, 1.37495621427],
        ),
        (
            event(&slow, EventType::LP, 0),
            0.6537309315891844,
            -1.047733565823334,
            &[
                0.120291549944,
                0.075638525196,
                0.00103057944974,
                1.37383567221,
            ],
        ),
        (
            event(&slow, EventType::LP, 1),
            5.430509345490274,
            -1.043891072264797,
            &[
                0.0400027902788,
                0.0898088217502,
                0.00134391207027,
                1.4396408027,
            ],
        ),
        (
            event(&slow, EventType::GR, 1),
            0.9752066442305001,
            -1.043963132195445,
            &[
                0.0319650416371,
                0.0939993989382,
                0.0851948385776,
                1.35963704764,
            ],
        ),
        (
            event(&friction, EventType::GR, 0),
            1.041478997531129,
            -1.092249834850394,
            &[0.543076606191, 1.0277197206],
        ),
        (
            event(&friction, EventType::CO, 0),
            1.002777817991802,
            -1.078810980470606,
            &[0.267575891313, 0.222305648086, 0.0, 1.0809147874],
        ),
        (
            event(&friction, EventType::LP, 1),
            0.9944192801072622,
            -1.081449550476252,
            &[
                0.290396475138,
                0.192300297948,
                0.015432224259,
                1.07266732945,
            ],
        ),
        (
            event(&damping, EventType::ST, 0),
            0.3189475197930335,
            -1.271294354034047,
            &[std::f64::consts::FRAC_PI_2, 0.0],
        ),
    ];
    for (proof, value, speed, lengths) in reference {
        let said = &proof.statement;
        assert!(has(said.parameter, value, 2e-16), "{value}: {said:?}");
        assert!(has(said.speed, speed, 5e-16), "{speed}: {said:?}");
        assert_eq!(said.lengths.len(), lengths.len());
        for (interval, length) in said.lengths.iter().zip(lengths) {
            assert!(has(*interval, *length, 5e-12), "{length}: {interval:?}");
        }
    }
}

/// Crossings in slip-stick waves and in a separated one, against figures of an independent program.
#[test]
fn crossings_of_the_imaginary_axis_are_proven() {
    let damped = points(
        "mode4_damping",
        &[
            ("range: (0.0, 0.4)", "range: (0.0, 0.08)"),
            ("stop_at: [0.05, 0.1, 0.2]", "stop_at: [0.05]"),
        ],
        Some(1),
    );
    let changes = [
        ("range: (0.00055, 0.2)", "range: (0.0498, 0.2)"),
        ("stop_at: [0.08, 0.045, 0.02, 0.004, 0.001],", ""),
    ];
    let separated = points("mode4_stability", &changes, Some(2));
    for (points, index, value, omega, zones) in [
        (&damped, 0, 0.03838265869219194, -10.1574642119505, 2),
        (&damped, 1, 0.06909390421441017, 6.66808360352309, 2),
        (&separated, 0, 0.082871287293597, 5.21284283037976, 3),
        (&separated, 1, 0.05872623872532664, 5.51164793031676, 3),
        (&separated, 2, 0.04988131031290541, 5.59321987123937, 5),
    ] {
        let proof = event(points, EventType::HB, index);
        let said = &proof.statement;
        assert_eq!(said.lengths.len(), zones);
        assert!(has(said.parameter, value, 1e-14), "{value}: {said:?}");
        assert!(has(said.omega.unwrap(), omega, 1e-14), "{omega}: {said:?}");
        assert!(said.unique > 0.0);
    }
    let point = separated
        .iter()
        .rfind(|point| point.kind == EventType::HB)
        .unwrap();
    let honest = proof(point);
    assert_eq!(certify::verify(point, honest), Ok(()));
    let mut other = honest.clone();
    if let WaveCondition::Crossing { sector, .. } = &mut other.condition {
        *sector = 1;
    }
    assert!(certify::verify(point, &other).is_err());
    let mut other = honest.clone();
    other.statement.omega = Some(Interval::point(5.0));
    assert_eq!(
        certify::verify(point, &other),
        Err(RefusedProof::Statement("ω"))
    );
    // of mode 4 there are sectors 0 to 3
    let mut other = honest.clone();
    if let WaveCondition::Crossing { sector, .. } = &mut other.condition {
        *sector += 4;
    }
    let none = RefusedProof::NoProof(OpenPoint::Sector.to_string());
    assert_eq!(certify::verify(point, &other), Err(none));
    // a pair does not cross at 0, and what crosses at 0 is no pair
    let mut other = honest.clone();
    if let WaveCondition::Crossing { omega, .. } = &mut other.condition {
        *omega = 1e-300;
    }
    assert!(certify::verify(point, &other).is_err());
}

/// Every special point of the exact flow without material damping is proven. In `positive_coupling` the second of
/// two separation zones closes just where the first lands without speed: free flight is symmetric in time.
#[test]
fn the_problem_files_are_proven() {
    let names = [
        "brake_lining",
        "mode2_cusp",
        "mode4_curve",
        "mode4_damping",
        "mode4_map",
        "mode4_stability",
        "mode4_static",
        "mode8_reverse",
        "mode8_reverse_nu03",
        "positive_coupling",
        "ring_coulomb_impact",
    ];
    for name in names {
        for point in points_of(name, &[]) {
            assert_eq!(certify::verify(&point, proof(&point)), Ok(()), "{name}");
        }
    }
}

/// (γ, δ) → (s²γ, sδ) leaves all lengths: the intervals of a scaled problem meet those of the first, with
/// s = 3, which is no power of two.
#[test]
fn scaling_keeps_what_is_proven() {
    let first = points_of("mode8_reverse", &[]);
    let scaled = points_of(
        "mode8_reverse",
        &[
            ("gamma: 1.0", "gamma: 9.0"),
            ("mismatch: 0.06,", "mismatch: 0.18,"),
            ("range: (0.01, 0.06)", "range: (0.03, 0.18)"),
            ("0.026773139826513", "0.080319419479539"),
        ],
    );
    assert_eq!(first.len(), scaled.len());
    for (one, other) in first.iter().zip(&scaled) {
        assert_eq!(one.kind, other.kind);
        let (one, other) = (&proof(one).statement, &proof(other).statement);
        let meet = |a: Interval, b: Interval| !a.intersection(b).is_empty();
        assert!(meet(one.parameter * Interval::point(3.0), other.parameter));
        assert!(meet(one.speed, other.speed * Interval::point(3.0)));
        assert!(
            one.lengths
                .iter()
                .zip(&other.lengths)
                .all(|(a, b)| meet(*a, *b))
        );
    }
}

/// Decimals, not doubles: with ten digits behind those of a double the intervals part.
#[test]
fn decimals_are_taken_as_written() {
    let change = |to| [("friction: 0.5,", to)];
    let plain = points_of("mode4_curve", &change("friction: 0.5,"));
    let close = points_of("mode4_curve", &change("friction: 0.50000000000000001,"));
    let written = |points: &[CertifiedPoint]| {
        event(points, EventType::GR, 0)
            .posed
            .written
            .friction
            .to_string()
    };
    assert_eq!(written(&plain), "0.5");
    assert_eq!(written(&close), "0.50000000000000001");
    let tenth = figure("0.50000000000000001");
    assert!(tenth.low <= 0.5 && tenth.high > 0.5);
}

fn tube(friction: f64, mismatch: f64) -> Model {
    let geometry = Geometry {
        nu: 0.3,
        xi: 1.5,
        gamma: 1.0,
    };
    Model::tube(geometry, friction, mismatch)
}

/// The slip-stick wave at a value of the mismatch, to be proven as such.
pub(crate) fn slip_stick_at(which: Which, mismatch: f64) -> Result<WaveProof, OpenPoint> {
    let model = tube(0.5, mismatch);
    let closed = slip_stick(&model, 4, which).unwrap();
    let posed = PosedWave {
        written: WrittenModel::new(&model, false, |_| None),
        impact: Impact::Frictionless,
        parameter: Parameter::Mismatch,
        mode: 4,
        unit: 1.0,
    };
    let near = NearWave {
        signature: Signature::slip_stick(),
        zones: vec![
            [closed.release, 1.0, closed.slip],
            [closed.release - closed.stick, 1.0, closed.stick],
        ],
        layers: Vec::new(),
        excess: closed.excess,
        parameter: mismatch,
    };
    certify::prove(
        posed,
        near,
        WaveCondition::Value(Decimal::of(mismatch)),
        None,
    )
}

/// δ at which the least pressure of the slow slip-stick wave has a value.
pub(crate) fn mismatch_of_pressure(least: f64) -> f64 {
    let model = tube(0.5, 1.0);
    let coefficients = model.constants().coefficients;
    let closed = slip_stick(&model, 4, Which::Slow).unwrap();
    (least - coefficients.coupling / closed.speed * closed.least_rate) / coefficients.g
}

/// δ at which Q + fP at the beginning of stick has a value, in the fast slip-stick wave.
fn mismatch_of_force(least: f64) -> f64 {
    let model = tube(0.5, 1.0);
    let coefficients = model.constants().coefficients;
    let closed = slip_stick(&model, 4, Which::Fast).unwrap();
    ((least + coefficients.h * closed.stick) - coefficients.coupling / closed.speed)
        / coefficients.g
}

#[test]
fn an_inequality_violated_by_1e_10_is_not_proven() {
    assert!(slip_stick_at(Which::Slow, mismatch_of_pressure(1e-10)).is_ok());
    assert_eq!(
        slip_stick_at(Which::Slow, mismatch_of_pressure(-1e-10)).err(),
        Some(OpenPoint::Inequality(UnprovenWave::Pressure(0)))
    );
    assert!(slip_stick_at(Which::Fast, mismatch_of_force(1e-10)).is_ok());
    assert_eq!(
        slip_stick_at(Which::Fast, mismatch_of_force(-1e-10)).err(),
        Some(OpenPoint::Inequality(UnprovenWave::Switch(
            1,
            WaveWatch::LowerForce
        )))
    );
}

#[test]
fn at_and_just_past_an_event_nothing_is_proven() {
    let take_off = mismatch_of_pressure(0.0);
    for share in [0.0, 1e-12] {
        let past = take_off * (1.0 - share);
        assert_eq!(
            slip_stick_at(Which::Slow, past).err(),
            Some(OpenPoint::Inequality(UnprovenWave::Pressure(0)))
        );
    }
    // at the fold, and beyond it where there is no wave
    let friction = points_of("mode4_friction", &[]);
    let fold = event(&friction, EventType::LP, 0);
    for share in [0.0, 1e-15, 1e-12, 1e-9] {
        let value = fold.near.parameter * (1.0 + share);
        let WaveProof { posed, near, .. } = fold.clone();
        let there = WaveCondition::Value(Decimal::of(value));
        let refused = certify::prove(posed, near, there, None).err();
        assert!(
            matches!(
                refused,
                Some(OpenPoint::NotIsolated | OpenPoint::NotEnclosed)
            ),
            "{share}: {refused:?}"
        );
    }
}

/// Where two waves are close to each other none is said to be unique as far as the other.
#[test]
fn uniqueness_does_not_reach_the_other_wave() {
    let model = tube(1.0915, 0.3);
    let [fast, slow] =
        [Which::Fast, Which::Slow].map(|which| slip_stick(&model, 4, which).unwrap());
    let apart = fast.excess / slow.excess - 1.0;
    let posed = PosedWave {
        written: WrittenModel::new(&model, false, |_| None),
        impact: Impact::Frictionless,
        parameter: Parameter::Friction,
        mode: 4,
        unit: 1.0,
    };
    let near = NearWave {
        signature: Signature::slip_stick(),
        zones: vec![
            [fast.release, 1.0, fast.slip],
            [fast.release - fast.stick, 1.0, fast.stick],
        ],
        layers: Vec::new(),
        excess: fast.excess,
        parameter: 1.0915,
    };
    let proof =
        certify::prove(posed, near, WaveCondition::Value(Decimal::of(1.0915)), None).unwrap();
    let unique = proof.statement.unique;
    assert!(unique > 1e-6 && unique < apart, "{unique:e} {apart:e}");
}

/// Static friction that is the kinetic one is Coulomb's law, and is proven alike.
#[test]
fn static_friction_is_covered() {
    let law = "friction: 0.5, friction_law: Static(ratio: 1.01),";
    let points = points_of("mode4_curve", &[("friction: 0.5,", law)]);
    assert!(points.iter().any(|point| point.kind == EventType::RV));
    for point in &points {
        assert!(proof(point).posed.written.ratio.is_some());
    }
    let model = Model {
        law: FrictionLaw::Stribeck {
            ratio: 1.1,
            velocity: 0.5,
        },
        ..tube(0.5, 0.2)
    };
    assert!(WrittenModel::new(&model, false, |_| None).ratio.is_none());
}

/// Coulomb impact: the waves of the reference to which those with material damping tend.
#[test]
fn coulomb_impact_is_covered() {
    let changes = [
        ("mismatch: 0.2,", "mismatch: 0.2, impact: Coulomb,"),
        ("range: (0.0003, 0.2)", "range: (0.01, 0.2)"),
        (
            "stop_at: [0.08, 0.045, 0.02, 0.004, 0.001]",
            "stop_at: [0.045]",
        ),
    ];
    let points = points_of("mode4_mismatch", &changes);
    let at = |kind| {
        points
            .iter()
            .rev()
            .find(|point| point.kind == kind)
            .unwrap()
    };
    for (kind, speed) in [
        (EventType::UZ, -1.248728692461),
        (EventType::EP, -1.258643980927),
    ] {
        let said = &proof(at(kind)).statement;
        assert!(has(said.speed, speed, 5e-13), "{said:?}");
    }
}

#[test]
fn falsified_certificates_are_refused() {
    let points = points_of("mode4_curve", &[]);
    let point = points
        .iter()
        .find(|point| point.kind == EventType::GR)
        .unwrap();
    let honest = proof(point);
    assert_eq!(certify::verify(point, honest), Ok(()));
    let refused = |change: &dyn Fn(&mut CertifiedPoint, &mut WaveProof)| {
        let (mut point, mut proof) = (point.clone(), honest.clone());
        change(&mut point, &mut proof);
        certify::verify(&point, &proof).expect_err("a falsified certificate")
    };
    // one digit of an interval
    let digit = |interval: &mut Interval| {
        *interval = *interval + Interval::point(1e-13);
    };
    assert_eq!(
        refused(&|_, proof| digit(&mut proof.statement.parameter)),
        RefusedProof::Statement("the parameter")
    );
    assert_eq!(
        refused(&|_, proof| digit(&mut proof.statement.speed)),
        RefusedProof::Statement("the speed")
    );
    assert_eq!(
        refused(&|_, proof| digit(&mut proof.statement.lengths[1])),
        RefusedProof::Statement("a length")
    );
    refused(&|_, proof| proof.statement.unique *= 1.5);
    refused(&|_, proof| proof.statement.inequalities += 1);
    // the wave, the model, the regimes, the switches
    refused(&|_, proof| proof.near.parameter += 1e-3);
    refused(&|_, proof| proof.near.zones[0][2] += 1e-2);
    refused(&|_, proof| proof.near.zones[0][2] = f64::NAN);
    refused(&|_, proof| proof.near.excess *= -1.0);
    refused(&|_, proof| proof.posed.written.friction = Decimal::of(0.5000001));
    refused(&|_, proof| proof.posed.mode = 0);
    refused(&|_, proof| proof.posed.unit = f64::NAN);
    refused(&|_, proof| proof.near.signature.0.swap(0, 1));
    refused(&|_, proof| proof.near.signature.0[1].regime = Regime::Separation);
    refused(&|_, proof| proof.near.signature.0[1].entry = ZoneEntry::Landing);
    refused(&|_, proof| {
        proof.near.zones.pop();
    });
    // the type, and what vanishes
    for kind in EventType::ALL
        .into_iter()
        .filter(|kind| *kind != EventType::GR)
    {
        assert!(matches!(
            refused(&|point, _| point.kind = kind),
            RefusedProof::Kind { .. }
        ));
    }
    refused(&|_, proof| proof.condition = WaveCondition::Fold);
    refused(&|point, proof| {
        point.kind = EventType::LP;
        proof.condition = WaveCondition::Fold;
    });
    refused(&|_, proof| {
        if let WaveCondition::Margin { zone, .. } = &mut proof.condition {
            *zone = 7;
        }
    });
}

fn decimal(text: &str) -> Decimal {
    Decimal::try_from(text.to_owned()).unwrap()
}

/// What is said of a point, changed; it is to be refused.
fn refused(
    point: &CertifiedPoint,
    change: impl Fn(&mut CertifiedPoint, &mut WaveProof),
) -> RefusedProof {
    let (mut point, mut proof) = (point.clone(), proof(point).clone());
    change(&mut point, &mut proof);
    certify::verify(&point, &proof).expect_err("a falsified certificate")
}

/// A margin is stated only of a zone that has it as a condition: Q + fP or Q − fP may vanish elsewhere, too, where nothing
/// switches.
#[test]
fn a_margin_belongs_to_its_zone() {
    let points = points_of("mode4_mismatch", &[]);
    let no_condition = RefusedProof::NoProof(OpenPoint::Margin.to_string());
    let of = |kind| points.iter().find(|point| point.kind == kind).unwrap();
    let (force, landing) = (of(EventType::RV), of(EventType::CO));
    for (point, watch, zone) in [
        (force, WaveWatch::LowerForce, 0),
        (force, WaveWatch::UpperForce, 1),
        (force, WaveWatch::LandingRate, 0),
        (force, WaveWatch::Impulse, 0),
        (force, WaveWatch::Gap, 0),
        (landing, WaveWatch::LowerForce, 1),
        (landing, WaveWatch::LandingRate, 0),
        (landing, WaveWatch::Tension, 1),
        (landing, WaveWatch::Release, 0),
    ] {
        let found = refused(point, |point, proof| {
            point.kind = match watch {
                WaveWatch::LowerForce => EventType::RV,
                WaveWatch::UpperForce => EventType::ST,
                _ => EventType::CO,
            };
            let time = 0.0;
            proof.condition = WaveCondition::Margin { watch, zone, time };
            proof.beyond = None;
        });
        assert_eq!(found, no_condition, "{watch:?} {zone}");
    }
}

/// What is beyond a change of regime is another sequence of zones with the same wave and an event of the same type, or is
/// left out.
#[test]
fn what_is_beyond_is_proven() {
    let points = points_of("mode4_mismatch", &[]);
    let of = |kind| points.iter().find(|point| point.kind == kind).unwrap();
    for point in points.iter().filter(|point| proof(point).beyond.is_some()) {
        // the event itself
        let itself = refused(point, |_, proof| {
            proof.beyond = Some(WaveBeyond {
                condition: proof.condition.clone(),
                near: proof.near.clone(),
            });
        });
        assert_eq!(
            itself,
            RefusedProof::Statement("the sequence of zones beyond")
        );
        // other states
        refused(point, |_, proof| {
            if let Some(beyond) = &mut proof.beyond {
                beyond.near.zones[0] = [7.5; 3];
            }
        });
        // less
        let (mut less, mut said) = (point.clone(), proof(point).clone());
        said.beyond = None;
        less.arc = None;
        assert_eq!(certify::verify(&less, &said), Ok(()));
    }
    let changes = points
        .iter()
        .filter(|point| matches!(proof(point).condition, WaveCondition::Margin { .. }));
    assert!(changes.clone().all(|point| proof(point).beyond.is_some()));
    assert!(changes.count() > 3);
    // no change of regime, no other sequence
    let other = proof(of(EventType::GR)).beyond.clone();
    let at_value = refused(of(EventType::UZ), |_, proof| proof.beyond = other.clone());
    assert_eq!(at_value, RefusedProof::Statement("that the regimes change"));
    // the type is that of what vanishes, whatever is beyond
    let typed = refused(of(EventType::CO), |point, proof| {
        point.kind = EventType::ST;
        if let Some(beyond) = &mut proof.beyond {
            beyond.near.signature = Signature::slip_stick();
        }
    });
    assert!(matches!(typed, RefusedProof::Kind { .. }));
}

/// Numbers that are those of no model, and a parameter that is not in the equations.
#[test]
fn the_numbers_are_those_of_a_model() {
    let points = points_of("mode4_curve", &[]);
    let point = &points[0];
    let named = |reason: OpenPoint| RefusedProof::NoProof(reason.to_string());
    for parameter in [Parameter::StiffnessDamping, Parameter::Smoothing] {
        let found = refused(point, |point, proof| {
            (point.parameter, proof.posed.parameter) = (parameter, parameter);
        });
        assert_eq!(found, named(OpenPoint::Parameter));
    }
    let given = refused(point, |point, proof| {
        let numbers = [
            "1.0875712069293",
            "0.31073463055122",
            "-0.81095236229209",
            "17.855545645728",
            "8.4578900427131",
        ];
        proof.posed.written.origin = WrittenCoefficients::Given(numbers.map(decimal));
        (point.parameter, proof.posed.parameter) = (Parameter::Nu, Parameter::Nu);
    });
    assert_eq!(given, named(OpenPoint::Parameter));
    refused(point, |_, proof| {
        proof.posed.written.damping = decimal("-0.05")
    });
    refused(point, |_, proof| {
        proof.posed.written.ratio = Some(decimal("0.9"))
    });
    // a wave with α < 0 solves the equations of that α, but they are those of no brake
    let model = tube(0.5, 0.2);
    let closed = slip_stick(&model, 4, Which::Fast).unwrap();
    let posed = |damping: &str, mode| PosedWave {
        written: WrittenModel {
            damping: decimal(damping),
            ..WrittenModel::new(&model, false, |_| None)
        },
        impact: Impact::Frictionless,
        parameter: Parameter::Mismatch,
        mode,
        unit: 1.0,
    };
    let near = |times: usize| NearWave {
        signature: Signature(Signature::slip_stick().0.repeat(times)),
        zones: [
            [closed.release, 1.0, closed.slip],
            [closed.release - closed.stick, 1.0, closed.stick],
        ]
        .repeat(times),
        layers: Vec::new(),
        excess: closed.excess,
        parameter: 0.2,
    };
    let value = || WaveCondition::Value(decimal("0.2"));
    assert!(certify::prove(posed("0.0", 4), near(1), value(), None).is_ok());
    let negative = certify::prove(posed("-1e-12", 4), near(1), value(), None);
    assert_eq!(negative.err(), Some(OpenPoint::Model));
    // the same wave traversed twice is none of half the mode
    let twice = certify::prove(posed("0.0", 2), near(2), value(), None);
    assert_eq!(twice.err(), Some(OpenPoint::Repeats));
}

/// An event stands in a certificate once.
#[test]
fn an_event_is_stated_once() {
    let mut points = points_of("mode4_curve", &[]);
    assert_eq!(certify::repeated(&points), Vec::<usize>::new());
    let graze = |point: &&CertifiedPoint| point.kind == EventType::GR;
    let mut again = points.iter().find(graze).unwrap().clone();
    again.label += 100;
    points.push(again.clone());
    // whatever zone it begins with
    let ProofOutcome::Proven(proof) = &mut again.outcome else {
        panic!("the graze is not proven");
    };
    proof.near.signature.0.rotate_left(1);
    proof.near.zones.rotate_left(1);
    again.label += 100;
    let label = again.label;
    points.push(again);
    let found = certify::repeated(&points);
    assert_eq!(found, vec![label - 100, label]);
}
