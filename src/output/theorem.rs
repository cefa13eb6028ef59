//! What is proven of a branch in words, so that it can be cited: hypothesis and conclusion for every point.

use crate::affine::orbit::Watch;
use crate::affine::system::System;
use crate::certify::{
    self, ArcOutcome, CertifiedPoint, Counted, ProofOutcome, Provable, ProvenVerdict, WaveProof,
    equilibrium, orbit,
};
use crate::interval::{Decimal, Interval};

/// A point as a theorem.
pub(crate) trait Stated: Provable {
    /// What lies on a branch between two points.
    const CURVE: &'static str;

    /// Hypothesis and conclusion for a proven point.
    fn theorem(&self, point: &CertifiedPoint<Self>, system: Option<&System>) -> String;
}

/// All theorems of a certificate, with headings.
pub(crate) fn theorems<P: Stated>(points: &[CertifiedPoint<P>], system: Option<&System>) -> String {
    let mut text = "# What is proven\n\nIn `certificate.ron` stands what proves these statements, in `source.ron` the \
        problem. Its numbers are the decimals that are written there. An interval is closed, and its ends are doubles.\n"
        .to_owned();
    let mut before = None;
    for point in points {
        let CertifiedPoint { label, kind, .. } = point;
        text.push_str(&format!("\n## {label}: {kind}\n\n"));
        match &point.outcome {
            ProofOutcome::Proven(proof) => text.push_str(&proof.theorem(point, system)),
            ProofOutcome::Open(reason) => {
                text.push_str(&format!("Nothing is proven here. {reason}.\n"))
            }
        }
        if let (Some(ArcOutcome::Proven), Some(before)) = (&point.arc, before) {
            text.push_str(&format!(
                "\n**From {before} to {label}.** {} Every inequality holds on all of it.\n",
                P::CURVE
            ));
        }
        before = Some(label);
    }
    text
}

/// Names and values, joined as in a sentence.
fn listed<'a>(pairs: impl Iterator<Item = (&'a str, &'a Decimal)>) -> String {
    let pairs: Vec<String> = pairs
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    pairs.join(", ")
}

impl Stated for orbit::OrbitProof {
    const CURVE: &'static str = "The orbits between these two are one curve without a fold, and all have one sequence \
        of zones. Of multipliers that pass −1 or the unit circle nothing is said.";

    fn theorem(&self, point: &CertifiedPoint<Self>, system: Option<&System>) -> String {
        let (said, name) = (&self.statement, &point.parameter);
        let names = system.map(|system| system.source.parameters.names());
        let values = names.into_iter().flatten().zip(&self.posed.values);
        let given = listed(values.filter(|(other, _)| other != name));
        let forced = system.is_some_and(|system| system.source.forcing.is_some());
        let closes = match (forced, self.posed.periods) {
            (false, _) => "It closes after its period and no part of it.".to_owned(),
            (true, 1) => "It closes after one period of the forcing.".to_owned(),
            (true, n) => format!("It closes after {n} periods of the forcing and no part of them."),
        };
        let ends =
            |way: &crate::affine::orbit::Way| format!("guard {}, exit {}", way.guard, way.exit);
        let zones = self.near.sequence.0.iter();
        let zones: Vec<String> = zones
            .map(|zone| match &zone.way {
                Some(way) => format!("{zone} ({})", ends(way)),
                None => zone.to_string(),
            })
            .collect();
        let given = match given.is_empty() {
            true => String::new(),
            false => format!(" with {given}"),
        };
        let made = made_by_contacts(system);
        format!(
            "**Hypothesis.** The system of `source.ron`{given}; {name} is free.{made} A guard is positive in its mode; where it is \
             zero the first of its exits is taken whose conditions are not negative.\n\n\
             **Conclusion.** There are a number {name} in {} and a periodic orbit with a period in {} and the zones {}. {closes} \
             Every guard is positive within every zone, except what vanishes at the event; every condition of an exit that is \
             taken holds, and none before it is; where two guards of a mode are zero at once, both lead on alike \
             ({} inequalities). {} No other orbit with these zones that satisfies the equations of the point has its parameter \
             within {:e} and its other unknowns within the same share of their units.\n",
            written(said.parameter),
            written(said.period),
            zones.join(" → "),
            said.inequalities,
            self.singled_out(),
            said.unique,
        )
    }
}

