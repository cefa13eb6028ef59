//! The equilibria of one mode as a curve in a parameter, or as a family in two: unknowns, units and equations.
//!
//! The unknowns are the states and the parameters, each in its unit. The equations are f(x, p) = 0. Where a mode
//! keeps forms h at zero, as one that slides, sticks or is closed, its rates satisfy ∇h·f = 0, or what it is is one of the other
//! forms, so that some of them follow from the others: those of the states by which these surfaces change most give way to
//! h(x, p) = 0.
//!
//! Rates of a mode that slides between two others are a quotient, which has no value where both fields are tangent to the surface,
//! and at an equilibrium of sliding they are so at once: (1 − l)f₁ + lf₂ = 0. That equation is regular there. With l from the
//! state j in which the fields differ most it is followed in the place of the quotient: f₁ − l(f₁ − f₂) = 0 in all other states.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::field::{Linear, Linearised, LocalField, Of, lifted, observed};
use crate::affine::mode::AffineSystem;
use crate::affine::monitored::MonitoredSystem;
use crate::affine::system::System;
use crate::continuation::newton::Equations;
use crate::linalg::{Matrix, Vector, balance, known_eigenvalues, solve};

/// The mode that an equilibrium is one of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RestMode {
    /// Its index: those of the file, then the sliding ones.
    pub mode: usize,
    /// Its name.
    pub name: String,
    /// Signs of the operands of `abs`, by the number of its step, where equilibria are followed on one side of the kinks of their rates:
    /// zero of one that stays zero, and of what is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub signs: Vec<f64>,
}

impl std::fmt::Display for RestMode {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.name)
    }
}

/// Units of the unknowns, and the place from which those of equations and guards come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EquilibriumScales {
    /// Of the states, then of the parameters.
    pub units: Vec<f64>,
    /// States and parameters of the first equilibrium.
    pub first: Vec<f64>,
    /// Of the eigenvalues.
    pub rate: f64,
}

/// An operand of `abs`, of order one, is zero where it is no larger: an equilibrium is known to about 1e-13.
pub(super) const AT_KINK: f64 = 1e-9;

/// What all equilibria of a branch have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibriumSetting {
    /// The system.
    pub system: System,
    /// Values of its parameters, that of the branch at its beginning.
    pub values: Vec<f64>,
    /// Index of the parameter of the branch.
    pub parameter: usize,
    /// Units.
    pub scales: EquilibriumScales,
}

/// Why the equations of an equilibrium cannot be evaluated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum EquilibriumFailure {
    /// A rate, a guard or a derivative has no finite value.
    #[error(
        "the rates or guards of the mode `{mode}` have no finite value or derivative there, as at a kink of `abs`, `min` or `max`"
    )]
    NoValue {
        /// Name of the mode.
        mode: String,
    },
    /// A motion does not come to a saddle on the way on which it did.
    #[error(
        "the equilibrium of `{mode}` is no saddle with as many growing directions, or what leaves it does not return on the \
         way on which it did"
    )]
    NoConnection {
        /// Name of the mode of the saddle that is left.
        mode: String,
    },
}

/// The equilibria of one mode.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibriumCurve {
    /// What all modes have in common.
    pub setting: Arc<EquilibriumSetting>,
    pub(super) signature: RestMode,
    pub(super) lifted: Arc<AffineSystem>,
    /// Index and value of the other parameter of a plane, which is lifted too and stays as it is.
    pub(super) beside: Option<(usize, f64)>,
    /// The same with the monitors in this mode, where there are any.
    pub(super) observed: Option<Arc<MonitoredSystem>>,
    /// Factors that make rates, the forms of surfaces and guards of order one at the first equilibrium.
    pub(super) rates: Vec<f64>,
    pub(super) surfaces: Vec<f64>,
    pub(super) guards: Vec<f64>,
}

/// The factor that makes a function of order one, by its changes over the units of its argument; where these are nothing beside its
/// order, as those of a rate may be at a branch point, it is of that order.
fn factor(linear: &Linear, units: &[f64], order: f64) -> f64 {
    /// Changes that are a smaller part of its order are nothing.
    const NOTHING: f64 = 1e-9;
    let terms = linear.by.iter().zip(units);
    let changes: f64 = terms.map(|(by, unit)| (by * unit).abs()).sum();
    let size = if changes > NOTHING * order {
        changes
    } else {
        order
    };
    match size.is_normal() {
        true => 1.0 / size,
        false => 1.0,
    }
}

