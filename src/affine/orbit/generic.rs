//! What is zero by the structure where modes are not linear: told by generic points.
//!
//! A function vanishes by the structure where some forms do if it vanishes at points that satisfy these and nothing
//! else: places near the orbit, moved at random by a tenth of what it moves by and then back onto the zeros of the forms.

use std::f64::consts::TAU;

use super::forms::{Forms, Units};
use crate::affine::mode::{AffineSystem, Exit, Row};
use crate::affine::recurrence::Series;
use crate::affine::series::ORDER;
use crate::linalg::{Matrix, Vector, even, pseudo_inverse};

/// Points that are tried.
const POINTS: usize = 3;
/// How far they are moved, in parts of what each state changes by along the orbit, and in turns.
const MOVED: f64 = 0.1;
/// Steps back onto the zeros at most.
const STEPS: usize = 30;
/// A form is zero at a point where it is no more than this part of its size: points are on their zeros to rounding.
const ZERO: f64 = 1e-9;
/// Highest order of a zero that is told from a function that is zero all along.
const HIGHEST: usize = 8;

/// Points of a mode at which some forms are zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    mode: usize,
    /// As vectors z.
    all: Vec<Vector>,
}

/// Derivatives of a form in the states, in their units, and in the phase, of a jet in z.
fn slopes(by_z: &Vector, z: &Vector, harmonics: usize, units: &Units) -> Vec<f64> {
    let n = units.states;
    let states = (0..n).map(|state| by_z[state] * units.z[state]);
    let turn = (1..=harmonics).map(|h| {
        let (cosine, sine) = (n + 2 * h - 1, n + 2 * h);
        h as f64 * (by_z[sine] * z[cosine] - by_z[cosine] * z[sine])
    });
    states.chain([turn.sum()]).collect()
}

impl Points {
    /// Points of a mode next to a state and a phase, moved by parts of these distances; none where rates have no value there.
    pub fn new(
        system: &AffineSystem,
        mode: usize,
        (state, phase): (&[f64], f64),
        forms: &Forms,
        (units, distances): (&Units, &[f64]),
    ) -> Points {
        let forms: Vec<Row> = forms.rows().collect();
        let moved = (0..POINTS).filter_map(|point| {
            let mut shares = even(point + 1).map(|share| MOVED * (2.0 * share - 1.0));
            let states = state.iter().zip(distances);
            let mut state: Vec<f64> = states
                .zip(&mut shares)
                .map(|((x, distance), share)| x + distance * share)
                .collect();
            let mut phase = phase + TAU * shares.next().unwrap_or_default();
            let field = &system.modes[mode].field;
            for _ in 0..STEPS {
                let z = system.lift(mode, &state, phase);
                let series = field.values_for(&forms, &z);
                let jets = forms.iter().map(|row| series.jet(row, 0));
                let (values, rows): (Vec<f64>, Vec<Vec<f64>>) = jets
                    .map(|(value, by_z, _)| (value, slopes(&by_z, &z, system.harmonics, units)))
                    .unzip();
                let mut pairs = values.iter().zip(&rows);
                let near = |(value, row): (&f64, &Vec<f64>)| {
                    let size: f64 = row.iter().map(|by| by.abs()).sum();
                    value.abs() <= 8.0 * f64::EPSILON * size
                };
                if pairs.all(near) {
                    return Some(z);
                }
                let matrix =
                    Matrix::from_fn(rows.len(), state.len() + 1, |row, column| rows[row][column]);
                if !matrix.iter().chain(&values).all(|x| x.is_finite()) {
                    return None;
                }
                let right = Vector::from_vec(values);
                let step = pseudo_inverse(&matrix, 1e-10)? * right;
                for (index, x) in state.iter_mut().enumerate() {
                    *x -= units.z[index] * step[index];
                }
                phase -= step[state.len()];
            }
            // no more than rounding may be left
            Some(system.lift(mode, &state, phase))
        });
        let finite = |z: &Vector| z.iter().all(|x| x.is_finite());
        Points {
            mode,
            all: moved.filter(finite).collect(),
        }
    }

