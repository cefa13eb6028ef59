//! The other branch at a doubling and at a loss of symmetry, against figures of an independent program.

use brakewave::EventType;
use brakewave::hybrid::{
    EarlierPoint, LabelledOrbit, NamedOrbit, NoFirstPoint, OrbitItem, OrbitRunner,
};
use brakewave::orbit::legs::Run;
use brakewave::problem::{
    Any, Continuation, OrbitStart, StopAfter, SystemProblem, Toward, parse_any,
};

use crate::affine::systems::{BALL, FRICTION};

const CHUA: &str = include_str!("../../problems/chua.ron");
const IMPACT: &str = include_str!("../../problems/impact_oscillator.ron");

/// A problem with a branch of its own; expectations of the file do not count.
fn problem(
    text: &str,
    parameter: &str,
    range: (f64, f64),
    toward: Toward,
) -> (SystemProblem, Continuation<String>) {
    let Any::System(problem) = parse_any(text, "test").unwrap() else {
        panic!("a system");
    };
    let continuation = Continuation {
        toward,
        max_points: Some(1500),
        ..Continuation::new(parameter.to_owned(), range)
    };
    (*problem, continuation)
}

fn collect(mut run: OrbitRunner, most: usize) -> Vec<OrbitItem> {
    let mut items = Vec::new();
    while run.progress().end.is_none() && items.len() < most {
        items.extend(run.step());
    }
    items
}

/// The other branch at an item.
fn switched(
    problem: &SystemProblem,
    continuation: &Continuation<String>,
    at: &OrbitItem,
) -> Result<OrbitRunner, NoFirstPoint> {
    let mut problem = problem.clone();
    problem.orbit.start = OrbitStart::Switch {
        dir: "earlier".into(),
        label: at.point.label.unwrap(),
    };
    let named = NamedOrbit {
        saved: at.saved.clone().unwrap(),
        kind: at.point.kind,
        has_shrunk: false,
    };
    OrbitRunner::begin(
        &problem,
        continuation,
        Some(&EarlierPoint::Orbit(named.clone())),
    )
}

/// The branch ends at the first event of this type.
fn until(event: EventType) -> Vec<StopAfter> {
    vec![StopAfter { event, count: 1 }]
}

fn first(items: &[OrbitItem], kind: EventType) -> &OrbitItem {
    let mut found = items.iter().filter(|item| item.point.kind == Some(kind));
    found.next().expect("the event is there")
}

fn near(found: f64, expected: f64, allowed: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off < allowed, "{found} for {expected}: {off:e}");
}

/// The ball: the first doubling in closed form, the next two from the reference; in whatever direction the branch is
/// asked for. It begins with the square of the amplitude, and goes on from saved progress.
#[test]
fn a_cascade_of_doublings() {
    let (problem, mut up) = problem(BALL, "G", (1.0, 2.0), Toward::Up);
    up.stop_after = until(EventType::PD);
    let items = collect(OrbitRunner::begin(&problem, &up, None).unwrap(), 400);
    let single = first(&items, EventType::PD);
    near(single.point.parameters[0], 1.526_823_700_519_061, 1e-12);
    let down = Continuation {
        toward: Toward::Down,
        ..up.clone()
    };
    let items = collect(switched(&problem, &down, single).unwrap(), 400);
    let begun = items[0].point.parameters[0] - single.point.parameters[0];
    assert!(begun > 0.0 && begun < 1e-3, "{begun:e}");
    assert_eq!(items[0].point.regimes, "flight-flight");
    let twice = first(&items, EventType::PD);
    near(twice.point.parameters[0], 1.667_130_660_769_543_1, 1e-12);
    near(twice.point.period, 2.0 * single.point.period, 1e-13);
    let run = || switched(&problem, &up, twice).unwrap();
    let items = collect(run(), 200);
    let four = first(&items, EventType::PD);
    near(four.point.parameters[0], 1.696_780_745_805_092_3, 1e-11);
    near(four.point.period, 4.0 * single.point.period, 1e-13);
    // the same after a pause
    for pause in [0, 1, 7] {
        let mut before = run();
        let mut seen: Vec<OrbitItem> = (0..pause).flat_map(|_| before.step()).collect();
        let state = ron::from_str(&ron::to_string(&before.state()).unwrap()).unwrap();
        let label = seen.first().and_then(|item| item.saved.clone());
        let Some(label) = label else {
            // nothing is saved before the first point
            continue;
        };
        let resumed = OrbitRunner::resume(&problem, &down, &label, state).unwrap();
        seen.extend(collect(resumed, 20));
        for (one, other) in seen.iter().zip(&items) {
            assert_eq!(one.point, other.point, "after {pause}");
        }
    }
}