impl EquilibriumCurve {
    /// The equilibria of a mode; `None` where the system makes no sense, or has no such mode.
    pub fn new(setting: EquilibriumSetting, mode: usize) -> Option<EquilibriumCurve> {
        let fits = setting.scales.units.len() == setting.system.source.states.len() + 1
            && setting.scales.first.len() == setting.scales.units.len()
            && setting.values.len() == setting.system.source.parameters.0.len()
            && setting.parameter < setting.values.len();
        let usable = |unit: &f64| unit.is_finite() && *unit > 0.0;
        let sensible = fits
            && setting.scales.units.iter().all(usable)
            && usable(&setting.scales.rate)
            && setting.scales.first.iter().all(|x| x.is_finite());
        if !sensible {
            return None;
        }
        let lifted = lifted(&setting.system, &setting.values, &[setting.parameter]).ok()?;
        let curve = EquilibriumCurve::of(Arc::new(setting), Arc::new(lifted), (mode, None));
        curve.map(EquilibriumCurve::observing)
    }

    /// The equilibria of another mode.
    pub(super) fn in_mode(&self, mode: usize) -> Option<EquilibriumCurve> {
        let (setting, lifted) = (self.setting.clone(), self.lifted.clone());
        let curve = EquilibriumCurve::of(setting, lifted, (mode, self.beside));
        curve.map(EquilibriumCurve::observing)
    }

    /// The same with the monitors of the system.
    pub(super) fn observing(self) -> EquilibriumCurve {
        let EquilibriumSetting {
            system,
            values,
            parameter,
            ..
        } = &*self.setting;
        if system.monitors().is_empty() {
            return self;
        }
        let followed = std::iter::once(*parameter).chain(self.beside.map(|(index, _)| index));
        let followed: Vec<usize> = followed.collect();
        let observed = observed(system, values, &followed, self.signature.mode).ok();
        EquilibriumCurve {
            observed: observed.map(Arc::new),
            ..self
        }
    }

    pub(super) fn of(
        setting: Arc<EquilibriumSetting>,
        lifted: Arc<AffineSystem>,
        (mode, beside): (usize, Option<(usize, f64)>),
    ) -> Option<EquilibriumCurve> {
        let own = lifted.modes.get(mode)?;
        let name = setting.system.mode_name(mode).into_owned();
        let EquilibriumScales { units, first, .. } = &setting.scales;
        let states = setting.system.source.states.len();
        let beyond = beside.iter().map(|(_, value)| value);
        let place: Vec<f64> = first.iter().chain(beyond).copied().collect();
        let at = LocalField {
            lifted: &lifted,
            mode,
            states,
            variables: units.len(),
            place: &place,
            signs: &[],
        };
        let at = at.linearised();
        let all = |list: Option<&Vec<Linear>>, orders: &[f64]| match list {
            Some(list) => {
                let pairs = list.iter().zip(orders);
                pairs
                    .map(|(linear, order)| factor(linear, units, *order))
                    .collect()
            }
            // there the mode has no values: elsewhere it is as it is
            None => vec![1.0; orders.len()],
        };
        let orders = units[..states].iter();
        let orders: Vec<f64> = orders.map(|unit| unit * setting.scales.rate).collect();
        let unknown = |count: usize| vec![0.0; count];
        Some(EquilibriumCurve {
            signature: RestMode {
                mode,
                name,
                signs: Vec::new(),
            },
            rates: all(at.as_ref().map(|at| &at.rates), &orders),
            surfaces: all(
                at.as_ref().map(|at| &at.surfaces),
                &unknown(own.surfaces().count()),
            ),
            guards: all(at.as_ref().map(|at| &at.guards), &unknown(own.guards.len())),
            lifted,
            beside,
            observed: None,
            setting,
        })
    }

    /// Number of states.
    pub(super) fn states(&self) -> usize {
        self.setting.system.source.states.len()
    }

    /// Number of parameters among the unknowns.
    pub(super) fn parameters(&self) -> usize {
        self.setting.scales.units.len() - self.states()
    }

    /// States and parameters at scaled unknowns, those last that stay as they are.
    pub fn place(&self, point: &Vector) -> Vec<f64> {
        let units = self.setting.scales.units.iter();
        let scaled = point.iter().zip(units).map(|(x, unit)| x * unit);
        scaled.chain(self.beside.map(|(_, value)| value)).collect()
    }

    /// The states at scaled unknowns.
    pub fn state(&self, point: &Vector) -> Vec<f64> {
        let mut place = self.place(point);
        place.truncate(self.states());
        place
    }