/// Where the modes of a system come from, if contacts make them.
fn made_by_contacts(system: Option<&System>) -> &'static str {
    match system.is_some_and(|system| !system.source.contacts.is_empty()) {
        true => {
            " Its modes, their guards and exits are made by the laws of its contacts, forces that hold being those that keep a \
             slip or a closed gap at zero."
        }
        false => "",
    }
}

impl orbit::OrbitProof {
    /// What makes the point a special one.
    fn singled_out(&self) -> String {
        let said = &self.statement;
        match &self.condition {
            orbit::OrbitCondition::Value(value) => {
                let outside = said.outside.map(|outside| match outside {
                    0 => " All its multipliers, but the trivial one of an orbit without forcing, are inside the unit circle."
                        .to_owned(),
                    _ => format!(" {outside} of its multipliers are outside the unit circle."),
                });
                format!(
                    "The parameter is {value}; the orbit is one of a curve on which the parameter is the coordinate.{}",
                    outside.unwrap_or_default()
                )
            }
            orbit::OrbitCondition::Fold => "The orbit is one of a curve along which the parameter is stationary there and has a \
                second derivative that is not zero: a quadratic fold."
                .to_owned(),
            orbit::OrbitCondition::Doubling => "With P the linearised return to the first entry at the same phase, −1 is a \
                geometrically simple eigenvalue of P, and det(P + 1) passes through zero along the branch with a slope that is not \
                zero. That −1 is algebraically simple is not said."
                .to_owned(),
            orbit::OrbitCondition::Branching => "The orbit is −x half a period later. With P the linearised map of that half, \
                followed by x → −x, −1 is a geometrically simple eigenvalue of P, and det(P + 1) passes through zero along the \
                branch with a slope that is not zero."
                .to_owned(),
            orbit::OrbitCondition::Torus { .. } => {
                let angle = said.angle.map(written).unwrap_or_default();
                format!(
                    "With P the linearised return to the first entry at the same phase, e^(iθ) and e^(−iθ) with θ in {angle}, inside \
                     (0, π), are simple eigenvalues of P; their modulus passes 1 along the branch with a slope that is not zero."
                )
            }
            orbit::OrbitCondition::Margin { watch, zone, .. } => {
                let what = match watch {
                    Watch::Inside(guard) => format!("guard {guard} touches zero within zone {zone}"),
                    Watch::Onset(guard) => {
                        format!("the first derivative of guard {guard} that is not zero on the branch vanishes at the entry of zone {zone}")
                    }
                    Watch::End(guard) => format!("guard {guard}, or its first derivative that is not zero on the branch, vanishes at the end of zone {zone}"),
                    Watch::Speed => format!("the guard that ends zone {zone} is zero with a rate of zero"),
                    Watch::Condition(index) => {
                        format!("condition {index} of the exit taken at the end of zone {zone} is zero")
                    }
                    Watch::Before(exit) => {
                        format!("the condition by which exit {exit} is not taken at the end of zone {zone} is zero")
                    }
                    Watch::Duration => format!("zone {zone} has no duration"),
                };
                format!(
                    "There {what}, and along the branch in this sequence of zones that passes through zero with a slope that is not zero."
                )
            }
        }
    }
}

impl Stated for equilibrium::EquilibriumProof {
    const CURVE: &'static str = "The equilibria between these two are one curve.";

