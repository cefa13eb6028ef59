//! A system at given values of its parameters: every mode a linear flow ż = Mz of z = (x, 1, cos φ, sin φ,
//! cos 2φ, …), with φ̇ = ω. Exact at resonance and for a singular matrix, where a particular solution is not.
//!
//! What is not affine adds components to z that are made of the others, so that rates, guards and resets are linear
//! in z all the same; how these move is not, and [`super::series`] has it.

use std::f64::consts::PI;
use std::sync::Arc;

use super::evaluation::{Evaluation, FormMode, FormSwitch};
use super::expression::{Algebra, Obstacle, Operation};
use super::form::{Dual, Form};
pub use super::rows::{MatrixBy, Row};
use super::series::{Field, Program, Terms};
use super::system::{Mistake, System, SystemError};
use crate::linalg::{Matrix, Vector};

/// A way for a mode to end.
#[derive(Clone, Debug, PartialEq)]
pub struct Exit {
    /// The mode that begins.
    pub to: usize,
    /// New states as linear forms of z.
    pub reset: MatrixBy,
    /// What is not negative where it is taken.
    pub conditions: Vec<Row>,
    /// The mode that begins where infinitely many such exits end in finite time.
    pub rest: Option<usize>,
}

/// What is positive in a mode, and where the mode leads when it is zero no more: the first exit whose conditions hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Guard {
    /// As a linear form of z.
    pub row: Row,
    /// Exits in the order of the file.
    pub exits: Vec<Exit>,
}

/// A mode at given parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct AffineMode {
    /// How many of the components of z are states: the others are constant, turn with the phase, or are made of these.
    pub states: usize,
    /// M of ż = Mz.
    pub matrix: MatrixBy,
    /// Everything that is positive in it.
    pub guards: Vec<Guard>,
    /// What is zero all along in a sliding mode.
    pub surface: Option<Row>,
    /// How the components of z move that are not those of states and phase.
    pub field: Field,
}

/// A system at given parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct AffineSystem {
    /// Number of states.
    pub states: usize,
    /// Multiples of the phase that occur: cos hφ and sin hφ for h from 1 to this.
    pub harmonics: usize,
    /// Angular frequency of the forcing; zero without.
    pub omega: Dual,
    /// Modes of the file, then the sliding modes.
    pub modes: Vec<AffineMode>,
    /// What z has beyond states and phase.
    pub program: Arc<Program>,
}

impl AffineSystem {
    /// The vector z of a state at a phase, in a mode.
    pub fn lift(&self, mode: usize, state: &[f64], phase: f64) -> Vector {
        let n = self.states;
        let base = self.size() - self.program.made();
        let mut z = Vector::from_fn(self.size(), |index, _| match index {
            _ if index < n => state[index],
            _ if index == n => 1.0,
            _ if index >= base => 0.0,
            _ => {
                let angle = (index - n).div_ceil(2) as f64 * phase;
                if (index - n) % 2 == 1 {
                    angle.cos()
                } else {
                    angle.sin()
                }
            }
        });
        self.modes[mode].field.complete(&mut z);
        z
    }

    /// Length of z.
    pub fn size(&self) -> usize {
        self.program.size()
    }

    /// Leads a system that is affine in a parameter from one value to another; `origin` is it at zero. False where it
    /// makes no sense there, or an entry that changes is zero by chance.
    pub fn move_to(&mut self, origin: &AffineSystem, value: f64) -> bool {
        self.omega.value = origin.omega.value + value * origin.omega.by[0];
        let mut regular = origin.omega == Dual::default() || self.omega.value > 0.0;
        let mut to = |at: &mut [f64], origin: &[f64], by: &[f64]| {
            for ((at, origin), by) in at.iter_mut().zip(origin).zip(by) {
                if *by != 0.0 {
                    *at = origin + value * by;
                    regular &= *at != 0.0 && at.is_finite();
                }
            }
        };
        for (mode, known) in self.modes.iter_mut().zip(&origin.modes) {
            let (own, by) = (&mut mode.matrix.at, &known.matrix.by[0]);
            to(
                own.as_mut_slice(),
                known.matrix.at.as_slice(),
                by.as_slice(),
            );
            for (guard, known) in mode.guards.iter_mut().zip(&known.guards) {
                let (own, by) = (&mut guard.row.at, &known.row.by[0]);
                to(own.as_mut_slice(), known.row.at.as_slice(), by.as_slice());
                for (exit, known) in guard.exits.iter_mut().zip(&known.exits) {
                    let (own, by) = (&mut exit.reset.at, &known.reset.by[0]);
                    to(own.as_mut_slice(), known.reset.at.as_slice(), by.as_slice());
                    for (row, known) in exit.conditions.iter_mut().zip(&known.conditions) {
                        let (own, by) = (&mut row.at, &known.by[0]);
                        to(own.as_mut_slice(), known.at.as_slice(), by.as_slice());
                    }
                }
            }
        }
        regular
    }
}

