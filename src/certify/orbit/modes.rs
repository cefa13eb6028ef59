//! A system as linear flows of z = (x, 1, cos φ, sin φ, …), with coefficients of any kind.

use std::collections::BTreeMap;
use std::ops::Index;

use super::OpenOrbit;
use super::exact::NamePolynomial;
use super::products::{Needed, ProductModes};
use crate::affine::algebra::{Algebra, Operation};
use crate::affine::dual::Coefficient;
use crate::affine::evaluation::{Evaluation, FormMode, FormSwitch};
use crate::affine::form::Form;
use crate::affine::system::{System, SystemError};
use crate::interval::Interval;

/// A linear form of z.
pub type Row<C> = Vec<C>;

/// A way for a mode to end.
#[derive(Clone, Debug)]
pub struct IntervalExit<C> {
    pub to: usize,
    /// New states as forms of z.
    pub reset: Vec<Row<C>>,
    /// What is not negative where it is taken.
    pub conditions: Vec<Row<C>>,
    /// The name of the switch in the file.
    pub name: Option<String>,
}

/// What is positive in a mode, and where it leads when it is zero no more.
#[derive(Clone, Debug)]
pub struct IntervalGuard<C> {
    pub row: Row<C>,
    pub exits: Vec<IntervalExit<C>>,
}

/// A mode: ż = Mz.
#[derive(Clone, Debug)]
pub struct IntervalMode<C> {
    pub matrix: Vec<Row<C>>,
    pub guards: Vec<IntervalGuard<C>>,
    /// What does not change, by the making of the mode: the form of its surface, a slip that a contact holds.
    pub kept: Vec<Row<C>>,
}

/// Modes by their numbers: of those that contacts make there are few.
#[derive(Clone, Debug, Default)]
pub struct Numbered<C>(BTreeMap<usize, IntervalMode<C>>);

impl<C> Numbered<C> {
    /// The mode of a number, if it is there.
    pub fn get(&self, number: usize) -> Option<&IntervalMode<C>> {
        self.0.get(&number)
    }
}

impl<C> Index<usize> for Numbered<C> {
    type Output = IntervalMode<C>;

    fn index(&self, number: usize) -> &IntervalMode<C> {
        &self.0[&number]
    }
}

/// Modes of the file, then the sliding ones; or some of those that contacts make.
#[derive(Clone, Debug)]
pub struct IntervalModes<C> {
    pub states: usize,
    pub harmonics: usize,
    pub omega: C,
    pub modes: Numbered<C>,
}

/// The direction that F₊ − F₋ keeps.
#[derive(Clone, Copy, Debug)]
enum JumpDirection {
    /// That of one state.
    State(usize),
    /// F₊ − F₋ itself, which depends on neither states nor phase.
    Constant,
}

/// What is known of a system whatever its parameters.
#[derive(Clone, Debug)]
pub struct Structure {
    /// Of every switch of a mode, the guard that it belongs to.
    guards: Vec<Vec<usize>>,
    slides: Vec<IntervalSliding>,
    /// The modes that contacts make, in the place of those of the file.
    products: Option<ProductModes>,
}

/// What is known of a sliding mode whatever the parameters.
#[derive(Clone, Debug)]
struct IntervalSliding {
    direction: JumpDirection,
    /// The guards of the modes on its sides, each with its mode, that are not its surface.
    watched: Vec<[usize; 2]>,
}

/// a + weight·b.
pub fn added<C: Coefficient>(one: &[C], other: &[C], weight: &C) -> Row<C> {
    let both = one.iter().zip(other);
    both.map(|(a, b)| match *b == C::default() {
        true => a.clone(),
        false => a.clone().sum(1.0, weight.clone().times(b.clone()), 1.0),
    })
    .collect()
}

/// −a.
pub fn negative<C: Coefficient>(row: &[C]) -> Row<C> {
    row.iter().cloned().map(C::negative).collect()
}

/// Σ aᵢMᵢ: ȧ along a flow, or what a form is after a reset.
pub fn through<C: Coefficient>(row: &[C], matrix: &[Row<C>]) -> Row<C> {
    let size = matrix.first().map_or(0, Vec::len);
    let terms = row.iter().zip(matrix).filter(|(a, _)| **a != C::default());
    terms.fold(vec![C::default(); size], |sum, (a, row)| {
        added(&sum, row, a)
    })
}

/// A number over another.
fn over<C: Coefficient>(one: C, other: C) -> Result<C, OpenOrbit> {
    one.operate(Operation::Over, other)
        .map_err(|_| OpenOrbit::Numbers)
}

impl<C: Coefficient> IntervalMode<C> {
    /// The derivative of this order of a form.
    pub fn derivative(&self, row: &[C], order: usize) -> Row<C> {
        (0..order).fold(row.to_vec(), |row, _| through(&row, &self.matrix))
    }