/// Multipliers of doubled orbits of the impact oscillator at w = 2.6; the branch comes back to the doubling, and
/// from there the single orbit is found.
#[test]
fn a_doubled_orbit_and_the_way_back() {
    let text = IMPACT.replace("\"w\": 1.0", "\"w\": 2.6");
    let text = text
        .replace("\"e\": 0.8", "\"e\": 0.7")
        .replace("\"A\": 1.0", "\"A\": 2.6");
    let from = text.find("Simulate(").unwrap();
    let end = from + text[from..].find("settle: 200)").unwrap() + "settle: 200)".len();
    let text = format!(
        "{}Given(mode: \"free\", state: {{\"x\": 1.0, \"v\": -1.056}}, phase: 0.53), periods: 2{}",
        &text[..from],
        &text[end..]
    );
    let text = text.replace("(0.05, 1.0)", "(2.0, 5.0)");
    let (problem, mut along) = problem(&text, "A", (2.0, 3.3), Toward::Up);
    along.stop_after = until(EventType::PD);
    let items = collect(OrbitRunner::begin(&problem, &along, None).unwrap(), 400);
    along.stop_after = Vec::new();
    let single = first(&items, EventType::PD);
    near(single.point.parameters[1], 2.679_437_972_458_919_1, 1e-12);
    along.stop_at = [2.8, 3.0, 3.2].map(Into::into).to_vec();
    let items = collect(switched(&problem, &along, single).unwrap(), 400);
    let users = items
        .iter()
        .filter(|item| item.point.kind == Some(EventType::UZ));
    let users: Vec<&OrbitItem> = users.collect();
    for (user, (re, im)) in users.iter().zip([
        (0.434_775_112_661_035_77, 0.0),
        (0.039_006_935_754_330_5, 0.299_670_277_366_571_74),
        (-0.161_077_069_650_633_07, 0.255_691_207_918_194_96),
    ]) {
        let leading = user.point.leading().unwrap();
        let off = (leading.re - re).abs().max((leading.im - im).abs());
        assert!(off < 1e-11, "{leading}: {off:e}");
    }
    assert_eq!(users.len(), 3);
    // back down: the two halves become one
    let saved: LabelledOrbit = users[0].saved.clone().unwrap();
    let mut back = problem.clone();
    back.orbit.start = OrbitStart::Restart {
        dir: "earlier".into(),
        label: saved.label,
    };
    let down = Continuation {
        toward: Toward::Down,
        stop_at: Vec::new(),
        ..along.clone()
    };
    let named = NamedOrbit {
        saved,
        kind: None,
        has_shrunk: false,
    };
    let items = collect(
        OrbitRunner::begin(&back, &down, Some(&EarlierPoint::Orbit(named.clone()))).unwrap(),
        400,
    );
    let end = items.last().unwrap();
    assert_eq!(end.point.kind, Some(EventType::PD));
    near(end.point.parameters[1], 2.679_437_972_458_919_1, 1e-6);
    let part = collect(switched(&problem, &down, end).unwrap(), 3);
    assert_eq!(part[0].point.regimes, "free");
    near(part[0].point.period, single.point.period, 1e-13);
    // no other branch leaves an ordinary orbit, whatever it is called
    let named = NamedOrbit {
        saved: items[1].saved.clone().or(items[0].saved.clone()).unwrap(),
        kind: Some(EventType::BP),
        has_shrunk: false,
    };
    let mut wrong = problem.clone();
    wrong.orbit.start = OrbitStart::Switch {
        dir: "earlier".into(),
        label: 1,
    };
    let refused =
        OrbitRunner::begin(&wrong, &along, Some(&EarlierPoint::Orbit(named.clone()))).err();
    let message = refused.map(|error| error.to_string()).unwrap_or_default();
    assert!(message.contains("no other branch passes"), "{message}");
}