impl System {
    /// The system at these values of its parameters, with derivatives in those of the indices `varying`.
    ///
    /// # Errors
    /// An expression that is not affine in the states or has no finite value, with its place; two modes that
    /// cannot slide.
    pub fn at(&self, values: &[f64], varying: &[usize]) -> Result<AffineSystem, SystemError> {
        let system = self.evaluated(values, varying)?;
        match self.forcing.is_some() && system.omega.value <= 0.0 {
            true => {
                let mistake = Mistake::Frequency(system.omega.value);
                Err(SystemError::at("forcing", mistake))
            }
            false => Ok(system),
        }
    }

    /// The system where one parameter is zero, whatever that does to the forcing, if all of it is affine in that parameter:
    /// [`AffineSystem::move_to`] leads from it to other values.
    pub fn origin(&self, values: &[f64], parameter: usize) -> Option<AffineSystem> {
        if self.integrated || !self.is_affine_in(parameter) {
            return None;
        }
        let mut values = values.to_vec();
        values[parameter] = 0.0;
        let origin = self.evaluated(&values, &[parameter]).ok()?;
        // a sliding field is affine, too, where the surface stays and with it the difference of the fields on its sides
        let stays = |by: &Vector| by.iter().all(|by| *by == 0.0);
        let surfaces = origin.modes.iter().filter_map(|mode| mode.surface.as_ref());
        let flat = surfaces.flat_map(|row| &row.by).all(stays);
        let alike = self.sliding.iter().all(|sides| {
            let [below, above] =
                sides.map(|side| origin.modes[side].matrix.by[0].rows(0, origin.states));
            below == above
        });
        (flat && alike && origin.program.made() == 0).then_some(origin)
    }

    /// Whether every expression is affine in a parameter.
    fn is_affine_in(&self, parameter: usize) -> bool {
        let name = self.source.parameters.names().nth(parameter);
        let mut known: Vec<(&str, Option<u32>)> = Vec::new();
        for (define, expression) in self.source.define.names().zip(&self.define) {
            let degree = expression.degree(&|one| degree_of(one, name, &known));
            known.push((define, degree));
        }
        let of = |one: &str| degree_of(one, name, &known);
        let switches = self.modes.iter().flat_map(|mode| &mode.switches);
        let of_switches = switches.flat_map(|switch| {
            let reset = switch.reset.iter().map(|(_, expression)| expression);
            [&switch.zero]
                .into_iter()
                .chain(reset)
                .chain(&switch.conditions)
        });
        let rates = self.modes.iter().flat_map(|mode| &mode.rates);
        let mut all = rates.chain(of_switches).chain(&self.forcing);
        all.all(|expression| expression.degree(&of).is_some())
    }

    /// The same as [`System::at`] for a forcing of any frequency.
    fn evaluated(&self, values: &[f64], varying: &[usize]) -> Result<AffineSystem, SystemError> {
        let parameter = |index: usize| {
            let varies = varying.iter().position(|varying| *varying == index);
            Dual::parameter(values[index], varies)
        };
        let evaluation = Evaluation::new(self, &parameter, Dual::number(PI))?;
        let omega = evaluation.frequency()?;
        let modes = evaluation.modes()?;
        let mut numerical = vec![None; self.sliding.len()];
        loop {
            match self.laid_out(&modes, omega, &numerical) {
                // what has no affine field slides by one that is not
                Err((error, Some(index))) if numerical[index].is_none() => {
                    let [first, second] = self.sliding[index].map(|side| &modes[side]);
                    let forms = SlidingForms::new(first, second, self.sliding[index], omega);
                    numerical[index] = Some(forms.map_err(|_| error)?);
                }
                result => return result.map_err(|(error, _)| error),
            }
        }
    }