    /// Scaled unknowns of these states at this value of the parameter.
    pub fn pack(&self, state: &[f64], value: f64) -> Vector {
        let place = state.iter().copied().chain([value]);
        let scaled = place
            .zip(&self.setting.scales.units)
            .map(|(x, unit)| x / unit);
        Vector::from_iterator(self.states() + 1, scaled)
    }

    /// Values of all parameters at scaled unknowns.
    pub fn values_at(&self, point: &Vector) -> Vec<f64> {
        let mut values = self.setting.values.clone();
        let own = (self.setting.parameter, self.place(point)[self.states()]);
        for (index, known) in std::iter::once(own).chain(self.beside) {
            if let Some(value) = values.get_mut(index) {
                *value = known;
            }
        }
        values
    }

    pub(super) fn local<'a>(&'a self, place: &'a [f64]) -> LocalField<'a> {
        LocalField {
            lifted: &self.lifted,
            mode: self.signature.mode,
            states: self.states(),
            variables: self.setting.scales.units.len(),
            place,
            signs: &self.signature.signs,
        }
    }

    /// The same equilibria on the side of all kinks of their rates on which a point is.
    pub fn on_side_of(mut self, point: &Vector) -> EquilibriumCurve {
        if !self.lifted.program.has_kinks() {
            return self;
        }
        self.signature.signs = Vec::new();
        let Ok(at) = self.linearised(point) else {
            return self;
        };
        let mut signs = vec![0.0; self.lifted.program.made()];
        for (step, operand) in &at.kinks {
            let value = self.scaled_operand(operand).value;
            // one that is zero on all equilibria has no side
            if value.abs() > AT_KINK {
                signs[*step] = value.signum();
            }
        }
        self.signature.signs = signs;
        self
    }

    /// An operand of `abs`, scaled to order one.
    pub(super) fn scaled_operand(&self, operand: &Linear) -> Linear {
        let units = &self.setting.scales.units;
        operand.scaled(units, factor(operand, units, 0.0))
    }

    /// The same beyond the kink of this number among those of the mode.
    pub(super) fn beyond_kink(&self, kink: usize) -> Option<EquilibriumCurve> {
        let field = &self.lifted.modes[self.signature.mode].field;
        let (step, _) = field.kinks().nth(kink)?;
        let mut beyond = self.clone();
        *beyond.signature.signs.get_mut(step)? *= -1.0;
        Some(beyond)
    }

    /// The functions of the mode at scaled unknowns.
    pub(super) fn linearised(&self, point: &Vector) -> Result<Linearised, EquilibriumFailure> {
        let place = self.place(point);
        let found = self.local(&place).linearised();
        found.ok_or_else(|| self.no_value())
    }

    pub(super) fn no_value(&self) -> EquilibriumFailure {
        EquilibriumFailure::NoValue {
            mode: self.signature.name.clone(),
        }
    }

    /// The equations in their order, each with its factor.
    pub(super) fn equations(&self, at: &Linearised) -> Vec<(Of, f64)> {
        let units = Vector::from_column_slice(&self.setting.scales.units[..self.states()]);
        let factor = |of: Of| match of {
            Of::Rate(state) => self.rates[state],
            Of::Surface(form) => self.surfaces[form],
        };
        let equations = at.equations(&units).into_iter();
        equations.map(|of| (of, factor(of))).collect()
    }

    /// Values of the equations and their derivatives in the scaled unknowns.
    pub(super) fn rows(&self, at: &Linearised) -> Vec<Linear> {
        let units = &self.setting.scales.units;
        let rows = self.equations(at).into_iter();
        rows.map(|(of, factor)| at.function(of).scaled(units, factor))
            .collect()
    }

    /// The equations that are followed, and their derivatives in the scaled unknowns.
    pub(super) fn followed(&self, at: &Linearised, place: &[f64]) -> Vec<Linear> {
        let mode = &self.lifted.modes[self.signature.mode];
        let sides = mode
            .sides
            .filter(|_| mode.surface.is_some() && mode.held.is_empty());
        let between = sides.and_then(|sides| self.between(sides, at, place));
        between.unwrap_or_else(|| self.rows(at))
    }

