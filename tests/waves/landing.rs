//! Landing with material damping β: no impact, but a concentrated reaction with its friction.
//!
//! Figures of an independent collocation, the limit β → 0, integration of the separation zone, the law of opening, and the way there and back through every event.

use brakewave::branch::EventType::{self, GR, RV, ST};
use brakewave::branch::orbit::{Follower, Found};
use brakewave::branch::polish;
use brakewave::branch::special::{OfWaves, Special};
use brakewave::continuation::walk::End;
use brakewave::linalg::Vector;
use brakewave::orbit::follow::Limits;
use brakewave::tube::model::signature::{Regime, ZoneEntry};
use brakewave::tube::model::{Damping, Impact, Model, Parameter};
use brakewave::tube::wave::admissibility::{WaveWatch, examine};
use brakewave::tube::wave::profile::sample;
use brakewave::tube::wave::start::Which;
use brakewave::tube::wave::{Wave, WaveScales};

use crate::waves::branches::{
    Case, Run, STEPS, mode4, regimes, speed, to_the_end, tube, with_coulomb_impact,
    with_material_damping,
};
use crate::waves::observed;

/// A solved wave.
type Solved = (Wave, Vector);

/// The wave with Coulomb impacts at a mismatch, posed in β at β = 0: the limit of damped waves.
fn undamped_limit(mismatch: f64) -> Solved {
    let case = with_coulomb_impact();
    let run = case.follow(&[mismatch]);
    let found = run.user_points(mismatch)[0];
    let point = &found.node.point;
    let wave = Wave::new(
        found.orbit.model_at(point),
        Parameter::StiffnessDamping,
        case.mode,
        found.orbit.signature.clone(),
        WaveScales {
            parameter: 0.01,
            ..found.orbit.scales
        },
    );
    let guess = wave.pack(
        &found.orbit.unpack(point),
        found.orbit.excess_at(point),
        0.0,
    );
    let point = polish(&wave, &guess).expect("the limit");
    (wave, point)
}

/// The wave of the same signature at another β, admissible or not, in steps of β.
fn damped((wave, point): &Solved, beta: f64) -> Solved {
    let mut point = point.clone();
    let steps = (beta / 5e-4).ceil().max(1.0);
    for step in 1..=steps as usize {
        let value = beta * step as f64 / steps;
        let guess = wave.pack(&wave.unpack(&point), wave.excess_at(&point), value);
        point = polish(wave, &guess).expect("the wave at this damping");
    }
    (wave.clone(), point)
}

fn separation(wave: &Wave) -> usize {
    (0..wave.zones())
        .find(|&zone| wave.signature.zone(zone).regime == Regime::Separation)
        .expect("a separation zone")
}

/// Pressure at take-off, (Ü, V̈) just before landing and V̈ just after it.
fn at_the_ends(wave: &Wave, point: &Vector) -> [f64; 4] {
    let zone = separation(wave);
    let posed = wave.at(point).expect("a frame");
    let flows = &posed.flows;
    let at = &flows.frame.at;
    let before = zone + wave.zones() - 1;
    let slide = wave.slide_at(point, before);
    let flow = flows.contact(wave.signature.zone(before).regime);
    let state = flow.state(&slide, slide.duration).expect("a state");
    let pressure = at.g * at.mismatch + at.kappa * flow.drive(&slide, slide.duration, state);
    let end = posed.zone_end(zone).expect("a landing");
    let [radial, tangential] = end.impulse.map(|jet| jet.value / at.material);
    let after = wave.slide_at(point, zone + 1);
    let next = wave.signature.zone(zone + 1).regime;
    let after = match next.sliding() {
        Some(_) => flows.contact(next).acceleration(&after, 0.0, after.entry),
        None => 0.0,
    };
    [pressure, radial, tangential, after]
}