/// Chua's symmetric orbit through three regions: where its half map has the multiplier −1 the full one has a BP right
/// beside a fold, and the orbit that leaves there is not symmetric.
#[test]
fn a_loss_of_symmetry() {
    let from = CHUA.find("Simulate(").unwrap();
    let end = from + CHUA[from..].find("settle: 200)").unwrap() + "settle: 200)".len();
    let text = format!(
        "{}Given(mode: \"upper\", state: {{\"x\": 1.0, \"y\": 0.8197494353846, \"z\": -0.3434700792719}}, \
         period: 2.4800502642831){}",
        &CHUA[..from],
        &CHUA[end..]
    );
    let text = text.replace("\"alpha\": 7.5", "\"alpha\": 9.0");
    let (problem, mut along) = problem(&text, "alpha", (8.5, 14.5), Toward::Up);
    along.ds_max = 0.05;
    along.stop_after = until(EventType::BP);
    let items = collect(OrbitRunner::begin(&problem, &along, None).unwrap(), 1200);
    let loss = first(&items, EventType::BP);
    near(loss.point.parameters[0], 13.728_817_274_033_318, 1e-11);
    let skew = |item: &OrbitItem| {
        let (low, high) = item.point.extremes[0];
        (low + high).abs()
    };
    // along the null vector the place is the zero of a cubic: known to the cube root of rounding
    assert!(skew(loss) < 1e-5, "{:e}", skew(loss));
    let other = collect(switched(&problem, &along, loss).unwrap(), 30);
    let skews: Vec<f64> = other.iter().take(20).map(skew).collect();
    assert!(skews.windows(2).all(|pair| pair[1] > pair[0]), "{skews:?}");
    assert!(skews[19] > 0.02, "{skews:?}");
}

/// Lorenz's equations at large r, where a symmetric cycle loses its symmetry and its halves double (AUTO's demo `lor`).
const LORENZ: &str = r#"(
    system: (
        states: ["x", "y", "z"],
        parameters: {"r": 280.0, "b": "8/3", "s": 10.0},
        modes: {"flow": (rates: {"x": "s*(y - x)", "y": "r*x - y - x*z", "z": "x*y - b*z"})},
    ),
    orbit: (start: Simulate(mode: "flow", state: {"x": 1.0, "y": 2.0, "z": 200.0}, settle: 100)),
    continuation: (parameter: "r", range: (200.0, 400.0)),
    stability: (),
)"#;

/// A cycle that never switches is one zone, and traversed twice one of twice the duration: its null vector at a doubling is no
/// difference of two halves, and the known branch is not across it. The cascade is that of AUTO-07p with 300 intervals, which
/// prints eleven digits.
#[test]
fn a_cycle_without_switches_doubles() {
    let (problem, mut along) = problem(LORENZ, "r", (200.0, 300.0), Toward::Down);
    along.stop_after = until(EventType::PD);
    let mut run = OrbitRunner::begin(&problem, &along, None).unwrap();
    let mut before = f64::INFINITY;
    for (r, period) in [
        (229.406_708_56, 0.480_866_820_3),
        (218.210_127_78, 0.987_948_936_4),
        (215.965_930_62, 1.986_752_37),
    ] {
        let items = collect(run, 200);
        let doubling = first(&items, EventType::PD);
        near(doubling.point.parameters[0], r, 1e-10);
        near(doubling.point.period, period, 2e-9);
        // it is no part of its own that is traversed twice
        assert!(items.iter().all(|item| item.point.parameters[0] < before));
        before = doubling.point.parameters[0];
        run = switched(&problem, &along, doubling).unwrap();
    }
}

