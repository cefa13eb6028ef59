//! A curve that tests are made on, piecewise and in closed form: the boundary of the unit disc from which
//! half-planes are cut. An arc hands over to a chord and the chord to the next arc. A shallow cut is a pair
//! of events that lie close together.

use super::arclength::{Node, Steps};
use super::locate::{self, LeastWithin, Place};
use super::newton::Equations;
use super::walk::{
    self, Curve, CurveBeginning, End, EndOf, Outcome, Segment, Walker, WatchedCurve, Within,
};
use crate::linalg::{Matrix, Vector};

/// The half-plane n·u > 1 − depth is cut off, n being the unit vector at an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cut {
    angle: f64,
    depth: f64,
}

impl Cut {
    fn normal(&self) -> [f64; 2] {
        [self.angle.cos(), self.angle.sin()]
    }

    /// 1 − depth − n·u, and its slope along a direction. n·u = cos(φ − angle) on the circle is formed from
    /// the distance of both points, which keeps the digits of a shallow cut.
    fn room(&self, node: &Node) -> (f64, f64) {
        let [x, y] = self.normal();
        let apart = (node.point[0] - x).powi(2) + (node.point[1] - y).powi(2);
        let excess = 0.5 * (node.point.norm_squared() - 1.0);
        let slope = -(x * node.tangent[0] + y * node.tangent[1]);
        (0.5 * apart - excess - self.depth, slope)
    }

    /// Angle from the middle of the chord to its ends.
    fn half_width(&self) -> f64 {
        2.0 * (0.5 * self.depth).sqrt().asin()
    }
}

/// A piece of the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
enum BoundaryPiece {
    Arc,
    Chord(usize),
}

/// The boundary while it is one piece.
#[derive(Clone)]
struct DiscBoundary {
    piece: BoundaryPiece,
    cuts: Vec<Cut>,
}

impl Equations for DiscBoundary {
    type Failure = std::convert::Infallible;

    fn unknowns(&self) -> usize {
        2
    }

    fn evaluate(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), Self::Failure> {
        let [x, y] = match self.piece {
            BoundaryPiece::Arc => {
                residual[0] = 0.5 * (point.norm_squared() - 1.0);
                [point[0], point[1]]
            }
            BoundaryPiece::Chord(index) => {
                let normal = self.cuts[index].normal();
                let along = normal[0] * point[0] + normal[1] * point[1];
                residual[0] = along - (1.0 - self.cuts[index].depth);
                normal
            }
        };
        jacobian[(0, 0)] = x;
        jacobian[(0, 1)] = y;
        Ok(())
    }
}

/// A point of the boundary.
#[derive(Clone, Debug)]
struct BoundaryPoint {
    point: Vector,
    /// Pieces on both sides of an event.
    corner: Option<(BoundaryPiece, BoundaryPiece)>,
    /// Which piece may have been missed before it.
    close: Option<BoundaryPiece>,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("a corner is not found")]
struct NotFound;

impl DiscBoundary {
    /// The pieces that this one may hand over to.
    fn neighbours(&self) -> Vec<BoundaryPiece> {
        let chords = (0..self.cuts.len()).map(BoundaryPiece::Chord);
        let all = std::iter::once(BoundaryPiece::Arc).chain(chords);
        all.filter(|piece| *piece != self.piece).collect()
    }

    /// What is positive while the neighbour is not reached, with its slope along the curve.
    fn room(&self, neighbour: BoundaryPiece, node: &Node) -> (f64, f64) {
        match neighbour {
            BoundaryPiece::Chord(index) => self.cuts[index].room(node),
            BoundaryPiece::Arc => (
                0.5 * (1.0 - node.point.norm_squared()),
                -node.point.dot(&node.tangent),
            ),
        }
    }
}

/// Values below this are rounding.
const ROUNDING: f64 = 1e-15;

impl WatchedCurve for DiscBoundary {
    type System = DiscBoundary;
    type Name = BoundaryPiece;
    type Watched = Vec<(f64, f64)>;
    type Event = BoundaryPiece;
    type Found = BoundaryPoint;
    type Refusal = NotFound;
    type End = ();
    type Close = BoundaryPiece;
    const CREEP: (usize, f64) = (20, 1e-12);

    fn system(&self) -> &DiscBoundary {
        self
    }