    fn theorem(&self, point: &CertifiedPoint<Self>, system: Option<&System>) -> String {
        let (said, name) = (&self.statement, &point.parameter);
        let source = system.map(|system| &system.source);
        let names = source.map(|source| source.parameters.names());
        let values = names.into_iter().flatten().zip(&self.posed.values);
        let given = listed(values.filter(|(other, _)| other != name));
        let given = match given.is_empty() {
            true => String::new(),
            false => format!(" with {given}"),
        };
        let states = source.into_iter().flat_map(|source| &source.states);
        let states = states.zip(&said.states);
        let states = states.map(|(state, interval)| format!("{state} in {}", written(*interval)));
        let states: Vec<String> = states.collect();
        let growing = said.growing.map(|growing| {
            let beside = match self.condition {
                equilibrium::EquilibriumCondition::Fold => " beside 0",
                equilibrium::EquilibriumCondition::Hopf { .. } => " beside ± iω",
                _ => "",
            };
            format!(
                " {growing} eigenvalues of `{}` have a positive real part there, all others{beside} a negative one.",
                self.near.mode
            )
        });
        let made = made_by_contacts(system);
        format!(
            "**Hypothesis.** The system of `source.ron`{given}; {name} is free.{made} A guard is positive in its mode; a sliding mode \
             lasts while the fields of both modes on its sides push to its surface and their other guards are positive.\n\n\
             **Conclusion.** There are a number {name} in {} and an equilibrium of `{}` with {}. Every guard of the mode is positive \
             there, except what vanishes at the event ({} inequalities). {}{} No other equilibrium of the mode that satisfies the \
             equations of the point has its parameter within {:e} and its other unknowns within the same share of their units.\n",
            written(said.parameter),
            self.near.mode,
            states.join(", "),
            said.inequalities,
            self.singled_out(system),
            growing.unwrap_or_default(),
            said.unique,
        )
    }
}

impl equilibrium::EquilibriumProof {
    /// What makes the point a special one.
    fn singled_out(&self, system: Option<&System>) -> String {
        let said = &self.statement;
        match &self.condition {
            equilibrium::EquilibriumCondition::Value(value) => format!(
                "The parameter is {value}; the equilibrium is one of a curve on which the parameter is the coordinate."
            ),
            equilibrium::EquilibriumCondition::Fold => "It is one of a curve along which the parameter is stationary there and has a second \
                derivative that is not zero: a quadratic fold. 0 is a geometrically simple eigenvalue."
                .to_owned(),
            equilibrium::EquilibriumCondition::Hopf { .. } => {
                let omega = said.omega.map(written).unwrap_or_default();
                let lyapunov = match said.lyapunov {
                    Some(equilibrium::ProvenLyapunov::Vertical) => {
                        " The rates of the mode are affine in the states: the cycles in the plane of the pair all belong to this \
                         value of the parameter, as far as they lie in the mode."
                            .to_owned()
                    }
                    Some(equilibrium::ProvenLyapunov::Within(interval)) => {
                        let sign = if interval.is_negative() {
                            ": it is supercritical"
                        } else if interval.is_positive() {
                            ": it is subcritical"
                        } else {
                            ""
                        };
                        format!(
                            " Its first Lyapunov coefficient, with ⟨q, q⟩ = 1 and the factor 1/ω, is in {}{sign}.",
                            written(interval)
                        )
                    }
                    None => String::new(),
                };
                format!(
                    "± iω with ω in {omega} are simple eigenvalues, and their real part passes zero along the branch with a speed \
                     that is not zero.{lyapunov}"
                )
            }
            equilibrium::EquilibriumCondition::Boundary { .. } => {
                let what = system.and_then(|system| self.vanishing(system));
                let beyond = self.beyond.as_ref().map(|beyond| {
                    let sides = match beyond.persists {
                        true => "different sides of it: the equilibrium persists",
                        false => "one side of it: a nonsmooth fold",
                    };
                    format!(
                        " `{}` rests there, too, with every other of its guards positive. Next to this value of the parameter the \
                         equilibria of either mode are a curve with the parameter as its coordinate; those that are admissible lie on \
                         {sides}.",
                        beyond.mode
                    )
                });
                format!(
                    "There {} is zero, and along the branch in this mode it passes through zero with a slope that is not zero.{}",
                    what.unwrap_or_default(),
                    beyond.unwrap_or_default()
                )
            }
        }
    }
}

