//! What the values of a problem with a system must hold to among each other.

use std::cell::LazyCell;
use std::collections::HashSet;

use super::super::error::{Flaw, excerpt, line};
use super::super::expectation::Expectation;
use super::super::explanation::{known, unknown_field};
use super::super::outline::{Outline, Subject};
use super::super::rules::{Check, Checks, ORDER, lengths};
use super::super::{Continuation, CurveSection, SystemCurve, SystemCurveEvent, fields};
use super::equilibrium::{COLUMNS, one_of_both};
use super::mistake::flaw_at;
use super::{BeginningSection, SystemPlot, SystemProblem};
use crate::affine::expression::Expression;
use crate::affine::monitor::MONITOR;
use crate::affine::system::{BadName, Mistake, Source, SystemError, is_name};
use crate::affine::values::value;
use crate::orbit::EventType;

/// Most parameters, and most abbreviations.
const MAX_NAMES: usize = 1000;
/// Most modes, sliding ones included.
const MAX_MODES: usize = 100;
/// Most monitors.
const MAX_MONITORS: usize = 100;
/// Most entries of `until` and of `if`.
const MAX_SWITCHES: usize = 100;
/// Most starts of a map.
const MAX_STARTS: usize = 100;

/// Columns of result files that have no state or parameter in them, and fields of expectations: a parameter of
/// that name could not be told from them.
const NO_PARAMETER: [&str; 29] = [
    "row",
    "column",
    "start",
    "passage",
    "found",
    "periods",
    "why",
    "point",
    "label",
    "type",
    "regimes",
    "period",
    "switches",
    "stable",
    "unstable",
    "multiplier_re",
    "multiplier_im",
    "newton",
    "residual",
    "leg",
    "regimes_before",
    "regimes_after",
    "sliding",
    "uncertainty",
    "what",
    "event",
    "tolerance",
    "sector",
    "numbers",
];
/// The same for a state.
const NO_STATE: [&str; 13] = [
    "time",
    "mode",
    "value",
    "sweep",
    "sample",
    "from",
    "to",
    "section",
    "equilibrium",
    "stable",
    "re",
    "im",
    "why",
];

/// Refuses numbers and texts that are not admitted by themselves, and lists without end.
pub(super) fn written(written: &SystemProblem<Source>, outline: &Outline) -> Check {
    one_of_both(written, outline)?;
    values(&written.system, outline)?;
    lengths(written.continuation.as_ref(), &written.expect, outline)?;
    let Source {
        parameters,
        define,
        modes,
        sliding,
        ..
    } = &written.system;
    let mut lists = vec![
        (
            "system.parameters".to_owned(),
            parameters.0.len(),
            MAX_NAMES,
        ),
        ("system.define".to_owned(), define.0.len(), MAX_NAMES),
        (
            "system.modes".to_owned(),
            modes.0.len() + sliding.0.len(),
            MAX_MODES,
        ),
        (MONITOR.to_owned(), written.monitor.0.len(), MAX_MONITORS),
        (
            "map.starts".to_owned(),
            written.map.as_ref().map_or(0, |map| map.starts.len()),
            MAX_STARTS,
        ),
    ];
    for (name, mode) in &modes.0 {
        let path = format!("system.modes.{name}.until");
        lists.push((path.clone(), mode.until.len(), MAX_SWITCHES));
        let longest = mode.until.iter().map(|switch| switch.conditions.len());
        lists.push((path, longest.max().unwrap_or(0), MAX_SWITCHES));
    }
    for (path, count, most) in lists {
        if count > most {
            let at = outline.locate(&path);
            let message = line(&format!("`{path}` has {count} entries"));
            return Err(Flaw::new(at, message, format!("write at most {most}")));
        }
    }
    fields::check(written, outline)
}

/// Refuses a value of a parameter that is written as an expression and has none.
fn values(source: &Source, outline: &Outline) -> Check {
    let all = &source.parameters.0;
    for (index, (name, _)) in all.iter().enumerate().filter(|(_, one)| one.1.is_nan()) {
        let path = format!("system.parameters.{name}");
        let text = outline.text.get(outline.locate(&path)).unwrap_or_default();
        let text: Result<String, _> = ron::from_str(text);
        let flawed = text.ok().map(|text| value(&text, &all[..index]));
        if let Some(Err(flaw)) = flawed {
            let error = SystemError::at(&path, Mistake::Expression(flaw));
            return Err(flaw_at(source, outline, &path, &error));
        }
    }
    Ok(())
}