    /// The one guard that leads to a mode, or to the other by sliding.
    fn guard_to(&self, to: usize) -> Option<usize> {
        let leads = |guard: &IntervalGuard<C>| guard.exits.iter().any(|exit| exit.to == to);
        let mut found = (0..self.guards.len()).filter(|index| leads(&self.guards[*index]));
        let first = found.next();
        first.filter(|_| found.next().is_none())
    }
}

/// The frequency of the forcing and the modes of a system as forms, with these coefficients.
fn evaluated<C: Coefficient>(
    system: &System,
    products: Option<&ProductModes>,
    parameter: &dyn Fn(usize) -> C,
    pi: C,
) -> Result<(C, Vec<FormMode<C>>), OpenOrbit> {
    let forms = || {
        let evaluation = Evaluation::new(system, parameter, pi.clone())?;
        let modes = match products {
            Some(_) => Vec::new(),
            None => evaluation.modes()?,
        };
        Ok((evaluation.frequency()?, modes))
    };
    let forms = forms().map_err(|error: SystemError| OpenOrbit::System(error.path));
    let (omega, modes) = forms?;
    let Some(products) = products else {
        return Ok((omega, modes));
    };
    let meaning = |name: &str| match name {
        "pi" => Some(pi.clone()),
        _ => system.source.parameters.index(name).map(parameter),
    };
    Ok((omega, products.values(&meaning)?))
}

impl<C: Coefficient> IntervalModes<C> {
    fn of(
        (omega, forms): &(C, Vec<FormMode<C>>),
        system: &System,
        structure: &Structure,
    ) -> Result<IntervalModes<C>, OpenOrbit> {
        let states = system.source.states.len();
        let harmonics = forms.iter().flat_map(FormMode::forms).map(Form::highest);
        let mut modes = IntervalModes {
            states,
            harmonics: harmonics.max().unwrap_or(0),
            omega: omega.clone(),
            modes: Numbered(BTreeMap::new()),
        };
        let numbers: Vec<usize> = match &structure.products {
            Some(products) => products.numbers().collect(),
            None => (0..forms.len()).collect(),
        };
        let written = forms.iter().zip(&structure.guards);
        for (number, (mode, guards)) in numbers.into_iter().zip(written) {
            let mode = modes.mode(mode, guards);
            modes.modes.0.insert(number, mode);
        }
        for (sides, sliding) in system.sliding.iter().zip(&structure.slides) {
            modes.slide(*sides, sliding)?;
        }
        Ok(modes)
    }

    /// What a sequence says of a switch at the end of a mode, by its guard and its exit: its name, where a mode of the same name goes
    /// on.
    pub fn label(&self, system: &System, mode: usize, [guard, exit]: [usize; 2]) -> Option<&str> {
        let exit = self.modes.get(mode)?.guards.get(guard)?.exits.get(exit)?;
        let says = system.mode_name(exit.to) == system.mode_name(mode);
        exit.name.as_deref().filter(|_| says)
    }

    /// Length of z.
    pub fn size(&self) -> usize {
        self.states + 1 + 2 * self.harmonics
    }

    fn row(&self, form: &Form<C>) -> Row<C> {
        let mut row = vec![C::default(); self.size()];
        row[..form.states.len()].clone_from_slice(&form.states);
        let harmonics = form.harmonics.iter().flatten();
        let after = [&form.constant].into_iter().chain(harmonics);
        for (place, value) in row[self.states..].iter_mut().zip(after) {
            *place = value.clone();
        }
        row
    }

    fn unit(&self, index: usize) -> Row<C> {
        let mut row = vec![C::default(); self.size()];
        row[index] = C::number(1.0);
        row
    }

    fn mode(&self, mode: &FormMode<C>, guards: &[usize]) -> IntervalMode<C> {
        let size = self.size();
        let mut matrix: Vec<Row<C>> = mode.rates.iter().map(|rate| self.row(rate)).collect();
        matrix.resize(size, vec![C::default(); size]);
        for h in 1..=self.harmonics {
            let cosine = self.states + 2 * h - 1;
            let turn = C::default().sum(1.0, self.omega.clone(), h as f64);
            matrix[cosine][cosine + 1] = turn.clone().negative();
            matrix[cosine + 1][cosine] = turn;
        }
        let mut found: Vec<IntervalGuard<C>> = Vec::new();
        for (switch, guard) in mode.switches.iter().zip(guards) {
            let exit = self.exit(switch);
            match found.get_mut(*guard) {
                Some(guard) => guard.exits.push(exit),
                None => found.push(IntervalGuard {
                    row: self.row(&switch.guard),
                    exits: vec![exit],
                }),
            }
        }
        IntervalMode {
            matrix,
            guards: found,
            kept: mode.held.iter().map(|form| self.row(form)).collect(),
        }
    }