/// A branch of cycles without symmetry ends at a symmetric one: the other branch there is that of symmetric cycles, and at the
/// loss of symmetry on that one the other is that of those without.
#[test]
fn the_other_branch_is_not_the_one_that_is_known() {
    let skew = |item: &OrbitItem| {
        let (low, high) = item.point.extremes[0];
        (low + high).abs() / high
    };
    let (problem, mut along) = problem(LORENZ, "r", (270.0, 330.0), Toward::Up);
    along.stop_after = until(EventType::BP);
    let own = collect(OrbitRunner::begin(&problem, &along, None).unwrap(), 200);
    assert!(skew(&own[0]) > 0.1);
    along.toward = Toward::Both;
    let symmetric = collect(
        switched(&problem, &along, first(&own, EventType::BP)).unwrap(),
        200,
    );
    assert!(symmetric.iter().all(|item| skew(item) < 1e-10));
    let [end, loss] = [&own, &symmetric].map(|items| first(items, EventType::BP));
    near(loss.point.parameters[0], end.point.parameters[0], 1e-11);
    let back = collect(switched(&problem, &along, loss).unwrap(), 20);
    let skews: Vec<f64> = back.iter().map(skew).collect();
    assert!(
        skews[0] > 1e-3 && skews.windows(2).all(|pair| pair[1] > pair[0]),
        "{skews:?}"
    );
}

/// A doubled orbit of two masses, with friction and two stops, comes to the single one, in units in which a plane across a step
/// meets the branch of the single one far away: it ends where the multiplier of that is -1, as in other units.
#[test]
fn a_doubled_branch_ends_beside_its_last_step() {
    let text = |[unit, other]: [f64; 2], d1: f64| {
        format!(
            r#"(
            system: (
                states: ["x", "v", "y", "w"],
                parameters: {{"A": 3.47, "c": 0.0725, "k0": 1.45, "h0": 0.493, "k1": 1.49, "d1": {d1:?}}},
                forcing: "0.828",
                contacts: {{
                    "p": Stop(gap: "1.44 - {unit}*x", restitution: "0.678"),
                    "q": Friction(slip: "{other}*w", bound: "0.161"),
                    "r": Stop(gap: "d1 - {other}*y", restitution: "0.797"),
                }},
                rates: {{
                    "x": "v", "y": "w",
                    "v": "(-k0*{unit}*x - c*{unit}*v - h0*({unit}*x - {other}*y) + A*cos(phase) - p)/(1.47*{unit})",
                    "w": "(-k1*{other}*y - c*{other}*w - h0*({other}*y - {unit}*x) + 0.5*A*sin(phase) + q - r)/{other}",
                }},
            ),
            orbit: (start: Simulate(mode: "open.stick.open", state: {{"x": 0.0, "v": 0.0, "y": 0.0, "w": 0.0}}, settle: 150), periods: 4),
            continuation: (parameter: "d1", range: (0.55, 1.98)),
            stability: (),
        )"#
        )
    };
    let doublings = [[1.0, 1.0], [320.0, 77.8], [1e-3, 1e3]].map(|units| {
        let (problem, along) = problem(&text(units, 1.1), "d1", (0.55, 1.98), Toward::Up);
        let items = collect(OrbitRunner::begin(&problem, &along, None).unwrap(), 1500);
        let last = items.last().unwrap().point.clone();
        assert_eq!(last.kind, Some(EventType::PD));
        // the multiplier of the single orbit is squared
        let of_one = |one: &brakewave::affine::orbit::Multiplier| (one.value.re - 1.0).abs() < 1e-6;
        assert!(
            last.multipliers.iter().any(of_one),
            "{:?}",
            last.multipliers
        );
        last.parameters[5]
    });
    doublings
        .iter()
        .for_each(|one| near(*one, 1.126_729_947_838_089, 1e-12));
}

