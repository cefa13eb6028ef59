//! A tube with its numbers in SI units, and the model that it is.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::outline::Outline;
use crate::tube::model::{CoefficientSource, Damping, FrictionLaw, Impact, Model};

/// The section `tube`, which stands in the place of `model`. Friction, damping and impact are those of a
/// model, in its units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tube {
    /// Young's modulus E > 0, Pa.
    pub young: f64,
    /// Density ρ > 0, kg/m³.
    pub density: f64,
    /// Poisson's ratio ν in (−1, ½).
    pub poisson: f64,
    /// Inner radius R > 0 of the tube when it is not on the shaft, m.
    pub inner: f64,
    /// Outer radius R* > R, held, m.
    pub outer: f64,
    /// Radius of the shaft less R, d > 0, m.
    pub oversize: f64,
    /// How fast the shaft turns.
    pub rotation: Rotation,
    /// Friction coefficient f ≥ 0.
    pub friction: f64,
    /// Damping, zero unless given, in units of Ω and 1/Ω.
    #[serde(default)]
    pub damping: Damping,
    /// Law of the impact that ends a separation.
    #[serde(default)]
    pub impact: Impact,
    /// Law of friction; its velocities are in units of RΩ.
    #[serde(default, rename = "friction_law")]
    pub law: FrictionLaw,
}

/// How fast the shaft turns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Rotation {
    /// Revolutions per minute.
    Rpm(f64),
    /// Angular velocity, rad/s.
    RadPerSecond(f64),
}

impl Rotation {
    /// Ω in rad/s.
    pub fn angular_velocity(self) -> f64 {
        match self {
            Rotation::Rpm(rpm) => rpm * TAU / 60.0,
            Rotation::RadPerSecond(velocity) => velocity,
        }
    }
}

impl Tube {
    /// Speed RΩ of the surface of the shaft, m/s.
    pub fn bore_speed(&self) -> f64 {
        self.inner * self.rotation.angular_velocity()
    }

    /// ξ = R*/R, γ = ρ(RΩ)²/E, δ = d/R, and all that a model shares with it.
    pub fn model(&self) -> Model {
        let bore = self.bore_speed();
        Model {
            source: CoefficientSource::Geometry {
                nu: self.poisson,
                xi: self.outer / self.inner,
                gamma: self.density * (bore * bore) / self.young,
            },
            friction: self.friction,
            mismatch: self.oversize / self.inner,
            damping: self.damping,
            impact: self.impact,
            law: self.law,
        }
    }
}

/// Fields of a model that a tube has under another name.
const RENAMED: [(&str, &str); 4] = [
    ("model.mismatch", "tube.oversize"),
    ("model.coefficients.nu", "tube.poisson"),
    ("model.coefficients.xi", "tube.outer"),
    ("model.coefficients.gamma", "tube.rotation"),
];