    fn exit(&self, switch: &FormSwitch<C>) -> IntervalExit<C> {
        let mut reset: Vec<Row<C>> = (0..self.states).map(|state| self.unit(state)).collect();
        for (state, form) in &switch.reset {
            reset[*state] = self.row(form);
        }
        IntervalExit {
            to: switch.to,
            reset,
            conditions: switch
                .conditions
                .iter()
                .map(|form| self.row(form))
                .collect(),
            // contacts name every switch of theirs
            name: switch.name.clone().filter(|_| switch.group.is_none()),
        }
    }

    /// Puts a sliding mode between two: Filippov's field F₋ − d (nᵀF₋)/(nᵀd), where n is the gradient of the guard
    /// of the first mode. It lasts while both fields point at the surface and the other guards of both modes are
    /// positive; where one of these ends it is not covered.
    fn slide(&mut self, sides: [usize; 2], sliding: &IntervalSliding) -> Result<(), OpenOrbit> {
        let own = self.modes.0.len();
        let [first, second] = sides.map(|side| &self.modes[side]);
        let leave = [first.guard_to(sides[1]), second.guard_to(sides[0])];
        let [Some(leave_first), Some(leave_second)] = leave else {
            return Err(OpenOrbit::Sliding);
        };
        let surface = first.guards[leave_first].row.clone();
        let [toward, away] = [first, second].map(|mode| through(&surface, &mode.matrix));
        let along: Vec<C> = (0..self.states)
            .map(|state| match sliding.direction {
                JumpDirection::State(only) => C::number(f64::from(u8::from(state == only))),
                JumpDirection::Constant => {
                    let [below, above] =
                        [first, second].map(|mode| mode.matrix[state][self.states].clone());
                    above.sum(1.0, below, -1.0)
                }
            })
            .collect();
        let terms = surface.iter().zip(&along);
        let across = terms.fold(C::default(), |sum, (n, d)| {
            sum.sum(1.0, n.clone().times(d.clone()), 1.0)
        });
        let mut matrix = first.matrix.clone();
        for (row, d) in matrix.iter_mut().zip(along) {
            if d != C::default() {
                *row = added(row, &toward, &over(d, across.clone())?.negative());
            }
        }
        let stay: Vec<Row<C>> = (0..self.states).map(|state| self.unit(state)).collect();
        let exit = |to: usize, conditions: Vec<Row<C>>| IntervalExit {
            to,
            reset: stay.clone(),
            conditions,
            name: None,
        };
        let guard = |row: &Row<C>, to: usize| IntervalGuard {
            row: row.clone(),
            exits: vec![exit(to, Vec::new())],
        };
        let ends = negative(&toward);
        let own_conditions = [guard(&ends, sides[0]), guard(&away, sides[1])];
        let watched = sliding.watched.iter().map(|[mode, guard]| IntervalGuard {
            row: self.modes[*mode].guards[*guard].row.clone(),
            exits: Vec::new(),
        });
        let guards = own_conditions.into_iter().chain(watched).collect();
        // at the surface: the sliding mode where the other field points back, the other mode where not
        let [slide_first, slide_second] = [away, ends].map(|held| exit(own, vec![held]));
        self.side(sides[0])?.guards[leave_first]
            .exits
            .insert(0, slide_first);
        self.side(sides[1])?.guards[leave_second]
            .exits
            .insert(0, slide_second);
        let mode = IntervalMode {
            matrix,
            guards,
            kept: vec![surface],
        };
        self.modes.0.insert(own, mode);
        Ok(())
    }

    /// A mode on one side of a surface.
    fn side(&mut self, number: usize) -> Result<&mut IntervalMode<C>, OpenOrbit> {
        self.modes.0.get_mut(&number).ok_or(OpenOrbit::Sliding)
    }
}

impl Structure {
    /// What is known of a system whatever its parameters, and its modes as formulas.
    ///
    /// # Errors
    /// Two modes between which sliding is not covered.
    pub fn of(
        system: &System,
        needed: &Needed,
    ) -> Result<(Structure, IntervalModes<NamePolynomial>), OpenOrbit> {
        if let Some(products) = ProductModes::of(system, needed)? {
            return Structure::of_products(system, products);
        }
        let names: Vec<&str> = system.source.parameters.names().collect();
        let named = |index: usize| NamePolynomial::named(names[index].to_owned());
        let forms = evaluated(system, None, &named, NamePolynomial::named("pi".to_owned()))?;
        let mut structure = Structure {
            guards: forms.1.iter().map(FormMode::guards).collect(),
            slides: Vec::new(),
            products: None,
        };
        for [first, second] in &system.sliding {
            let modes = IntervalModes::of(&forms, system, &structure)?;
            structure.slides.push(IntervalSliding {
                direction: modes.direction(*first, *second)?,
                watched: modes.watched([*first, *second]),
            });
        }
        let modes = IntervalModes::of(&forms, system, &structure)?;
        Ok((structure, modes))
    }

