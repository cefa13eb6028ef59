//! Sums of states that never change along a sequence of zones: of what sticks all the time, the place; of an element that never
//! slips, its stretch less its travel.
//!
//! They make an orbit one of a family, which differ in their values. The orbit that is meant has those of the start: that a sum is
//! what it was takes the place of the equation by which it would return, which says nothing.

use super::forms::{Forms, Units};
use super::signature::{Sequence, exit_of};

use crate::affine::mode::{AffineMode, AffineSystem, MatrixBy, Row};
use crate::affine::surfaces::Surfaces;
use crate::linalg::{Matrix, Vector};

/// The sums of states that never change along a sequence.
#[derive(Clone, Debug, Default)]
pub struct Conserved {
    /// All of them, each with a state that the others do not have.
    basis: Vec<(usize, Vector)>,
    /// Those of which no law says the value.
    sums: Vec<Vector>,
    /// Where modes are not linear, the numbers of the forms that contacts hold in every zone, one for each of the sums.
    lasting: Vec<usize>,
}

/// Part of the terms of an entry below which it is their rounding.
const NOTHING: f64 = 64.0 * f64::EPSILON;

impl Conserved {
    /// Of a sequence whose modes and exits are in the system; where these are not linear, of what contacts hold and of sums whose rates
    /// are zero term by term.
    pub fn new(system: &AffineSystem, sequence: &Sequence, units: &Units) -> Conserved {
        let first = &system.modes[sequence.zone(0).mode];
        // what slides all the time is led onto its surface
        let slides = sequence.switches() == 0 && first.surface.is_some();
        if slides {
            return Conserved::default();
        }
        if system.program.made() > 0 || !system.modes.are_exact() {
            return Conserved::of_contacts(system, sequence, units);
        }
        let basis = dependencies(changes(system, sequence, units));
        // what is held has the value that holds it, and moves with it
        let mut known = Forms::default();
        for held in &first.held {
            let mut sum = Row::zero(held.at.len());
            sum.at
                .rows_mut(0, system.states)
                .copy_from(&held.at.rows(0, system.states));
            known.insert(&sum, units);
        }
        let mut sums = Vec::new();
        for (_, sum) in &basis {
            let row = row(sum, system.size());
            if !known.contain(&row, units.size(&row), units) {
                known.insert(&row, units);
                sums.push(sum.clone());
            }
        }
        Conserved {
            basis,
            sums,
            lasting: Vec::new(),
        }
    }

    /// What contacts hold in every zone, where it is no function of anything but the states and changes with them alike
    /// everywhere, and behind it sums of states.
    fn of_contacts(system: &AffineSystem, sequence: &Sequence, units: &Units) -> Conserved {
        let states = system.states;
        let is_flat = |row: &Row| {
            let fixed = |by: &Vector| by.rows(0, states).iter().all(|by| *by == 0.0);
            row.by.iter().all(fixed) && !(states + 1..system.size()).any(|c| row.has(c))
        };
        let held = system.modes[sequence.zone(0).mode].held.iter().enumerate();
        let lasts = |row: &&Row| is_flat(row) && is_held(system, sequence, row, units);
        let (numbers, gradients): (Vec<usize>, Vec<Vector>) = held
            .filter(|(_, row)| lasts(row))
            .map(|(number, row)| (number, row.at.rows(0, states).clone_owned()))
            .unzip();
        let sizes = units.z.rows(0, states).clone_owned();
        let sums = dependencies(changes(system, sequence, units));
        let sums = sums.into_iter().map(|(_, sum)| sum);
        let all: Vec<Vector> = gradients.into_iter().chain(sums).collect();
        let surfaces = Surfaces::new(&all, &sizes);
        let given = surfaces.given().map(|(_, form)| form);
        let (held, sums): (Vec<usize>, Vec<usize>) = given.partition(|form| *form < numbers.len());
        Conserved {
            basis: surfaces.reduced().collect(),
            sums: sums.into_iter().map(|form| all[form].clone()).collect(),
            lasting: held.into_iter().map(|form| numbers[form]).collect(),
        }
    }