    fn name(&self) -> &BoundaryPiece {
        &self.piece
    }

    fn watch(&self, node: &Node, _: Option<&Self::Watched>) -> Result<Self::Watched, NotFound> {
        let neighbours = self.neighbours().into_iter();
        Ok(neighbours.map(|other| self.room(other, node)).collect())
    }

    fn within(
        &self,
        step: &Segment<Self::Watched>,
        located: &[(Place, BoundaryPiece)],
    ) -> Within<BoundaryPiece> {
        let end = located.first().map_or(f64::INFINITY, |(place, _)| place.s);
        let mut within = Within::Nothing;
        for (index, neighbour) in self.neighbours().into_iter().enumerate() {
            let ends = [step.before[index], step.after[index]];
            if ends[0].0 <= 4.0 * ROUNDING || ends[1].0 <= 0.0 {
                continue;
            }
            let least = locate::least(self, step.from, step.ds, ends, 1e-12, |node| {
                Some(self.room(neighbour, node))
            });
            match least {
                LeastWithin::Found(place, value) if value < -100.0 * ROUNDING && place.s < end => {
                    return Within::Pair(place.s);
                }
                LeastWithin::Found(place, value) if value <= ROUNDING && place.s < end => {
                    within = Within::Close(place.s, neighbour);
                }
                _ => {}
            }
        }
        within
    }

    fn doubted(&self, found: BoundaryPoint, close: BoundaryPiece) -> BoundaryPoint {
        BoundaryPoint {
            close: Some(close),
            ..found
        }
    }

    fn locate(
        &self,
        step: &Segment<Self::Watched>,
    ) -> Result<Vec<(Place, BoundaryPiece)>, NotFound> {
        let neighbours = self.neighbours().into_iter().enumerate();
        let reached = neighbours.filter(|(index, _)| step.after[*index].0 <= 0.0);
        let zero = |(index, neighbour): (usize, BoundaryPiece)| {
            // where the step sets out from a corner the function is zero, and positive just after it
            let first = step.before[index].0.max(f64::MIN_POSITIVE);
            let ends = ((0.0, first), (step.ds, step.after[index].0));
            let small = (0.0, f64::EPSILON * step.ds);
            let value = |node: &Node| Some(self.room(neighbour, node).0);
            let zero = locate::zero_along(self, step.from, ends, small, 1e-12, value);
            zero.map(|(place, _)| (place, neighbour)).ok_or(NotFound)
        };
        reached.map(zero).collect()
    }

    fn meet(
        &self,
        step: &Segment<Self::Watched>,
        place: &Place,
        together: &[BoundaryPiece],
    ) -> Result<Outcome<DiscBoundary>, NotFound> {
        let curve = DiscBoundary {
            piece: together[0],
            cuts: self.cuts.clone(),
        };
        let point = place.node.point.clone();
        let at = Node::on(&curve, point.clone()).ok_or(NotFound)?;
        let entered = walk::enter(
            &curve,
            (&at, &walk::EITHER_WAY),
            step.ds,
            20,
            1e-12,
            |from, to| {
                let to = to.ok()?;
                let inside = |other| curve.room(other, &to).0 > 0.0;
                // round the corner, not back
                let forwards = from.tangent.dot(&place.node.tangent) > 0.0;
                (forwards && curve.neighbours().into_iter().all(inside)).then_some(())
            },
        );
        let (node, ds, ()) = entered.ok_or(NotFound)?;
        let found = BoundaryPoint {
            point,
            corner: Some((self.piece, curve.piece)),
            close: None,
        };
        let watched = curve.watch(&node, None)?;
        let beginning = CurveBeginning {
            curve,
            node,
            watched,
            ds,
        };
        Ok(Outcome::Entered(vec![found], beginning))
    }

    fn arrive(&mut self, _: &mut Node, _: &Self::Watched, _: &[(Place, Self::Event)]) {}

    fn point(&self, _: f64, node: &Node, _: &Self::Watched) -> BoundaryPoint {
        BoundaryPoint {
            point: node.point.clone(),
            corner: None,
            close: None,
        }
    }

    fn closing(&self, _: f64, _: &Node, reached: BoundaryPoint) -> BoundaryPoint {
        reached
    }
}

impl Curve for DiscBoundary {}