    /// Those of an equilibrium of sliding between two modes; `None` where their fields are the same, or have no value.
    fn between(&self, sides: [usize; 2], at: &Linearised, place: &[f64]) -> Option<Vec<Linear>> {
        let field = |mode: usize| {
            let local = LocalField {
                mode,
                ..self.local(place)
            };
            local.rates()
        };
        let [first, second] = sides.map(field);
        let (first, second) = (first?, second?);
        let pairs = first.iter().zip(&second);
        let apart: Vec<Linear> = pairs.map(|(one, other)| one.plus(-1.0, other)).collect();
        let size = |state: &usize| (apart[*state].value * self.rates[*state]).abs();
        let widest = (0..apart.len()).max_by(|one, other| size(one).total_cmp(&size(other)))?;
        let divisor = apart[widest].value;
        if divisor == 0.0 {
            return None;
        }
        let l = first[widest].value / divisor;
        let slope = first[widest].plus(-l, &apart[widest]).by / divisor;
        let units = &self.setting.scales.units;
        let rows = (0..apart.len()).map(|state| {
            if state == widest {
                // whichever state that is, the determinant of all rows has one sign
                let factor = self.surfaces[0].copysign(divisor);
                return at.surfaces[0].scaled(units, factor);
            }
            let mut row = first[state].plus(-l, &apart[state]);
            row.by -= &slope * apart[state].value;
            row.scaled(units, self.rates[state])
        });
        Some(rows.collect())
    }
}

impl Equations for EquilibriumCurve {
    type Failure = EquilibriumFailure;

    fn has_kinks(&self) -> bool {
        self.lifted.program.has_kinks() && self.signature.signs.is_empty()
    }

    fn unknowns(&self) -> usize {
        self.setting.scales.units.len()
    }

    fn evaluate(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), EquilibriumFailure> {
        let at = self.linearised(point)?;
        for (row, linear) in self.followed(&at, &self.place(point)).iter().enumerate() {
            residual[row] = linear.value;
            for (column, by) in linear.by.iter().enumerate() {
                jacobian[(row, column)] = *by;
            }
        }
        Ok(())
    }
}

/// Units in which an equilibrium is followed: the size of every state; of one that is zero, or next to nothing, what it
/// changes by over the range of the parameter; and of one that stays zero what makes the derivatives of the rates alike. Where all
/// states are rounding, none has a size: there the unit is how far rates are linear.
pub(super) fn scales(
    system: &System,
    values: &[f64],
    parameter: usize,
    (mode, state): (usize, &[f64]),
    width: f64,
) -> Option<EquilibriumScales> {
    /// A state that is smaller than this part of the others in balanced units is zero.
    const NOTHING: f64 = 1e-9;
    /// One that is smaller than this part of them has no unit of its own: what it is elsewhere may be of their order, as the current of a diode
    /// that begins to conduct.
    const SMALL: f64 = 1e-6;
    /// One that is smaller than this part of its change has that for its unit: beside a fold steps would be next to nothing, and so
    /// would be what the parameter changes by in them.
    const LITTLE: f64 = 1e-3;
    let lifted = lifted(system, values, &[parameter]).ok()?;
    let first: Vec<f64> = state.iter().copied().chain([values[parameter]]).collect();
    let field = LocalField {
        lifted: &lifted,
        mode,
        states: state.len(),
        variables: first.len(),
        place: &first,
        signs: &[],
    };
    let signs = field.on_side(1.0);
    let (field, at) = field.or_on_side(&signs)?;
    let slopes = at.slopes();
    let n = state.len();
    let rate = rate_unit(&slopes);
    let (balanced, _) = balance(&slopes, rate);
    let change = change(&field, &at, &balanced, width);
    let size = |index: usize| {
        let (x, change) = (state[index].abs(), change[index].abs());
        if x > LITTLE * change { x } else { change }
    };
    let largest = (0..n).fold(0.0, |most: f64, index| {
        most.max(size(index) / balanced[index])
    });
    let linear = linear_within(&field, &balanced, rate);
    let linear = linear.filter(|linear| largest < NOTHING * linear);
    let all_rounding = linear.filter(|_| is_zero_but_for_rounding(&field, &at, &balanced));
    let known = if largest.is_normal() { largest } else { 1.0 };
    let largest = all_rounding.unwrap_or(known);
    let sized = |index: usize| {
        let least = SMALL * largest * balanced[index];
        all_rounding.is_none() && size(index) > least
    };
    let unit = |index: usize| match sized(index) {
        true => size(index),
        false => largest * balanced[index],
    };
    let units: Vec<f64> = (0..n).map(unit).collect();
    // where it would change the rates of others by as much as they change themselves
    let counts = |index: usize| {
        let others = (0..n).filter(|other| *other != index && sized(*other));
        let sizes = others.map(|other| rate * units[other] / slopes[(other, index)].abs());
        sizes.fold(f64::INFINITY, f64::min)
    };
    // balanced with what does next to nothing to it, it has a unit that means nothing to them
    let unit = |index: usize| match counts(index) {
        most if most.is_finite() && units[index] < SMALL * most => most,
        _ => units[index],
    };
    Some(EquilibriumScales {
        units: (0..n).map(unit).chain([width]).collect(),
        rate,
        first,
    })
}

