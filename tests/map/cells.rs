//! What stands in the cells.

use brakewave::branch::{BranchPoint, Stability};
use brakewave::map::{Cell, CellPoint, MapPlane, Missing, Rows};
use brakewave::problem::{self, Map, Problem};
use brakewave::tube::model::{Model, Parameter};
use brakewave::tube::wave::start::{Which, least_mismatch, slip_stick};

use crate::map::problem;

fn parse(sections: &str) -> (Problem, Map) {
    let text = problem(sections);
    let problem = problem::parse(&text, "p.ron").unwrap();
    let map = problem.map.clone().unwrap();
    (problem, map)
}

fn cells(problem: &Problem, map: &Map) -> Vec<Cell> {
    let rows = Rows::new(problem, map, &mut |_| {}).unwrap();
    (0..MapPlane::new(map).rows())
        .flat_map(|index| rows.row(index).unwrap())
        .collect()
}

/// The wave of the first passage.
fn wave(cell: &Cell) -> Option<&BranchPoint> {
    match &cell.found {
        CellPoint::Wave(point) if cell.passage == 1 => Some(point),
        _ => None,
    }
}

fn at(problem: &Problem, point: &BranchPoint) -> Model {
    problem
        .model
        .with(Parameter::Friction, point.model.friction)
        .with(Parameter::Mismatch, point.model.mismatch)
}

/// Speeds along f = 0.5 of an independent program, all digits it gives.
#[test]
fn a_row_meets_the_reference_figures() {
    let (problem, map) = parse(
        "map: (first: (parameter: Friction, range: (0.25, 0.5)), \
         second: (parameter: Mismatch, range: (0.004, 0.2)), \
         points: Grid(rows: 2, columns: 50), starts: [Fast])",
    );
    let cells = cells(&problem, &map);
    for (column, speed, regimes) in [
        (49, -1.242700800630082, "slip-stick"),
        (19, -1.242963703241321, "slip-reverse-stick"),
        (4, -1.253060437162417, "slip-separation-reverse-stick"),
        (0, -1.26182855710314, "slip-separation-reverse-stick"),
    ] {
        let found = cells
            .iter()
            .find(|cell| (cell.row, cell.column) == (1, column))
            .and_then(wave)
            .unwrap();
        assert!(
            (found.speed / speed - 1.0).abs() < 1e-11,
            "{} {speed}",
            found.speed
        );
        assert_eq!(found.regimes, regimes);
    }
}

/// A wave is slip-stick exactly where the closed form is admissible, and has its speed there.
#[track_caller]
fn meets_the_closed_form(problem: &Problem, cells: &[Cell]) -> usize {
    let mut waves = 0;
    for point in cells.iter().filter_map(wave) {
        let model = at(problem, point);
        let closed = slip_stick(&model, problem.wave.mode, Which::Fast).unwrap();
        let admissible = model.mismatch > least_mismatch(&model, &closed);
        assert_eq!(point.regimes == "slip-stick", admissible, "{point:?}");
        if admissible {
            assert!((point.speed / closed.speed - 1.0).abs() < 1e-11);
        }
        waves += 1;
    }
    waves
}

#[test]
fn slip_stick_is_where_the_closed_form_is() {
    let (problem, map) = parse(
        "map: (first: (parameter: Friction, range: (0.3, 0.9)), \
         second: (parameter: Mismatch, range: (0.05, 0.2)), \
         points: Grid(rows: 7, columns: 25), starts: [Fast])",
    );
    assert_eq!(
        meets_the_closed_form(&problem, &cells(&problem, &map)),
        7 * 25
    );
}

/// Along a row in friction the branch is followed both ways from the value of the model.
#[test]
fn rows_in_friction_go_both_ways() {
    let (problem, map) = parse(
        "map: (first: (parameter: Mismatch, range: (0.15, 0.2)), \
         second: (parameter: Friction, range: (0.25, 0.9)), \
         points: Grid(rows: 3, columns: 14), starts: [Fast])",
    );
    assert_eq!(
        meets_the_closed_form(&problem, &cells(&problem, &map)),
        3 * 14
    );
}

