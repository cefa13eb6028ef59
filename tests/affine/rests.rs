//! Systems whose equilibria are followed, in any units and order of their states.

use brakewave::EventType;
use brakewave::affine::system::Source;
use brakewave::hybrid::equilibrium::{
    EquilibriumEvent, EquilibriumItem, EquilibriumRunner, NamedEquilibrium,
};
use brakewave::orbit::legs::{Run as _, RunEnd};
use brakewave::problem::{Any, SystemProblem, parse_any};

use EventType::EP;

pub const BRUSSELATOR: &str = r#"(states: ["x", "y"], parameters: {"A": 1.0, "B": 1.5},
    modes: {"flow": (rates: {"x": "A - (B + 1)*x + x^2*y", "y": "B*x - x^2*y"})})"#;
pub const PREDATORS: &str = r#"(states: ["x", "y"], parameters: {"K": 0.9, "a": 1.0, "b": 0.5, "d": 0.4},
    modes: {"flow": (rates: {"x": "x*(1 - x/K) - a*x*y/(b + x)", "y": "a*x*y/(b + x) - d*y"})})"#;
pub const LORENZ: &str = r#"(states: ["x", "y", "z"], parameters: {"r": 20.0, "s": 10.0, "b": 2.6666666666666667},
    modes: {"flow": (rates: {"x": "s*(y - x)", "y": "r*x - y - x*z", "z": "x*y - b*z"})})"#;
pub const REACTION: &str = r#"(states: ["u", "w"], parameters: {"p": 0.05, "q": 14.0, "r": 2.0},
    modes: {"flow": (rates: {"u": "-u + p*(1 - u)*exp(w)", "w": "-w + p*q*(1 - u)*exp(w) - r*w"})})"#;
pub const FITZHUGH: &str = r#"(states: ["v", "w"], parameters: {"I": 0.0, "b": 0.45, "eps": 0.08, "a": 0.7},
    modes: {"flow": (rates: {"v": "v - v^3/3 - w + I", "w": "eps*(v + a - b*w)"})})"#;
pub const PITCHFORK: &str = r#"(states: ["x", "y"], parameters: {"mu": -1.0, "q": 1.0},
    modes: {"flow": (rates: {"x": "mu*x + x*y - q*x^5", "y": "-y + x^2"})})"#;
pub const HARVEST: &str = r#"(states: ["x", "y"], parameters: {"a": 1.0, "b": 0.3, "d": 0.42, "h": 0.15, "al": 0.45},
    modes: {
        "low": (rates: {"x": "x*(1 - x) - a*x*y/(b + x)", "y": "a*x*y/(b + x) - d*y"}, until: [(zero: "al - y", to: "high")]),
        "high": (rates: {"x": "x*(1 - x) - a*x*y/(b + x)", "y": "a*x*y/(b + x) - (d + h)*y"},
            until: [(zero: "y - al", to: "low")]),
    }, sliding: {"slide": ("low", "high")})"#;
pub const CHUA: &str = r#"(states: ["x", "y", "z"],
    parameters: {"alpha": 6.0, "beta": 14.28, "c": -0.14285714285714285714, "m": 0.28571428571428571429, "E": 1.2857142857142857143},
    modes: {
        "left": (rates: {"x": "alpha*(y - m*x - (m - c)) + E", "y": "x - y + z", "z": "-beta*y"},
            until: [(zero: "-1 - x", to: "middle")]),
        "middle": (rates: {"x": "alpha*(y - c*x) + E", "y": "x - y + z", "z": "-beta*y"},
            until: [(zero: "1 - x", to: "right"), (zero: "x + 1", to: "left")]),
        "right": (rates: {"x": "alpha*(y - m*x - (c - m)) + E", "y": "x - y + z", "z": "-beta*y"},
            until: [(zero: "x - 1", to: "middle")]),
    })"#;