/// An independent program: collocation of the whole wave with 1e4 to 2e4 points.
#[test]
fn an_independent_collocation_finds_the_same_waves() {
    let low = undamped_limit(0.01);
    let high = undamped_limit(0.045);
    // speed, durations, and what is given of P at take-off, Ü, V̈ before landing and V̈ after it
    let none = f64::NAN;
    type Figures<'a> = (&'a Solved, f64, f64, &'a [f64], [f64; 4]);
    let cases: [Figures; 3] = [
        (
            &low,
            0.005,
            -1.26287826,
            &[0.33520772, 0.81670571, 0.09190902],
            [4.3115e-3, 234.84, 19.483, none],
        ),
        (
            &low,
            0.001,
            -1.25929959,
            &[0.33083316, 0.81959997, 0.09692399],
            [9.439e-4, 1376.7, 5.645, none],
        ),
        (
            &high,
            0.001,
            -1.25061467,
            &[0.52208306, 0.28116607, 0.20249406, 0.16468359, 0.08559265],
            [none, none, 21.774, 6.9087],
        ),
    ];
    let (mut worst, mut ends) = (0.0_f64, 0.0_f64);
    for (limit, beta, expected, durations, expected_ends) in cases {
        let (wave, point) = damped(limit, beta);
        worst = worst.max((wave.speed_at(&point) - expected).abs());
        for (zone, expected) in durations.iter().enumerate() {
            worst = worst.max((wave.duration_at(&point, zone) - expected).abs());
        }
        for (seen, expected) in at_the_ends(&wave, &point).into_iter().zip(expected_ends) {
            if expected.is_finite() {
                ends = ends.max((seen / expected - 1.0).abs());
            }
        }
    }
    observed(
        "separation with material damping against collocation",
        worst,
    );
    observed("pressure at take-off, Ü and V̈ at landing", ends);
    // eight decimals are given of the former, four to five digits of the latter
    assert!(worst < 1e-8, "{worst:e}");
    assert!(ends < 1e-4, "{ends:e}");
}

/// As β → 0 the waves tend to those with Coulomb impacts, linearly in β.
#[test]
fn the_limit_is_the_coulomb_impact() {
    for (mismatch, expected) in [(0.01, -1.258643980927), (0.045, -1.248728692461)] {
        let limit = undamped_limit(mismatch);
        let begun = limit.0.speed_at(&limit.1);
        assert!((begun - expected).abs() < 1e-12, "{begun}");
        let slope = |beta: f64| {
            let (wave, point) = damped(&limit, beta);
            (wave.speed_at(&point) - begun) / beta
        };
        let betas = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];
        let slopes = betas.map(slope);
        // from β = 1e-6 the limit of the slope is known to 1e-6 of the next order, 1e-10/β² to rounding
        let first = slopes[3];
        for (beta, slope) in betas.into_iter().zip(slopes) {
            println!("δ = {mismatch}, β = {beta:e}: (c − c₀)/β = {slope:.9}");
            let allowed = 300.0 * beta.max(1e-6) * first.abs() + 1e-14 / beta;
            assert!((slope - first).abs() < allowed, "{slope} for {first}");
        }
        let order = ((slopes[1] * betas[1]) / (slopes[5] * betas[5]))
            .abs()
            .log10()
            / 4.0;
        observed(
            &format!("order of c − c₀ in β at δ = {mismatch}, less 1"),
            order - 1.0,
        );
        assert!((order - 1.0).abs() < 5e-3, "{order}");
    }
}

/// A branch that falls in β comes to β = 0 itself, where its wave has Coulomb impacts and says so.
#[test]
fn a_branch_reaches_the_limit() {
    let (wave, point) = damped(&undamped_limit(0.045), 1e-3);
    let limits = Limits {
        range: (0.0, 0.01),
        stop_at: Vec::new(),
        steps: STEPS,
    };
    let run = to_the_end(
        Follower::new(wave, &point, false, limits).expect("a start"),
        None,
    );
    assert_eq!(run.end, Some(End::Edge));
    assert!(run.events().is_empty(), "{:?}", kinds(&run));
    let last = run.points.last().expect("points");
    assert_eq!(last.special, Some(Special::Own(OfWaves::CoulombLimit)));
    assert_eq!(last.parameter, 0.0);
    let error = (speed(last) + 1.248728692461).abs();
    observed("β → 0 along a branch against the Coulomb impact", error);
    // as many digits are given
    assert!(error < 1e-12, "{error:e}");
}

