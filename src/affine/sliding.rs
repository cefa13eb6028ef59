//! Sliding modes between two modes that meet in a surface, after Filippov.
//!
//! On the surface h = 0 the motion follows the combination of both fields that stays in it. It lasts while both fields
//! point at the surface, and it ends, too, where another guard of one of the two modes is zero: as that mode would.

use super::algebra::{Algebra, Obstacle, Operation};
use super::dual::{Coefficient, Dual, Measured};
use super::evaluation::{FormMode, FormSwitch};
use super::form::Form;
use super::mode::{AffineMode, AffineSystem, Exit, Guard};
use super::rows::{MatrixBy, Row};
use super::series::Field;
use super::system::{Mistake, System, SystemError};
use crate::linalg::{Matrix, Vector, balance};

/// A sliding mode whose field is not affine.
#[derive(Clone, Debug)]
pub(super) struct SlidingForms {
    /// Filippov's field F₋ + λ(F₊ − F₋), λ = Lġ₋/(Lġ₋ − Lġ₊).
    pub rates: Vec<Form>,
    /// The rates of the guard of the first mode along both fields.
    pub falls: [Form; 2],
}

/// The same in components of z.
pub(super) struct SlidingField {
    /// The rates.
    pub matrix: MatrixBy,
    /// The rates of the guard of the first mode along both fields.
    pub falls: [Row; 2],
}

