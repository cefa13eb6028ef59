//! What the values of a problem with waves must hold to among each other.

use super::outline::Outline;
use super::rules::{Check, Checks, ORDER};
use super::{
    Continuation, CurveEvent, CurveSection, Expectation, Map, Plot, Problem, Start, Toward,
    drawable_columns,
};
use crate::orbit::EventType;
use crate::simulation::task::{
    Body, Circle, GrowthTask, MAX_SAMPLES, MAX_SIMULATION_POINTS, MIN_GROWTH_POINTS, Perturbation,
    Simulation, SimulationStart,
};
use crate::tube::flow::method::Method;
use crate::tube::model::{CoefficientSource, FrictionLaw, Impact, Parameter, Sectors};

/// Refuses the first values of the problem that make no sense together.
pub(super) fn check(problem: &Problem, outline: &Outline) -> Check {
    let checks = Checks { problem, outline };
    checks.model()?;
    if let Some(section) = &problem.continuation {
        checks.branch(section)?;
    }
    if let Some(section) = &problem.stability {
        checks.sectors("stability.sectors", &section.sectors)?;
    }
    if let Some(section) = &problem.map {
        checks.map(section)?;
    }
    if let Some(section) = &problem.simulation {
        checks.simulation(section)?;
    }
    if let Some(section) = &problem.curve {
        checks.curve(section)?;
    }
    checks.plots()?;
    for (index, event) in problem.expect.iter().enumerate() {
        checks.expectation(&format!("expect.{index}"), event)?;
    }
    Ok(())
}

impl Problem {
    /// What a plot shows but the problem does not ask for, and how to ask for it.
    pub(crate) fn lacks(&self, plot: &Plot) -> Option<(&'static str, String)> {
        const STABILITY: (&str, &str) =
            ("the section `stability`", "add `stability: (sectors: All)`");
        const PROFILES: (&str, &str) = ("profiles", "leave out `profiles: 0`");
        const CONDITIONING: (&str, &str) =
            ("`conditioning`", "add `conditioning: true` to `output`");
        const ROTATION: (&str, &str) = (
            "the angular velocity of the shaft",
            "add `rotation: 62.8` in rad/s to `output`",
        );
        let Problem {
            stability, output, ..
        } = self;
        let (needed, given) = match plot {
            Plot::Diagram => return None,
            Plot::Spectrum | Plot::Multipliers => (STABILITY, stability.is_some()),
            Plot::Column(name) => match name.as_str() {
                "unstable" | "lead_re" | "lead_im" | "lead_sector" => {
                    (STABILITY, stability.is_some())
                }
                "condition" | "expected_error" => (CONDITIONING, output.conditioning),
                "hertz" => (ROTATION, output.rotation.is_some()),
                name => {
                    let lacking = Parameter::from_column(name)
                        .filter(|&parameter| self.model.value(parameter).is_none())
                        .filter(|_| !self.restarts())?;
                    let (_, cure) = lacking.absent();
                    return Some(("this parameter in the model", format!("use `{cure}`")));
                }
            },
            _ => (PROFILES, output.profiles > 0 || !plot.shows_profiles()),
        };
        let (needed, cure) = needed;
        (!given).then(|| (needed, cure.to_owned()))
    }

    /// Whether the first wave brings its own model.
    fn restarts(&self) -> bool {
        self.wave.start.label().is_some()
    }
}

