//! What an orbit, and the beginning of a motion, must hold to.

use super::super::error::{Flaw, excerpt};
use super::super::explanation::known;
use super::super::rules::{Check, Checks};
use super::mistake::flaw_at;
use super::{BeginningSection, OrbitStart, SystemProblem};
use crate::affine::closure::{PERIOD, Prescribed};
use crate::affine::contact::place::Contradiction;
use crate::affine::system::{Ordered, Source};

/// Relative difference of a period that is given from the one that the forcing has: a number of few digits will
/// do, for the forcing has the others.
const SAME_PERIOD: f64 = 1e-2;

impl Checks<'_, SystemProblem> {
    pub(super) fn orbit(&self) -> Check {
        let orbit = &self.problem.orbit;
        let path = "orbit.start";
        if let Some(start) = orbit.start.beginning() {
            self.start(path, &start)?;
        }
        let forced = self.source().forcing.is_some();
        let rule = "without `forcing` an orbit has no other period than its own: leave it out";
        self.admit(
            "orbit.periods",
            orbit.periods,
            forced || orbit.periods == 1,
            rule,
        )?;
        self.prescribed()?;
        let OrbitStart::Given { period, .. } = &orbit.start else {
            return Ok(());
        };
        let system = self.problem.system.at(&self.problem.values(), &[]);
        let omega = system.map_or(0.0, |system| system.omega.value);
        match *period {
            None if !forced && orbit.period.is_none() => {
                let message =
                    "missing field `period` in `orbit.start`: without `forcing` it is not known";
                self.refuse(
                    "orbit.start.period",
                    message,
                    "add for example `period: 6.28`",
                )
            }
            Some(period) if forced => {
                let expected = orbit.periods as f64 * std::f64::consts::TAU / omega;
                let rule = format!(
                    "with `forcing` and `periods: {}` the period is {expected:?}; leave it out",
                    orbit.periods
                );
                let holds = (period / expected - 1.0).abs() <= SAME_PERIOD;
                self.admit("orbit.start.period", period, holds, &rule)
            }
            _ => Ok(()),
        }
    }

    /// Refuses a prescribed period that is none, or for which no parameter is free.
    fn prescribed(&self) -> Check {
        let orbit = &self.problem.orbit;
        let system = &self.problem.system;
        let (period, free) = match (&orbit.period, &orbit.free) {
            (None, None) => return Ok(()),
            (Some(period), Some(free)) => (period, free),
            (Some(_), None) => {
                let message = "missing field `free` in `orbit`: for a prescribed period one parameter is free";
                let help = "add for example `free: \"c\"`";
                return self.refuse("orbit.free", message, help);
            }
            (None, Some(_)) => {
                let message = "missing field `period` in `orbit`: a parameter is free for a prescribed period";
                let help = "add for example `period: \"2*pi/c\"`, or leave out `free`";
                return self.refuse("orbit.period", message, help);
            }
        };
        if system.source.forcing.is_some() {
            let message = "`orbit.period` prescribes a period, and `forcing` has one";
            return self.refuse("orbit.period", message, "leave out one of the two");
        }
        if matches!(orbit.start, OrbitStart::Switch { .. }) {
            let message =
                "the other branch at an event is one of orbits whose period is not prescribed";
            return self.refuse("orbit.start", message, "leave out `period` and `free`");
        }
        let names: Vec<&str> = self.source().parameters.names().collect();
        self.one_of("orbit.free", "parameter", free, &names)?;
        let source = self.source();
        let index = source.parameters.index(free).unwrap_or(0);
        let prescribed = Prescribed::new(source, period, index);
        let of_values = |prescribed: Prescribed| prescribed.period(&self.problem.values(), &[]);
        if let Err(error) = prescribed.and_then(of_values) {
            return Err(flaw_at(source, self.outline, PERIOD, &error));
        }
        let continued = self.problem.continuation.as_ref();
        let continued = continued.map(|section| section.parameter.as_str());
        let curve = self.problem.curve.as_ref();
        let curve = curve.map(|section| &section.parameters);
        let fixed = [
            ("continuation.parameter", continued),
            ("curve.parameters.0", curve.map(|(first, _)| first.as_str())),
            (
                "curve.parameters.1",
                curve.map(|(_, second)| second.as_str()),
            ),
        ];
        let rule = "that parameter is free for the prescribed period: take another one";
        for (path, name) in fixed {
            let taken = name == Some(free.as_str());
            self.admit(path, name.unwrap_or_default(), !taken, rule)?;
        }
        Ok(())
    }

    /// Refuses a beginning that names no mode, or not every state once, or a phase of nothing.
    pub(super) fn start(&self, path: &str, start: &BeginningSection) -> Check {
        let Source {
            states, forcing, ..
        } = self.source();
        let system = &self.problem.system;
        self.names_a_mode(&format!("{path}.mode"), &start.mode)?;
        let names: Vec<&str> = states.iter().map(String::as_str).collect();
        let home = format!("{path}.state");
        let Ordered(given) = &start.state;
        for (index, (name, _)) in given.iter().enumerate() {
            let twice = given[..index].iter().any(|(other, _)| other == name);
            let shown = excerpt(name);
            let wrong = if twice {
                let message = format!("`{shown}` is given twice in `{home}`");
                (message, "keep one of the two".to_owned())
            } else if !names.contains(&name.as_str()) {
                let message = format!("`{shown}` is no state{}", known(name, &names));
                (message, "name a state of `system`".to_owned())
            } else {
                continue;
            };
            let at = self.outline.key_of(&home, name);
            let at = at.unwrap_or_else(|| self.outline.locate(&home));
            return Err(Flaw::new(at, wrong.0, wrong.1));
        }
        let missing = |name: &&&str| start.state.index(name).is_none() && !system.is_stretch(name);
        if let Some(name) = names.iter().find(missing) {
            let message = format!("the state `{name}` is missing in `{home}`");
            let help = format!("add for example `\"{name}\": 0.0`");
            return self.refuse(&format!("{home}.{name}"), message, help);
        }
        let rule = "there is no `forcing` that it could be the phase of; leave it out";
        let holds = forcing.is_some() || start.phase == 0.0;
        self.admit(&format!("{path}.phase"), start.phase, holds, rule)?;
        self.fits(path, start)
    }

    /// Refuses a name that is none of a mode, of the file or made by contacts.
    pub(super) fn names_a_mode(&self, path: &str, name: &str) -> Check {
        let system = &self.problem.system;
        if system.products.is_none() {
            let names: Vec<&str> = system.mode_names().collect();
            return self.one_of(path, "mode", name, &names);
        }
        if system.mode(name).is_some() {
            return Ok(());
        }
        let contacts = self.source().contacts.0.iter();
        let of_contacts = contacts.map(|(name, law)| {
            let mut states = law.states().to_vec();
            states.dedup();
            format!("{} of `{name}`", states.join("/"))
        });
        let own = self.source().modes.names().collect::<Vec<_>>().join("/");
        let own = (!own.is_empty()).then(|| format!("{own} of `modes`"));
        let parts: Vec<String> = own.into_iter().chain(of_contacts).collect();
        let message = format!("`{}` is no mode of the contacts", excerpt(name));
        let help = format!(
            "join the states of the contacts by dots: {}",
            parts.join(", ")
        );
        self.refuse(path, message, help)
    }

    /// Refuses a mode whose contacts contradict the state.
    fn fits(&self, path: &str, start: &BeginningSection) -> Check {
        let system = &self.problem.system;
        let Ok(at) = system.at(&self.problem.values(), &[]) else {
            return Ok(());
        };
        let Some(place) = start.place(system, &at) else {
            return Ok(());
        };
        match system.admits(&at, &place) {
            Ok(()) => Ok(()),
            Err(Contradiction::Other { contact, fits }) => {
                let mode = excerpt(&start.mode);
                let message = format!("`{mode}` contradicts the state, by the contact `{contact}`");
                self.refuse(&format!("{path}.mode"), message, format!("write `{fits}`"))
            }
            Err(beyond @ Contradiction::Beyond { .. }) => {
                let help = "begin with a stretch that the element holds";
                self.refuse(&format!("{path}.state"), beyond.to_string(), help)
            }
            Err(behind @ Contradiction::Behind { .. }) => {
                let help = "begin where no gap of a `Stop` is negative";
                self.refuse(&format!("{path}.state"), behind.to_string(), help)
            }
        }
    }
}
