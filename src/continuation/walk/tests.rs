//! Curves in the plane, their closing and their ends.

use super::*;
use crate::continuation::circle::UnitCircle;
use crate::continuation::locate::{Target, zero_along};
use crate::linalg::Vector;

/// The circle beyond x = 1/2 is not there.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("x = {0} is too small")]
struct TooSmall(f64);

/// The circle on which y = x is watched, up to an edge, and x ≥ `least` is asked for.
struct Watched {
    edge: f64,
    least: f64,
}

#[derive(Clone, Copy)]
enum Event {
    Diagonal,
    Edge,
}

impl WatchedCurve for Watched {
    type System = UnitCircle;
    type Name = ();
    type Watched = f64;
    type Event = Event;
    type Found = (bool, Vector);
    type Refusal = TooSmall;
    type End = ();
    type Close = ();
    const CREEP: (usize, f64) = (20, 1e-3);

    fn system(&self) -> &UnitCircle {
        &UnitCircle
    }

    fn name(&self) -> &() {
        &()
    }

    fn watch(&self, node: &Node, _: Option<&f64>) -> Result<f64, TooSmall> {
        let (x, y) = (node.point[0], node.point[1]);
        if x < self.least {
            Err(TooSmall(x))
        } else {
            Ok(y - x)
        }
    }

    fn within(&self, _: &Segment<f64>, _: &[(Place, Event)]) -> Within<()> {
        Within::Nothing
    }

    fn doubted(&self, found: (bool, Vector), (): ()) -> (bool, Vector) {
        found
    }

    fn locate(&self, step: &Segment<f64>) -> Result<Vec<(Place, Event)>, TooSmall> {
        let target = Target {
            index: 1,
            value: self.edge,
            outside: 1.0,
        };
        let way = [&step.from.point, &step.to.point];
        let met = target
            .meetings(&UnitCircle, step.from, &way, 1e-10)
            .unwrap();
        let mut located: Vec<_> = met.into_iter().map(|place| (place, Event::Edge)).collect();
        if step.before * step.after < 0.0 {
            let ends = ((0.0, *step.before), (step.ds, *step.after));
            let value = |node: &Node| Some(node.point[1] - node.point[0]);
            let zero = zero_along(&UnitCircle, step.from, ends, (1e-15, 1e-16), 1e-10, value);
            located.push((zero.unwrap().0, Event::Diagonal));
        }
        Ok(located)
    }

    fn meet(
        &self,
        step: &Segment<f64>,
        place: &Place,
        together: &[Event],
    ) -> Result<Outcome<Watched>, TooSmall> {
        let (_, point) = self.point(place.s, &place.node, step.after);
        Ok(match together[0] {
            Event::Diagonal => Outcome::Passed((true, point)),
            Event::Edge => Outcome::Ended(vec![(true, point)], End::Edge),
        })
    }

    fn arrive(&mut self, _: &mut Node, _: &f64, _: &[(Place, Event)]) {}

    fn point(&self, _: f64, node: &Node, _: &f64) -> (bool, Vector) {
        (false, node.point.clone())
    }

    fn closing(&self, _: f64, first: &Node, _: (bool, Vector)) -> (bool, Vector) {
        (true, first.point.clone())
    }
}

impl Curve for Watched {}

/// Follows the circle from (1, 0) upwards: the special points and the end.
fn walked(edge: f64, least: f64) -> (Vec<Vector>, EndOf<Watched>) {
    let node = Node {
        point: Vector::from_vec(vec![1.0, 0.0]),
        tangent: Vector::from_vec(vec![0.0, 1.0]),
        newton: 0,
        residual: 0.0,
    };
    let steps = Steps {
        ds: 0.05,
        ds_min: 1e-9,
        ds_max: 0.1,
        tolerance: 1e-10,
    };
    let mut walker = Walker::begin(Watched { edge, least }, node, steps).unwrap();
    let mut special = Vec::new();
    for _ in 0..10_000 {
        let (found, end) = walker.step();
        for (is_special, point) in found {
            assert!((point.norm() - 1.0).abs() < 4.0 * f64::EPSILON);
            special.extend(is_special.then_some(point));
        }
        if let Some(end) = end {
            return (special, end);
        }
    }
    panic!("the walk does not end");
}

#[test]
fn a_closed_curve_ends_on_its_first_point() {
    let (special, end) = walked(2.0, -2.0);
    assert_eq!(end, End::Closed);
    let half = 0.5_f64.sqrt();
    let expected = [[half, half], [-half, -half], [1.0, 0.0]];
    assert_eq!(special.len(), expected.len());
    for (point, [x, y]) in special.iter().zip(expected) {
        assert!((point[0] - x).abs() < 1e-14 && (point[1] - y).abs() < 1e-14);
    }
}

#[test]
fn an_edge_is_met_exactly_and_ends_the_curve() {
    let (special, end) = walked(0.9, -2.0);
    assert_eq!(end, End::Edge);
    assert_eq!(special.len(), 2);
    assert_eq!(special[1][1], 0.9);
}

/// A step is halved down to the shortest one before the curve is given up. Steps that short creep.
#[test]
fn a_curve_without_a_step_says_why() {
    let (special, end) = walked(2.0, 0.5);
    assert_eq!(special.len(), 1);
    match end {
        End::NoStep {
            reason: Refused::Curve(TooSmall(x)),
            ..
        } => assert!((x - 0.5).abs() < 1e-8, "{x}"),
        End::Creeps { steps, .. } => assert_eq!(steps, 20),
        other => panic!("{other:?}"),
    }
}