impl SlidingForms {
    /// The field between two modes with these numbers.
    ///
    /// # Errors
    /// The difference of the fields has no value.
    pub fn new(
        first: &FormMode,
        second: &FormMode,
        sides: [usize; 2],
        omega: Dual,
    ) -> Result<SlidingForms, Obstacle> {
        let leads = |switch: &&FormSwitch, to: usize| switch.to == to;
        let mut back = second.switches.iter().filter(|one| leads(one, sides[0]));
        let back: Vec<&Form> = back.by_ref().map(|switch| &switch.guard).collect();
        let is_opposite = |guard: &Form| {
            let sum = |back: &&Form| guard.clone().operate(Operation::Plus, (*back).clone());
            back.iter()
                .any(|back| sum(back).is_ok_and(|sum| sum.is_zero()))
        };
        let guards = || {
            let switches = first.switches.iter().filter(|one| leads(one, sides[1]));
            switches.map(|switch| &switch.guard)
        };
        let guard = guards().find(|guard| is_opposite(guard));
        let guard = guard
            .or_else(|| guards().next())
            .cloned()
            .unwrap_or_default();
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

/// Relative size of what two rows may differ by where they are the same for the mathematics, in [`AffineSystem::units_of_z`]:
/// coefficients are made from the same numbers in different order.
const SAME: f64 = 1e-12;

/// The largest entry of a row, in units of z.
fn largest(row: &Vector, units: &Vector) -> f64 {
    row.component_mul(units).amax()
}

impl AffineSystem {
    /// Units of z in which what acts back on what acts on it is alike in size, over all modes: in these rounding is told, whatever
    /// units the file has.
    fn units_of_z(&self) -> Vector {
        let nothing = Matrix::zeros(self.size(), self.size());
        let written = self.modes.written().iter();
        let all = written.fold(nothing, |sum, mode| sum + mode.matrix.at.abs());
        balance(&all, 0.0).0
    }

    /// The difference of two fields. Of friction that is zero at one value of a parameter only the direction counts, which is that
    /// nearby.
    fn difference(&self, below: &MatrixBy, above: &MatrixBy) -> Option<MatrixBy> {
        let difference = MatrixBy {
            at: &above.at - &below.at,
            by: [0, 1].map(|p| &above.by[p] - &below.by[p]),
        };
        if difference.at.amax() != 0.0 {
            return Some(difference);
        }
        let at = difference.by.into_iter().find(|by| by.amax() > 0.0)?;
        Some(MatrixBy {
            at,
            ..MatrixBy::zero(self.size(), self.size())
        })
    }

    /// The field of a sliding mode and the rates of its surface along both fields, where the difference of these keeps
    /// its direction and the surface is flat.
    fn sliding_field(&self, sides: [usize; 2], surface: &Row) -> Option<SlidingField> {
        // ∂/∂t of the surface's form along both fields
        let [toward, away] = self.rates_in(surface, sides)?;
        let [below, above] = sides.map(|side| &self.modes[side].matrix);
        let difference = self.difference(below, above)?;
        // the largest row of F₊ − F₋; the others are multiples of it
        let rows = 0..self.states;
        let units = self.units_of_z();
        let main = rows.max_by(|one, other| {
            let size =
                |row: usize| largest(&difference.at.row(row).transpose(), &units) / units[row];
            size(*one).total_cmp(&size(*other))
        });
        let main = main.unwrap_or(0);
        let reference = difference.at.row(main).transpose();
        let pivot = reference.component_mul(&units).iamax();
        let scale = reference[pivot];
        let mut direction = Row::zero(self.states);
        for state in 0..self.states {
            let row = difference.row(state);
            let ratio = row.at[pivot] / scale;
            let left = &row.at - &reference * ratio;
            let [below, above] = [below, above].map(|side| side.at.row(state).transpose());
            let size = largest(&below, &units).max(largest(&above, &units));
            let parallel = largest(&left, &units) <= SAME * size;
            if scale == 0.0 || !parallel {
                return None;
            }
            let by = [0, 1]
                .map(|p| (row.by[p][pivot] - ratio * difference.by[p][(main, pivot)]) / scale);
            direction.set(state, Dual::new(ratio, by));
        }
        let normal = surface.at.rows(0, self.states);
        let across = normal.dot(&direction.at);
        if across.abs() <= SAME * normal.abs().dot(&direction.at.abs()) {
            return None;
        }
        let across_by = [0, 1].map(|p| {
            surface.by[p].rows(0, self.states).dot(&direction.at) + normal.dot(&direction.by[p])
        });
        let across = Dual::new(across, across_by);
        let mut matrix = below.clone();
        for state in 0..self.states {
            let weight = direction.dual(state).over(across);
            let mut row = below.row(state);
            for column in 0..self.size() {
                // what rounding leaves of a rate that cancels would act on all that follows from it
                let held = weight.times(toward.dual(column)).negative();
                row.set(column, row.dual(column).cancelled(held));
            }
            matrix.set_row(state, &row);
        }
        Some(SlidingField {
            matrix,
            falls: [toward, away],
        })
    }

    /// Puts the sliding mode with this index between two modes: Filippov's field F₋ − d (nᵀF₋)/(nᵀd) where
    /// F₊ − F₋ keeps the direction d and n is the gradient of the guard of the first mode. It lasts while both
    /// fields point at the surface, and each of the two modes crosses into the other where one does not. Where the
    /// direction changes or the surface is curved `numerical` has the field, and the rates of the guard along both.
    pub(super) fn slide(
        &mut self,
        system: &System,
        own: usize,
        sides: [usize; 2],
        numerical: Option<SlidingField>,
    ) -> Result<(), (SystemError, Option<usize>)> {
        let names = sides.map(|side| system.mode_name(side).into_owned());
        let path = format!("sliding.{}", system.mode_name(own));
        let index = own - system.modes.len();
        let refuse = |mistake: fn(String, String) -> Mistake, index: Option<usize>| {
            let [one, other] = names.clone();
            Err((SystemError::at(path.clone(), mistake(one, other)), index))
        };
        let [first, second] = sides;
        let Some([leave_first, leave_second]) = self.meeting(first, second) else {
            return refuse(Mistake::NoSurface, None);
        };
        let surface = self.modes[first].guards[leave_first].row.clone();
        let field = numerical.or_else(|| self.sliding_field(sides, &surface));
        let Some(SlidingField { matrix, falls }) = field else {
            return refuse(Mistake::NoSliding, Some(index));
        };
        let [toward, away] = falls;
        let stay = MatrixBy {
            at: Matrix::identity(self.states, self.size()),
            ..MatrixBy::zero(self.states, self.size())
        };
        let exit = |to: usize, conditions: Vec<Row>, tangent: Option<(usize, usize)>| Exit {
            to,
            reset: stay.clone(),
            conditions,
            rest: None,
            tangent,
            name: None,
            of_contact: false,
            refusal: None,
            keeps: false,
        };
        let released = |row: Row, to: usize, guard: usize| Guard {
            row,
            exits: vec![exit(to, Vec::new(), Some((guard, 2)))],
            written: None,
        };
        let guards = vec![
            released(toward.negative(), first, leave_first),
            released(away.clone(), second, leave_second),
        ];
        // at the surface: the sliding mode where the other field points back, the other mode where not
        let slides = [away, toward.negative()];
        for ((from, guard), held) in [(first, leave_first), (second, leave_second)]
            .into_iter()
            .zip(slides)
        {
            let exits = &mut self.modes.written_mut()[from].guards[guard].exits;
            let name = exits.first().and_then(|exit| exit.name.clone());
            let slides = exit(own, vec![held], None);
            exits.insert(0, Exit { name, ..slides });
        }
        let leads = sides.iter().all(|side| self.modes[*side].leads);
        self.modes.written_mut().push(AffineMode {
            states: self.states,
            matrix,
            guards,
            surface: Some(surface),
            held: Vec::new(),
            bounds: Vec::new(),
            sides: Some(sides),
            field: Field::default(),
            obstruction: None,
            leads,
        });
        Ok(())
    }

    /// Whether a guard leads from one mode to another in which its negative leads back, and its rate is the same in both:
    /// between them nothing slides but where that rate is zero, too.
    pub(super) fn is_of_second_order(&self, from: usize, guard: usize, to: usize) -> bool {
        let row = &self.modes[from].guards[guard].row;
        let meets = self
            .meeting(from, to)
            .is_some_and(|[leave, _]| leave == guard);
        let units = self.units_of_z();
        let alike = |[own, other]: [Row; 2]| is_nothing(&difference(&own, &other), &own, &units);
        meets && from != to && self.rates_in(row, [from, to]).is_some_and(alike)
    }

    /// The guards of two modes that lead from one to the other and are the same but for their sign: the one pair of them.
    fn meeting(&self, first: usize, second: usize) -> Option<[usize; 2]> {
        let leading = |from: usize, to: usize| {
            let guards = self.modes[from].guards.iter().enumerate();
            guards.filter(move |(_, guard)| guard.exits.iter().any(|exit| exit.to == to))
        };
        let units = &self.units_of_z();
        let mut pairs = leading(first, second).flat_map(|(leave, guard)| {
            let own = &guard.row.at;
            let opposite = leading(second, first).filter(move |(_, back)| {
                let size = largest(own, units);
                size > 0.0 && largest(&(own + &back.row.at), units) <= SAME * size
            });
            opposite.map(move |(back, _)| [leave, back])
        });
        let pair = pairs.next();
        pair.filter(|_| pairs.next().is_none())
    }

    /// Lets a sliding mode end, too, where another guard of one of its two modes is zero: as that mode would, with its
    /// reset. Where both modes have the guard and lead to two modes that meet in a surface themselves, what lies there
    /// follows: see [`AffineSystem::arrivals`].
    pub(super) fn watch_sides(&mut self, own: usize) {
        let AffineMode { surface, sides, .. } = &self.modes[own];
        let Some((surface, sides)) = surface.clone().zip(*sides) else {
            return;
        };
        let units = self.units_of_z();
        // those of the file only: whether the motion slides beyond is decided beyond
        let is_written = |exit: &Exit| self.modes[exit.to].sides.is_none();
        let guards = |side: usize| -> Vec<Guard> {
            let guards = self.modes[side].guards.iter();
            let elsewhere = guards.filter(|guard| ratio(&guard.row, &surface, &units).is_none());
            let bare = elsewhere.map(|guard| Guard {
                exits: guard
                    .exits
                    .iter()
                    .filter(|exit| is_written(exit))
                    .cloned()
                    .collect(),
                ..guard.clone()
            });
            bare.collect()
        };
        let [first, mut second] = sides.map(guards);
        let mut watched = Vec::new();
        for guard in first {
            let own = reduced(&guard.row, &surface, &units);
            let same = |other: &Guard| {
                let factor = ratio(&reduced(&other.row, &surface, &units), &own, &units);
                factor.is_some_and(|factor| factor > 0.0)
            };
            let twin = second
                .iter()
                .position(same)
                .map(|index| second.remove(index));
            let exits = self.exits_of_both(&surface, &guard, twin.as_ref());
            watched.push(Guard { exits, ..guard });
        }
        for guard in second {
            let exits = self.exits_of_both(&surface, &guard, None);
            watched.push(Guard { exits, ..guard });
        }
        self.modes.written_mut()[own].guards.extend(watched);
    }

    /// Where sliding along a surface leads at a guard, which the mode on the other side has, too, or not. Nowhere where the
    /// two modes jump differently, or by different conditions.
    fn exits_of_both(&self, surface: &Row, guard: &Guard, twin: Option<&Guard>) -> Vec<Exit> {
        let Guard { row, exits, .. } = guard;
        let Some(Guard { exits: others, .. }) = twin else {
            let arrivals = exits
                .iter()
                .flat_map(|exit| self.arrivals(surface, (row, exit), exit.to));
            return arrivals.collect();
        };
        let units = self.units_of_z();
        let on_surface = |one: &Row, other: &Row| {
            let [one, other] = [one, other].map(|row| reduced(row, surface, &units));
            is_nothing(&difference(&one, &other), &one, &units)
        };
        let alike = |(one, other): (&Exit, &Exit)| {
            let mut resets = (0..self.states).map(|row| (one.reset.row(row), other.reset.row(row)));
            let mut conditions = one.conditions.iter().zip(&other.conditions);
            one.rest == other.rest
                && one.conditions.len() == other.conditions.len()
                && resets.all(|(one, other)| on_surface(&one, &other))
                && conditions.all(|(one, other)| on_surface(one, other))
        };
        let mut pairs = exits.iter().zip(others);
        if exits.len() != others.len() || !pairs.all(alike) {
            return Vec::new();
        }
        let pairs = exits.iter().zip(others);
        pairs
            .flat_map(|(one, other)| self.arrivals(surface, (row, one), other.to))
            .collect()
    }

    /// The exits from sliding along a surface that stand for one of a mode on its side, where that on the other side
    /// leads to `other`, which may be the same.
    ///
    /// Where the two modes beyond meet in a surface h = 0 of their own, h > 0 in the first of them, the state after the
    /// reset decides: the mode of its sign, or, on that surface, the one to which both fields point, or the sliding mode
    /// where both point at it. Where both point away it is that one which leaves the guard as well, where the other comes back to it;
    /// no field decides where both leave it.
    fn arrivals(&self, surface: &Row, (met, exit): (&Row, &Exit), other: usize) -> Vec<Exit> {
        let [one, other] = [exit.to, other];
        let is_continuous = exit.is_continuous();
        let units = self.units_of_z();
        let after = |row: &Row| self.before_reset(row, &exit.reset);
        let sliding = || {
            let modes = self.modes.written().iter().enumerate();
            modes.filter_map(|(number, mode)| Some((number, mode, mode.sides?)))
        };
        let exit = |to: usize, more: Vec<Row>| {
            let conditions = exit.conditions.iter().cloned().chain(more).collect();
            Exit {
                to,
                conditions,
                ..exit.clone()
            }
        };
        let lands_on = |row: &Row| {
            let row = after(row)?;
            Some(is_nothing(&reduced(&row, surface, &units), &row, &units))
        };
        let joins = |sides: [usize; 2]| match one == other {
            true => sides.contains(&one),
            false => sides == [one, other] || sides == [other, one],
        };
        let beyond = sliding().find(|(_, mode, sides)| {
            let lands = || mode.surface.as_ref().and_then(lands_on) == Some(true);
            joins(*sides) && (one != other || lands())
        });
        let (slides, sides, row, falls) = match beyond {
            Some((number, mode, sides)) => {
                let Some(row) = mode.surface.clone() else {
                    return Vec::new();
                };
                // its own conditions come first
                let falls = [mode.guards[0].row.negative(), mode.guards[1].row.clone()];
                (Some(number), sides, row, falls)
            }
            None if one == other => return vec![exit(one, Vec::new())],
            None => {
                let Some((row, falls)) = self.surface_between(one, other) else {
                    return Vec::new();
                };
                (None, [one, other], row, falls)
            }
        };
        let exits = || {
            let [first, second] = sides;
            let row = after(&row)?;
            if !is_nothing(&reduced(&row, surface, &units), &row, &units) {
                let below = row.negative();
                return Some(vec![exit(first, vec![row]), exit(second, vec![below])]);
            }
            let [toward, away] = [after(&falls[0])?, after(&falls[1])?];
            let [not_toward, not_away] = [toward.negative(), away.negative()];
            let slides = slides.map(|to| exit(to, vec![not_toward.clone(), away.clone()]));
            let leaving = self.leaving(met, sides).filter(|_| is_continuous);
            let parts = leaving.into_iter().flatten().zip(sides);
            let parts = parts.map(|(leaves, to)| {
                let apart = [toward.clone(), not_away.clone()].into_iter();
                exit(to, apart.chain(leaves).collect())
            });
            let parts: Vec<Exit> = parts.collect();
            let crosses = [
                exit(first, vec![toward.clone(), away]),
                exit(second, vec![not_toward, not_away.clone()]),
            ];
            Some(slides.into_iter().chain(crosses).chain(parts).collect())
        };
        exits().unwrap_or_default()
    }

    /// The rates of a form in two modes; `None` where it has to do with what is made of others: its surface need not be flat.
    fn rates_in(&self, row: &Row, sides: [usize; 2]) -> Option<[Row; 2]> {
        let base = self.size() - self.program.made();
        let is_flat = (base..self.size()).all(|column| !row.has(column));
        is_flat.then(|| sides.map(|side| row.through(&self.modes[side].matrix)))
    }

    /// The flat surface in which two modes meet, and its rate in each of them.
    fn surface_between(&self, one: usize, other: usize) -> Option<(Row, [Row; 2])> {
        let [guard, _] = self.meeting(one, other)?;
        let row = &self.modes[one].guards[guard].row;
        Some((row.clone(), self.rates_in(row, [one, other])?))
    }

    /// What is positive where the first of two modes leaves a guard and the other comes back to it, and the other way round; `None` where
    /// the guard is curved.
    fn leaving(&self, guard: &Row, sides: [usize; 2]) -> Option<[[Row; 2]; 2]> {
        let [one, other] = self.rates_in(guard, sides)?;
        let [leaves, leaves_too] = [one.negative(), other.negative()];
        Some([[leaves, other], [leaves_too, one]])
    }

    /// The form before a reset whose value a form has after it; `None` where that is not linear in z.
    fn before_reset(&self, row: &Row, reset: &MatrixBy) -> Option<Row> {
        let changed: Vec<usize> = (0..self.states)
            .filter(|state| reset.row(*state) != Row::unit(self.size(), *state))
            .collect();
        let base = self.size() - self.program.made();
        let mut made = (base..self.size()).filter(|column| row.has(*column));
        if made.any(|column| self.program.depends(column, &changed)) {
            return None;
        }
        let mut before = row.clone();
        for state in &changed {
            before.set(*state, Dual::default());
        }
        for state in changed {
            before.subtract(row.dual(state).negative(), &reset.row(state));
        }
        Some(before)
    }
}

/// A form with what a surface makes of it taken away: they are the same where the form of the surface is zero.
fn reduced(row: &Row, surface: &Row, units: &Vector) -> Row {
    let mut row = row.clone();
    let pivot = surface.at.component_mul(units).iamax();
    let factor = row.dual(pivot).over(surface.dual(pivot));
    row.subtract(factor, surface);
    row
}

/// The form that is one minus another.
fn difference(one: &Row, other: &Row) -> Row {
    let mut row = one.clone();
    row.subtract(Dual::parameter(1.0, None), other);
    row
}

/// Whether a form is zero but for the rounding of one that it is made of.
fn is_nothing(row: &Row, of: &Row, units: &Vector) -> bool {
    let size = largest(&of.at, units);
    let sizes = of.by.iter().map(|by| largest(by, units));
    let of_slopes = sizes.fold(size, f64::max);
    let mut slopes = row.by.iter();
    largest(&row.at, units) <= SAME * size
        && slopes.all(|by| largest(by, units) <= SAME * of_slopes)
}

/// The number that one form is times another, if it is.
fn ratio(one: &Row, other: &Row, units: &Vector) -> Option<f64> {
    let pivot = other.at.component_mul(units).iamax();
    if other.at[pivot] == 0.0 {
        return None;
    }
    let factor = one.dual(pivot).over(other.dual(pivot));
    let mut left = one.clone();
    left.subtract(factor, other);
    is_nothing(&left, one, units).then_some(factor.value)
}
