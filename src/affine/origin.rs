//! Systems that are led along a parameter: where every expression is affine in it, the entries of modes at zero and their
//! slopes say all other ones.

use std::fmt;
use std::sync::Arc;

use super::dual::{Degree, Dual};
use super::mode::{AffineSystem, Anew};
use super::system::System;
use crate::linalg::Vector;

/// A system where a parameter is zero, from which other values are led to.
pub struct Origin {
    system: AffineSystem,
    anew: Anew,
}

impl fmt::Debug for Origin {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.system.fmt(formatter)
    }
}

impl System {
    /// The system where one parameter is zero, whatever that does to the forcing, if all of it is affine in that parameter; modes
    /// that contacts make may be so one by one.
    pub fn origin(&self, values: &[f64], parameter: usize) -> Option<Origin> {
        if self.integrated {
            return None;
        }
        let mut zero = values.to_vec();
        zero[parameter] = 0.0;
        let led = Dual::led(&zero, parameter);
        let mut system = self.evaluated_by(&led, (&[], &[])).ok()?.system;
        let affine = |number: &Dual| number.degree <= Degree::Affine;
        if !system.signs.iter().chain([&system.omega]).all(affine) || system.program.made() > 0 {
            return None;
        }
        // a sliding field is affine, too, where the surface stays and with it the difference of the fields on its sides
        let stays = |by: &Vector| by.iter().all(|by| *by == 0.0);
        let written = || system.modes.written().iter();
        let surfaces = written().filter_map(|mode| mode.surface.as_ref());
        let flat = surfaces.flat_map(|row| &row.by).all(stays);
        let alike = self.sliding.iter().all(|sides| {
            let [below, above] =
                sides.map(|side| system.modes[side].matrix.by[0].rows(0, system.states));
            below == above
        });
        // and where what they take over from the modes on their sides is no product of what changes
        let sliding = written().filter(|mode| mode.sides.is_some());
        let exits = sliding.flat_map(|mode| mode.guards.iter().flat_map(|guard| &guard.exits));
        let plain = exits
            .flat_map(|exit| &exit.reset.by)
            .all(|by| by.iter().all(|by| *by == 0.0));
        if !(flat && alike && plain && written().all(|mode| mode.leads)) {
            return None;
        }
        let anew: Anew = match self.products {
            None => Arc::new(|_| None),
            Some(_) => {
                let here = self.at(values, &[parameter]).ok()?;
                system.modes = system.modes.shaped_as(&here.modes);
                let (own, values) = (self.clone(), values.to_vec());
                Arc::new(move |value| {
                    let mut values = values.clone();
                    values[parameter] = value;
                    let system = own.at(&values, &[parameter]);
                    system.ok().map(|system| system.modes)
                })
            }
        };
        Some(Origin { system, anew })
    }
}

impl Origin {
    /// The system at a value of the parameter; `None` where it makes no sense there, or an entry that changes is zero by
    /// chance.
    pub fn at(&self, value: f64) -> Option<AffineSystem> {
        let mut system = self.system.clone();
        self.lead(&mut system, value).then_some(system)
    }

    /// Leads the system from one value to another; false where [`Origin::at`] has none.
    pub fn lead(&self, system: &mut AffineSystem, value: f64) -> bool {
        let Origin {
            system: origin,
            anew,
        } = self;
        system.omega.value = origin.omega.value + value * origin.omega.by[0];
        let turns = origin.omega == Dual::default() || system.omega.value > 0.0;
        let mut signs = origin.signs.iter();
        let holds = signs.all(|sign| sign.by[0] == 0.0 || sign.value + value * sign.by[0] > 0.0);
        turns && holds && system.modes.lead(&origin.modes, value, anew)
    }
}