    /// Whether a form that a mode holds has a value by a law in every zone, where modes are not linear.
    pub fn lasts(&self, held: usize) -> bool {
        self.lasting.contains(&held)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.basis.is_empty()
    }

    /// How many have a value of the start.
    pub fn count(&self) -> usize {
        self.sums.len()
    }

    /// How many have a value by a law.
    pub fn held(&self) -> usize {
        self.basis.len() - self.sums.len()
    }

    /// Adds what is zero in a mode at the beginning of the sequence: what it holds, and what the sums differ by from those of
    /// the states that are kept.
    pub fn at_beginning(&self, mode: &AffineMode, kept: &[f64], forms: &mut Forms, units: &Units) {
        if self.is_empty() {
            return;
        }
        for held in &mode.held {
            forms.insert(held, units);
        }
        for sum in self.kept(mode, kept) {
            forms.insert(&sum, units);
        }
    }

    /// What the sums differ by in a mode from those of the states that are kept, if they are.
    pub fn kept(&self, mode: &AffineMode, kept: &[f64]) -> impl Iterator<Item = Row> {
        let sums = self.sums.iter().filter(move |_| kept.len() == mode.states);
        sums.map(move |sum| {
            let mut row = row(sum, mode.matrix.at.ncols());
            row.at[mode.states] = -sum.iter().zip(kept).map(|(by, x)| by * x).sum::<f64>();
            row
        })
    }

    /// What a matrix that keeps the sums does to perturbations that do not change them.
    pub fn within(&self, matrix: &Matrix) -> Matrix {
        let mut within = matrix.clone();
        for (pivot, sum) in &self.basis {
            let column = within.column(*pivot).clone_owned();
            for (state, by) in sum.iter().enumerate().filter(|(_, by)| **by != 0.0) {
                let mut own = within.column_mut(state);
                own.axpy(-by / sum[*pivot], &column, 1.0);
            }
        }
        // where every state is one of them nothing is left
        let left = self.others(matrix.nrows());
        Matrix::from_fn(left.len(), left.len(), |row, column| {
            within[(left[row], left[column])]
        })
    }

    /// A change of states that does not change the sums, in the states that are left.
    pub fn left(&self, change: &Vector) -> Vector {
        let left = self.others(change.len());
        Vector::from_fn(left.len(), |row, _| change[left[row]])
    }

    /// The states that are left, of so many.
    fn others(&self, states: usize) -> Vec<usize> {
        let is_left = |state: &usize| self.basis.iter().all(|(pivot, _)| pivot != state);
        (0..states).filter(is_left).collect()
    }
}

/// A sum of states as a form of z.
fn row(sum: &Vector, size: usize) -> Row {
    let mut row = Row::zero(size);
    row.at.rows_mut(0, sum.len()).copy_from(sum);
    row
}

/// Whether contacts hold a form in every zone: it is one of theirs, or a sum of them, as a slip between two blocks is where both stick to
/// a belt.
fn is_held(system: &AffineSystem, sequence: &Sequence, form: &Row, units: &Units) -> bool {
    let mut zones = sequence.0.iter();
    zones.all(|zone| {
        let held = &system.modes[zone.mode].held;
        held.contains(form) || {
            let mut forms = Forms::default();
            held.iter().for_each(|held| {
                forms.insert(held, units);
            });
            forms.contain(form, units.size(form), units)
        }
    })
}

/// What is held at zero in every zone, whatever the parameters: each form with a component that it has most of.
fn held(system: &AffineSystem, sequence: &Sequence, units: &Units) -> Vec<(usize, Vector)> {
    let zones = sequence.0.iter();
    let forms = zones.flat_map(|zone| &system.modes[zone.mode].held);
    let all = forms.filter(|held| {
        let fixed = held.by.iter().flat_map(|by| by.iter()).all(|by| *by == 0.0);
        fixed && is_held(system, sequence, held, units)
    });
    let mut known: Vec<(usize, Vector)> = Vec::new();
    let mut seen = Forms::default();
    for form in all {
        if seen.contain(form, units.size(form), units) {
            continue;
        }
        seen.insert(form, units);
        let form = without(form.at.clone(), &known);
        let pivot = form.rows(0, system.states).iamax();
        if form[pivot] != 0.0 {
            known.push((pivot, form));
        }
    }
    known
}