/// Where the text has what a model has at this path: in its section `model`, or in `tube`.
pub(super) fn place_of(path: &str, outline: &Outline<'_>) -> String {
    let of_model = path.strip_prefix("model").filter(|_| outline.has("tube"));
    let renamed = RENAMED.iter().find(|(model, _)| *model == path);
    match (of_model, renamed) {
        (None, _) => path.to_owned(),
        (_, Some((_, tube))) => (*tube).to_owned(),
        (Some(rest), None) => format!("tube{rest}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::refused;
    use super::super::{Problem, ProblemError, parse};
    use super::*;
    use crate::tube::model::Parameter;

    const TUBE: &str = "(
    tube: (young: 2e9, density: 2000, poisson: 0.3, inner: 0.2, outer: 0.3, oversize: 1e-4, rotation: Rpm(300), friction: 0.5),
    wave: (mode: 4, start: Fast),
    continuation: (parameter: Mismatch, range: (5e-5, 1.5e-3)),
    output: (plots: [Column(\"hertz\")]),
)";

    fn read(from: &str, to: &str) -> Result<Problem, ProblemError> {
        assert_eq!(TUBE.matches(from).count(), 1, "{from}");
        parse(&TUBE.replace(from, to), "p.ron")
    }

    /// The formulas of docs/waves.md, whichever way the rotation is written.
    #[test]
    fn a_tube_is_its_model() {
        let problem = read(
            "friction: 0.5",
            "friction: 0.5, impact: Coulomb, damping: (stiffness: 0.01)",
        );
        let problem = problem.unwrap();
        let bore = 0.2 * 300.0 * TAU / 60.0;
        for (parameter, expected) in [
            (Parameter::Nu, 0.3),
            (Parameter::Xi, 1.5),
            (Parameter::Gamma, 2000.0 * bore * bore / 2e9),
            (Parameter::Mismatch, 5e-4),
            (Parameter::Friction, 0.5),
            (Parameter::StiffnessDamping, 0.01),
        ] {
            let found = problem.model.value(parameter).unwrap();
            assert!(
                (found / expected - 1.0).abs() < 1e-15,
                "{parameter:?}: {found}"
            );
        }
        assert_eq!(problem.model.impact, Impact::Coulomb);
        assert_eq!(problem.output.rotation, Some(10.0 * TAU / 2.0));
        let other = read("Rpm(300)", "RadPerSecond(31.41592653589793)").unwrap();
        let difference = other.model.value(Parameter::Gamma).unwrap()
            / problem.model.value(Parameter::Gamma).unwrap();
        assert!((difference - 1.0).abs() < 1e-15);
        let stored = ron::to_string(&problem).unwrap();
        assert_eq!(ron::from_str::<Problem>(&stored).unwrap(), problem);
    }

    /// Refused at the text of the user, in the words of a tube.
    #[test]
    fn what_is_no_tube_is_refused_where_it_stands() {
        #[rustfmt::skip]
        let cases = [
            // text, replacement, marked, message, help
            ("poisson: 0.3", "poisson: 0.6", "0.6", "`tube.poisson` is 0.6", "between -1 and 0.5"),
            ("young: 2e9", "young: 0", "0", "`tube.young` is 0.0", "in Pa, must be greater than 0"),
            ("density: 2000", "density: inf", "inf", "`tube.density` is inf", "finite"),
            ("outer: 0.3", "outer: 0.1", "0.1", "`tube.outer` is 0.1", "greater than the inner one, 0.2"),
            ("outer: 0.3", "outer: 1e300", "1e300", "this tube has xi = inf", "greater than 1"),
            ("Rpm(300)", "Rpm(-300)", "-300", "`tube.rotation` is -300.0", "must turn"),
            ("Rpm(300)", "300", "300", "must be a name", "Rpm(600.0)"),
            ("Rpm(300)", "Hertz(5)", "Hertz", "unknown choice `Hertz`", "Rpm(600.0)"),
            ("Rpm(300)", "Rpm(1e-200)", "Rpm(1e-200)", "this tube has gamma = 0.0", "greater than 0"),
            ("friction: 0.5", "friction: -0.5", "-0.5", "`tube.friction` is -0.5", "at least 0"),
            ("friction: 0.5", "friction: 0.5, damping: (mass: -1)", "-1", "`tube.damping.mass`", "at least 0"),
            ("friction: 0.5", "frcition: 0.5", "frcition", "unknown field `frcition` in `tube`", "friction: 0.5"),
            (", friction: 0.5", "", "(", "missing field `friction` in `tube`", "friction: 0.5"),
            ("(5e-5, 1.5e-3)", "(5e-6, 1.5e-4)", "(5e-6, 1.5e-4)", "starts at mismatch = 0.0005, outside", "oversize/inner"),
            ("output: (", "output: (rotation: 62.8, ", "62.8", "`output.rotation` is given beside `tube`", "leave it out"),
        ];
        for (from, to, place, message, help) in cases {
            let text = TUBE
                .replace(from, to)
                .replace("inner: 0.2, outer: 1e300", "inner: 1e-9, outer: 1e300");
            assert_ne!(text, TUBE, "{from}");
            refused(&text, place, message, help);
        }
        let model = "model: (coefficients: Given(a: 2, b: 1, D: 1, g: 1, h: 1), friction: 0.5, mismatch: 1),\nwave:";
        let both = read("wave:", model).unwrap_err();
        assert!(
            both.to_string().contains("`tube` is given beside `model`"),
            "{both}"
        );
        assert_eq!(both.line(), Some(2));
        let error = parse("(wave: (mode: 4, start: Fast))", "p.ron").unwrap_err();
        assert!(
            error.help().contains("`model: (") && error.help().contains("or `tube: (young: 2e9"),
            "{error}"
        );
    }

    /// What is refused only later points into the tube as well.
    #[test]
    fn paths_of_a_model_lead_into_the_tube() {
        let at = |path: &str| {
            let error = super::super::refuse_at(TUBE, "p.ron", path, "x", "y");
            TUBE.lines()
                .nth(1)
                .unwrap()
                .chars()
                .skip(error.column().unwrap() - 1)
                .take(5)
                .collect::<String>()
        };
        let places = [
            "model.mismatch",
            "model.friction",
            "model.coefficients.gamma",
        ]
        .map(at);
        assert_eq!(places, ["1e-4,", "0.5),", "Rpm(3"]);
        assert_eq!(at("model.damping.mass"), "(youn");
        assert!(
            super::super::says(TUBE, "model.friction")
                && !super::super::says(TUBE, "model.damping")
        );
        let written = super::super::decimal_at(TUBE, "model.coefficients.nu").unwrap();
        assert_eq!(written.nearest(), 0.3);
    }
}