/// The equations of separation, integrated backwards from the end of every separation zone, where no motion
/// grows much, by the classical method of order 4 in steps of a hundredth of the layer: how far its
/// beginning is from U = δ, U̇ = 0 and V, V̇ of the zone before, and Ü = 0, V̈ as before a take-off, or
/// behind a touch 0 < Ü⁺ < Ü⁻, [V̈] = (fb/a)[Ü].
fn integrated_backwards(wave: &Wave, point: &Vector) -> f64 {
    let model = wave.model_at(point);
    let c = model.constants().coefficients;
    let speed = wave.speed_at(point);
    let kappa = c.coupling / speed;
    let [a, b] = [c.a, c.b].map(|square| square / (speed * speed));
    let (alpha, beta) = (model.damping.mass, model.damping.stiffness);
    let posed = wave.at(point).expect("a frame");
    let flows = &posed.flows;
    let steady = flows.frame.steady().value;
    // (U, U̇, Ü, V, V̇, V̈)
    let slope = |x: &[f64; 6]| {
        let [u, u1, u2, v, v1, v2] = *x;
        let lift = (1.0 - b) * u2 + (alpha + beta * c.g) * u1 + c.g * u + kappa * (v1 + beta * v2);
        let drag = (1.0 - a) * v2 + (alpha + beta * c.h) * v1 + c.h * v - kappa * (u1 + beta * u2);
        [u1, u2, lift / (beta * b), v1, v2, drag / (beta * a)]
    };
    let along = |x: &[f64; 6], by: &[f64; 6], h: f64| -> [f64; 6] {
        std::array::from_fn(|i| x[i] + h * by[i])
    };
    let at_end = |zone: usize| {
        let slide = wave.slide_at(point, zone);
        let t = slide.duration;
        if wave.signature.zone(zone).regime == Regime::Separation {
            let state = flows.separation().state(&slide, t).expect("a state");
            let end = posed.zone_end(zone).expect("a landing");
            let [lift, bend] = end.impulse.map(|jet| jet.value / beta);
            return [state[0], state[1], lift, state[2] + steady, state[3], bend];
        }
        let flow = flows.contact(wave.signature.zone(zone).regime);
        let [y, w] = flow.state(&slide, t).expect("a state");
        let bend = flow.acceleration(&slide, t, [y, w]);
        [model.mismatch, 0.0, 0.0, y + steady, w, bend]
    };
    let zones = 0..wave.zones();
    let separated = zones.filter(|&zone| wave.signature.zone(zone).regime == Regime::Separation);
    let mut worst = 0.0_f64;
    for zone in separated {
        let mut x = at_end(zone);
        assert!(x[2] > 0.0);
        let duration = wave.duration_at(point, zone);
        let layer = beta * b / (1.0 - b);
        let steps = (100.0 * duration / layer).ceil() as usize;
        let h = -duration / steps as f64;
        for _ in 0..steps {
            let k1 = slope(&x);
            let k2 = slope(&along(&x, &k1, 0.5 * h));
            let k3 = slope(&along(&x, &k2, 0.5 * h));
            let k4 = slope(&along(&x, &k3, h));
            x = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        }
        let mut expected = at_end((zone + wave.zones() - 1) % wave.zones());
        if wave.signature.zone(zone).entry == ZoneEntry::Touch {
            assert!(0.0 < x[2] && x[2] < expected[2], "{x:?} {expected:?}");
            expected[5] += model.friction * c.b / c.a * (x[2] - expected[2]);
            expected[2] = x[2];
        }
        // in the frequency of slip
        let unit = ((1.0 - a) / c.h).sqrt();
        for (index, (seen, expected)) in x.into_iter().zip(expected).enumerate() {
            worst = worst.max((seen - expected).abs() * unit.powi(index as i32 % 3));
        }
    }
    worst
}

/// A wave at the lower end of a range of δ.
fn last(model: Model, damping: Damping, mode: u32, lowest: f64) -> Solved {
    let case = Case {
        model: Model { damping, ..model },
        parameter: Parameter::Mismatch,
        mode,
        which: Which::Fast,
        range: (lowest, model.mismatch),
        up: false,
        until: None,
    };
    let run = case.follow(&[]);
    assert_eq!(run.end, Some(End::Edge));
    let found = run.points.last().expect("points");
    (found.orbit.as_ref().clone(), found.node.point.clone())
}