/// A body between two stops: the branch of orbits that are not symmetric begins at a loss of symmetry and, beyond
/// of its ends, would be its own mirror image. It ends at either once, and the loss of symmetry is where the branch of
/// symmetric orbits has it.
#[test]
fn a_branch_without_symmetry_ends_where_it_would_retrace_itself() {
    let skew = r#"(
        system: (
            states: ["x", "v"],
            parameters: {"c": 0.1, "A": 3.6, "w": 1.0, "d": 1.0, "e": 0.7},
            forcing: "w",
            modes: {"free": (
                rates: {"x": "v", "v": "A*cos(phase) - c*v - x"},
                until: [
                    (zero: "d - x", to: "free", reset: {"v": "-e*v"}),
                    (zero: "d + x", to: "free", reset: {"v": "-e*v"}),
                ],
            )},
        ),
        orbit: (start: Given(mode: "free", state: {"x": 1.0, "v": -1.0203605}, phase: 0.9368582)),
        continuation: (parameter: "A", range: (3.0, 5.0)),
        stability: (),
    )"#;
    let (problem, along) = problem(skew, "A", (3.0, 5.0), Toward::Down);
    let items = collect(OrbitRunner::begin(&problem, &along, None).unwrap(), 400);
    let kinds: Vec<_> = items.iter().filter_map(|item| item.point.kind).collect();
    assert_eq!(kinds, [EventType::EP, EventType::BP]);
    let end = items.last().unwrap();
    near(end.point.parameters[1], 3.520_685_394_067_528, 1e-8);
}

/// Dry friction: as the frequency falls, slip comes to rest right after it has begun, and a moment later in frequency it
/// does not begin before: two events that a long step sees at once, in their order.
#[test]
fn a_touch_right_after_the_entry_comes_first() {
    let text = FRICTION.replace(
        "\"F\": 0.6666666666666666, \"z\": 0.05",
        "\"F\": 0.051469, \"z\": 0.035721",
    );
    let from = text.find("Simulate(").unwrap();
    let end = from + text[from..].find("settle: 100)").unwrap() + "settle: 100)".len();
    let text = format!(
        "{}Given(mode: \"forth\", state: {{\"x\": -1.0516314, \"v\": 0.0}}, phase: 3.1353697){}",
        &text[..from],
        &text[end..]
    );
    let text = text.replace("\"w\": 1.2", "\"w\": 0.24472");
    let (problem, mut along) = problem(&text, "w", (0.2, 1.2), Toward::Down);
    along.stop_after = until(EventType::SL);
    let items = collect(OrbitRunner::begin(&problem, &along, None).unwrap(), 60);
    let events = items.iter().filter(|item| item.point.kind.is_some());
    let events: Vec<_> = events.collect();
    let kinds: Vec<_> = events.iter().filter_map(|item| item.point.kind).collect();
    assert_eq!(kinds, [EventType::EP, EventType::GR, EventType::SL]);
    for (event, expected) in events[1..]
        .iter()
        .zip([0.244_500_007_866_058, 0.244_472_208_120_768])
    {
        near(event.point.parameters[0], expected, 1e-12);
    }
}

