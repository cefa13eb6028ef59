//! The rates of a mode with their derivatives in states and parameter at once.
//!
//! The parameter of the branch, or the two of a plane, are taken as further states, which rest: rates, guards and surfaces
//! are then functions of u = (x, p), and what [`HyperDual`] numbers give are their derivatives, up to the third, in any
//! directions of u.

use crate::affine::expression::Expression;
use crate::affine::hyperdual::{DIRECTIONS, HyperDual};
use crate::affine::mode::{AffineSystem, Row};
use crate::affine::monitored::MonitoredSystem;
use crate::affine::series::{BEYOND, Field};
use crate::affine::surfaces::Surfaces;
use crate::affine::system::{System, SystemError};
use crate::linalg::{Matrix, Vector, without_noise};

/// A system whose parameters with these indices are its last states.
///
/// # Errors
/// It makes no sense at these values of the others.
pub(super) fn lifted(
    system: &System,
    values: &[f64],
    parameters: &[usize],
) -> Result<AffineSystem, SystemError> {
    let (system, values) = raised(system, values, parameters);
    system.at(&values, &[])
}

/// The same with the forms of its monitors in a mode.
///
/// # Errors
/// As [`lifted`]; an expression of a monitor that has no finite value.
pub(super) fn observed(
    system: &System,
    values: &[f64],
    parameters: &[usize],
    mode: usize,
) -> Result<MonitoredSystem, SystemError> {
    let (system, values) = raised(system, values, parameters);
    system.monitored(&values, &[], &[mode])
}

/// The system and the values of its other parameters.
fn raised(system: &System, values: &[f64], parameters: &[usize]) -> (System, Vec<f64>) {
    let mut system = system.clone();
    let all = std::mem::take(&mut system.source.parameters.0);
    let moved = parameters.iter().filter_map(|index| all.get(*index));
    system
        .source
        .states
        .extend(moved.map(|(name, _)| name.clone()));
    let values = values.iter().enumerate();
    let values: Vec<f64> = values
        .filter(|(index, _)| !parameters.contains(index))
        .map(|(_, value)| *value)
        .collect();
    let all = all.into_iter().enumerate();
    system.source.parameters.0 = all
        .filter(|(index, _)| !parameters.contains(index))
        .map(|(_, named)| named)
        .collect();
    if let Ok(rest) = Expression::read("0") {
        let rests = vec![rest; parameters.len()];
        let modes = system.modes.iter_mut();
        modes.for_each(|mode| mode.rates.extend_from_slice(&rests));
    }
    (system, values)
}

/// A function of u at a place: its value, and its derivatives in u.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Linear {
    pub value: f64,
    pub by: Vector,
    /// Sum of the sizes of the terms of which the value is made.
    pub size: f64,
}

impl Linear {
    /// The same in units of its argument, times a factor.
    pub fn scaled(&self, units: &[f64], factor: f64) -> Linear {
        let by = self.by.iter().zip(units);
        Linear {
            value: self.value * factor,
            by: Vector::from_iterator(self.by.len(), by.map(|(by, unit)| by * unit * factor)),
            size: self.size * factor,
        }
    }

    /// The function times a sign.
    pub fn times(self, sign: f64) -> Linear {
        Linear {
            value: sign * self.value,
            by: self.by * sign,
            size: self.size * sign.abs(),
        }
    }

    /// The sum with another one times a factor.
    pub fn plus(&self, factor: f64, other: &Linear) -> Linear {
        Linear {
            value: self.value + factor * other.value,
            by: &self.by + &other.by * factor,
            size: self.size + factor.abs() * other.size,
        }
    }

    /// Whether its value is what rounding leaves of its terms.
    pub fn is_rounding(&self) -> bool {
        const ROUNDINGS: f64 = 64.0 * f64::EPSILON;
        self.value.abs() <= ROUNDINGS * self.size
    }

    fn is_finite(&self) -> bool {
        self.value.is_finite() && self.by.iter().all(|by| by.is_finite())
    }
}

/// The functions of a mode at a place.
#[derive(Clone, Debug)]
pub(super) struct Linearised {
    /// Rates of the states.
    pub rates: Vec<Linear>,
    /// The forms that are zero all along in the mode.
    pub surfaces: Vec<Linear>,
    /// Guards, those of a sliding mode with what holds it.
    pub guards: Vec<Linear>,
    /// Operands of `abs`, each with the number of its step.
    pub kinks: Vec<(usize, Linear)>,
    /// Whether the rates have no value there, but for what Newton's method looks beyond.
    pub lacks_value: bool,
    /// Whether neither of two fields pushes at the surface between them: Filippov's field is 0/0 there, and has no derivatives.
    pub is_tangent: bool,
}

