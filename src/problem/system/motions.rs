//! What maps and scans of a system must hold to: where many motions begin, and what is looked at of them.

use super::super::error::Flaw;
use super::super::map::{PARAMETER, STATE};
use super::super::rules::{Check, Checks, ORDER};
use super::super::scan::{MAX_SCANNED, MAX_VALUES};
use super::super::{SampleSection, Scan, ScanValues, Shares, Sweep, SystemMap};
use super::SystemProblem;
use super::mistake::flaw_at;
use crate::affine::system::Ordered;

impl Checks<'_, SystemProblem> {
    /// Refuses a map of a system that cannot be computed.
    pub(super) fn map(&self, section: &SystemMap) -> Check {
        let names: Vec<&str> = self.source().parameters.names().collect();
        let states: Vec<&str> = self.source().states.iter().map(String::as_str).collect();
        let basin = section.is_basin();
        for (side, axis) in [("first", &section.first), ("second", &section.second)] {
            let (path, range) = (format!("map.{side}.range"), axis.range);
            let (field, known) = match basin {
                true => (STATE, &states),
                false => (PARAMETER, &names),
            };
            if axis.state.is_some() != basin || axis.parameter.is_some() == basin {
                let message =
                    format!("`map.{side}` needs a `{field}`, and nothing else that changes");
                let help = "both sides are parameters, or both are states in which motions begin";
                return self.refuse(&format!("map.{side}"), message, help);
            }
            self.one_of(&format!("map.{side}.{field}"), field, axis.name(), known)?;
            self.admit(&path, range, range.0 < range.1, ORDER)?;
            if !basin {
                self.ends(&path, axis.name(), [range.0, range.1])?;
            }
        }
        let columns = [
            "attractor",
            "regimes",
            "period",
            "periods",
            "share",
            "mark",
            "found",
        ];
        let taken = states
            .iter()
            .chain(&names)
            .find(|name| columns.contains(name));
        if let Some(name) = taken.filter(|_| basin || section.shares.is_some()) {
            let message = format!("`{name}` is a column of the attractors already");
            return self.refuse("map", message, "choose another name in `system`");
        }
        if (basin || section.shares.is_some()) && names.is_empty() {
            let message = "orbits are found by equations in a parameter, and the system has none";
            let help = "write one of its numbers as a parameter";
            return self.refuse("map", message, help);
        }
        self.plane(section)?;
        if let Some(shares) = &section.shares {
            self.shares(shares)?;
        }
        for (index, start) in section.starts.iter().enumerate() {
            self.start(&format!("map.starts.{index}"), start)?;
        }
        Ok(())
    }

    fn shares(&self, section: &Shares) -> Check {
        let names: Vec<&str> = self.source().parameters.names().collect();
        let path = "map.shares.parameter";
        self.one_of(path, "parameter", &section.parameter, &names)?;
        self.values("map.shares", section.values, &section.parameter)?;
        let rule = format!("take fewer values or motions, {MAX_SCANNED} in all at most");
        let count = section.values.count();
        let holds = count.saturating_mul(section.draws) <= MAX_SCANNED;
        self.admit("map.shares.draws", section.draws, holds, &rule)?;
        self.within("map.shares", section.within.as_ref())
    }

    /// Refuses values that are none, or where the system makes no sense.
    fn values(&self, section: &str, values: ScanValues, parameter: &str) -> Check {
        let ScanValues::Linear(low, high, count) = values;
        let path = format!("{section}.values");
        self.admit(&path, values, low < high, ORDER)?;
        let rule = format!("a scan has from 2 to {MAX_VALUES} values");
        let holds = (2..=MAX_VALUES).contains(&count);
        self.admit(&format!("{path}.2"), count, holds, &rule)?;
        self.ends(&path, parameter, [low, high])?;
        Ok(())
    }

    /// Refuses a scan that cannot be computed.
    pub(super) fn scan(&self, section: &Scan) -> Check {
        let names: Vec<&str> = self.source().parameters.names().collect();
        self.one_of("scan.parameter", "parameter", &section.parameter, &names)?;
        self.values("scan", section.values, &section.parameter)?;
        let count = section.values.count();
        let rule = format!("take fewer values or samples, {MAX_SCANNED} samples in all at most");
        let holds = count.saturating_mul(section.keep) <= MAX_SCANNED;
        self.admit("scan.keep", section.keep, holds, &rule)?;
        self.exponents(section)?;
        if let (SampleSection::Phase(_), None) = (&section.section, &self.source().forcing) {
            let message = "there is no `forcing` whose phase a section could be";
            let help = "write `section: Zero(\"..\")`: samples are taken where this expression rises to zero";
            return self.refuse("scan.section", message, help);
        }
        let extended = section.system(&self.problem.system);
        let sensible = extended.and_then(|(system, _)| system.at(&self.problem.values(), &[]));
        if let Err(error) = sensible {
            let path = "scan.section.0";
            return Err(flaw_at(self.source(), self.outline, path, &error));
        }
        match &section.start {
            Some(start) => self.start("scan.start", start)?,
            None if self.problem.earlier_run().is_some() => {
                let message =
                    "`orbit` begins at an earlier run: where the motions begin is not known";
                let help =
                    "add for example `start: (mode: \"free\", state: {\"x\": 0.0, \"v\": 0.0})`";
                return self.refuse("scan", message, help);
            }
            None => {}
        }
        for (name, given) in [
            ("seed", section.seed.is_some()),
            ("within", section.within.is_some()),
        ] {
            let random = section.sweep == Sweep::Fresh;
            if given && !random {
                let message = format!("`{name}` is for motions that begin at random");
                let help = "leave it out, or write `sweep: Fresh`";
                return self.refuse(&format!("scan.{name}"), message, help);
            }
        }
        if section.within.is_some() && section.seed.is_none() {
            let message = "`within` is for motions that begin at random";
            return self.refuse("scan.within", message, "add for example `seed: 1`");
        }
        self.within("scan", section.within.as_ref())
    }

    /// Refuses ranges of random states that are none.
    fn within(&self, section: &str, within: Option<&Ordered<(f64, f64)>>) -> Check {
        let Some(Ordered(ranges)) = within else {
            return Ok(());
        };
        let states: Vec<&str> = self.source().states.iter().map(String::as_str).collect();
        for (index, (name, range)) in ranges.iter().enumerate() {
            let path = format!("{section}.within.{name}");
            self.one_of(&path, "state", name, &states)?;
            let twice = ranges[..index].iter().any(|(other, _)| other == name);
            self.admit(&path, name, !twice, "keep one of the two")?;
            self.admit(&path, range, range.0 < range.1, ORDER)?;
        }
        Ok(())
    }

    /// Refuses more exponents than there are, those of a single sample, and states of their names.
    fn exponents(&self, section: &Scan) -> Check {
        let (count, states) = (section.lyapunov.count(), &self.source().states);
        let rule = format!(
            "the system has {} of them, one for each state",
            states.len()
        );
        self.admit("scan.lyapunov", count, count <= states.len(), &rule)?;
        let rule = "perturbations grow from sample to sample: take at least two, better a hundred";
        let holds = count == 0 || section.keep > 1;
        self.admit("scan.keep", section.keep, holds, rule)?;
        let columns = section.exponent_columns();
        match states.iter().find(|state| columns.contains(*state)) {
            None => Ok(()),
            Some(name) => {
                let at = self.outline.text_in("system.states", name);
                let at = at.unwrap_or_else(|| self.outline.locate("system.states"));
                let message = format!("`{name}` is a column of the results already");
                Err(Flaw::new(at, message, "choose another name"))
            }
        }
    }
}