/// A form less what is held in it.
fn without(mut form: Vector, held: &[(usize, Vector)]) -> Vector {
    for (pivot, held) in held {
        let factor = form[*pivot] / held[*pivot];
        if factor != 0.0 {
            form.axpy(-factor, held, 1.0);
            form[*pivot] = 0.0;
        }
    }
    form
}

/// Of every state: how its rate depends on z in every zone, and how its jump does at every switch, with derivatives in the
/// parameters, where what is held is zero.
fn changes(system: &AffineSystem, sequence: &Sequence, units: &Units) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = vec![Vec::new(); system.states];
    let held = held(system, sequence, units);
    let mut seen = Vec::new();
    let mut add = |matrix: &MatrixBy, stays: f64| {
        for (state, row) in rows.iter_mut().enumerate() {
            let mut own = matrix.at.row(state).transpose();
            own[state] -= stays;
            row.extend(without(own, &held).iter());
            for by in &matrix.by {
                row.extend(without(by.row(state).transpose(), &held).iter());
            }
        }
    };
    for (index, zone) in sequence.0.iter().enumerate() {
        if !seen.contains(&zone.mode) {
            seen.push(zone.mode);
            add(&system.modes[zone.mode].matrix, 0.0);
        }
        if let Some(exit) = exit_of(system, sequence, index).filter(|exit| !exit.is_continuous()) {
            add(&exit.reset, 1.0);
        }
    }
    rows
}

/// The sums of rows that are zero, by elimination: the coefficients of each, with a row that the others do not have. Every entry is
/// compared with the terms that it is made of, and columns by their largest entries: no unit decides.
fn dependencies(rows: Vec<Vec<f64>>) -> Vec<(usize, Vector)> {
    let count = rows.len();
    let largest = |column: usize| rows.iter().map(|row| row[column].abs()).fold(0.0, f64::max);
    let columns: Vec<f64> = (0..rows.first().map_or(0, Vec::len)).map(largest).collect();
    let mut found: Vec<(usize, Vector)> = Vec::new();
    let mut kept: Vec<(usize, Vec<f64>, Vector)> = Vec::new();
    for (index, mut row) in rows.into_iter().enumerate() {
        let mut terms: Vec<f64> = row.iter().map(|x| x.abs()).collect();
        let mut sum = Vector::zeros(count);
        sum[index] = 1.0;
        for (pivot, other, of) in &kept {
            let factor = row[*pivot] / other[*pivot];
            if factor == 0.0 {
                continue;
            }
            for ((own, terms), other) in row.iter_mut().zip(&mut terms).zip(other) {
                *terms += (factor * other).abs();
                *own -= factor * other;
                if own.abs() <= NOTHING * *terms {
                    *own = 0.0;
                }
            }
            sum.axpy(-factor, of, 1.0);
        }
        let part = |place: &usize| row[*place].abs() / columns[*place];
        let told = (0..row.len()).filter(|place| row[*place] != 0.0);
        match told.max_by(|one, other| part(one).total_cmp(&part(other))) {
            Some(pivot) => kept.push((pivot, row, sum)),
            // the row itself stands in no other sum
            None => found.push((index, sum)),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of three rows the third is the first less twice the second: one sum; in rows of their own there is none.
    #[test]
    fn sums_that_are_zero_are_found() {
        let rows = vec![
            vec![1.0, 2.0, 0.1],
            vec![0.5, 0.25, 3.0],
            vec![0.0, 1.5, -5.9],
        ];
        let found = dependencies(rows.clone());
        assert_eq!(found.len(), 1);
        let (pivot, sum) = &found[0];
        assert_eq!(*pivot, 2);
        let [first, second] = [0, 1].map(|row| sum[row]);
        assert!(
            (first + 1.0).abs() < 1e-15 && (second - 2.0).abs() < 1e-15,
            "{sum}"
        );
        assert!(dependencies(rows[..2].to_vec()).is_empty());
        assert_eq!(dependencies(vec![vec![0.0, 0.0]]).len(), 1);
    }
}