impl Linearised {
    /// ∂f/∂x, without what is rounding.
    pub fn slopes(&self) -> Matrix {
        let n = self.rates.len();
        let slope = |row: usize, column: usize| self.rates[row].by[column];
        let mut slopes = Matrix::from_fn(n, n, slope);
        // at an equilibrium no surface changes, so that the rates of the states that surfaces give follow from the others:
        // what rounding leaves of them would close loops
        Surfaces::balanced(&self.normals(), &slopes).complete(&mut slopes);
        without_noise(slopes)
    }

    /// The equations of an equilibrium, one for each state: its rate, or the surface that gives it, in these units of the states.
    pub fn equations(&self, units: &Vector) -> Vec<Of> {
        let surfaces = self.surfaces(units);
        let equation = |state: usize| {
            let form = surfaces.form_of(state);
            form.map_or(Of::Rate(state), Of::Surface)
        };
        (0..self.rates.len()).map(equation).collect()
    }

    /// One of the functions of the mode.
    pub fn function(&self, of: Of) -> &Linear {
        match of {
            Of::Rate(state) => &self.rates[state],
            Of::Surface(form) => &self.surfaces[form],
        }
    }

    /// The surfaces that the motion does not leave, in these units of the states.
    pub fn surfaces(&self, units: &Vector) -> Surfaces {
        Surfaces::new(&self.normals(), units)
    }

    /// ∂f/∂x of the motion within its surfaces.
    pub fn within(&self) -> Matrix {
        let slopes = self.slopes();
        Surfaces::balanced(&self.normals(), &slopes).within(&slopes)
    }

    /// Gradients of the surfaces in the states.
    fn normals(&self) -> Vec<Vector> {
        let states = self.rates.len();
        let surfaces = self.surfaces.iter();
        surfaces
            .map(|one| one.by.rows(0, states).clone_owned())
            .collect()
    }
}

/// Which functions of a mode are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    /// The rate of a state.
    Rate(usize),
    /// The form of one of its surfaces.
    Surface(usize),
}

/// A mode at a place u.
#[derive(Clone, Copy)]
pub(super) struct LocalField<'a> {
    pub lifted: &'a AffineSystem,
    pub mode: usize,
    /// Number of states.
    pub states: usize,
    /// How many of the components of u vary: the first ones, among them all states.
    pub variables: usize,
    /// States and parameters.
    pub place: &'a [f64],
    /// Signs of the operands of `abs` where the mode is followed on one side of its kinks; none where it is not.
    pub signs: &'a [f64],
}

