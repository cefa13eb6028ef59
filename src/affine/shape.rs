//! Where the expressions of a system stand in z: modes of forms as matrices and rows.

use std::sync::Arc;

use super::dual::{Degree, Dual};
use super::evaluation::{FormMode, FormSwitch};
use super::form::Form;
use super::mode::{AffineMode, Exit, Guard};
use super::program::{Program, Terms};
use super::rows::{MatrixBy, Row};
use super::series::Field;

/// A mode in which nothing moves.
pub(super) fn still(states: usize) -> FormMode {
    FormMode {
        rates: vec![Form::default(); states],
        switches: Vec::new(),
        held: Vec::new(),
        bounds: Vec::new(),
    }
}

/// How the components of z move in a mode that are not those of states and phase.
pub(super) fn field(mode: &AffineMode, program: &Arc<Program>, how: (f64, bool)) -> Field {
    let exits = || mode.guards.iter().flat_map(|guard| &guard.exits);
    let conditions = exits().flat_map(|exit| exit.conditions.iter().cloned());
    let reset = exits().flat_map(|exit| (0..mode.states).map(|row| exit.reset.row(row)));
    let guards = mode.guards.iter().map(|guard| guard.row.clone());
    let along = guards.chain(mode.surfaces().cloned());
    Field::new(program, &mode.matrix, (along, conditions.chain(reset)), how)
}

/// Where what stands in z.
pub(super) struct Shape {
    /// How many states there are.
    pub states: usize,
    /// Multiples of the phase that occur.
    pub harmonics: usize,
    /// What is not affine.
    pub terms: Terms,
}

impl Shape {
    fn size(&self) -> usize {
        self.terms.program().size()
    }

    /// A form as a row.
    pub fn row(&self, form: &Form) -> Row {
        let mut row = Row::zero(self.size());
        for (column, value) in self.terms.coefficients(form) {
            row.add(column, value);
        }
        row
    }

    /// The matrix of rates.
    pub fn matrix(&self, rates: &[Form], omega: Dual) -> MatrixBy {
        let mut matrix = MatrixBy::zero(self.size(), self.size());
        for (state, rate) in rates.iter().enumerate() {
            for (column, value) in self.terms.coefficients(rate) {
                matrix.add(state, column, value);
            }
        }
        for h in 1..=self.harmonics {
            let cosine = self.states + 2 * h - 1;
            let mut turn = |row: usize, column: usize, factor: f64| {
                matrix.at[(row, column)] = factor * omega.value;
                for (by, derivative) in matrix.by.iter_mut().zip(omega.by) {
                    by[(row, column)] = factor * derivative;
                }
            };
            turn(cosine, cosine + 1, -(h as f64));
            turn(cosine + 1, cosine, h as f64);
        }
        matrix
    }

    /// A mode of this number, but for how what is not affine moves.
    pub fn mode(&self, number: usize, mode: &FormMode, omega: Dual) -> AffineMode {
        let held = mode.held.iter();
        let bounds = mode.bounds.iter();
        AffineMode {
            states: self.states,
            field: Field::default(),
            guards: self.guards(number, &mode.switches),
            surface: None,
            held: held.map(|form| self.row(form)).collect(),
            bounds: bounds
                .map(|(guard, form)| (*guard, self.row(form)))
                .collect(),
            sides: None,
            obstruction: None,
            leads: mode.forms().all(|form| form.degree() <= Degree::Affine),
            matrix: self.matrix(&mode.rates, omega),
        }
    }

    /// Guards of a mode in the order of the file, each with all its exits.
    fn guards(&self, mode: usize, switches: &[FormSwitch]) -> Vec<Guard> {
        let mut guards: Vec<Guard> = Vec::new();
        for (index, switch) in switches.iter().enumerate() {
            let exit = self.exit(switch);
            let row = self.row(&switch.guard);
            let known = match switch.group {
                Some(group) => guards.get_mut(group),
                None => guards.iter_mut().find(|guard| guard.row == row),
            };
            match known {
                Some(guard) => guard.exits.push(exit),
                None => guards.push(Guard {
                    row,
                    exits: vec![exit],
                    written: Some([mode, index]),
                }),
            }
        }
        guards
    }

    fn exit(&self, switch: &FormSwitch) -> Exit {
        let mut reset = MatrixBy::zero(self.states, self.size());
        reset.at.fill_with_identity();
        for (state, form) in &switch.reset {
            reset.at[(*state, *state)] = 0.0;
            for (column, value) in self.terms.coefficients(form) {
                reset.add(*state, column, value);
            }
        }
        Exit {
            to: switch.to,
            reset,
            conditions: switch
                .conditions
                .iter()
                .map(|form| self.row(form))
                .collect(),
            rest: switch.rest,
            tangent: switch.tangent,
            name: switch.name.clone(),
            // those of contacts alone have guards that are given
            of_contact: switch.group.is_some(),
            refusal: switch.refusal.clone(),
            keeps: switch.keeps,
        }
    }
}
