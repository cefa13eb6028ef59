//! Names beside a curve against what branches find at their places.

use brakewave::branch::EventType;
use brakewave::branch::run::WaveRunner;
use brakewave::curve::{Region, WholeCurve};
use brakewave::orbit::legs::Run as _;
use brakewave::problem::{Problem, parse};
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::stability::spectrum::{SpectrumRequest, spectrum};

use crate::curve::curve;

/// A problem for mode 4 (or 2) at ν = 0.3, ξ = 1.5.
fn problem(mode: u32, start: &str, model: &str, sections: &str) -> Problem {
    let text = format!(
        "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), {model}), \
         wave: (mode: {mode}, start: {start}), {sections})"
    );
    parse(&text, "regions").unwrap()
}

/// The waves of a branch at the one value it is asked to stop at.
fn passages(problem: &Problem) -> Vec<String> {
    let mut branch =
        WaveRunner::begin(problem, problem.continuation.as_ref().unwrap(), None).unwrap();
    let mut found = Vec::new();
    while branch.progress().end.is_none() {
        for item in branch.step() {
            if item.point.kind == Some(EventType::UZ) {
                found.push(item.point.regimes.clone());
            }
        }
    }
    found
}

/// Names to compare: from every stretch and side the first few, among which the picture chooses.
fn chosen(curve: &WholeCurve, most: usize) -> Vec<&Region> {
    let mut sides: Vec<((usize, bool), usize)> = Vec::new();
    let mut found = Vec::new();
    for region in &curve.regions {
        let side = (region.stretch, region.left);
        let index = match sides.iter().position(|(known, _)| *known == side) {
            Some(index) => index,
            None => {
                sides.push((side, 0));
                sides.len() - 1
            }
        };
        sides[index].1 += 1;
        if sides[index].1 <= most {
            found.push(region);
        }
    }
    found
}

/// The regimes of a name.
fn regimes(name: &str) -> Vec<&str> {
    name.split(", ").collect()
}

/// Every wave that a name speaks of is met by a branch in the mismatch at the friction of its place,
/// from the fast or from the slow wave; and a wave it does not speak of is not slip-stick on both.
fn in_the_plane_of_mismatch_and_friction(event: &str, least: usize) {
    let curve = curve(&problem(
        4,
        "Fast",
        "friction: 0.5, mismatch: 0.2",
        &format!(
            "continuation: (parameter: Mismatch, range: (0.03, 0.2), toward: Down), \
             curve: (event: {event}, parameters: (Mismatch, Friction), \
             range: ((0.002, 0.22), (0.1, 1.2)))"
        ),
    ));
    let chosen = chosen(&curve, 4);
    assert!(chosen.len() >= least, "{}", chosen.len());
    for region in chosen {
        let [mismatch, friction] = region.place;
        let mut met = Vec::new();
        for start in ["Fast", "Slow"] {
            // the closed form has waves below the fold only; above it they are met along f
            for (model, sections) in [
                (
                    format!("friction: {friction}, mismatch: 0.9"),
                    format!(
                        "continuation: (parameter: Mismatch, range: (0.002, 0.9), toward: Down, \
                         max_points: 3000, stop_at: [{mismatch}])"
                    ),
                ),
                (
                    format!("friction: 0.5, mismatch: {mismatch}"),
                    format!(
                        "continuation: (parameter: Friction, range: (0.05, 3.0), toward: Up, \
                         max_points: 800, stop_at: [{friction}])"
                    ),
                ),
            ] {
                let across = problem(4, start, &model, &sections);
                if WaveRunner::begin(&across, across.continuation.as_ref().unwrap(), None).is_ok() {
                    met.extend(passages(&across));
                }
            }
        }
        for name in regimes(&region.name.to_string()) {
            assert!(
                met.iter().any(|wave| wave == name),
                "{event}: {name} at {:?}, where there are {met:?}",
                region.place
            );
        }
    }
}

#[test]
fn waves_beside_take_off() {
    in_the_plane_of_mismatch_and_friction("GR", 12);
}

#[test]
fn waves_beside_the_opening_of_reverse_slip() {
    in_the_plane_of_mismatch_and_friction("RV", 12);
}

/// No slip-stick wave is named beyond the fold in f, where the closed form has none.
#[test]
fn no_closed_form_beyond_the_fold() {
    // q = S(ζ)/ζ is stationary there
    let fold = 1.091_518_420_359_11;
    for event in ["GR", "RV"] {
        let curve = curve(&problem(
            4,
            "Fast",
            "friction: 0.5, mismatch: 0.2",
            &format!(
                "continuation: (parameter: Mismatch, range: (0.03, 0.2), toward: Down), \
                 curve: (event: {event}, parameters: (Mismatch, Friction), \
                 range: ((0.002, 0.22), (0.1, 1.2)))"
            ),
        ));
        assert!(
            curve
                .regions
                .iter()
                .any(|region| region.name.to_string() == "slip-stick")
        );
        for region in &curve.regions {
            let beyond = region.place[1] > fold;
            assert!(
                !(beyond && regimes(&region.name.to_string()).contains(&"slip-stick")),
                "{region:?}"
            );
        }
    }
}