/// Waves of every signature.
#[test]
fn integration_backwards_finds_the_same_take_off() {
    let mut worst = 0.0_f64;
    for (mismatch, beta) in [(0.01, 1e-3), (0.01, 5e-3), (0.01, 1.2e-2), (0.045, 3e-3)] {
        let (wave, point) = damped(&undamped_limit(mismatch), beta);
        worst = worst.max(integrated_backwards(&wave, &point));
    }
    let damping = |mass: f64, stiffness: f64| Damping { mass, stiffness };
    for (model, damping, mode, lowest, signature) in [
        (
            mode4(0.06),
            damping(0.1, 0.005),
            4,
            0.02,
            "slip-separation-slip-stick",
        ),
        (mode4(0.06), damping(0.0, 0.012), 4, 0.01, "slip-separation"),
        (
            tube(0.2, 1.3, 0.1, 0.1),
            damping(0.0, 1e-3),
            3,
            0.02,
            "slip-separation-slip-reverse",
        ),
        (
            tube(0.4, 1.5, 0.8, 0.1),
            damping(0.0, 1e-3),
            2,
            0.002,
            "slip-separation-reverse",
        ),
        (
            tube(0.45, 1.25, 0.2, 0.05),
            damping(0.0, 5e-3),
            1,
            0.002,
            "slip-separation-separation-slip-reverse-stick",
        ),
    ] {
        let (wave, point) = last(model, damping, mode, lowest);
        assert_eq!(wave.signature.to_string(), signature);
        let error = integrated_backwards(&wave, &point);
        println!("observed: {signature}: {error:.1e}");
        worst = worst.max(error);
    }
    observed("separation against integration backwards", worst);
    // (1/100)⁴/120 of the layers, of order one, and what grows of it
    assert!(worst < 1e-8, "{worst:e}");
}

/// Where slip returns through V̇ = 1 between reverse slip and slip, V̈ is continuous with material damping
/// and vanishes where a stick zone opens. Without damping V̈ jumps, and what vanishes there is fP − Q:
/// that event is the limit, linearly in β.
#[test]
fn a_stick_zone_opens_between_reverse_slip_and_slip() {
    let opens = |beta: f64| {
        let mut model = tube(0.2, 1.3, 0.1, 0.1);
        model.impact = Impact::Coulomb;
        model.damping.stiffness = beta;
        let case = Case {
            model,
            parameter: Parameter::Mismatch,
            mode: 3,
            which: Which::Fast,
            range: (0.005, 0.1),
            up: false,
            until: None,
        };
        let run = case.follow(&[]);
        assert_eq!(run.end, Some(End::Edge), "β = {beta}");
        let found = run
            .events()
            .into_iter()
            .find(|found| found.kind() == Some(ST) && !found.orbit.signature.has(Regime::Stick));
        let found = found.expect("a stick zone opens");
        assert_eq!(
            regimes(found),
            (
                "slip-separation-slip-reverse".to_string(),
                "slip-separation-slip-reverse-stick".to_string()
            )
        );
        found.parameter
    };
    let limit = opens(0.0);
    let [first, .., last] = [1e-4, 1e-5, 1e-6].map(|beta| {
        let slope = (opens(beta) - limit) / beta;
        println!("observed: β = {beta:e}: (δ − δ₀)/β = {slope:.6}");
        slope
    });
    assert!((first / last - 1.0).abs() < 1e-2, "{first} for {last}");
}

