//! A system at given values of its parameters: every mode a linear flow ż = Mz of z = (x, 1, cos φ, sin φ,
//! cos 2φ, …), with φ̇ = ω. Exact at resonance and for a singular matrix, where a particular solution is not.
//!
//! What is not affine adds components to z that are made of the others, so that rates, guards and resets are linear
//! in z all the same; how these move is not, and [`super::series`] has it.

use std::fmt;
use std::ops::Index;
use std::sync::{Arc, OnceLock};

use super::contact::mistake::ContactMistake;
use super::dual::Dual;
use super::program::Program;
pub use super::rows::{MatrixBy, Row};
use super::series::Field;
use super::slots::Slots;
use super::surfaces::Surfaces;
use crate::linalg::Vector;

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
    /// Where sliding or a contact ends by its own condition: the guard of `to` that is zero there, and of how many orders.
    pub tangent: Option<(usize, usize)>,
    /// The name of the switch.
    pub name: Option<String>,
    /// Whether a contact makes it, and has given it that name.
    pub of_contact: bool,
    /// Why no motion takes it where its conditions hold.
    pub refusal: Option<ContactMistake>,
    /// Whether its guard keeps its value within the mode: one that is zero ends nothing.
    pub keeps: bool,
}

impl Exit {
    /// Its name in the file: that which a contact gives its own switches says what its states say.
    pub fn own_name(&self) -> Option<&str> {
        self.name.as_deref().filter(|_| !self.of_contact)
    }

    /// Whether no state jumps.
    pub fn is_continuous(&self) -> bool {
        self.reset.at.is_identity(0.0)
    }
}

/// What is positive in a mode, and where the mode leads when it is zero no more: the first exit whose conditions hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Guard {
    /// As a linear form of z.
    pub row: Row,
    /// Exits in the order of the file; none where the two modes of a sliding mode lead to different places.
    pub exits: Vec<Exit>,
    /// The mode and the switch of the file whose `zero` it is; `None` for the conditions of sliding.
    pub written: Option<[usize; 2]>,
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
    /// What is zero all along in a sliding mode between two others.
    pub surface: Option<Row>,
    /// What contacts hold at zero all along.
    pub held: Vec<Row>,
    /// Bounds of friction that slips, where they are no constants, each with the number of the guard that is its slip.
    pub bounds: Vec<(usize, Row)>,
    /// The modes on the two sides of the surface of a sliding mode: the first where its form is positive.
    pub sides: Option<[usize; 2]>,
    /// How the components of z move that are not those of states and phase.
    pub field: Field,
    /// Why the forces of its contacts make no motion, if they do not: then it has no guard.
    pub obstruction: Option<ContactMistake>,
    /// Whether every entry is affine in the parameter along which the system is led, if it is.
    pub leads: bool,
}

impl AffineMode {
    /// Every form that is zero all along in it.
    pub fn surfaces(&self) -> impl Iterator<Item = &Row> {
        self.surface.iter().chain(&self.held)
    }

    /// The derivatives of a form in the components of z.
    fn gradient(&self, row: &Row, z: &Vector) -> Vector {
        match self.field.is_exact {
            true => row.at.clone(),
            false => self.field.series(z, 0, true, true).jet(row, 0).1,
        }
    }

    /// Whether it leads to the same places by as many guards, exits and conditions as another.
    pub(super) fn has_shape_of(&self, other: &AffineMode) -> bool {
        let kind = |exit: &Exit| {
            let refused = exit.refusal.is_some();
            (
                exit.to,
                exit.rest,
                exit.tangent,
                exit.conditions.len(),
                refused,
            )
        };
        let guard = |(one, other): (&Guard, &Guard)| {
            one.written == other.written
                && one.exits.iter().map(kind).eq(other.exits.iter().map(kind))
        };
        self.obstruction == other.obstruction
            && self.held.len() == other.held.len()
            && self.bounds.len() == other.bounds.len()
            && self.guards.len() == other.guards.len()
            && self.guards.iter().zip(&other.guards).all(guard)
    }