    /// The system with the terms of all forms as components of z; the index of the sliding mode that fails.
    fn laid_out(
        &self,
        modes: &[FormMode],
        omega: Dual,
        numerical: &[Option<SlidingForms>],
    ) -> Result<AffineSystem, (SystemError, Option<usize>)> {
        let forms = modes.iter().flat_map(FormMode::forms);
        let sliding = numerical.iter().flatten();
        let sliding = sliding.flat_map(|forms| forms.rates.iter().chain(&forms.falls));
        let forms: Vec<&Form> = forms.chain(sliding).collect();
        let harmonics = forms.iter().map(|form| form.highest()).max().unwrap_or(0);
        let mut terms = Terms::new(self.source.states.len(), harmonics);
        forms.iter().for_each(|form| terms.add(form));
        let shape = Shape {
            states: self.source.states.len(),
            harmonics,
            terms,
        };
        let program = Arc::new(shape.terms.program().clone());
        let modes = modes.iter().map(|mode| {
            let matrix = shape.matrix(&mode.rates, omega);
            AffineMode {
                states: shape.states,
                field: Field::default(),
                guards: shape.guards(&mode.switches),
                surface: None,
                matrix,
            }
        });
        let mut system = AffineSystem {
            states: shape.states,
            harmonics,
            omega,
            modes: modes.collect(),
            program: program.clone(),
        };
        for (index, sides) in self.sliding.iter().enumerate() {
            let own = self.modes.len() + index;
            let sliding = numerical[index].as_ref().map(|forms| {
                let falls = forms.falls.each_ref().map(|form| shape.row(form));
                (shape.matrix(&forms.rates, omega), falls)
            });
            system.slide(self, own, *sides, sliding)?;
        }
        for mode in &mut system.modes {
            let exits = || mode.guards.iter().flat_map(|guard| &guard.exits);
            let conditions = exits().flat_map(|exit| exit.conditions.iter().cloned());
            let reset = exits().flat_map(|exit| (0..shape.states).map(|row| exit.reset.row(row)));
            let guards = mode.guards.iter().map(|guard| guard.row.clone());
            let watched = guards
                .chain(conditions)
                .chain(reset)
                .chain(mode.surface.clone());
            let how = (self.flow_tolerance(), self.integrated);
            mode.field = Field::new(&program, &mode.matrix, watched, how);
        }
        Ok(system)
    }
}

/// The degree in a parameter of what a name stands for.
fn degree_of(one: &str, parameter: Option<&str>, known: &[(&str, Option<u32>)]) -> Option<u32> {
    let mut known = known.iter();
    match known.find(|(name, _)| *name == one) {
        Some((_, degree)) => *degree,
        None => Some(u32::from(Some(one) == parameter)),
    }
}

/// A sliding mode whose field is not affine.
#[derive(Clone, Debug)]
struct SlidingForms {
    /// Filippov's field F₋ + λ(F₊ − F₋), λ = Lġ₋/(Lġ₋ − Lġ₊).
    rates: Vec<Form>,
    /// The rates of the guard of the first mode along both fields.
    falls: [Form; 2],
}