/// Refuses the first values of the problem that make no sense together.
pub(super) fn check(problem: &SystemProblem, outline: &Outline) -> Check {
    let checks = Checks { problem, outline };
    checks.names()?;
    checks.monitors()?;
    match &problem.equilibrium {
        Some(section) => checks.equilibrium(section)?,
        None => checks.orbit()?,
    }
    checks.used()?;
    if let Some(section) = &problem.continuation {
        checks.branch(section)?;
    }
    if let Some(section) = &problem.curve {
        checks.curve(section)?;
    }
    if let Some(section) = &problem.map {
        checks.map(section)?;
    }
    if let Some(section) = &problem.simulation
        && let Some(start) = &section.start
    {
        checks.start("simulation.start", start)?;
    }
    if let Some(section) = &problem.scan {
        checks.scan(section)?;
    }
    checks.output()?;
    for (index, event) in problem.expect.iter().enumerate() {
        checks.expectation(&format!("expect.{index}"), event)?;
    }
    Ok(())
}

/// Whether a name is that of the column of an extremum of a state.
fn is_extremum(name: &str, states: &[String]) -> bool {
    let state = name.strip_prefix("min_").or(name.strip_prefix("max_"));
    state.is_some_and(|state| states.iter().any(|one| one == state))
}

impl Checks<'_, SystemProblem> {
    pub(super) fn source(&self) -> &Source {
        &self.problem.system.source
    }

    /// Refuses states and parameters that could not be told from other columns.
    fn names(&self) -> Check {
        let Source {
            states, parameters, ..
        } = self.source();
        let refused = |at, name: &str| {
            let message = format!("`{name}` is a column of the results already");
            Err(Flaw::new(at, message, "choose another name"))
        };
        let whole = |path: &str| self.outline.locate(path);
        // states of equilibria have the names of columns, too
        let rests = self.problem.equilibrium.is_some();
        let of_equilibria = |name: &str| rests && COLUMNS.contains(&name);
        for name in states {
            let own = name.as_str();
            let of_branch = || rests && NO_PARAMETER.contains(&own);
            if NO_STATE.contains(&own) || of_equilibria(own) || of_branch() {
                let at = self.outline.text_in("system.states", name);
                return refused(at.unwrap_or_else(|| whole("system.states")), name);
            }
        }
        for name in parameters.names() {
            if is_extremum(name, states) || NO_PARAMETER.contains(&name) || of_equilibria(name) {
                let at = self.outline.key_of("system.parameters", name);
                return refused(at.unwrap_or_else(|| whole("system.parameters")), name);
            }
        }
        Ok(())
    }

    /// Refuses monitors that could not be told from other columns.
    fn monitors(&self) -> Check {
        let Source {
            states, parameters, ..
        } = self.source();
        let mut seen: Vec<&str> = Vec::new();
        for name in self.problem.monitor.names() {
            let at = || {
                let at = self.outline.key_of(MONITOR, name);
                at.unwrap_or_else(|| self.outline.locate(MONITOR))
            };
            let refused = |message: String, help: &str| Err(Flaw::new(at(), message, help));
            let shown = excerpt(name);
            if !is_name(name) {
                let message = format!("`{shown}` cannot be a name here: {}", BadName::NoWord);
                return refused(message, "write for example `peak` or `loss_2`");
            }
            if seen.contains(&name) {
                let message = format!("`{shown}` cannot be a name here: {}", BadName::Twice);
                return refused(message, "keep one of the two, or give one another name");
            }
            let of_system =
                parameters.names().any(|one| one == name) || states.iter().any(|one| one == name);
            if of_system {
                let message = format!("`{shown}` is a state or a parameter already");
                return refused(message, "choose another name");
            }
            let rests = self.problem.equilibrium.is_some();
            let of_equilibria = rests && COLUMNS.contains(&name);
            let is_column =
                NO_PARAMETER.contains(&name) || NO_STATE.contains(&name) || of_equilibria;
            if is_column || is_extremum(name, states) {
                let message = format!("`{shown}` is a column of the results already");
                return refused(message, "choose another name");
            }
            seen.push(name);
        }
        for (name, monitor) in &self.problem.monitor.0 {
            if let Some((_, number)) = monitor.switch() {
                let path = format!("{MONITOR}.{name}.2");
                let rule = "`1` is the first switch of this name in the period";
                self.admit(&path, number, number > 0, rule)?;
            }
        }
        Ok(())
    }

    /// Names in values of parameters that are written as expressions.
    fn named_by_values(&self) -> HashSet<String> {
        let mut named = HashSet::new();
        let texts = self.outline.below("system.parameters");
        let texts = texts.filter_map(|text| ron::from_str::<String>(text).ok());
        for value in texts.filter_map(|text| Expression::read(&text).ok()) {
            value.names(&mut |name, _| {
                named.insert(name.to_owned());
            });
        }
        named
    }

    /// Whether a section follows, scans or maps a parameter of this name.
    fn varies(&self, name: &str) -> bool {
        let is_named = |text: &str| ron::from_str::<String>(text).is_ok_and(|text| text == name);
        let mut sections = ["continuation", "curve", "map", "scan"].into_iter();
        sections.any(|section| self.outline.below(section).any(is_named))
    }

    /// Refuses parameters that nothing depends on, and modes that nothing leads to.
    fn used(&self) -> Check {
        let system = &self.problem.system;
        let prescribed = self.problem.prescribed();
        let in_period = |name: &str| prescribed.as_ref().is_some_and(|period| period.has(name));
        let mut unused = system.unused_parameters().into_iter();
        let monitors = self.problem.monitors();
        let in_monitor = |name: &str| monitors.iter().any(|one| one.has(name));
        // read only where a parameter stands nowhere else
        let in_value = LazyCell::new(|| self.named_by_values());
        let serves = |name: &str| in_value.contains(name) && !self.varies(name);
        if let Some(name) =
            unused.find(|name| !in_period(name) && !in_monitor(name) && !serves(name))
        {
            let at = self.outline.key_of("system.parameters", name);
            let at = at.unwrap_or_else(|| self.outline.locate("system.parameters"));
            let (message, help) = match in_value.contains(name) {
                true => (
                    format!(
                        "no expression has the parameter `{name}`, but the value of another one"
                    ),
                    "values are found once, before it varies: write that value as an abbreviation of `define`",
                ),
                false => (
                    format!("the parameter `{name}` is not used"),
                    "remove it, or use it in an expression",
                ),
            };
            return Err(Flaw::new(at, message, help));
        }
        // an earlier run may have begun in any mode
        if self.problem.earlier_run().is_some() {
            return Ok(());
        }
        let simulation = self.problem.simulation.as_ref();
        let scan = self.problem.scan.as_ref();
        let starts = [
            self.problem.start_of_motion(),
            simulation.and_then(|section| section.start.clone()),
            scan.and_then(|section| section.start.clone()),
        ];
        let of_map = self.problem.map.iter().flat_map(|section| &section.starts);
        let starts: Vec<&BeginningSection> = starts.iter().flatten().chain(of_map).collect();
        let rests = self.problem.equilibrium.as_ref();
        let rests = rests.and_then(|section| section.start.mode());
        let begins =
            |name: &str| rests == Some(name) || starts.iter().any(|start| start.mode == name);
        let mut alone = system.unentered_modes().into_iter();
        let Some(name) = alone.find(|name| !begins(name)) else {
            return Ok(());
        };
        let at = self.outline.key_of("system.modes", name);
        let at = at.unwrap_or_else(|| self.outline.locate("system.modes"));
        let message = format!("no switch leads to the mode `{name}`, and nothing begins in it");
        Err(Flaw::new(at, message, "remove it, or let a `to` name it"))
    }

    /// Refuses a name that is none of those known.
    pub(super) fn one_of(&self, path: &str, what: &str, name: &str, names: &[&str]) -> Check {
        if names.contains(&name) {
            return Ok(());
        }
        let message = format!("`{}` is no {what}{}", excerpt(name), known(name, names));
        self.refuse(path, message, format!("name a {what} of `system`"))
    }

    /// Refuses a range at an end of which the system makes no sense; returns the value of the parameter here.
    pub(super) fn ends(&self, path: &str, column: &str, ends: [f64; 2]) -> Result<f64, Flaw> {
        let mut values = self.problem.values();
        let index = self.source().parameters.index(column).unwrap_or(0);
        let here = values[index];
        for (end, value) in ends.into_iter().enumerate() {
            values[index] = value;
            if let Err(error) = self.problem.system.at(&values, &[]) {
                let message = format!(
                    "at {column} = {value:?}, an end of the range, the system makes no sense: {}",
                    line(&error.mistake.to_string())
                );
                let help = match error.mistake {
                    Mistake::Frequency(_) => "choose a range in which it is positive".to_owned(),
                    _ => format!("choose a range in which `{}` has values", error.path),
                };
                self.refuse(&format!("{path}.{end}"), message, help)?;
            }
        }
        Ok(here)
    }

    fn branch(&self, section: &Continuation<String>) -> Check {
        let names: Vec<&str> = self.source().parameters.names().collect();
        let column = section.parameter.as_str();
        self.one_of("continuation.parameter", "parameter", column, &names)?;
        let range = section.range;
        self.admit("continuation.range", range, range.0 < range.1, ORDER)?;
        let here = self.ends("continuation.range", column, [range.0, range.1])?;
        // an earlier run brings its own parameters
        if self.problem.earlier_run().is_none() {
            self.beginning(section, column, here, || {
                format!("widen the range or change `{column}` in the system")
            })?;
        }
        let monitors: Vec<&str> = self.problem.monitor.names().collect();
        self.user_points(section, column, &monitors)?;
        self.steps("continuation", [section.ds, section.ds_min, section.ds_max])?;
        let events: Vec<EventType> = section.stop_after.iter().map(|stop| stop.event).collect();
        for (index, &event) in events.iter().enumerate() {
            let path = format!("continuation.stop_after.{index}.event");
            self.looked_for(&path, event)?;
            self.once(&path, index, &events)?;
        }
        Ok(())
    }

    fn curve(&self, section: &SystemCurve) -> Check {
        let CurveSection {
            parameters, range, ..
        } = section;
        let names: Vec<&str> = self.source().parameters.names().collect();
        for (side, name, range) in [(0, &parameters.0, range.0), (1, &parameters.1, range.1)] {
            self.one_of(
                &format!("curve.parameters.{side}"),
                "parameter",
                name,
                &names,
            )?;
            self.admit(
                &format!("curve.range.{side}"),
                range,
                range.0 < range.1,
                ORDER,
            )?;
        }
        let (first, second) = parameters;
        let rule = "the two parameters of a curve must be different";
        self.admit("curve.parameters.1", second, first != second, rule)?;
        if self.outline.has("curve.sector") {
            let message = "`curve.sector` is for waves of a tube, and this is a system";
            return self.refuse("curve.sector", message, "leave it out");
        }
        self.label_without_index(section.event.kind().is_none())?;
        if let Some(kind) = section.event.kind() {
            self.curve_event(kind)?;
        }
        if let SystemCurveEvent::Constant(name) = &section.event {
            let monitors: Vec<&str> = self.problem.monitor.names().collect();
            if !monitors.contains(&name.as_str()) {
                let known = known(name, &monitors);
                let message = format!("`{}` is no monitor{known}", excerpt(name));
                let help = "name an entry of the section `monitor`";
                return self.refuse("curve.event.0", message, help);
            }
        }
        self.steps("curve", [section.ds, section.ds_min, section.ds_max])
    }

    /// Refuses events that orbits do not have, or whose multipliers are not computed.
    fn looked_for(&self, path: &str, event: EventType) -> Check {
        if self.problem.equilibrium.is_some() {
            let message = format!("a {event} is no event of equilibria of a system");
            let help = "take an event of equilibria: LP, BP, HB, BE, UZ, EP, MX";
            return match event.of_equilibria() {
                true => Ok(()),
                false => self.refuse(path, message, help),
            };
        }
        if !event.of_systems() {
            let message =
                format!("a {event} is an event of waves of a tube, not of orbits of a system");
            let help = "take an event of orbits: LP, PD, NS, BP, GR, CO, SL, HC, UZ, EP, MX";
            return self.refuse(path, message, help);
        }
        if event.of_spectrum() && self.problem.stability.is_none() {
            let message = format!("no {event} is found without the section `stability`");
            return self.refuse(path, message, "add `stability: ()`");
        }
        Ok(())
    }

    fn output(&self) -> Check {
        let output = &self.problem.output;
        for (path, given) in [
            ("output.rotation", output.rotation.is_some()),
            ("output.conditioning", output.conditioning),
        ] {
            if given {
                let message = format!("`{path}` is for waves of a tube, and this is a system");
                return self.refuse(path, message, "leave it out");
            }
        }
        let states: Vec<&str> = self.source().states.iter().map(String::as_str).collect();
        let columns = self.problem.drawable_columns();
        for (index, plot) in output.plots.iter().enumerate() {
            let path = format!("output.plots.{index}");
            let shown: &[&String] = match plot {
                SystemPlot::Phase(one, other) => &[one, other],
                SystemPlot::Time(one) => &[one],
                _ => &[],
            };
            for (side, name) in shown.iter().enumerate() {
                self.one_of(&format!("{path}.{side}"), "state", name, &states)?;
            }
            if let SystemPlot::Column(name) = plot {
                let rule = format!(
                    "name a column of branch.csv, e.g. `Column(\"period\")`; it has {}",
                    line(&columns.join(", "))
                );
                self.admit(&path, plot, columns.contains(name), &rule)?;
            }
            self.once(&path, index, &output.plots)?;
            if self.problem.equilibrium.is_some() {
                self.plot_of_equilibria(&path, plot)?;
                continue;
            }
            if let Some((needed, cure)) = self.problem.lacks(plot) {
                let message = format!("the plot {plot:?} shows nothing without {needed}");
                return self.refuse(&path, message, format!("{cure}, or leave out the plot"));
            }
        }
        Ok(())
    }

    /// Whether the frequency of the forcing depends on a parameter.
    fn forcing_changes_with(&self, parameter: &str) -> bool {
        let forcing = self.source().forcing.as_ref();
        let forcing = forcing.and_then(|text| Expression::read(text).ok());
        let mut changes = false;
        if let Some(forcing) = forcing {
            forcing.names(&mut |name, _| changes |= name == parameter);
        }
        changes
    }

    fn expectation(&self, path: &str, event: &Expectation) -> Check {
        self.looked_for(&format!("{path}.event"), event.event)?;
        if event.sector.is_some() {
            let message = "`sector` is expected of an orbit, which has none";
            return self.refuse(&format!("{path}.sector"), message, "leave it out");
        }
        let numbers = self.numbers_of_events();
        let fields = Expectation::FIELDS
            .into_iter()
            .filter(|name| *name != "sector");
        let all: Vec<&str> = fields.chain(numbers.iter().copied()).collect();
        let mut seen = Vec::new();
        for (name, _) in event.numbers() {
            let at = || {
                let map = format!("{path}.numbers");
                let at = self.outline.key_of(path, name);
                let at = at.or_else(|| self.outline.key_of(&map, name));
                at.unwrap_or_else(|| self.outline.locate(path))
            };
            if !numbers.contains(&name) {
                let (message, help) = unknown_field(Subject::System, "expect", name, &all);
                return Err(Flaw::new(at(), message, help));
            }
            if seen.contains(&name) {
                let message = format!("`{name}` is given twice in `expect`");
                return Err(Flaw::new(at(), message, "keep one of the two"));
            }
            seen.push(name);
            if name.starts_with("multiplier_") && self.problem.stability.is_none() {
                let message = format!("`{name}` is not known without the section `stability`");
                return Err(Flaw::new(at(), message, "add `stability: ()`"));
            }
        }
        self.compared(path, event, &numbers)?;
        let Some(section) = &self.problem.continuation else {
            return Ok(());
        };
        let restarts = self.problem.earlier_run().is_some();
        let column = section.parameter.as_str();
        let keeps_period = self.source().forcing.is_some() && !self.forcing_changes_with(column);
        let varies = |name: &str| {
            let free = self.problem.orbit.free.as_deref() == Some(name);
            let other = self.source().parameters.index(name).is_none();
            restarts || free || name == column || other && !(keeps_period && name == "period")
        };
        let states = &self.source().states;
        let other = match self.problem.equilibrium {
            Some(_) => Some(states.first().map_or("re", String::as_str)),
            None => Some("period").filter(|_| !keeps_period),
        };
        self.fallible(path, event, section, column, varies, ("system", other))
    }
}

impl SystemProblem {
    /// What a plot shows but the problem does not ask for, and how to ask for it.
    pub(crate) fn lacks(&self, plot: &SystemPlot) -> Option<(&'static str, &'static str)> {
        let multipliers = match plot {
            SystemPlot::Diagram => return None,
            SystemPlot::Phase(..) | SystemPlot::Time(_) => {
                let lacking = self.output.profiles == 0;
                return lacking.then_some(("profiles", "leave out `profiles: 0`"));
            }
            SystemPlot::Multipliers => true,
            SystemPlot::Column(name) => {
                ["unstable", "multiplier_re", "multiplier_im"].contains(&name.as_str())
            }
        };
        let lacking = multipliers && self.stability.is_none();
        lacking.then_some(("the section `stability`", "add `stability: ()`"))
    }
}