    /// Leads it to a value of the parameter in which the same mode, `origin`, is affine, from any other value; that is it where
    /// the parameter is zero. False where an entry that changes is zero by chance, or not finite.
    pub(super) fn lead(&mut self, origin: &AffineMode, value: f64) -> bool {
        let mut regular = self.matrix.lead(&origin.matrix, value);
        for (guard, known) in self.guards.iter_mut().zip(&origin.guards) {
            regular &= guard.row.lead(&known.row, value);
            for (exit, known) in guard.exits.iter_mut().zip(&known.exits) {
                regular &= exit.reset.lead(&known.reset, value);
                for (row, known) in exit.conditions.iter_mut().zip(&known.conditions) {
                    regular &= row.lead(known, value);
                }
            }
        }
        for (row, known) in self.held.iter_mut().zip(&origin.held) {
            regular &= row.lead(known, value);
        }
        for ((_, row), (_, known)) in self.bounds.iter_mut().zip(&origin.bounds) {
            regular &= row.lead(known, value);
        }
        regular
    }
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
    pub modes: Modes,
    /// What z has beyond states and phase.
    pub program: Arc<Program>,
    /// Numbers of its contacts that make no sense where they are negative.
    pub signs: Vec<Dual>,
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

    /// The sizes of the terms of which the rates of the states are made at a place, summed up: where they cancel, a rate has their
    /// rounding.
    pub(super) fn terms_of_rates(&self, mode: usize, state: &[f64], phase: f64) -> Vec<f64> {
        let AffineMode { field, matrix, .. } = &self.modes[mode];
        let sizes = field.sizes(&self.lift(mode, state, phase));
        let of_rate = |rate: usize| {
            let terms = sizes.iter().enumerate();
            terms
                .map(|(of, size)| matrix.at[(rate, of)].abs() * size)
                .sum()
        };
        (0..self.states).map(of_rate).collect()
    }

    /// The surfaces of a mode through a state at a phase, in these units of the states.
    pub(super) fn surfaces(
        &self,
        mode: usize,
        state: &[f64],
        phase: f64,
        units: &Vector,
    ) -> Surfaces {
        let own = &self.modes[mode];
        if own.surfaces().next().is_none() {
            return Surfaces::default();
        }
        let z = self.lift(mode, state, phase);
        let gradients: Vec<Vector> = own
            .surfaces()
            .map(|row| own.gradient(row, &z).rows(0, self.states).clone_owned())
            .collect();
        Surfaces::new(&gradients, units)
    }

    /// Moves z of a sliding mode back onto its surface, from which rounding and the truncation of series lead it away:
    /// along the state of which its form has most. What is further off than they lead is left where it is.
    pub fn correct(&self, mode: usize, z: &mut Vector) {
        /// Part of the terms of the form: a start may have this distance from its surface by its decimals.
        const NEAR: f64 = 1e-9;
        let own = &self.modes[mode];
        let AffineMode { surface, field, .. } = own;
        let Some(surface) = surface else { return };
        let gradient = own.gradient(surface, z);
        let size = |state: &usize| gradient[*state].abs();
        let most = (0..self.states).max_by(|one, other| size(one).total_cmp(&size(other)));
        let (off, terms) = (surface.value(z), surface.size(z));
        if let Some(state) = most.filter(|_| off != 0.0 && off.abs() <= NEAR * terms) {
            let step = off / gradient[state];
            if step.is_finite() {
                z[state] -= step;
                field.complete(z);
            }
        }
    }

    /// Length of z.
    pub fn size(&self) -> usize {
        self.program.size()
    }
}

/// Makes a mode of its number.
type Make = Box<dyn Fn(usize) -> AffineMode + Send + Sync>;

/// Makes all modes anew at a value of the parameter that a system is led along.
pub(super) type Anew = Arc<dyn Fn(f64) -> Option<Modes> + Send + Sync>;

/// The modes of a system at given parameters.
#[derive(Clone)]
pub struct Modes(Kind);

#[derive(Clone)]
enum Kind {
    Written(Vec<AffineMode>),
    Made(Arc<Made>),
}

struct Made {
    count: usize,
    make: Make,
    slots: Slots<AffineMode>,
}

impl Made {
    fn mode(&self, number: usize) -> &AffineMode {
        self.slots.get_or_make(number, || (self.make)(number))
    }
}

impl Modes {
    /// All of them.
    pub(super) fn of(modes: Vec<AffineMode>) -> Modes {
        Modes(Kind::Written(modes))
    }