/// Beside ST there are slip-stick waves on the side of less damping only: α√(ak² + h) = kf|D|.
#[test]
fn stick_is_gone_beyond_the_hopf_point() {
    let curve = curve(&problem(
        4,
        "Fast",
        "friction: 0.5, mismatch: 0.2",
        "continuation: (parameter: MassDamping, range: (0.0, 0.4), toward: Up), \
         curve: (event: ST, parameters: (MassDamping, Friction), range: ((0.0, 0.6), (0.1, 1.0)))",
    ));
    let c = brakewave::tube::model::coefficients::Geometry {
        nu: 0.3,
        xi: 1.5,
        gamma: 1.0,
    }
    .coefficients();
    assert!(curve.regions.len() >= 10);
    for Region { place, name, .. } in &curve.regions {
        let [damping, friction] = *place;
        let slides = damping * (16.0 * c.a + c.h).sqrt() > 4.0 * friction * c.coupling.abs();
        assert!(
            !slides && name.to_string() == "slip-stick",
            "{place:?} {name}"
        );
    }
}

/// Three waves inside the wedge of a cusp, one outside.
#[test]
fn waves_are_counted_beside_a_cusp() {
    let curve = curve(&problem(
        2,
        "Fast",
        "friction: 0.5, mismatch: 2.0",
        "continuation: (parameter: Friction, range: (0.3, 3.0), toward: Up), curve: (event: LP, \
         parameters: (Friction, StiffnessDamping), range: ((1.8, 3.0), (0.0, 0.02)), ds_max: 0.5)",
    ));
    // what lies beyond the other side of the wedge is not named here
    for one in &curve.regions {
        let side = |other: &&Region| (other.stretch, other.left) == (one.stretch, one.left);
        assert!(
            curve
                .regions
                .iter()
                .filter(side)
                .all(|other| other.name == one.name)
        );
    }
    let mut seen = Vec::new();
    for region in chosen(&curve, 3) {
        let [friction, damping] = region.place;
        let across = problem(
            2,
            "Fast",
            &format!("friction: 1.5, mismatch: 2.0, damping: (stiffness: {damping})"),
            &format!(
                "continuation: (parameter: Friction, range: (1.5, 4.0), toward: Up, \
                 stop_at: [{friction}])"
            ),
        );
        let count = passages(&across).len();
        let word = if count == 1 { "wave" } else { "waves" };
        assert_eq!(
            region.name.to_string(),
            format!("{count} {word} slip-stick"),
            "{:?}",
            region.place
        );
        seen.push(count);
    }
    assert!(seen.contains(&1) && seen.contains(&3), "{seen:?}");
}

/// The sign of Re λ in the spectrum at the place, of the only pair near ω.
#[test]
fn pairs_grow_and_decay_where_it_is_written() {
    let (mut grow, mut decay) = (0, 0);
    for (sector, index) in [(0, 3), (0, 1), (1, 1), (2, 1)] {
        let curve = curve(&problem(
            4,
            "Fast",
            "friction: 0.5, mismatch: 0.2",
            &format!(
                "continuation: (parameter: Mismatch, range: (0.06, 0.2), toward: Down), \
                 curve: (event: HB, sector: {sector}, index: {index}, \
                 parameters: (Mismatch, Friction), range: ((0.01, 0.3), (0.1, 1.2)))"
            ),
        ));
        for region in chosen(&curve, 4) {
            let [mismatch, friction] = region.place;
            // the pair's frequency on the curve, at the nearest point
            let near = curve.points.iter().min_by(|one, other| {
                let way = |point: &brakewave::curve::CurvePoint| {
                    ((point.parameters[0] - mismatch) / 0.29)
                        .hypot((point.parameters[1] - friction) / 1.1)
                };
                way(one).total_cmp(&way(other))
            });
            let omega = near.unwrap().angular.unwrap();
            let there = problem(
                4,
                "Fast",
                &format!("friction: {friction}, mismatch: {mismatch}"),
                &format!(
                    "continuation: (parameter: Mismatch, range: ({}, {}), toward: Up)",
                    0.999 * mismatch,
                    1.001 * mismatch
                ),
            );
            let mut branch =
                WaveRunner::begin(&there, there.continuation.as_ref().unwrap(), None).unwrap();
            let item = branch.step().remove(0);
            let (wave, point) = item.wave();
            let request = SpectrumRequest {
                sectors: vec![sector],
                eigenvalues: 40,
                max_frequency: 14.0,
            };
            let characteristic = Characteristic::new(wave, point).unwrap();
            let found = spectrum(&characteristic, &request, None);
            let close: Vec<_> = found.sectors[0]
                .eigenvalues
                .iter()
                .filter(|value| (value.im - omega).abs() < 0.45 && value.re.abs() < 0.15)
                .collect();
            let [only] = close[..] else {
                continue;
            };
            let name = if only.re > 0.0 {
                "the pair grows"
            } else {
                "the pair decays"
            };
            assert_eq!(
                region.name.to_string(),
                name,
                "{:?}: {only:?}",
                region.place
            );
            if only.re > 0.0 { grow += 1 } else { decay += 1 }
        }
    }
    assert!(grow >= 8 && decay >= 8, "{grow} {decay}");
}