/// Beside a homoclinic orbit of Chua's circuit, to a saddle that turns as it decays, folds and doublings accumulate (Shilnikov 1965): each
/// turn brings one of both, on the other side and nearer to it by one factor, until a step moves the parameter by less than it is known
/// to: what rounding makes of multipliers there is no event.
#[test]
fn folds_accumulate_beside_a_homoclinic_orbit() {
    let parameters = "\"alpha\": 9.575, \"beta\": 12.0282, \"m\": -0.160312, \"n\": 0.335313";
    let begin = CHUA.find("parameters: {").unwrap() + "parameters: {".len();
    let end = begin + CHUA[begin..].find('}').unwrap();
    let text = format!("{}{parameters}{}", &CHUA[..begin], &CHUA[end..]);
    let from = text.find("Simulate(").unwrap();
    let end = from + text[from..].find("settle: 200)").unwrap() + "settle: 200)".len();
    let text = format!(
        "{}Given(mode: \"inner\", state: {{\"x\": 1.0, \"y\": -0.31041834088168824, \"z\": -1.4650345139171845}}, \
         period: 8.7277854627058815){}",
        &text[..from],
        &text[end..]
    );
    let (problem, along) = problem(&text, "alpha", (6.0, 12.0), Toward::Up);
    let items = collect(OrbitRunner::begin(&problem, &along, None).unwrap(), 300);
    let values = |kind: EventType| -> Vec<f64> {
        let own = items.iter().filter(|item| item.point.kind == Some(kind));
        own.map(|item| item.point.parameters[0]).collect()
    };
    let (folds, doublings, limit) = (
        values(EventType::LP),
        values(EventType::PD),
        values(EventType::HC),
    );
    assert_eq!((folds.len(), doublings.len(), limit.len()), (5, 5, 1));
    for all in [folds, doublings] {
        let off: Vec<f64> = all.iter().map(|value| value - limit[0]).collect();
        let ratios: Vec<f64> = off.windows(2).map(|pair| pair[1] / pair[0]).collect();
        // what is small beside the first of them falls by their square
        let last = ratios[3];
        assert!(last < 0.0, "{ratios:?}");
        for (index, ratio) in ratios.iter().enumerate() {
            let allowed = 2.0 * off[index].abs();
            assert!(
                (ratio / last - 1.0).abs() <= allowed.max(2e-3),
                "{ratios:?}"
            );
        }
    }
    // the zero of what of the growing direction returns, from matrix exponentials by bisection
    near(
        items.last().unwrap().point.parameters[0],
        9.573_986_855_703,
        1e-11,
    );
}

/// Friction and a stop: the doubled branch begins flat, so that beside its first orbit little tells it from a family at one value
/// of the parameter. It leads to the graze that the branch of the doubled orbit has from its other side.
#[test]
fn a_doubling_that_begins_flat() {
    const DOUBLES: &str = r#"(
        system: (
            states: ["x1", "v1", "x2", "v2"],
            parameters: {"A": 1.207, "w": 0.631, "k": 1.276, "c": 0.16, "F1": 0.287, "d": 1.0, "e": 0.673},
            forcing: "w",
            contacts: {"q": Friction(slip: "v1", bound: "F1"), "p": Stop(gap: "d - x2", restitution: "e")},
            rates: {
                "x1": "v1", "v1": "A*cos(phase) - x1 - k*(x1 - x2) - c*v1 + q",
                "x2": "v2", "v2": "-0.8*x2 - k*(x2 - x1) - c*v2 - p",
            },
        ),
        orbit: (
            start: Simulate(mode: "forward.open", state: {"x1": 0.0, "v1": 0.1, "x2": 0.0, "v2": 0.0}, settle: 2000.0),
            periods: 4,
        ),
        continuation: (parameter: "d", range: (0.95, 1.05)),
        stability: (),
    )"#;
    // beyond the graze, the branch of what a motion settles on turns back to the doubling
    let (problem, mut down) = problem(DOUBLES, "d", (0.95, 1.05), Toward::Down);
    let doubled = collect(OrbitRunner::begin(&problem, &down, None).unwrap(), 400);
    let (graze, double) = (
        first(&doubled, EventType::GR),
        first(&doubled, EventType::PD),
    );
    down.stop_after = until(EventType::GR);
    // of an orbit traversed twice the branch at its doubling is that of the single one
    let mut single = switched(&problem, &down, double).unwrap();
    let begun = single.step();
    near(2.0 * begun[0].point.period, double.point.period, 1e-13);
    let single = NamedOrbit {
        saved: begun[0].saved.clone().unwrap(),
        kind: Some(EventType::PD),
        has_shrunk: false,
    };
    let start = OrbitStart::Switch {
        dir: "earlier".into(),
        label: single.saved.label,
    };
    let mut problem = problem;
    problem.orbit.start = start;
    let earlier = EarlierPoint::Orbit(single);
    let items = collect(
        OrbitRunner::begin(&problem, &down, Some(&earlier)).unwrap(),
        400,
    );
    let met = first(&items, EventType::GR);
    near(met.point.period, double.point.period, 1e-13);
    near(met.point.parameters[5], graze.point.parameters[5], 1e-13);
}