impl Checks<'_, Problem> {
    /// Refuses a parameter that the model does not have.
    fn known(&self, path: &str, parameter: Parameter) -> Check {
        if self.problem.model.value(parameter).is_some() {
            return Ok(());
        }
        let (instead, cure) = parameter.absent();
        let message = format!("`{}` is unknown: {instead}", parameter.column());
        self.refuse(path, message, format!("use `{cure}`, or another parameter"))
    }

    /// Refuses a range in which a parameter has no sense, or which is empty.
    fn range(&self, path: &str, parameter: Parameter, range: (f64, f64)) -> Check {
        for (end, value) in [range.0, range.1].into_iter().enumerate() {
            let path = format!("{path}.{end}");
            self.admit(&path, value, parameter.admits(value), &parameter.rule())?;
        }
        self.admit(path, range, range.0 < range.1, ORDER)
    }

    /// Refuses a Bloch sector beyond half the mode: it is the conjugate of another one.
    fn sector(&self, path: &str, sector: usize) -> Check {
        let mode = self.problem.wave.mode;
        let last = mode as usize / 2;
        let rule = format!("the sectors of mode {mode} run from 0 to {last}");
        self.admit(path, sector, sector <= last, &rule)
    }

    fn sectors(&self, path: &str, sectors: &Sectors) -> Check {
        let Sectors::Only(list) = sectors else {
            return Ok(());
        };
        let rule = "name at least one sector, e.g. `Only([0])`, or write `All`";
        self.admit(path, list, !list.is_empty(), rule)?;
        // a list longer than there are sectors fails on one of its first entries
        for (index, &entry) in list.iter().enumerate() {
            let path = format!("{path}.0.{index}");
            self.sector(&path, entry)?;
            self.once(&path, index, list)?;
        }
        Ok(())
    }

    /// Refuses events that waves do not have.
    fn of_waves(&self, path: &str, event: EventType) -> Check {
        if event.of_waves() {
            return Ok(());
        }
        let message =
            format!("a {event} is an event of orbits of a system, not of waves of a tube");
        self.refuse(
            path,
            message,
            "take an event of waves: LP, HB, BP, GR, RV, CO, ST, UZ, EP, MX",
        )
    }

    /// Refuses events of a spectrum that is not computed.
    fn looked_for(&self, path: &str, event: EventType, wanted: Option<usize>) -> Check {
        match (&self.problem.stability, wanted) {
            (None, _) if event.of_spectrum() => {
                let message = format!("no {event} is found without the section `stability`");
                self.refuse(path, message, "add `stability: (sectors: All)`")
            }
            (Some(section), Some(sector)) => match &section.sectors {
                Sectors::Only(list) if !list.contains(&sector) => {
                    let message = format!("`stability.sectors` leaves out sector {sector}");
                    self.refuse(path, message, "add it there, or write `All`")
                }
                _ => Ok(()),
            },
            _ => Ok(()),
        }
    }

    fn model(&self) -> Check {
        let model = &self.problem.model;
        if let Some(tube) = &self.problem.tube {
            let rule = format!(
                "the outer radius is greater than the inner one, {:?}",
                tube.inner
            );
            self.admit("tube.outer", tube.outer, tube.outer > tube.inner, &rule)?;
            for parameter in [Parameter::Mismatch, Parameter::Xi, Parameter::Gamma] {
                let value = model.value(parameter).unwrap_or(f64::NAN);
                if !(parameter.admits(value) && value.is_finite()) {
                    let message = format!("this tube has {} = {value:?}", parameter.column());
                    return self.refuse(parameter.path(), message, parameter.rule());
                }
            }
        }
        if let CoefficientSource::Given { a, b, coupling, .. } = model.source {
            let rule = "a must be greater than b";
            self.admit("model.coefficients.a", a, a > b, rule)?;
            let rule = "D must not be 0: without coupling there is no travelling wave";
            self.admit("model.coefficients.D", coupling, coupling != 0.0, rule)?;
        }
        let smooth = matches!(model.law, FrictionLaw::Regularised { .. });
        if smooth && model.impact == Impact::Coulomb {
            return self.refuse(
                "model.impact",
                "a `Coulomb` impact needs a friction law with a sliding direction",
                "leave out `impact`, or the `Regularised` friction law",
            );
        }
        let exact = model.law.piecewise_linear() || self.problem.method != Some(Method::Exact);
        let rule = "this friction law depends on the velocity and has no closed form; write \
                    `Shooting(tolerance: 1e-12)` or `Collocation(intervals: 20, degree: 4)`";
        self.admit("method", Method::Exact, exact, rule)
    }

    fn branch(&self, section: &Continuation) -> Check {
        self.range("continuation.range", section.parameter, section.range)?;
        self.known("continuation.parameter", section.parameter)?;
        self.first_point(section)?;
        self.user_points(section, section.parameter.column(), &[])?;
        let steps = [section.ds, section.ds_min, section.ds_max];
        self.steps("continuation", steps)?;
        let events: Vec<EventType> = section.stop_after.iter().map(|stop| stop.event).collect();
        for (index, &event) in events.iter().enumerate() {
            let path = format!("continuation.stop_after.{index}.event");
            self.of_waves(&path, event)?;
            self.looked_for(&path, event, None)?;
            self.once(&path, index, &events)?;
        }
        Ok(())
    }

    fn first_point(&self, section: &Continuation) -> Check {
        let column = section.parameter.column();
        let value = match self.problem.wave.start {
            // a restart brings its own parameters, and so does a Hopf point
            Start::Restart { .. } | Start::Switch { .. } => return Ok(()),
            Start::Hopf => {
                let only = Toward::beyond_hopf(section.parameter);
                let holds = [Toward::Both, only].contains(&section.toward);
                let rule = format!(
                    "waves exist on one side of the Hopf point only: write `toward: {only:?}`, or \
                     leave it out"
                );
                return self.admit("continuation.toward", section.toward, holds, &rule);
            }
            Start::Fast | Start::Slow => self.problem.model.value(section.parameter),
        };
        let value = value.unwrap_or(f64::NAN);
        self.beginning(section, column, value, || match self.problem.tube {
            None => format!("widen the range or change `{column}` in the model"),
            Some(_) if section.parameter == Parameter::Mismatch => {
                let gamma = self.problem.model.value(Parameter::Gamma);
                let scale = gamma.unwrap_or(1.0).sqrt();
                // most tubes have their first events between these, for all lengths scale with √γ
                let (least, most) = (1e-3 * scale, 1.01 * scale.max(value));
                format!(
                    "mismatch is oversize/inner, without a unit; a range to begin with is \
                     ({least:.2e}, {most:.2e})"
                )
            }
            Some(_) => format!("widen the range: `{column}` has the units of a model"),
        })
    }

    fn curve(&self, section: &CurveSection) -> Check {
        self.sector("curve.sector", section.sector)?;
        if self.outline.has("curve.sector") && section.event != CurveEvent::HB {
            return self.refuse(
                "curve.sector",
                "`curve.sector` is given for an event that has none, or whose label says it",
                "leave it out, or follow an HB",
            );
        }
        self.label_without_index(section.event.kind().is_none())?;
        let (first, second) = section.parameters;
        for (side, parameter, range) in [(0, first, section.range.0), (1, second, section.range.1)]
        {
            self.known(&format!("curve.parameters.{side}"), parameter)?;
            self.range(&format!("curve.range.{side}"), parameter, range)?;
        }
        let rule = "the two parameters of a curve must be different";
        self.admit("curve.parameters.1", second, first != second, rule)?;
        self.steps("curve", [section.ds, section.ds_min, section.ds_max])
    }

    fn map(&self, section: &Map) -> Check {
        for (side, axis) in [("first", &section.first), ("second", &section.second)] {
            self.known(&format!("map.{side}.parameter"), axis.parameter)?;
            self.range(&format!("map.{side}.range"), axis.parameter, axis.range)?;
        }
        self.plane(section)?;
        let starts = &section.starts.0;
        let rule = "name Fast, Slow or both, each once";
        self.admit("map.starts", starts, !starts.is_empty(), rule)?;
        for (index, start) in starts.iter().enumerate() {
            let known = matches!(start, Start::Fast | Start::Slow);
            let holds = known && !starts[..index].contains(start);
            self.admit(&format!("map.starts.{index}"), start, holds, rule)?;
        }
        if section.shares.is_some() {
            let message = "`map.shares` is for motions of a system of one's own";
            return self.refuse("map.shares", message, "leave it out");
        }
        Ok(())
    }

    fn simulation(&self, section: &Simulation) -> Check {
        let around = match section.body {
            Body::Ring { points, .. } => points,
            Body::Annulus { around, across } => {
                self.annulus(section, around, across)?;
                around
            }
        };
        let speed = match section.start {
            SimulationStart::Profile { speed, .. } => speed,
            _ => 1.0,
        };
        let rule = "the speed of a wave is not 0";
        self.admit("simulation.start.speed", speed, speed != 0.0, rule)?;
        let mode = self.problem.wave.mode as usize;
        let from_wave = section.start != SimulationStart::SteadySliding;
        let whole = section.circle == Circle::Whole;
        let alike = !(from_wave && whole) || around.is_multiple_of(mode);
        let rule = format!("{mode} waves need a multiple of {mode} points to be alike");
        self.admit("simulation.body.points", around, alike, &rule)?;
        if let Some(perturbation) = section.perturbation {
            self.perturbation(perturbation, around, section.circle)?;
        }
        let (duration, every) = (section.duration, section.every);
        let holds = every <= duration && duration / every <= MAX_SAMPLES as f64;
        let rule = format!(
            "the time between samples must be at most the duration, and leave at most \
             {MAX_SAMPLES} samples"
        );
        self.admit("simulation.every", every, holds, &rule)?;
        if let Some(growth) = &section.growth {
            let per_wave = if whole { around / mode } else { around };
            self.growth(growth, from_wave, around, per_wave)?;
        }
        if self.problem.model.law != FrictionLaw::Coulomb {
            return self.refuse(
                "model.friction_law",
                "`friction_law` is not Coulomb's, and no other is simulated",
                "leave it out; a ring has `friction: Tanh(epsilon: 0.01)` in its section",
            );
        }
        Ok(())
    }

    fn annulus(&self, section: &Simulation, around: usize, across: usize) -> Check {
        let rule = format!("an annulus has at most {MAX_SIMULATION_POINTS} elements");
        let holds = across <= MAX_SIMULATION_POINTS / around;
        self.admit("simulation.body.across", across, holds, &rule)?;
        if self.problem.model.source.geometry().is_none() {
            let message = "an annulus needs a geometry, but the coefficients are `Given`";
            let help = format!("write `{}`, or simulate a `Ring`", Parameter::Xi.absent().1);
            return self.refuse("simulation.body", message, help);
        }
        if section.start != SimulationStart::SteadySliding {
            return self.refuse(
                "simulation.start",
                "an annulus cannot begin with a wave: the table holds its contact line only",
                "write `start: SteadySliding` with a perturbation",
            );
        }
        Ok(())
    }

    fn perturbation(&self, added: Perturbation, around: usize, circle: Circle) -> Check {
        let mode = self.problem.wave.mode;
        let waves = match circle {
            Circle::Whole => 1,
            Circle::Wavelength => mode,
        };
        let highest = (around as u64 * u64::from(waves) / 4) as u32;
        let holds = added.mode <= highest && added.mode.is_multiple_of(waves);
        let rule = match circle {
            Circle::Whole => format!("the points resolve the modes 0 to {highest}"),
            Circle::Wavelength => format!(
                "one wavelength of mode {mode} holds multiples of {mode}, here up to {highest}; \
                 write `circle: Whole` for others"
            ),
        };
        self.admit("simulation.perturbation.mode", added.mode, holds, &rule)
    }

    fn growth(
        &self,
        growth: &GrowthTask,
        from_wave: bool,
        around: usize,
        per_wave: usize,
    ) -> Check {
        if !from_wave {
            return self.refuse(
                "simulation.growth",
                "there is no wave whose perturbations could grow",
                "write `start: Wave`, or remove `growth`",
            );
        }
        let rule = format!("growth needs at least {MIN_GROWTH_POINTS} points per wavelength");
        let holds = per_wave >= MIN_GROWTH_POINTS;
        self.admit("simulation.body.points", around, holds, &rule)?;
        self.sectors("simulation.growth.sectors", &growth.sectors)
    }

    fn plots(&self) -> Check {
        let columns = drawable_columns();
        let plots = &self.problem.output.plots;
        for (index, plot) in plots.iter().enumerate() {
            let path = format!("output.plots.{index}");
            if let Plot::Column(name) = plot {
                let rule = format!(
                    "name a column of branch.csv, e.g. `Column(\"amplitude\")`; it has {}",
                    columns.join(", ")
                );
                self.admit(&path, plot, columns.contains(name), &rule)?;
            }
            self.once(&path, index, plots)?;
            if let Some((needed, cure)) = self.problem.lacks(plot) {
                let message = format!("the plot {plot:?} shows nothing without {needed}");
                return self.refuse(&path, message, format!("{cure}, or leave out the plot"));
            }
        }
        Ok(())
    }

    fn expectation(&self, path: &str, event: &Expectation) -> Check {
        let kind = event.event;
        if let Some(entry) = event.sector {
            self.sector(&format!("{path}.sector"), entry)?;
        }
        self.of_waves(&format!("{path}.event"), kind)?;
        self.looked_for(&format!("{path}.event"), kind, event.sector)?;
        let omega = event.numbers().any(|(name, _)| name == "omega");
        for (name, given) in [("sector", event.sector.is_some()), ("omega", omega)] {
            if given && !kind.of_spectrum() {
                let message = format!("`{name}` is expected of a {kind}, which has none");
                let help = "leave it out, or expect an HB or a BP";
                return self.refuse(&format!("{path}.{name}"), message, help);
            }
        }
        self.compared(path, event, &Expectation::NUMBERS)?;
        for (name, _) in event.numbers() {
            if let Some(parameter) = Parameter::from_column(name) {
                self.known(&format!("{path}.{name}"), parameter)?;
            }
        }
        let Some(section) = &self.problem.continuation else {
            return Ok(());
        };
        let column = section.parameter.column();
        let varies = |name: &str| {
            // a restart brings its own model
            let restarts = self.problem.restarts();
            restarts || name == column || Parameter::from_column(name).is_none()
        };
        self.fallible(
            path,
            event,
            section,
            column,
            varies,
            ("model", Some("speed")),
        )
    }
}
