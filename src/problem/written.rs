//! A problem file as it is written, where one section may stand in the place of another one.

use serde::{Deserialize, Serialize};

use super::error::Flaw;
use super::examples::example;
use super::expectation::of_waves;
use super::outline::{Outline, Subject};
use super::{
    Continuation, CurveSection, Expectation, Map, Output, Problem, StabilitySection, Tube,
    WaveSection,
};
use crate::simulation::task::Simulation;
use crate::tube::flow::method::Method;
use crate::tube::model::Model;

/// The sections of a problem file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Problem", deny_unknown_fields)]
pub(super) struct WrittenProblem {
    title: Option<String>,
    model: Option<Model>,
    tube: Option<Tube>,
    wave: Option<WaveSection>,
    method: Option<Method>,
    pub continuation: Option<Continuation>,
    stability: Option<StabilitySection>,
    map: Option<Map>,
    simulation: Option<Simulation>,
    curve: Option<CurveSection>,
    #[serde(default)]
    output: Output,
    #[serde(default, deserialize_with = "of_waves")]
    pub expect: Vec<Expectation>,
    #[serde(default)]
    certify: bool,
}

/// What moves: a model in its own units, or a tube in metres.
enum Brake {
    Model(Model),
    Tube(Tube),
}

impl WrittenProblem {
    /// The problem that is meant.
    pub fn problem(self, outline: &Outline<'_>) -> Result<Problem, Flaw> {
        let brake = one_of(
            outline,
            [
                ("model", self.model.map(Brake::Model)),
                ("tube", self.tube.map(Brake::Tube)),
            ],
        )?;
        let wave = one_of(outline, [("wave", self.wave)])?;
        let mut output = self.output;
        let (model, tube) = match brake {
            Brake::Model(model) => (model, None),
            Brake::Tube(tube) => {
                if output.rotation.is_some() {
                    let at = outline.locate("output.rotation");
                    let message = "`output.rotation` is given beside `tube`, which has its own";
                    return Err(Flaw::new(at, message, "leave it out"));
                }
                output.rotation = Some(tube.rotation.angular_velocity());
                (tube.model(), Some(tube))
            }
        };
        Ok(Problem {
            title: self.title,
            model,
            tube,
            wave,
            method: self.method,
            continuation: self.continuation,
            stability: self.stability,
            map: self.map,
            simulation: self.simulation,
            curve: self.curve,
            output,
            expect: self.expect,
            certify: self.certify,
        })
    }
}

/// What is wrong with a section beside another one.
pub(super) fn beside(outline: &Outline<'_>, second: &str, first: &str) -> Flaw {
    let message = format!("`{second}` is given beside `{first}`, in whose place it stands");
    Flaw::new(outline.locate(second), message, "keep one of the two")
}

/// The one that is written of sections that stand in each other's place, the usual one first.
fn one_of<T, const N: usize>(
    outline: &Outline<'_>,
    sections: [(&'static str, Option<T>); N],
) -> Result<T, Flaw> {
    let names = sections.each_ref().map(|(name, _)| *name);
    let mut given = sections
        .into_iter()
        .filter_map(|(name, section)| Some((name, section?)));
    match (given.next(), given.next()) {
        (Some((_, section)), None) => Ok(section),
        (Some((first, _)), Some((second, _))) => Err(beside(outline, second, first)),
        (None, _) => {
            let examples = names.map(|name| {
                let example = example(Subject::Tube, "", name).unwrap_or(name.to_owned());
                format!("`{example}`")
            });
            let message = format!("missing field `{}` in the problem", names[0]);
            let help = format!("add for example {}", examples.join(", or "));
            Err(Flaw::new(outline.locate(names[0]), message, help))
        }
    }
}