impl LocalField<'_> {
    /// The components of z, with their derivatives along directions of u.
    fn components(&self, directions: &[&Vector]) -> Vec<HyperDual> {
        self.components_of(&self.lifted.modes[self.mode].field, directions)
    }

    /// Those that a field has to do with.
    fn components_of(&self, field: &Field, directions: &[&Vector]) -> Vec<HyperDual> {
        let mut z: Vec<HyperDual> = Vec::with_capacity(self.lifted.size());
        for (index, value) in self.place.iter().enumerate() {
            let mut by = [0.0; DIRECTIONS];
            for (by, direction) in by.iter_mut().zip(directions) {
                *by = direction.get(index).copied().unwrap_or_default();
            }
            z.push(HyperDual::along(*value, by));
        }
        z.push(HyperDual::constant(1.0));
        field.differentiate(&mut z, self.signs);
        z
    }

    /// A row of numbers times the components of z. What it does not have may have no value.
    fn of<'b>(row: impl Iterator<Item = &'b f64>, z: &[HyperDual]) -> HyperDual {
        let mut sum = HyperDual::default();
        let terms = row.zip(z).filter(|(c, _)| **c != 0.0);
        terms.for_each(|(c, z)| sum.add(*c, z));
        sum
    }

    fn function(&self, of: Of, z: &[HyperDual]) -> HyperDual {
        let mode = &self.lifted.modes[self.mode];
        match of {
            Of::Rate(state) => LocalField::of(mode.matrix.at.row(state).iter(), z),
            Of::Surface(index) => {
                let surface = mode.surfaces().skip(index).take(1);
                LocalField::of(surface.flat_map(|row| row.at.iter()), z)
            }
        }
    }

    /// The components of z with their derivatives in all variables, so many of these at a time.
    fn passes(&self, field: &Field) -> Vec<Vec<HyperDual>> {
        let all = self.variables;
        let units: Vec<Vector> = (0..all)
            .map(|index| Vector::from_fn(all, |other, _| f64::from(u8::from(other == index))))
            .collect();
        let chunks = units.chunks(DIRECTIONS);
        chunks
            .map(|chunk| self.components_of(field, &chunk.iter().collect::<Vec<_>>()))
            .collect()
    }

    /// A row of numbers times the components of z.
    fn linear(&self, passes: &[Vec<HyperDual>], row: &mut dyn Iterator<Item = &f64>) -> Linear {
        let row: Vec<f64> = row.copied().collect();
        let sums = passes.iter().map(|z| LocalField::of(row.iter(), z));
        let sums: Vec<HyperDual> = sums.collect();
        let by = |index: usize| sums[index / DIRECTIONS].derivative(&[index % DIRECTIONS]);
        let terms = row.iter().zip(&passes[0]).filter(|(c, _)| **c != 0.0);
        Linear {
            value: sums[0].value(),
            by: Vector::from_fn(self.variables, |index, _| by(index)),
            size: terms.map(|(c, z)| (c * z.value()).abs()).sum(),
        }
    }

    /// A form of the system with its first derivatives, also of what the motion has nothing to do with.
    pub fn form(&self, form: &Row) -> Linear {
        let mut field = self.lifted.modes[self.mode].field.clone();
        field.watch(&form.at);
        self.linear(&self.passes(&field), &mut form.at.iter())
    }

    /// The rates of the mode with their first derivatives; `None` where one has no finite value.
    pub fn rates(&self) -> Option<Vec<Linear>> {
        let rates = self.rates_by(&self.passes(&self.lifted.modes[self.mode].field));
        rates.iter().all(Linear::is_finite).then_some(rates)
    }

    fn rates_by(&self, passes: &[Vec<HyperDual>]) -> Vec<Linear> {
        let matrix = &self.lifted.modes[self.mode].matrix.at;
        let rates = 0..self.states;
        rates
            .map(|state| self.linear(passes, &mut matrix.row(state).iter()))
            .collect()
    }

    /// All functions of the mode with their first derivatives; `None` where one has no finite value.
    pub fn linearised(&self) -> Option<Linearised> {
        let mode = &self.lifted.modes[self.mode];
        let passes = self.passes(&mode.field);
        let linear = |row: &mut dyn Iterator<Item = &f64>| self.linear(&passes, row);
        let of_row = |row: &Row| linear(&mut row.at.iter());
        let z = |component: usize| passes[0][component].value();
        let guards: Vec<Linear> = mode.guards.iter().map(|guard| of_row(&guard.row)).collect();
        let slides = mode.sides.is_some() && mode.surface.is_some() && mode.held.is_empty();
        let mut pushes = guards.iter().take(2);
        let found = Linearised {
            is_tangent: slides && pushes.all(Linear::is_rounding),
            lacks_value: mode.field.lacks_value(z, BEYOND),
            rates: self.rates_by(&passes),
            surfaces: mode.surfaces().map(of_row).collect(),
            guards,
            kinks: {
                let kinks = mode.field.kinks();
                kinks
                    .map(|(step, row)| (step, linear(&mut row.iter())))
                    .collect()
            },
        };
        let rates = found.rates.iter().filter(|_| !found.is_tangent);
        let all = rates.chain(&found.surfaces);
        let is_finite = all.chain(&found.guards).all(Linear::is_finite);
        is_finite.then_some(found)
    }

    /// The same field with its functions and their derivatives; at a kink, where it has none, those of one side, with these signs.
    pub fn or_on_side<'b>(self, signs: &'b [f64]) -> Option<(LocalField<'b>, Linearised)>
    where
        Self: 'b,
    {
        let on_side = || {
            let field = LocalField { signs, ..self };
            Some((field, field.linearised()?))
        };
        let here = self.linearised().map(|at| (self, at));
        here.or_else(on_side)
    }

    /// D²F(v, w) of functions, for one v and several w: a column for each of these.
    pub fn second(&self, functions: &[Of], v: &Vector, others: &[Vector]) -> Matrix {
        let mut found = Matrix::zeros(functions.len(), others.len());
        for (pair, chunk) in others.chunks(DIRECTIONS - 1).enumerate() {
            let directions: Vec<&Vector> = std::iter::once(v).chain(chunk).collect();
            let z = self.components(&directions);
            for (row, of) in functions.iter().enumerate() {
                let value = self.function(*of, &z);
                for index in 0..chunk.len() {
                    let column = pair * (DIRECTIONS - 1) + index;
                    found[(row, column)] = value.derivative(&[0, index + 1]);
                }
            }
        }
        found
    }

    /// Signs of the operands of `abs` on one side of all kinks whose side is not known.
    pub fn on_side(&self, side: f64) -> Vec<f64> {
        let field = &self.lifted.modes[self.mode].field;
        let mut signs = self.signs.to_vec();
        signs.resize(self.lifted.program.made(), 0.0);
        for (step, _) in field.kinks() {
            if signs[step] == 0.0 {
                signs[step] = side;
            }
        }
        signs
    }

    /// D³f(v, v, w) of all rates is D³f with all three directions.
    pub fn third(&self, directions: [&Vector; DIRECTIONS]) -> Vector {
        let z = self.components(&directions);
        Vector::from_fn(self.states, |state, _| {
            self.function(Of::Rate(state), &z).derivative(&[0, 1, 2])
        })
    }
}