impl SlidingForms {
    fn new(
        first: &FormMode,
        second: &FormMode,
        sides: [usize; 2],
        omega: Dual,
    ) -> Result<SlidingForms, Obstacle> {
        let leads = |switch: &&FormSwitch| switch.switch.to == sides[1];
        let guard = first
            .switches
            .iter()
            .find(leads)
            .map(|switch| switch.guard.clone());
        let guard = guard.unwrap_or_default();
        let minus = |one: &Form, other: &Form| one.clone().operate(Operation::Minus, other.clone());
        let falls = [
            guard.lie(&first.rates, omega)?,
            guard.lie(&second.rates, omega)?,
        ];
        let difference = minus(&falls[0], &falls[1])?;
        let share = falls[0].clone().operate(Operation::Over, difference)?;
        let rates = first.rates.iter().zip(&second.rates).map(|(below, above)| {
            let step = minus(above, below)?;
            if step.is_zero() {
                return Ok(below.clone());
            }
            let moved = share.clone().operate(Operation::Times, step)?;
            below.clone().operate(Operation::Plus, moved)
        });
        Ok(SlidingForms {
            rates: rates.collect::<Result<_, Obstacle>>()?,
            falls,
        })
    }
}

/// Where what stands in z.
struct Shape {
    states: usize,
    harmonics: usize,
    terms: Terms,
}

impl Shape {
    fn size(&self) -> usize {
        self.terms.program().size()
    }

    fn row(&self, form: &Form) -> Row {
        let mut row = Row::zero(self.size());
        for (column, value) in self.terms.coefficients(form) {
            row.add(column, value);
        }
        row
    }