/// What the law of friction and of contact asks of every wave of a branch: aV − σfbU has a continuous
/// second derivative at a landing that slides, the friction of the reaction is enough at one that
/// sticks, P > 0 and U > δ.
#[test]
fn landings_obey_their_law() {
    let (mut worst, mut sliding, mut arrested) = (0.0_f64, 0, 0);
    for beta in [3e-3, 1e-3, 1e-5] {
        let case = Case {
            range: (0.004, 0.2),
            ..with_material_damping(beta)
        };
        let run = case.follow(&[]);
        println!("{beta}: {:?} {:?}", kinds(&run), run.end);
        assert_eq!(run.end, Some(End::Edge));
        for found in &run.points {
            let (wave, point) = (&found.orbit, &found.node.point);
            if !wave.signature.has(Regime::Separation) || found.kind().is_some() {
                continue;
            }
            let model = wave.model_at(point);
            let c = model.constants().coefficients;
            let zone = separation(wave);
            let [pressure, before, dragged, after] = at_the_ends(wave, point);
            assert!(pressure > 0.0 && before > 0.0);
            let largest = model.friction * c.b / c.a * before;
            let next = wave.signature.zone(zone + 1);
            if next.entry == ZoneEntry::ArrestedLanding {
                assert!((dragged - after).abs() <= largest);
                arrested += 1;
            } else {
                let sigma = next.regime.sliding().expect("sliding");
                worst = worst.max((after - dragged + sigma * largest).abs() / largest);
                sliding += 1;
            }
            for sample in sample(wave, point, 60).expect("samples") {
                let separated = sample.regime == Regime::Separation.name();
                let bound = model.friction * sample.pressure * (1.0 + 1e-9) + 1e-12;
                assert!(separated || sample.pressure > 0.0 && sample.shear.abs() <= bound);
                assert!(sample.radial - model.mismatch > -1e-13);
            }
        }
    }
    observed(
        &format!("{sliding} sliding and {arrested} arrested landings"),
        worst,
    );
    assert!(sliding > 20 && arrested > 20 && worst < 1e-9, "{worst:e}");
}

fn kinds(run: &Run) -> Vec<EventType> {
    run.events()
        .into_iter()
        .filter_map(|found| found.kind())
        .collect()
}

fn event(run: &Run, kind: EventType) -> &Found {
    let mut events = run.events().into_iter();
    events
        .find(|found| found.kind() == Some(kind))
        .expect("the branch has this event")
}

/// Just beyond GR, where P ≈ −ε + κx² in contact, the zone lasts √(50/3)·√(ε/κ) as long as it is short
/// against the layer βb̃/m_b, and begins at −2/5 of that. ε and κ are those of the least pressure along
/// the waves in contact, that exist on both sides of GR.
#[test]
fn separation_opens_like_a_square_root() {
    let case = with_material_damping(5e-3);
    let run = case.follow(&[]);
    let grazing = event(&run, GR);
    let (wave, point, delta) = (&grazing.orbit, &grazing.node.point, grazing.parameter);
    let least = |mismatch: f64| {
        let guess = wave.pack(&wave.unpack(point), wave.excess_at(point), mismatch);
        let point = polish(wave, &guess).expect("the wave in contact");
        let examination = examine(wave, &point).expect("margins");
        let margin = examination
            .margins
            .into_iter()
            .find(|margin| margin.watch == WaveWatch::Pressure)
            .expect("a least pressure");
        (point, margin)
    };
    let pressure = |mismatch: f64| least(mismatch).1.jet.value * wave.scales.pressure;
    let slope = |step: f64| {
        (pressure(delta * (1.0 + step)) - pressure(delta * (1.0 - step))) / (2.0 * delta * step)
    };
    let slope = (4.0 * slope(1e-3) - slope(2e-3)) / 3.0;
    // P at times beside the least pressure
    let (_, margin) = least(delta);
    let flows = wave.flows(point).expect("a frame");
    let flow = flows.contact(Regime::Slip);
    let slide = wave.slide_at(point, margin.zone);
    let at = &flows.frame.at;
    let beside = |t: f64| {
        let state = flow.state(&slide, t).expect("a state");
        at.g * at.mismatch + at.kappa * flow.drive(&slide, t, state)
    };
    let bend = |step: f64| {
        let t = margin.time;
        0.5 * (beside(t + step) + beside(t - step) - 2.0 * beside(t)) / (step * step)
    };
    let curvature = (4.0 * bend(1e-3) - bend(2e-3)) / 3.0;
    let limit = (50.0_f64 / 3.0 * slope / curvature).sqrt();

    // the distance to GR falls by 4 from one wave to the next, the zone by 2
    let distances: Vec<f64> = (0..7).map(|j| 1e-6 * delta * 0.25_f64.powi(j)).collect();
    let stops: Vec<f64> = distances.iter().map(|distance| delta - distance).collect();
    let run = case.follow(&stops);
    let mut ratios = Vec::new();
    for stop in &stops {
        let found = run.user_points(*stop)[0];
        let zone = separation(&found.orbit);
        let duration = found.orbit.duration_at(&found.node.point, zone);
        ratios.push(duration / (delta - stop).sqrt() / limit - 1.0);
        // P⁻ = (5/3)ε at take-off
        let [pressure, ..] = at_the_ends(&found.orbit, &found.node.point);
        println!(
            "T = {duration:.3e}: {:.3e}, P⁻/ε = {:.6}",
            ratios[ratios.len() - 1],
            pressure / (slope * (delta - stop))
        );
    }
    for pair in ratios.windows(2) {
        let extrapolated = 2.0 * pair[1] - pair[0];
        observed(
            "square-root law with damping, extrapolated",
            extrapolated.abs(),
        );
    }
    let [.., before, last] = ratios[..] else {
        panic!("ratios")
    };
    // of first order in T over the layer, with a factor of order one
    assert!((before / last - 2.0).abs() < 0.1, "{ratios:?}");
    assert!((2.0 * last - before).abs() < 1e-4, "{ratios:?}");
}

