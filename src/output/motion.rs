//! The folder of a motion of a system of one's own: its samples, its switches, its section.
//!
//! Rows are appended as they are found. A motion is computed again from its beginning where it was interrupted, and
//! ends in the same files.

use super::layout::{self, SECTION, SERIES, SWITCHES};
use super::origin::ProblemOrigin;
use super::render::Format;
use super::store::{GrowingFile, Store, StoreError};
use crate::affine::course::Seen;
use crate::affine::motion::Moment;
use crate::affine::system::System;
use crate::problem::SystemProblem;
use crate::table::{line_of, number};

/// The folder of a motion being written.
#[derive(Debug)]
pub(crate) struct MotionFolder<'a> {
    system: &'a System,
    series: GrowingFile,
    switches: GrowingFile,
    /// With a forcing only.
    section: Option<GrowingFile>,
    /// Switches written.
    pub switched: usize,
    /// Section samples written.
    sections: usize,
}

impl<'a> MotionFolder<'a> {
    /// Begins a folder, in place of what an earlier motion left there.
    ///
    /// # Errors
    /// When something else is in the way, or the system refuses.
    pub(crate) fn create(
        store: &Store,
        problem: &'a SystemProblem,
    ) -> Result<MotionFolder<'a>, StoreError> {
        let system = &problem.system;
        let forced = system.source.forcing.is_some();
        let mut names = vec![SERIES, SWITCHES, ProblemOrigin::<SystemProblem>::FILE];
        names.extend(forced.then_some(SECTION));
        let pictures = layout::OF_MOTION.map(|name| layout::picture(name, Format::Svg));
        store.begin(&names, pictures.to_vec(), None)?;
        ProblemOrigin::keep(store, problem)?;
        let states = &system.source.states;
        let of_states =
            |ending: &'static str| states.iter().map(move |state| format!("{state}{ending}"));
        let header = |first: &[&str], rest: Vec<String>| {
            let first = first.iter().map(|name| (*name).to_owned());
            line_of(&first.chain(rest).collect::<Vec<_>>())
        };
        let mut values: Vec<String> = of_states("").collect();
        values.push("mode".to_owned());
        let sides = of_states("_before").chain(of_states("_after")).collect();
        let table = |name: &str, header: String| store.table(name, &header, None);
        Ok(MotionFolder {
            system,
            series: table(SERIES, header(&["time", "phase"], values.clone()))?,
            switches: table(SWITCHES, header(&["time", "from", "to"], sides))?,
            section: forced
                .then(|| table(SECTION, header(&["sample", "time"], values)))
                .transpose()?,
            switched: 0,
            sections: 0,
        })
    }

    /// Adds what was seen.
    ///
    /// # Errors
    /// When the system refuses.
    pub(crate) fn write(&mut self, seen: &Seen) -> Result<(), StoreError> {
        let mode = |mode: usize| self.system.mode_name(mode).into_owned();
        let numbers = |values: &[f64]| values.iter().copied().map(number).collect::<Vec<_>>();
        let row = |first: Vec<String>, place: &Moment| {
            line_of(&[first, numbers(&place.state), vec![mode(place.mode)]].concat())
        };
        match seen {
            Seen::Sample(place) => {
                let phase = place.phase.rem_euclid(std::f64::consts::TAU);
                let line = row(numbers(&[place.time, phase]), place);
                self.series.push(line.as_bytes())
            }
            Seen::Section(place) => {
                let Some(section) = &mut self.section else {
                    return Ok(());
                };
                let first = vec![self.sections.to_string(), number(place.time)];
                self.sections += 1;
                section.push(row(first, place).as_bytes())
            }
            Seen::Switch(switching) => {
                let names = [switching.from, switching.to].map(mode);
                // between two modes of one name a contact changes nothing: a damped spring that parts is open, before its gap is and
                // after it
                let moves = switching.of_contact && switching.from != switching.to;
                if moves && names[0] == names[1] {
                    return Ok(());
                }
                self.switched += 1;
                let line = line_of(
                    &[
                        vec![number(switching.time)],
                        names.to_vec(),
                        numbers(&switching.before),
                        numbers(&switching.after),
                    ]
                    .concat(),
                );
                self.switches.push(line.as_bytes())
            }
        }
    }
}