pub const FOCI: &str = r#"(states: ["x", "y"], parameters: {"mu": 0.5, "tL": -0.8, "dL": 1.0, "tR": 0.4, "dR": 1.0},
    modes: {
        "left": (rates: {"x": "tL*x - y", "y": "dL*x - mu"}, until: [(zero: "-x", to: "right")]),
        "right": (rates: {"x": "tR*x - y", "y": "dR*x - mu"}, until: [(zero: "x", to: "left")]),
    })"#;
pub const RELAY: &str = r#"(states: ["s", "x", "y"], parameters: {"mu": -0.3, "k": 0.4, "c": 0.05, "M": 0.8, "p": 0.6, "r": 0.3},
    modes: {
        "plus": (rates: {"s": "p*x + r*y - M", "x": "mu*x - y - x*(x^2 + y^2) + k", "y": "x + mu*y - y*(x^2 + y^2) + c"},
            until: [(zero: "s", to: "minus")]),
        "minus": (rates: {"s": "p*x + r*y + M", "x": "mu*x - y - x*(x^2 + y^2) - k", "y": "x + mu*y - y*(x^2 + y^2) + c"},
            until: [(zero: "-s", to: "plus")]),
    }, sliding: {"slide": ("plus", "minus")})"#;
pub const TWO: &str = r#"(states: ["x", "v", "y", "w"], parameters: {"m": 0.0, "n": 0.15, "k": 2.0, "kap": 0.5},
    modes: {"flow": (rates: {"x": "v", "v": "-x + (m - x^2)*v + kap*w", "y": "w", "w": "-k*y + (n - y^2)*w + kap*x"})})"#;

/// A system, the place to begin at, the parameter and its range.
#[derive(Clone, Copy)]
pub struct Course<'a> {
    pub system: &'a str,
    pub mode: &'a str,
    pub state: &'a [f64],
    pub parameter: &'a str,
    pub range: (f64, f64),
}

/// The states of a system in these units, in reversed order where asked for.
pub fn in_units(text: &str, units: &[f64], reversed: bool) -> Source {
    let mut source: Source = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(text)
        .unwrap();
    let states = source.states.clone();
    let unit = |name: &str| {
        let index = states.iter().position(|state| state == name)?;
        units.get(index).copied()
    };
    let written = |expression: &str| {
        let mut found = String::new();
        let mut word = String::new();
        for c in expression.chars().chain([' ']) {
            if c.is_alphanumeric() || c == '_' {
                word.push(c);
                continue;
            }
            match unit(&word) {
                Some(unit) => found.push_str(&format!("({unit:?}*{word})")),
                None => found.push_str(&word),
            }
            word.clear();
            found.push(c);
        }
        found
    };
    for (_, defined) in &mut source.define.0 {
        *defined = written(defined);
    }
    for (_, mode) in &mut source.modes.0 {
        for (name, rate) in &mut mode.rates.0 {
            *rate = format!("({})/{:?}", written(rate), unit(name).unwrap());
        }
        for switch in &mut mode.until {
            switch.zero = written(&switch.zero);
        }
    }
    if reversed {
        source.states.reverse();
    }
    source
}

impl Course<'_> {
    /// The problem with the states in these units.
    pub fn problem(&self, units: &[f64], reversed: bool, more: &str) -> SystemProblem {
        let names: Source = in_units(self.system, &[1.0; 9], false);
        let state = names.states.iter().zip(self.state).zip(units);
        let state: Vec<String> = state
            .map(|((name, x), unit)| format!("\"{name}\": {:?}", x / unit))
            .collect();
        let source = in_units(self.system, units, reversed);
        let text = format!(
            "(system: {}, equilibrium: (start: Given(mode: \"{}\", state: {{{}}})),
            continuation: (parameter: \"{}\", range: {:?}), {more})",
            ron::to_string(&source).unwrap(),
            self.mode,
            state.join(", "),
            self.parameter,
            self.range
        );
        match parse_any(&text, "test") {
            Ok(Any::System(problem)) => *problem,
            other => panic!("{other:?} of {text}"),
        }
    }

    pub fn all(&self, units: &[f64], reversed: bool) -> Vec<EquilibriumItem> {
        let problem = self.problem(units, reversed, "");
        followed(runner(&problem, None))
    }

    pub fn events(&self) -> Vec<EquilibriumEvent> {
        events(&self.all(&[1.0; 9], false))
    }
}