/// What the states change by over a range of the parameter, where equations bend: of the linear change of each the part s with
/// s + qs² = 1, q the part of the change that second derivatives make of all of it. Beside a fold that is next to nothing.
fn change(field: &LocalField, at: &Linearised, units: &Vector, width: f64) -> Vector {
    let n = field.states;
    let equations = at.equations(units);
    let by = |row: usize, variable: usize| at.function(equations[row]).by[variable];
    let slopes = Matrix::from_fn(n, n, by);
    let by_parameter = Vector::from_fn(n, |row, _| -by(row, n) * width);
    let change = solve(&slopes, &by_parameter).unwrap_or_else(|| Vector::zeros(n));
    let along = change.clone().resize_vertically(n + 1, 0.0);
    let bends = field.second(&equations, &along, std::slice::from_ref(&along));
    let bends = Vector::from_fn(n, |row, _| 0.5 * bends[(row, 0)]);
    let Some(bends) = solve(&slopes, &bends) else {
        return change;
    };
    change.zip_map(&bends, |change, bend| {
        let part = (bend / change).abs();
        match part.is_finite() {
            true => change * 2.0 / (1.0 + (1.0 + 4.0 * part).sqrt()),
            false => change,
        }
    })
}

/// Whether the states are zero but for rounding: where they are, the rates are zero and linear, too. A function that has come to its end,
/// as tanh 40, may look linear as far as one likes from a place that is not next to zero.
fn is_zero_but_for_rounding(field: &LocalField, at: &Linearised, units: &Vector) -> bool {
    /// What part of the slopes of rates changes over what is rounding.
    const CHANGED: f64 = 1e-6;
    let n = field.states;
    let mut place = field.place.to_vec();
    place[..n].fill(0.0);
    let origin = LocalField {
        place: &place,
        ..*field
    };
    let slopes = |one: &Linear| one.by.rows(0, n).component_mul(units);
    origin.linearised().is_some_and(|origin| {
        let mut pairs = origin.rates.iter().zip(&at.rates);
        pairs.all(|(there, here)| {
            let changed = slopes(there) - slopes(here);
            there.is_rounding() && changed.amax() <= CHANGED * slopes(here).amax()
        })
    })
}

/// How far from a place rates are linear, in these units of the states: where their second or third derivatives make as much of a
/// change of state as the first. `None` where they have none.
fn linear_within(field: &LocalField, units: &Vector, rate: f64) -> Option<f64> {
    let n = field.states;
    let functions: Vec<Of> = (0..n).map(Of::Rate).collect();
    let along =
        |index: usize| Vector::from_fn(n + 1, |i, _| if i == index { units[i] } else { 0.0 });
    let along: Vec<Vector> = (0..n).map(along).collect();
    let size = |row: usize, derivative: f64| (derivative / (units[row] * rate)).abs();
    let mut least = f64::INFINITY;
    for one in &along {
        let second = field.second(&functions, one, &along);
        for (column, other) in along.iter().enumerate() {
            let third = field.third([one, one, other]);
            for row in 0..n {
                let by = [
                    size(row, second[(row, column)]).recip(),
                    size(row, third[row]).sqrt().recip(),
                ];
                // a kink has no derivatives
                least = by.into_iter().fold(least, f64::min);
            }
        }
    }
    least.is_normal().then_some(least)
}

/// The geometric mean of the sizes of all eigenvalues that are not zero to rounding, or next to nothing beside others: a unit of rates.
fn rate_unit(slopes: &Matrix) -> f64 {
    /// Part of the largest below which one is that, as at a branch point.
    const NOTHING: f64 = 1e-12;
    let known = known_eigenvalues(slopes).unwrap_or_default();
    let sizes = known.iter().map(|one| one.value.norm());
    let least = NOTHING * sizes.fold(0.0, f64::max);
    let told = known
        .iter()
        .filter(|one| one.value.norm() > one.error.max(least));
    let logs: Vec<f64> = told.map(|one| one.value.norm().ln()).collect();
    let mean = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
    if mean.is_normal() { mean } else { 1.0 }
}