    /// The points to which an exit leads these.
    pub fn through(&self, system: &AffineSystem, exit: &Exit) -> Points {
        let field = &system.modes[self.mode].field;
        let image = |z: &Vector| {
            let mut z = z.clone();
            field.complete_at_switch(&mut z);
            let state = &exit.reset.at * &z;
            z.rows_mut(0, system.states).copy_from(&state);
            system.modes[exit.to].field.complete(&mut z);
            z
        };
        Points {
            mode: exit.to,
            all: self.all.iter().map(image).collect(),
        }
    }

    /// Whether a form is zero at some z of the mode of these points.
    pub fn is_zero(&self, system: &AffineSystem, row: &Row, z: &Vector, units: &Units) -> bool {
        let mut z = z.clone();
        system.modes[self.mode].field.complete(&mut z);
        row.value(&z).abs() <= ZERO * units.sum(row)
    }

    /// Whether rates have a value at every point that was tried.
    pub fn are_whole(&self) -> bool {
        self.all.len() == POINTS
    }

    /// Gives what is made of states and phase the values that it has at another value of the parameter.
    pub fn complete(&mut self, system: &AffineSystem) {
        let field = &system.modes[self.mode].field;
        self.all.iter_mut().for_each(|z| field.complete(z));
    }

    /// Whether a form of this size, which may be one of a switch, is zero at all of them.
    pub fn contain(&self, system: &AffineSystem, row: &Row, size: f64) -> bool {
        let field = &system.modes[self.mode].field;
        let zero = |z: &Vector| {
            let mut z = z.clone();
            field.complete_at_switch(&mut z);
            row.value(&z).abs() <= ZERO * size
        };
        !self.all.is_empty() && self.all.iter().all(zero)
    }

    /// Of every guard of the mode the least order of a derivative along the flow that is not zero at all of them; `None`
    /// where all are.
    pub fn orders(&self, system: &AffineSystem, units: &Units, longest: f64) -> Vec<Option<usize>> {
        let mode = &system.modes[self.mode];
        let series = self.all.iter().map(|z| {
            let series = mode.field.series(z, ORDER, false, true);
            let length = mode.field.length(&series, longest, true);
            (series, length)
        });
        let series: Vec<(Series, f64)> = series.collect();
        let order = |row: &Row| {
            let size = units.sum(row);
            let orders = series.iter().map(|(series, length)| {
                let moves = |k: &usize| {
                    let term = series.of(&row.at, *k) * length.powi(*k as i32);
                    term.is_nan() || term.abs() > ZERO * size
                };
                (0..=HIGHEST).find(moves)
            });
            let least = orders.flatten().min();
            if series.is_empty() { Some(0) } else { least }
        };
        mode.guards.iter().map(|guard| order(&guard.row)).collect()
    }

    /// States of which forms, each a derivative of some order of one, have one of their own that they change with.
    pub fn pivots<'r>(
        &self,
        system: &AffineSystem,
        forms: impl Iterator<Item = (&'r Row, usize)>,
        units: &Units,
    ) -> Vec<usize> {
        let Some(z) = self.all.first() else {
            return Vec::new();
        };
        let forms: Vec<(&Row, usize)> = forms.collect();
        let highest = forms.iter().map(|(_, order)| *order).max().unwrap_or(0);
        let field = &system.modes[self.mode].field;
        let series = field.series(z, highest + 1, true, true);
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let mut pivots = Vec::new();
        for (row, order) in forms {
            let (_, by_z, _) = series.jet(row, order);
            let mut own = slopes(&by_z, z, system.harmonics, units);
            own.truncate(units.states);
            for (known, pivot) in rows.iter().zip(&pivots) {
                let factor = own[*pivot] / known[*pivot];
                own.iter_mut()
                    .zip(known)
                    .for_each(|(x, y)| *x -= factor * y);
            }
            let largest = (0..own.len()).max_by(|a, b| own[*a].abs().total_cmp(&own[*b].abs()));
            let size = own.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
            let Some(pivot) = largest.filter(|_| size > 0.0) else {
                break;
            };
            pivots.push(pivot);
            rows.push(own);
        }
        pivots
    }
}