#[test]
fn quasi_random_points_are_reached_one_by_one() {
    let (problem, map) = parse(
        "map: (first: (parameter: Friction, range: (0.3, 0.9)), \
         second: (parameter: Mismatch, range: (0.05, 0.2)), \
         points: QuasiRandom(count: 70), starts: [Fast])",
    );
    let cells = cells(&problem, &map);
    assert_eq!(cells.len(), 70);
    assert_eq!(cells[69].row, 1);
    assert_eq!(meets_the_closed_form(&problem, &cells), 70);
}

/// Beyond the fold in friction there is nothing, and every cell says so.
#[test]
fn cells_without_a_wave_say_why() {
    let (problem, map) = parse(
        "map: (first: (parameter: Friction, range: (1.2, 1.4)), \
         second: (parameter: Mismatch, range: (0.1, 0.2)), points: Grid(rows: 2, columns: 3))",
    );
    let cells = cells(&problem, &map);
    assert_eq!(cells.len(), 2 * 3 * 2);
    for cell in cells {
        let CellPoint::Nothing { why, model } = &cell.found else {
            panic!("{cell:?}");
        };
        assert!(cell.passage == 0 && model.friction >= 1.2);
        // the closed form has none, and every branch was followed to its end
        assert!(matches!(why, Missing::NoBranch(_)) && why.is_known());
        assert!(why.to_string().contains("fold"), "{why}");
    }
}

/// A branch that is cut short says nothing about the points beyond: they are not known to have no wave.
#[test]
fn cells_beyond_a_failure_are_told_apart() {
    let (problem, map) = parse(
        "continuation: (parameter: Mismatch, range: (0.05, 0.2), max_points: 2), \
         map: (first: (parameter: Friction, range: (0.45, 0.5)), \
         second: (parameter: Mismatch, range: (0.05, 0.2)), \
         points: Grid(rows: 2, columns: 60), starts: [Fast])",
    );
    let cells = cells(&problem, &map);
    assert!(cells.iter().filter_map(wave).count() >= 16);
    let cut = cells.iter().filter(|cell| match &cell.found {
        CellPoint::Nothing { why, .. } => !why.is_known() && matches!(why, Missing::Cut(_)),
        CellPoint::Wave(_) => false,
    });
    assert!(cut.count() >= 60);
}

/// Beyond the fold where the fast and the slow slip-stick wave meet, a row has none to begin with; its waves
/// are reached along the friction. The speed is that of a branch in f at δ = 0.05.
#[test]
fn a_row_without_slip_stick_waves_is_reached_from_its_neighbours() {
    let (problem, map) = parse(
        "map: (first: (parameter: Friction, range: (0.495, 1.095)), \
         second: (parameter: Mismatch, range: (0.05, 0.2)), \
         points: Grid(rows: 3, columns: 4), starts: [Fast])",
    );
    let cells = cells(&problem, &map);
    let found = cells.iter().find(|cell| (cell.row, cell.column) == (2, 0));
    let found = found.and_then(wave).unwrap();
    assert_eq!(found.regimes, "slip-separation-reverse-stick");
    assert!(
        (found.speed + 1.1941584714165).abs() < 1e-12,
        "{}",
        found.speed
    );
}

