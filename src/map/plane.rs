//! Where in the plane: the points of a map and how they fall into rows.

use crate::problem::{Map, MapPoints, PlaneAxis};

/// Quasi-random points that make a row: enough to be worth a file, few enough to share out.
const POINTS_PER_ROW: usize = 64;

/// The plastic number, the real root of x³ = x + 1.
const PLASTIC: f64 = 1.324_717_957_244_746;

/// The points of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapPlane {
    ranges: [(f64, f64); 2],
    points: MapPoints,
}

impl MapPlane {
    /// The plane of a `map` section.
    pub fn new<X: PlaneAxis, S>(map: &Map<X, S>) -> MapPlane {
        MapPlane {
            ranges: [map.first.range(), map.second.range()],
            points: map.points,
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        match self.points {
            MapPoints::Grid { rows, .. } => rows,
            MapPoints::QuasiRandom { count } => count.div_ceil(POINTS_PER_ROW),
        }
    }

    /// Points of a row, as values of the two parameters. Along the row of a grid the first one is
    /// constant and the second one increases.
    pub fn row(&self, row: usize) -> Vec<[f64; 2]> {
        let [of_first, of_second] = self.ranges;
        match self.points {
            MapPoints::Grid { rows, columns } => {
                let first = equidistant(of_first, row, rows);
                (0..columns)
                    .map(|column| [first, equidistant(of_second, column, columns)])
                    .collect()
            }
            MapPoints::QuasiRandom { count } => {
                let from = row * POINTS_PER_ROW;
                (from..count.min(from + POINTS_PER_ROW))
                    .map(|index| {
                        let [one, other] = quasi_random(index);
                        [part(of_first, one), part(of_second, other)]
                    })
                    .collect()
            }
        }
    }

    /// Two corners that lie opposite each other.
    pub(super) fn corners(&self) -> [[f64; 2]; 2] {
        let [first, second] = self.ranges;
        [[first.0, second.0], [first.1, second.1]]
    }

    /// The point at a place of a row.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn point(&self, row: usize, column: usize) -> Option<[f64; 2]> {
        match self.points {
            MapPoints::Grid { rows, columns } => {
                let [of_first, of_second] = self.ranges;
                (row < rows && column < columns).then(|| {
                    [
                        equidistant(of_first, row, rows),
                        equidistant(of_second, column, columns),
                    ]
                })
            }
            MapPoints::QuasiRandom { .. } if row < self.rows() => {
                self.row(row).get(column).copied()
            }
            MapPoints::QuasiRandom { .. } => None,
        }
    }

    /// The values of both parameters on a grid.
    pub(super) fn axes(&self) -> Option<[Vec<f64>; 2]> {
        let MapPoints::Grid { rows, columns } = self.points else {
            return None;
        };
        let values = |range, count| {
            let value = |index| equidistant(range, index, count);
            (0..count).map(value).collect()
        };
        let [of_first, of_second] = self.ranges;
        Some([values(of_first, rows), values(of_second, columns)])
    }
}

/// The value at an index of `count` equidistant ones; both ends exactly.
fn equidistant(range: (f64, f64), index: usize, count: usize) -> f64 {
    if index + 1 == count {
        return range.1;
    }
    part(range, index as f64 / (count - 1) as f64)
}

fn part((low, high): (f64, f64), part: f64) -> f64 {
    (low + (high - low) * part).clamp(low, high)
}

/// The additive recurrence ½ + n(1/ρ, 1/ρ²) mod 1 with the plastic number ρ, of low discrepancy at
/// any length (M. Roberts, 2018).
fn quasi_random(index: usize) -> [f64; 2] {
    let n = index as f64;
    [
        (0.5 + n / PLASTIC).fract(),
        (0.5 + n / (PLASTIC * PLASTIC)).fract(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{MapAxis, Start, WaveStarts};
    use crate::tube::model::Parameter;

    fn plane(points: MapPoints) -> MapPlane {
        let axis = |parameter, range| MapAxis { parameter, range };
        MapPlane::new(&Map {
            first: axis(Parameter::Friction, (0.1, 0.7)),
            second: axis(Parameter::Mismatch, (0.004, 0.2)),
            points,
            starts: WaveStarts(vec![Start::Fast]),
            shares: None,
        })
    }

    #[test]
    fn a_grid_has_its_ends_exactly_and_increases() {
        let plane = plane(MapPoints::Grid {
            rows: 7,
            columns: 11,
        });
        assert_eq!(plane.rows(), 7);
        assert_eq!(plane.row(0)[0], [0.1, 0.004]);
        assert_eq!(plane.row(6)[10], [0.7, 0.2]);
        for row in 0..7 {
            let points = plane.row(row);
            assert!(points.windows(2).all(|pair| pair[0][1] < pair[1][1]));
        }
    }

    /// Every point once, and the discrepancy of a low-discrepancy set: in each of 100 boxes within
    /// a few points of its share.
    #[test]
    fn quasi_random_points_fill_the_plane_evenly() {
        let count = 5000;
        let plane = plane(MapPoints::QuasiRandom { count });
        let points: Vec<[f64; 2]> = (0..plane.rows()).flat_map(|row| plane.row(row)).collect();
        assert_eq!(points.len(), count);
        let mut boxes = [0_i32; 100];
        for [first, second] in points {
            let one = ((first - 0.1) / 0.6 * 10.0) as usize;
            let other = ((second - 0.004) / 0.196 * 10.0) as usize;
            boxes[one.min(9) * 10 + other.min(9)] += 1;
        }
        assert!(boxes.iter().all(|held| (held - 50).abs() <= 6), "{boxes:?}");
    }
}
