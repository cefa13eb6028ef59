//! The fundamental matrix over T as a band.

use super::chain::{ChainNodes, Stages, rows};
use super::ring::{RingEquations, RingPerturbations, dot, radau};

/// Perturbations of some points, followed at those and further points: rows for V and V̇ of each
/// point, and in them a column for V and for V̇ of each perturbed point.
pub(super) struct Fan {
    nodes: ChainNodes,
    columns: usize,
    displacement: Vec<f64>,
    rate: Vec<f64>,
    work: Vec<f64>,
}

impl Fan {
    /// Unit perturbations of `group` points that begin `inset` points after the first.
    pub(super) fn new(first: isize, count: usize, inset: usize, group: usize, cyclic: bool) -> Fan {
        let columns = 2 * group;
        let mut fan = Fan {
            nodes: ChainNodes {
                first,
                count,
                cyclic,
            },
            columns,
            displacement: vec![0.0; count * columns],
            rate: vec![0.0; count * columns],
            work: vec![0.0; 3 * count * columns],
        };
        for index in 0..group {
            let row = (inset + index) * columns;
            fan.displacement[row + 2 * index] = 1.0;
            fan.rate[row + 2 * index + 1] = 1.0;
        }
        fan
    }

    pub(super) fn row(&self, index: usize, component: usize) -> &[f64] {
        let rows = if component == 0 {
            &self.displacement
        } else {
            &self.rate
        };
        &rows[index * self.columns..(index + 1) * self.columns]
    }

    /// Takes the perturbations through a time step. False where it is singular.
    pub(super) fn advance(&mut self, ring: &RingEquations, linear: &RingPerturbations) -> bool {
        let Some(factors) = ring.factors(linear, self.nodes) else {
            return false;
        };
        let ChainNodes { count, cyclic, .. } = self.nodes;
        let (columns, step) = (self.columns, linear.step);
        let radau = radau();
        for index in 0..count {
            let slopes = &linear.slopes[self.nodes.point(index, linear.slopes.len())];
            let row = index * columns;
            let work = &mut self.work[3 * row..3 * (row + columns)];
            for (stage, work) in work.chunks_exact_mut(columns).enumerate() {
                // hΣA_sr(∂F/∂V̂)_r, V before the step being the same for all stages
                let own = step * ring.own() * dot(&radau, stage, &[1.0; 3]);
                work.copy_from_slice(&self.rate[row..row + columns]);
                add(own, &self.displacement[row..row + columns], work);
                let mut from = |slope: &Stages, neighbour: usize| {
                    let start = neighbour * columns;
                    add(
                        step * dot(&radau, stage, slope),
                        &self.displacement[start..start + columns],
                        work,
                    );
                };
                if cyclic || index + 1 < count {
                    from(&slopes.ahead, (index + 1) % count);
                }
                if cyclic || index > 0 {
                    from(&slopes.behind, (index + count - 1) % count);
                }
            }
        }
        factors.solve(&mut self.work, columns);
        for index in 0..count {
            let row = index * columns;
            let work = rows(&self.work[3 * row..], columns);
            for (stage, work) in work.iter().enumerate() {
                add(
                    step * radau[(2, stage)],
                    work,
                    &mut self.displacement[row..row + columns],
                );
            }
            self.rate[row..row + columns].copy_from_slice(work[2]);
        }
        true
    }
}

/// to += factor·from.
fn add(factor: f64, from: &[f64], to: &mut [f64]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += factor * from;
    }
}

/// The fundamental matrix over T as a band: for each point p of the cell the response of the points
/// p − reach to p + reach of an endless chain to perturbations of V_p and V̇_p.
#[derive(Clone, Debug)]
pub(super) struct Band {
    pub(super) points: usize,
    pub(super) reach: usize,
    /// [point p][offset][component of response][component of perturbation].
    pub(super) values: Vec<[[f64; 2]; 2]>,
}

impl Band {
    pub(super) fn new(
        ring: &RingEquations,
        steps: &[RingPerturbations],
        points: usize,
        reach: usize,
    ) -> Option<Band> {
        // points that respond
        let width = 2 * reach + 1;
        let mut values = Vec::with_capacity(points * width);
        let mut begin = 0;
        while begin < points {
            // points followed together: with as many as the window has extra, half of the work is of
            // use, and a window stays in the cache
            let group = (2 * reach).min(points - begin);
            let first = begin as isize - reach as isize;
            let mut fan = Fan::new(first, group + 2 * reach, reach, group, false);
            for step in steps {
                if !fan.advance(ring, step) {
                    return None;
                }
            }
            for index in 0..group {
                for offset in 0..width {
                    values.push([0, 1].map(|component| {
                        let row = fan.row(index + offset, component);
                        [row[2 * index], row[2 * index + 1]]
                    }));
                }
            }
            begin += group;
        }
        Some(Band {
            points,
            reach,
            values,
        })
    }

    /// Visits the entries of S^{-1}Y, S⁻¹ shifting rows by `shift` points: row and column within the
    /// cell, by how many cells the row lies ahead of the column, value.
    pub(super) fn shifted(&self, shift: isize, mut visit: impl FnMut(usize, usize, isize, f64)) {
        let points = self.points as isize;
        for (index, response) in self.values.iter().enumerate() {
            let width = 2 * self.reach + 1;
            let (point, offset) = (
                index / width,
                (index % width) as isize - self.reach as isize,
            );
            let row = point as isize + offset + shift;
            let cell = row.div_euclid(points);
            let row = row.rem_euclid(points) as usize;
            for (component, entries) in response.iter().enumerate() {
                for (other, value) in entries.iter().enumerate() {
                    visit(2 * row + component, 2 * point + other, cell, *value);
                }
            }
        }
    }
}