/// The waves at a point of the plane do not depend on which parameter is the first one, nor do their names and
/// the starts that they are listed under.
#[test]
fn both_orders_of_the_parameters_find_the_same_waves() {
    let waves = |map: &str| {
        let text = format!(
            "(model: (coefficients: Geometry(nu: 0.24, xi: 1.37, gamma: 0.9), friction: 0.5, \
             mismatch: 0.1), wave: (mode: 3, start: Fast), map: ({map}))"
        );
        let problem = problem::parse(&text, "p.ron").unwrap();
        let map = problem.map.clone().unwrap();
        let cells = cells(&problem, &map);
        let points = cells.iter().filter_map(|cell| match &cell.found {
            CellPoint::Wave(point) => Some((cell.start, point)),
            CellPoint::Nothing { .. } => None,
        });
        let numbers = |point: &BranchPoint| {
            let model = &point.model;
            [model.mismatch, model.friction, point.speed].map(|value| format!("{value:.9}"))
        };
        let mut waves: Vec<_> = points
            .map(|(start, point)| (numbers(point), point.regimes.clone(), start))
            .collect();
        waves.sort();
        waves
    };
    let [mismatch, friction] = [
        "(parameter: Mismatch, range: (0.012, 0.13))",
        "(parameter: Friction, range: (0.3, 1.9))",
    ];
    let one = waves(&format!(
        "first: {mismatch}, second: {friction}, points: Grid(rows: 4, columns: 5)"
    ));
    let other = waves(&format!(
        "first: {friction}, second: {mismatch}, points: Grid(rows: 5, columns: 4)"
    ));
    assert_eq!(one, other);
    assert!(one.len() >= 20);
    assert!(one.iter().any(|(_, regimes, _)| !regimes.contains("stick")));
}

/// Every wave stands once in a cell, round folds, where branches without stick close, and where the branches
/// of both starts meet.
#[test]
fn no_wave_stands_twice_in_a_cell() {
    let waves = |sections: &str| {
        let (problem, map) = parse(sections);
        let mut waves = Vec::new();
        for cell in cells(&problem, &map) {
            if let CellPoint::Wave(point) = &cell.found {
                waves.push((cell.row, cell.column, point.speed, point.amplitude));
            }
        }
        for (index, one) in waves.iter().enumerate() {
            let twice = waves[..index].iter().any(|other| {
                (one.0, one.1) == (other.0, other.1)
                    && (one.2 / other.2 - 1.0).abs() < 1e-9
                    && (one.3 / other.3 - 1.0).abs() < 1e-9
            });
            assert!(!twice, "{one:?}");
        }
        waves.len()
    };
    let without_stick = "map: (first: (parameter: Friction, range: (0.2, 0.25)), \
         second: (parameter: Mismatch, range: (0.01, 0.2)), \
         points: Grid(rows: 2, columns: 40), starts: [Fast])";
    assert!(waves(without_stick) > 60);
    let both_starts = "map: (first: (parameter: Friction, range: (1.07, 1.08)), \
         second: (parameter: Mismatch, range: (0.1, 0.2)), \
         points: Grid(rows: 2, columns: 6))";
    assert!(waves(both_starts) >= 12 + 4);
}

/// Mode 4 at f = 0.5: at δ = 0.2 the leading eigenvalue lies in sector 1, figures of an independent
/// program; at α = 0.317 the wave is stable on the whole circle.
#[test]
fn stability_of_the_cells() {
    let (mut problem, map) = parse(
        "stability: (max_frequency: 12.0), \
         map: (first: (parameter: MassDamping, range: (0.0, 0.317)), \
         second: (parameter: Mismatch, range: (0.198, 0.2)), \
         points: Grid(rows: 2, columns: 2), starts: [Fast])",
    );
    let found = |problem: &Problem| -> Vec<BranchPoint> {
        let cells = cells(problem, &map);
        assert_eq!(cells.len(), 4);
        cells.iter().filter_map(wave).cloned().collect()
    };
    let points = found(&problem);
    let lead = points[1].lead.unwrap();
    assert_eq!(lead.sector, 1);
    assert!((lead.re - 0.1279698868278).abs() < 1e-11);
    assert!((lead.im - 1.319591652955).abs() < 1e-11);
    let stable: Vec<_> = points.iter().map(|point| point.stable.unwrap()).collect();
    assert_eq!(
        stable,
        [Stability::No, Stability::No, Stability::Yes, Stability::Yes]
    );
    // not asked for, not there; and the waves themselves do not depend on it
    problem.stability = None;
    for (with, without) in points.iter().zip(found(&problem)) {
        assert_eq!(without.stable, None);
        assert_eq!(with.speed.to_bits(), without.speed.to_bits());
    }
}