/// However thin the layers are, separation opens where it does.
#[test]
fn separation_opens_at_any_damping() {
    let run = |beta: f64| {
        let case = Case {
            range: (0.04, 0.2),
            ..with_material_damping(beta)
        };
        let run = case.follow(&[]);
        assert_eq!(run.end, Some(End::Edge), "β = {beta}");
        assert_eq!(kinds(&run), [RV, GR], "β = {beta}");
        let last = run.points.last().expect("points");
        assert!(last.orbit.signature.has(Regime::Separation));
        event(&run, GR).parameter
    };
    let slope = |beta: f64| (run(beta) - run(1e-9)) / (beta - 1e-9);
    let (coarse, fine) = (slope(1e-6), slope(1e-8));
    println!("observed: δ of GR over β: {coarse} {fine}");
    // of second order in β, and the rounding of δ
    assert!((coarse / fine - 1.0).abs() < 1e-3, "{coarse} {fine}");
}

/// From above GR down and back up: the same waves, whatever the damping.
#[test]
fn there_and_back() {
    let mut worst = 0.0_f64;
    for beta in [5e-3, 1e-3, 1e-5, 1e-6, 1e-7] {
        let case = Case {
            range: (0.03, 0.2),
            ..with_material_damping(beta)
        };
        let run = case.follow(&[]);
        println!("{beta}: {:?} {:?}", kinds(&run), run.end);
        assert_eq!(run.end, Some(End::Edge));
        let last = run.points.last().expect("points");
        assert!(last.orbit.signature.has(Regime::Separation));
        let limits = Limits {
            range: case.range,
            stop_at: Vec::new(),
            steps: STEPS,
        };
        let wave = last.orbit.as_ref().clone();
        let follower = Follower::new(wave, &last.node.point, true, limits).expect("a start");
        let back = to_the_end(follower, None);
        println!("back: {:?} {:?}", kinds(&back), back.end);
        for kind in [GR, RV] {
            let (there, again) = (event(&run, kind).parameter, event(&back, kind).parameter);
            worst = worst.max((there / again - 1.0).abs());
        }
        let (first, again) = (&run.points[0], back.points.last().expect("points"));
        assert_eq!(first.orbit.signature, again.orbit.signature);
        worst = worst.max((&first.node.point - &again.node.point).amax());
    }
    observed("separation with material damping: there and back", worst);
    assert!(worst < 1e-10, "{worst:e}");
}

/// In β from the undamped limit to β of order one: the zone closes on the way.
#[test]
fn damping_closes_the_separation() {
    for mismatch in [0.045, 0.01] {
        let (wave, point) = undamped_limit(mismatch);
        let limits = Limits {
            range: (0.0, 1.0),
            stop_at: vec![1e-12, 1e-8, 1e-6, 1e-4, 1e-3, 5e-3],
            steps: STEPS,
        };
        let run = to_the_end(
            Follower::new(wave, &point, true, limits).expect("a regular start"),
            None,
        );
        for found in run.points.iter().filter(|found| found.kind().is_some()) {
            println!(
                "{mismatch}: {:?} {:e} {} c = {:.12}",
                found.kind(),
                found.parameter,
                found.orbit.signature,
                speed(found)
            );
        }
        println!("{:?}", run.end.as_ref().map(|_| run.points.len()));
        assert!(kinds(&run).contains(&GR), "{:?} {:?}", kinds(&run), run.end);
    }
}