    fn matrix(&self, rates: &[Form], omega: Dual) -> MatrixBy {
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

    /// Guards in the order of the file, each with all its exits.
    fn guards(&self, switches: &[FormSwitch]) -> Vec<Guard> {
        let mut guards: Vec<Guard> = Vec::new();
        for switch in switches {
            let exit = self.exit(switch);
            let row = self.row(&switch.guard);
            match guards.iter_mut().find(|guard| guard.row == row) {
                Some(guard) => guard.exits.push(exit),
                None => guards.push(Guard {
                    row,
                    exits: vec![exit],
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
            to: switch.switch.to,
            reset,
            conditions: switch
                .conditions
                .iter()
                .map(|form| self.row(form))
                .collect(),
            rest: switch.switch.rest,
        }
    }
}

/// Relative size of what two rows may differ by where they are the same for the mathematics: coefficients
/// are made from the same numbers in different order.
const SAME: f64 = 1e-12;

impl AffineSystem {
    /// The field of a sliding mode and the rates of its surface along both fields, where the difference of these keeps
    /// its direction and the surface is flat.
    fn sliding_field(&self, sides: [usize; 2], surface: &Row) -> Option<(MatrixBy, [Row; 2])> {
        let base = self.size() - self.program.made();
        if (base..self.size()).any(|column| surface.has(column)) {
            return None;
        }
        let [below, above] = sides.map(|side| &self.modes[side].matrix);
        // ∂/∂t of the surface's form along both fields
        let [toward, away] = [below, above].map(|matrix| surface.through(matrix));
        let mut difference = MatrixBy {
            at: &above.at - &below.at,
            by: [0, 1].map(|p| &above.by[p] - &below.by[p]),
        };
        // friction that is zero at one value of a parameter: only the direction counts, which is that nearby
        if difference.at.amax() == 0.0 {
            let slope = difference.by.iter().find(|by| by.amax() > 0.0)?;
            let at = slope.clone();
            difference = MatrixBy {
                at,
                ..MatrixBy::zero(self.size(), self.size())
            };
        }
        // the largest row of F₊ − F₋; the others are multiples of it
        let rows = 0..self.states;
        let largest = rows.max_by(|one, other| {
            let size = |row: usize| difference.at.row(row).amax();
            size(*one).total_cmp(&size(*other))
        });
        let largest = largest.unwrap_or(0);
        let (reference, pivot) = {
            let row = difference.at.row(largest);
            (row.transpose(), row.iamax_full().1)
        };
        let scale = reference[pivot];
        let mut direction = Row::zero(self.states);
        for state in 0..self.states {
            let row = difference.row(state);
            let ratio = row.at[pivot] / scale;
            let parallel = (&row.at - &reference * ratio).amax() <= SAME * scale.abs();
            if scale == 0.0 || !parallel {
                return None;
            }
            let by = [0, 1]
                .map(|p| (row.by[p][pivot] - ratio * difference.by[p][(largest, pivot)]) / scale);
            direction.set(state, Dual { value: ratio, by });
        }
        let normal = surface.at.rows(0, self.states);
        let across = normal.dot(&direction.at);
        if across.abs() <= SAME * surface.at.amax() * direction.at.amax() {
            return None;
        }
        let across_by = [0, 1].map(|p| {
            surface.by[p].rows(0, self.states).dot(&direction.at) + normal.dot(&direction.by[p])
        });
        let mut matrix = below.clone();
        for state in 0..self.states {
            let weight = direction.at[state] / across;
            let row = Row {
                at: below.at.row(state).transpose() - &toward.at * weight,
                by: [0, 1].map(|p| {
                    let by = (direction.by[p][state] - weight * across_by[p]) / across;
                    below.by[p].row(state).transpose() - &toward.by[p] * weight - &toward.at * by
                }),
            };
            matrix.set_row(state, &row);
        }
        Some((matrix, [toward, away]))
    }

    /// Puts the sliding mode with this index between two modes: Filippov's field F₋ − d (nᵀF₋)/(nᵀd) where
    /// F₊ − F₋ keeps the direction d and n is the gradient of the guard of the first mode. It lasts while both
    /// fields point at the surface, and each of the two modes crosses into the other where one does not. Where the
    /// direction changes or the surface is curved `numerical` has the field, and the rates of the guard along both.
    fn slide(
        &mut self,
        system: &System,
        own: usize,
        sides: [usize; 2],
        numerical: Option<(MatrixBy, [Row; 2])>,
    ) -> Result<(), (SystemError, Option<usize>)> {
        let names = sides.map(|side| system.mode_name(side).to_owned());
        let path = format!("sliding.{}", system.mode_name(own));
        let index = own - system.modes.len();
        let refuse = |mistake: fn(String, String) -> Mistake, index: Option<usize>| {
            let [one, other] = names.clone();
            Err((SystemError::at(path.clone(), mistake(one, other)), index))
        };
        let guard_of = |from: usize, to: usize| {
            let guards = &self.modes[from].guards;
            let mut between = guards
                .iter()
                .enumerate()
                .filter(|(_, guard)| guard.exits.iter().any(|exit| exit.to == to));
            let first = between.next();
            first
                .filter(|_| between.next().is_none())
                .map(|(index, _)| index)
        };
        let [first, second] = sides;
        let (Some(leave_first), Some(leave_second)) =
            (guard_of(first, second), guard_of(second, first))
        else {
            return refuse(Mistake::NoSurface, None);
        };
        let surface = self.modes[first].guards[leave_first].row.clone();
        let opposite = &self.modes[second].guards[leave_second].row;
        let size = surface.at.amax();
        let meets = (&surface.at + &opposite.at).amax() <= SAME * size;
        if !meets || size == 0.0 {
            return refuse(Mistake::NoSurface, None);
        }
        let field = numerical.or_else(|| self.sliding_field(sides, &surface));
        let Some((matrix, [toward, away])) = field else {
            return refuse(Mistake::NoSliding, Some(index));
        };
        let stay = MatrixBy {
            at: Matrix::identity(self.states, self.size()),
            ..MatrixBy::zero(self.states, self.size())
        };
        let exit = |to: usize, conditions: Vec<Row>| Exit {
            to,
            reset: stay.clone(),
            conditions,
            rest: None,
        };
        let guards = vec![
            Guard {
                row: toward.negative(),
                exits: vec![exit(first, Vec::new())],
            },
            Guard {
                row: away.clone(),
                exits: vec![exit(second, Vec::new())],
            },
        ];
        // at the surface: the sliding mode where the other field points back, the other mode where not
        let slides = [away, toward.negative()];
        for ((from, guard), held) in [(first, leave_first), (second, leave_second)]
            .into_iter()
            .zip(slides)
        {
            let exits = &mut self.modes[from].guards[guard].exits;
            exits.insert(0, exit(own, vec![held]));
        }
        self.modes.push(AffineMode {
            states: self.states,
            matrix,
            guards,
            surface: Some(surface),
            field: Field::default(),
        });
        Ok(())
    }
}