impl Stated for WaveProof {
    const CURVE: &'static str = "The waves between these two are one curve without a fold, and all have one sequence of \
        regimes. Of eigenvalues that cross the imaginary axis nothing is said.";

    fn theorem(&self, point: &CertifiedPoint<Self>, _: Option<&System>) -> String {
        let (said, posed) = (&self.statement, &self.posed);
        let symbol = point.parameter.symbol();
        let singled = match &self.condition {
            certify::WaveCondition::Value(value) => format!(
                "{symbol} is {value}; the wave is one of a curve on which {symbol} is the coordinate."
            ),
            certify::WaveCondition::Fold => format!(
                "The wave is one of a curve along which {symbol} is stationary there and has a second derivative that is not \
                 zero: a quadratic fold."
            ),
            certify::WaveCondition::Crossing { sector, .. } => {
                let omega = said.omega.map(written).unwrap_or_default();
                format!(
                    "In Bloch sector {sector}, iω with ω in {omega} is a simple eigenvalue of the linearised equations, and \
                     crosses the imaginary axis along the branch with a speed that is not zero."
                )
            }
            certify::WaveCondition::Margin { watch, zone, .. } => format!(
                "The inequality {watch:?} of zone {zone} vanishes there, and along the branch in this sequence of regimes passes \
                 through zero with a slope that is not zero."
            ),
        };
        let lengths: Vec<String> = said.lengths.iter().copied().map(written).collect();
        let mut text = format!(
            "**Hypothesis.** The model of `source.ron`; {symbol} is free.\n\n\
             **Conclusion.** There are a number {symbol} in {} and a travelling wave of mode {} with a speed c in {} and the regimes \
             {}, whose zones have lengths in {}. Every inequality of contact and friction holds over whole zones, except what \
             vanishes at the event ({} inequalities). {singled} No other wave with these regimes that satisfies the equations of \
             the point has its parameter within {:e} and its other unknowns within the same share of their units.\n",
            written(said.parameter),
            posed.mode,
            written(said.speed),
            self.near.signature,
            lengths.join(", "),
            said.inequalities,
            said.unique,
        );
        for eigenvalue in &self.eigenvalues {
            text.push_str(&format!(
                "\nIn Bloch sector {} there is an eigenvalue with Re λ in {} and Im λ in {}.\n",
                eigenvalue.sector,
                written(eigenvalue.growth),
                written(eigenvalue.omega),
            ));
        }
        if let Some(Counted::Proven(growth)) = &point.growth {
            let counts: Vec<String> = growth.counts.iter().map(usize::to_string).collect();
            let follows = match growth.verdict {
                ProvenVerdict::Stable { .. } => {
                    " No other has Re λ ≥ 0 but λ = 0 of translation: the wave is stable."
                }
                ProvenVerdict::Unstable => " The wave is unstable.",
                ProvenVerdict::Neutral | ProvenVerdict::HighFrequency => {
                    " Stability is not decided by that."
                }
            };
            text.push_str(&format!(
                "\nIn the Bloch sectors from 0 on, {} eigenvalues have Re λ > 0 and |Im λ| up to {}.{follows}\n",
                counts.join(", "),
                growth.window,
            ));
        }
        text
    }
}

/// An interval whose ends, written with 17 digits or as few as read back, enclose it: the decimal of a
/// double is nearer to it than the next double is.
pub(super) fn enclosing(Interval { low, high }: Interval) -> Interval {
    if low == 0.0 && high == 0.0 {
        return Interval::ZERO;
    }
    Interval::new(low.next_down(), high.next_up())
}

/// An interval in words.
pub(super) fn written(interval: Interval) -> String {
    let Interval { low, high } = enclosing(interval);
    format!("[{low:?}, {high:?}]")
}
