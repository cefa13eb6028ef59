//! What stands in the cells.

use brakewave::branch::{BranchPoint, Stability};
use brakewave::map::{Cell, CellPoint, Plane, row};
use brakewave::model::{Model, Parameter};
use brakewave::problem::{self, Map, Problem};
use brakewave::wave::start::{Which, least_mismatch, slip_stick};

use crate::problem;

fn parse(sections: &str) -> (Problem, Map) {
    let text = problem(sections);
    let problem = problem::parse(&text, "p.ron").unwrap();
    let map = problem.map.clone().unwrap();
    (problem, map)
}

fn cells(problem: &Problem, map: &Map) -> Vec<Cell> {
    (0..Plane::new(map).rows())
        .flat_map(|index| row(problem, map, index).unwrap())
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
    let cells = row(&problem, &map, 1).unwrap();
    assert!(cells.len() >= 50);
    for (column, speed, regimes) in [
        (49, -1.242700800630082, "slip-stick"),
        (19, -1.242963703241321, "slip-reverse-stick"),
        (4, -1.253060437162417, "slip-separation-reverse-stick"),
        (0, -1.26182855710314, "slip-separation-reverse-stick"),
    ] {
        let found = cells
            .iter()
            .find(|cell| cell.column == column)
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
        assert!(why.contains("fold"), "{why}");
    }
}

/// Every wave stands once in a cell, round folds and where branches without stick close.
#[test]
fn no_wave_stands_twice_in_a_cell() {
    let (problem, map) = parse(
        "map: (first: (parameter: Friction, range: (0.2, 0.25)), \
         second: (parameter: Mismatch, range: (0.01, 0.2)), \
         points: Grid(rows: 2, columns: 40), starts: [Fast])",
    );
    let cells = cells(&problem, &map);
    let mut waves = Vec::new();
    for cell in &cells {
        if let CellPoint::Wave(point) = &cell.found {
            waves.push((cell.row, cell.column, point.speed, point.amplitude));
        }
    }
    assert!(waves.len() > 60);
    for (index, one) in waves.iter().enumerate() {
        let twice = waves[..index].iter().any(|other| {
            (one.0, one.1) == (other.0, other.1)
                && (one.2 / other.2 - 1.0).abs() < 1e-9
                && (one.3 / other.3 - 1.0).abs() < 1e-9
        });
        assert!(!twice, "{one:?}");
    }
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