pub fn runner(problem: &SystemProblem, named: Option<&NamedEquilibrium>) -> EquilibriumRunner {
    let section = problem.continuation.as_ref().unwrap();
    EquilibriumRunner::begin(problem, section, named).unwrap_or_else(|error| panic!("{error}"))
}

pub fn followed(mut runner: EquilibriumRunner) -> Vec<EquilibriumItem> {
    let all = to_its_end(&mut runner);
    assert_eq!(runner.progress().end, Some(RunEnd::Finished));
    all
}

/// All points of a branch, however it ends.
pub fn to_its_end(runner: &mut EquilibriumRunner) -> Vec<EquilibriumItem> {
    let mut all = Vec::new();
    while runner.progress().end.is_none() {
        all.extend(runner.step());
    }
    all
}

/// The events of a branch but for its ends.
pub fn events(all: &[EquilibriumItem]) -> Vec<EquilibriumEvent> {
    let events = all.iter().filter_map(|item| item.event.clone());
    events.filter(|event| event.kind != EP).collect()
}

pub fn number(event: &EquilibriumEvent, name: &str) -> f64 {
    event
        .number(name)
        .unwrap_or_else(|| panic!("{name} of {event:?}"))
}

/// The one event of a type at a value has these numbers, to a few hundred roundings.
#[track_caller]
pub fn meets(
    all: &[EquilibriumEvent],
    kind: EventType,
    parameter: &str,
    value: f64,
    numbers: &[(&str, f64)],
) {
    let near = |event: &&EquilibriumEvent| {
        let off = (number(event, parameter) - value).abs();
        let same = |(name, expected): &(&str, f64)| {
            (number(event, name) - expected).abs() <= 1e-13 * expected.abs().max(1.0)
        };
        event.kind == kind
            && off <= 1e-13 * value.abs().max(1e-2)
            && off <= 2.0 * event.uncertainty
            && numbers.iter().all(same)
    };
    let found = all.iter().filter(near).count();
    assert_eq!(found, 1, "{kind} at {value}, {numbers:?}: {all:#?}");
}

pub const STARTS: [Course; 11] = [
    Course {
        system: BRUSSELATOR,
        mode: "flow",
        state: &[1.1, 1.4],
        parameter: "B",
        range: (1.0, 3.0),
    },
    Course {
        system: PREDATORS,
        mode: "flow",
        state: &[0.33, 0.5],
        parameter: "K",
        range: (0.2, 2.0),
    },
    Course {
        system: LORENZ,
        mode: "flow",
        state: &[7.0, 7.0, 19.0],
        parameter: "r",
        range: (0.5, 30.0),
    },
    Course {
        system: REACTION,
        mode: "flow",
        state: &[0.0, 0.0],
        parameter: "p",
        range: (0.01, 0.2),
    },
    Course {
        system: FITZHUGH,
        mode: "flow",
        state: &[-1.0, -0.6],
        parameter: "I",
        range: (-1.0, 4.0),
    },
    Course {
        system: PITCHFORK,
        mode: "flow",
        state: &[0.0, 0.0],
        parameter: "mu",
        range: (-1.5, 1.0),
    },
    Course {
        system: HARVEST,
        mode: "low",
        state: &[0.21, 0.4],
        parameter: "al",
        range: (0.3, 0.6),
    },
    Course {
        system: CHUA,
        mode: "right",
        state: &[2.2, 0.0, -2.2],
        parameter: "E",
        range: (-2.0, 2.0),
    },
    Course {
        system: FOCI,
        mode: "right",
        state: &[0.5, 0.2],
        parameter: "mu",
        range: (-1.0, 1.0),
    },
    Course {
        system: RELAY,
        mode: "slide",
        state: &[0.0, 0.0, 0.0],
        parameter: "mu",
        range: (-0.6, 0.3),
    },
    Course {
        system: TWO,
        mode: "flow",
        state: &[0.0; 4],
        parameter: "m",
        range: (-1.0, 1.0),
    },
];