/// Events of a branch without symmetry that comes to the symmetric one, in a direction.
fn comes_to(text: &str, parameter: &str, range: (f64, f64)) -> Vec<(EventType, f64)> {
    let (problem, along) = problem(text, parameter, range, Toward::Up);
    let items = collect(OrbitRunner::begin(&problem, &along, None).unwrap(), 400);
    let special = items
        .iter()
        .filter_map(|item| Some((item.point.kind?, item)));
    let events = special.map(|(kind, item)| (kind, item.point.parameters[0]));
    events.collect()
}

/// A branch without symmetry ends at one BP, where the symmetric one loses its symmetry, to its last digits: of Lorenz's system by a half
/// map with an own integrator, with and without a switch that changes nothing, and of an oscillator between two stops.
#[test]
fn a_branch_ends_at_the_symmetric_one_in_one_place() {
    let rates = r#"rates: {"x": "s*(y - x)", "y": "r*x - y - x*z", "z": "x*y - b*z"}"#;
    let lorenz = |states: &str, modes: &str, first: &str| {
        format!(
            r#"(system: (states: [{states}], parameters: {{"r": 310.0, "s": 10.0, "b": 2.6666666666666665}}, modes: {{{modes}}}),
            orbit: (start: Simulate(mode: "{first}", state: {{"x": 10.0, "y": 10.0, "z": 265.0}}, settle: 200)),
            continuation: (parameter: "r", range: (200.0, 345.0)), stability: ())"#
        )
    };
    let smooth = format!(r#""p": ({rates})"#);
    let switched = format!(
        r#""p": ({rates}, until: [(zero: "x", to: "n")]), "n": ({rates}, until: [(zero: "-x", to: "p")])"#
    );
    let turned = r#""z", "y", "x""#;
    for (states, modes) in [
        (r#""x", "y", "z""#, &smooth),
        (r#""x", "y", "z""#, &switched),
        (turned, &switched),
    ] {
        let events = comes_to(&lorenz(states, modes, "p"), "r", (200.0, 345.0));
        let kinds: Vec<EventType> = events.iter().map(|one| one.0).collect();
        assert_eq!(kinds, [EventType::EP, EventType::BP], "{states} {modes}");
        near(events[1].1, 312.973_532_984_16, 3e-13);
    }
    for (states, unit) in [
        (r#""x", "v""#, 1.0),
        (r#""v", "x""#, 1.0),
        (r#""x", "v""#, 1e-3),
    ] {
        let stops = format!(
            r#"(system: (states: [{states}], parameters: {{"A": 0.69}}, forcing: "0.9", modes: {{"free": (
            rates: {{"x": "v", "v": "{unit}*A*cos(phase) - 0.12*v - x"}}, until: [
                (zero: "{unit} - x", to: "free", reset: {{"v": "-0.7*v"}}),
                (zero: "{unit} + x", to: "free", reset: {{"v": "-0.7*v"}})])}}),
            orbit: (start: Simulate(mode: "free", state: {{"x": {}, "v": 0.0}}, settle: 200)),
            continuation: (parameter: "A", range: (0.1, 1.4)), stability: ())"#,
            0.9 * unit
        );
        let events = comes_to(&stops, "A", (0.1, 1.4));
        let last = events.last().unwrap();
        assert_eq!(last.0, EventType::BP, "{states} {unit}");
        assert_eq!(
            events.iter().filter(|one| one.0 == EventType::BP).count(),
            1
        );
        near(last.1, 0.705_852_858_131_17, 3e-14);
    }
}