/// Follows the boundary from (1, 0), anticlockwise or clockwise, with steps up to a length: all points and
/// the end.
fn walked(cuts: &[Cut], sign: f64, ds_max: f64) -> (Vec<BoundaryPoint>, EndOf<DiscBoundary>) {
    let node = Node::at(
        Vector::from_vec(vec![1.0, 0.0]),
        Vector::from_vec(vec![0.0, sign]),
    );
    let steps = Steps {
        ds: 0.5 * ds_max,
        ds_min: 1e-12,
        ds_max,
        tolerance: 1e-12,
    };
    let curve = DiscBoundary {
        piece: BoundaryPiece::Arc,
        cuts: cuts.to_vec(),
    };
    let mut walker = Walker::begin(curve, node, steps).expect("a first point");
    let mut points = Vec::new();
    for _ in 0..10_000 {
        let (found, end) = walker.step();
        points.extend(found);
        if let Some(end) = end {
            return (points, end);
        }
    }
    panic!("the walk does not end");
}

/// The corners of cuts that do not overlap, in order: angle, and the pieces before and after.
fn corners(cuts: &[Cut]) -> Vec<(f64, (BoundaryPiece, BoundaryPiece))> {
    let mut corners: Vec<_> = cuts
        .iter()
        .enumerate()
        .flat_map(|(index, cut)| {
            let (half, chord) = (cut.half_width(), BoundaryPiece::Chord(index));
            [
                (cut.angle - half, (BoundaryPiece::Arc, chord)),
                (cut.angle + half, (chord, BoundaryPiece::Arc)),
            ]
        })
        .collect();
    corners.sort_by(|one, other| one.0.total_cmp(&other.0));
    corners
}

/// Both corners of every cut are found, there and back, whatever the depth and the steps, and the boundary
/// closes. Angles are known to rounding over the angle at which arc and chord meet.
#[test]
fn pairs_of_corners_are_found_there_and_back() {
    for depth in [1e-1, 1e-3, 1e-5, 1e-7, 1e-9, 1e-10, 1e-11, 1e-12] {
        for ds_max in [0.3, 0.1, 0.03] {
            let cuts = [0.7, 2.0, 3.5, 5.1].map(|angle| Cut { angle, depth });
            let expected = corners(&cuts);
            for sign in [1.0, -1.0] {
                let (points, end) = walked(&cuts, sign, ds_max);
                assert_eq!(end, End::Closed, "depth {depth:e}, steps {ds_max}");
                let mut found: Vec<_> = points
                    .iter()
                    .filter_map(|found| Some((found.corner?, &found.point)))
                    .collect();
                if sign < 0.0 {
                    found.reverse();
                }
                assert_eq!(
                    found.len(),
                    expected.len(),
                    "depth {depth:e}, steps {ds_max}"
                );
                for ((pieces, point), (angle, between)) in found.iter().zip(&expected) {
                    let (before, after) = *between;
                    let between = if sign > 0.0 {
                        (before, after)
                    } else {
                        (after, before)
                    };
                    assert_eq!(*pieces, between);
                    let there = point[1].atan2(point[0]).rem_euclid(std::f64::consts::TAU);
                    let error = (there - angle).abs();
                    let rounding = 16.0 * f64::EPSILON / cuts[0].half_width();
                    assert!(
                        error < rounding,
                        "{error:e} at depth {depth:e}, steps {ds_max}"
                    );
                }
                assert!(points.iter().all(|found| found.close.is_none()));
            }
        }
    }
}

/// A line that touches the circle: no corner, and one point says that there may be some. A line that passes
/// it by is none.
#[test]
fn a_touch_is_said_to_be_undecided() {
    for (depth, doubts) in [(0.0, 1), (1e-17, 1), (-1e-12, 0), (-1e-3, 0)] {
        for sign in [1.0, -1.0] {
            let cut = Cut { angle: 2.0, depth };
            let (points, end) = walked(&[cut], sign, 0.1);
            assert_eq!(end, End::Closed);
            assert!(points.iter().all(|found| found.corner.is_none()));
            let close: Vec<_> = points.iter().filter_map(|found| found.close).collect();
            assert_eq!(
                close,
                vec![BoundaryPiece::Chord(0); doubts],
                "depth {depth:e}"
            );
        }
    }
}