    /// So many, which are made when they are asked for.
    pub(super) fn made(count: usize, make: Make) -> Modes {
        let slots = Slots::new(count);
        Modes(Kind::Made(Arc::new(Made { count, make, slots })))
    }

    /// The same, of which those that are made when they are asked for lead only where they have the shape of others: where the
    /// parameter is zero by chance, a mode may lead elsewhere than at other values.
    pub(super) fn shaped_as(self, others: &Modes) -> Modes {
        let Kind::Made(own) = &self.0 else {
            return self;
        };
        let (own, others) = (own.clone(), others.clone());
        Modes::made(
            own.count,
            Box::new(move |number| {
                let mut mode = own.mode(number).clone();
                mode.leads &= mode.has_shape_of(&others[number]);
                mode
            }),
        )
    }

    /// Leads all of them to a value of the parameter in which those of the origin are affine, those that are made when they are
    /// asked for one by one: `anew` makes what cannot be led. False where that is one of those that are laid out.
    pub(super) fn lead(&mut self, origin: &Modes, value: f64, anew: &Anew) -> bool {
        let (own, known) = match (&mut self.0, &origin.0) {
            (Kind::Made(own), Kind::Made(known)) => (own, known.clone()),
            (Kind::Written(modes), Kind::Written(known)) => {
                let mut modes = modes.iter_mut().zip(known);
                return modes.all(|(mode, known)| mode.lead(known, value));
            }
            _ => return false,
        };
        let (of, anew, other) = (known.clone(), anew.clone(), OnceLock::new());
        let make = Box::new(move |number: usize| {
            let origin = of.mode(number);
            let mut mode = origin.clone();
            if origin.leads && origin.obstruction.is_none() && mode.lead(origin, value) {
                return mode;
            }
            let other: &Option<Modes> = other.get_or_init(|| anew(value));
            if let Some(other) = other {
                mode = other[number].clone();
            }
            mode.leads = false;
            mode
        });
        match Arc::get_mut(own) {
            Some(own) => {
                own.make = make;
                own.slots
                    .retain(|number, mode| mode.leads && mode.lead(known.mode(number), value));
            }
            None => *self = Modes::made(known.count, make),
        }
        true
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match &self.0 {
            Kind::Written(modes) => modes.len(),
            Kind::Made(made) => made.count,
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The mode of a number, if there is one.
    pub fn get(&self, index: usize) -> Option<&AffineMode> {
        (index < self.len()).then(|| &self[index])
    }

    /// Whether the flow of every mode is exact: modes that are made when they are asked for are all alike.
    pub fn are_exact(&self) -> bool {
        match &self.0 {
            Kind::Written(modes) => modes.iter().all(|mode| mode.field.is_exact),
            Kind::Made(_) => self[0].field.is_exact,
        }
    }

    /// Those that are laid out from the beginning.
    pub fn written(&self) -> &[AffineMode] {
        match &self.0 {
            Kind::Written(modes) => modes,
            Kind::Made(_) => &[],
        }
    }

    /// See [`Modes::written`]; none can be added to others.
    pub(super) fn written_mut(&mut self) -> &mut Vec<AffineMode> {
        if let Kind::Made(_) = self.0 {
            self.0 = Kind::Written(Vec::new());
        }
        match &mut self.0 {
            Kind::Written(modes) => modes,
            Kind::Made(_) => unreachable!("it has been replaced"),
        }
    }
}

impl Index<usize> for Modes {
    type Output = AffineMode;

    fn index(&self, index: usize) -> &AffineMode {
        match &self.0 {
            Kind::Written(modes) => &modes[index],
            Kind::Made(made) => made.mode(index),
        }
    }
}

impl PartialEq for Modes {
    fn eq(&self, other: &Modes) -> bool {
        match (&self.0, &other.0) {
            (Kind::Written(one), Kind::Written(other)) => one == other,
            (Kind::Made(one), Kind::Made(other)) => Arc::ptr_eq(one, other),
            _ => false,
        }
    }
}

impl fmt::Debug for Modes {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Kind::Written(modes) => modes.fmt(formatter),
            Kind::Made(made) => write!(
                formatter,
                "{} modes, made when they are asked for",
                made.count
            ),
        }
    }
}