    /// The same of modes that contacts make.
    fn of_products(
        system: &System,
        products: ProductModes,
    ) -> Result<(Structure, IntervalModes<NamePolynomial>), OpenOrbit> {
        let names: Vec<&str> = system.source.parameters.names().collect();
        let named = |index: usize| NamePolynomial::named(names[index].to_owned());
        let pi = NamePolynomial::named("pi".to_owned());
        let frequency = || Evaluation::new(system, &named, pi)?.frequency();
        let omega = frequency().map_err(|error: SystemError| OpenOrbit::System(error.path))?;
        let forms = (omega, products.exact());
        let structure = Structure {
            guards: products.guards.clone(),
            slides: Vec::new(),
            products: Some(products),
        };
        let modes = IntervalModes::of(&forms, system, &structure)?;
        Ok((structure, modes))
    }

    /// Whether it is known over an interval of the parameter.
    pub fn covers(&self, parameter: Interval) -> bool {
        let products = self.products.as_ref();
        products.is_none_or(|products| parameter.within(products.range))
    }

    /// The modes with other coefficients of the parameters.
    ///
    /// # Errors
    /// A number that is not finite.
    pub fn modes<C: Coefficient>(
        &self,
        system: &System,
        parameter: &dyn Fn(usize) -> C,
        pi: C,
    ) -> Result<IntervalModes<C>, OpenOrbit> {
        let forms = evaluated(system, self.products.as_ref(), parameter, pi)?;
        IntervalModes::of(&forms, system, self)
    }
}

impl IntervalModes<NamePolynomial> {
    /// The guards of two modes that are not the surface in which they meet, each form once.
    fn watched(&self, sides: [usize; 2]) -> Vec<[usize; 2]> {
        let row = |[mode, guard]: [usize; 2]| &self.modes[mode].guards[guard].row;
        let surface = self.modes[sides[0]].guard_to(sides[1]);
        let surface = surface.map(|guard| row([sides[0], guard]));
        let is_multiple = |one: &Row<NamePolynomial>, other: &Row<NamePolynomial>| {
            let pivot = other.iter().position(|entry| !entry.is_zero());
            pivot.is_some_and(|pivot| {
                let minus = one[pivot].clone().negative();
                let scaled = vec![NamePolynomial::default(); one.len()];
                let own = added(&scaled, one, &other[pivot]);
                added(&own, other, &minus)
                    .iter()
                    .all(NamePolynomial::is_zero)
            })
        };
        let mut found: Vec<[usize; 2]> = Vec::new();
        for mode in sides {
            for guard in 0..self.modes[mode].guards.len() {
                let own = row([mode, guard]);
                let is_surface = surface.is_some_and(|surface| is_multiple(own, surface));
                if !is_surface && !found.iter().any(|known| row(*known) == own) {
                    found.push([mode, guard]);
                }
            }
        }
        found
    }

    fn direction(&self, first: usize, second: usize) -> Result<JumpDirection, OpenOrbit> {
        let [below, above] = [first, second].map(|side| &self.modes[side]);
        let guards = below.guard_to(second).zip(above.guard_to(first));
        let (one, other) = guards.ok_or(OpenOrbit::Sliding)?;
        let both = below.guards[one].row.iter().zip(&above.guards[other].row);
        let mut sums = both.map(|(a, b)| a.clone().sum(1.0, b.clone(), 1.0));
        if !sums.all(|sum| sum.is_zero()) {
            return Err(OpenOrbit::Sliding);
        }
        let minus = <NamePolynomial as Algebra>::number(-1.0);
        let difference: Vec<Row<NamePolynomial>> = (0..self.states)
            .map(|state| added(&above.matrix[state], &below.matrix[state], &minus))
            .collect();
        let moves = |row: &Row<NamePolynomial>| row.iter().any(|entry| !entry.is_zero());
        let mut moving = (0..self.states).filter(|state| moves(&difference[*state]));
        match (moving.next(), moving.next()) {
            (Some(only), None) => return Ok(JumpDirection::State(only)),
            (None, _) => return Err(OpenOrbit::Sliding),
            _ => {}
        }
        let constant = |row: &Row<NamePolynomial>| {
            let mut entries = row.iter().enumerate();
            entries.all(|(column, entry)| column == self.states || entry.is_zero())
        };
        match difference.iter().all(constant) {
            true => Ok(JumpDirection::Constant),
            false => Err(OpenOrbit::Sliding),
        }
    }
}
