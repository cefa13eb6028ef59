//! What is wrong with a system, at its place in the text of the problem and with what would be right.

use std::ops::Range;

use super::super::error::{Flaw, line};
use super::super::explanation::known;
use super::super::outline::{Outline, within_text};
use crate::affine::algebra::{Extremum, Function, Obstacle};
use crate::affine::contact::{ContactMistake, Kinematic};
use crate::affine::expression::Wrong;
use crate::affine::system::{BadName, Mistake, Source, SystemError};

/// The place and the words of a mistake.
pub(super) fn flaw(source: &Source, outline: &Outline, error: &SystemError) -> Flaw {
    let path = format!("system.{}", error.path);
    flaw_at(source, outline, &path, error)
}

/// The same at another path.
pub(super) fn flaw_at(source: &Source, outline: &Outline, path: &str, error: &SystemError) -> Flaw {
    let mut message = line(&error.mistake.to_string());
    let mut names = Vec::new();
    let help = match &error.mistake {
        Mistake::Expression(flaw) => {
            let help = about_expression(source, &flaw.wrong);
            if matches!(
                flaw.wrong,
                Wrong::Unknown(_) | Wrong::NoParameter(_) | Wrong::NoFunction(_)
            ) {
                names.extend(error.nearest.clone());
            }
            help
        }
        Mistake::States(_) => "write for example `states: [\"x\", \"v\"]`".to_owned(),
        Mistake::Rates => "write `rates` inside of each mode, or leave out `modes`".to_owned(),
        Mistake::SlidingContacts => "leave out `sliding`".to_owned(),
        Mistake::Contact(mistake) => about_contact(mistake),
        Mistake::NoModes => "add for example `\"free\": (rates: {\"x\": \"-x\"})`".to_owned(),
        Mistake::Name(_, bad) => match bad {
            BadName::NoWord => "write for example `x`, `A` or `theta_2`".to_owned(),
            BadName::Reserved => "choose another name".to_owned(),
            BadName::Twice => "keep one of the two, or give one another name".to_owned(),
        },
        Mistake::NoRate(state) => format!("add for example `\"{state}\": \"0\"`"),
        Mistake::NoState(_) => {
            names.extend(error.nearest.clone());
            format!("the states are {}", list(source.states.iter()))
        }
        Mistake::NoMode(_) => {
            names.extend(error.nearest.clone());
            format!("the modes are {}", list(source.modes.names()))
        }
        Mistake::NoSwitch(name) => {
            names.extend(error.nearest.clone());
            let mut known = source.switch_names().peekable();
            match known.peek() {
                Some(_) => format!("the names of switches are {}", list(known)),
                None => format!("add `name: \"{name}\"` to an entry of `until`"),
            }
        }
        Mistake::NoForcing => {
            "add for example `forcing: \"1.5\"`, its angular frequency, to `system`".to_owned()
        }
        Mistake::Frequency(_) | Mistake::Period(_) => {
            "change the parameters that it depends on".to_owned()
        }
        Mistake::Within(..) => "change the parameters that it depends on".to_owned(),
        Mistake::NoSurface(..) => {
            "give each of the two one `zero` that leads to the other, as in `v` and `-v`".to_owned()
        }
        Mistake::NoSliding(..) => {
            "leave out this sliding mode, or let the rates of the two differ".to_owned()
        }
    };
    if let Some(near) = names.first() {
        message = format!("{message}; did you mean `{near}`?");
    }
    Flaw::new(place(outline, path, &error.mistake), message, help)
}

/// What to do about a contact.
fn about_contact(mistake: &ContactMistake) -> String {
    match mistake {
        ContactMistake::Many(_) | ContactMistake::Products(_) | ContactMistake::States(_) => {
            "leave out contacts that do not change".to_owned()
        }
        ContactMistake::Nonlinear(name) => {
            format!("write sums of `{name}` times numbers, parameters and states")
        }
        ContactMistake::HasForce => "write it in terms of states and parameters".to_owned(),
        ContactMistake::NoInfluence(name, _) => {
            format!("add `+ {name}` to the rate of a velocity that it acts on")
        }
        ContactMistake::Sign(name, Kinematic::Slip) => format!(
            "write `+ {name}` in the rate of the velocity, or turn the sign of `slip`: a positive slip gets a negative \
             force"
        ),
        ContactMistake::Sign(name, Kinematic::Gap) => {
            format!("write `- {name}` where the gap is `d - x` and `+ {name}` where it is `x - d`")
        }
        ContactMistake::Massless => "let the force stand in the rate of a velocity".to_owned(),
        ContactMistake::Bound(_)
        | ContactMistake::Restitution(_)
        | ContactMistake::Coefficient(..)
        | ContactMistake::Static(..) => "change the parameters that it depends on".to_owned(),
        ContactMistake::BoundChanges => "write a number, or a parameter".to_owned(),
        ContactMistake::Impulse => {
            "let the restitution be 0, or let the bound depend on a `Spring`".to_owned()
        }
        ContactMistake::Singular(_) => {
            "let two contacts not hold the same velocity, or join them to one".to_owned()
        }
        ContactMistake::Pressed { .. } => "let one of the two be a `Spring`".to_owned(),
        ContactMistake::Behind(_) => "let the reset end where the gap is positive".to_owned(),
        ContactMistake::Paradox(..) => "lessen the coefficient of friction".to_owned(),
        ContactMistake::Obstacle(..) => "change the parameters that it depends on".to_owned(),
    }
}

/// Names by which functions that jump go elsewhere.
const JUMPS: [&str; 8] = [
    "sign",
    "sgn",
    "signum",
    "step",
    "heaviside",
    "floor",
    "ceil",
    "round",
];

/// The names of all functions.
fn functions() -> Vec<&'static str> {
    let of_two = Extremum::ALL.iter().map(|(name, _)| *name);
    let of_one = Function::ALL.iter().map(|function| function.name());
    of_one.chain(of_two).collect()
}

/// What an expression may have.
fn about_expression(source: &Source, wrong: &Wrong) -> String {
    let listed = || list(functions().into_iter());
    match wrong {
        Wrong::TooLong(_) | Wrong::TooDeep(_) => "name parts of it in `define`".to_owned(),
        Wrong::Unreadable => format!(
            "an expression has numbers, names, `+ - * / ^`, brackets and the functions {}",
            listed()
        ),
        Wrong::Unclosed => "close every bracket that is opened".to_owned(),
        Wrong::Unopened => "remove it, or open a bracket before it".to_owned(),
        Wrong::Juxtaposed => "a product is written with `*`, as in `c*v`".to_owned(),
        Wrong::Stars => "write for example `x^3`".to_owned(),
        Wrong::Comma => {
            "of two numbers, the greater is `max(a, b)` and the lesser `min(a, b)`; of three, `max(a, max(b, c))`".to_owned()
        }
        Wrong::Second => "write for example `max(x, 0)`".to_owned(),
        // time itself is in no expression
        Wrong::Unknown(name) if ["t", "time"].contains(&name.as_str()) => {
            "time stands in the phase of the forcing alone: write `cos(phase)` for `cos(w*t)`, with `forcing: \"w\"` in \
             `system`; or add a state of rate 1"
                .to_owned()
        }
        Wrong::NoParameter(_) => {
            format!("the parameters are {}", list(source.parameters.names()))
        }
        Wrong::NotBefore(_) => {
            "a value has numbers, `pi` and the parameters before it: let them stand in this order".to_owned()
        }
        Wrong::Unknown(_) => {
            let states = source.states.iter().map(String::as_str);
            let names = states
                .chain(source.parameters.names())
                .chain(source.define.names());
            format!(
                "the names are {}, and those before it in `define`",
                list(names)
            )
        }
        Wrong::NoFunction(name) if JUMPS.contains(&name.as_str()) => {
            "what jumps is a switch: write a contact, as -m*sign(s) is the force of `Friction(slip: \"s\", bound: \"m\")`, or a mode \
             for each side, each with a `zero` that leads to the other"
                .to_owned()
        }
        Wrong::NoFunction(name) => {
            let names = functions();
            let near = known(name, &names);
            format!("write a function that there is{near}")
        }
        Wrong::Obstacle(Obstacle::Deep) => {
            "write shorter expressions, or fewer abbreviations of abbreviations".to_owned()
        }
        Wrong::Obstacle(Obstacle::NotAffine) => {
            "write a sum of states times coefficients of the parameters".to_owned()
        }
        Wrong::Obstacle(Obstacle::Phase) => {
            "write for example `cos(phase)` or `sin(2*phase)`; 16 times the phase is the most"
                .to_owned()
        }
        Wrong::Obstacle(Obstacle::NotFinite) => {
            "look for a division by zero at the values of the parameters".to_owned()
        }
    }
}

/// Names one after the other, as many as a message can hold.
fn list<T: AsRef<str>>(names: impl Iterator<Item = T>) -> String {
    const MOST: usize = 24;
    let mut all: Vec<String> = names.map(|name| format!("`{}`", name.as_ref())).collect();
    if all.len() > MOST {
        all.truncate(MOST);
        all.push("more".to_owned());
    }
    line(&all.join(", "))
}

/// Where the text has what is wrong.
fn place(outline: &Outline, path: &str, mistake: &Mistake) -> Range<usize> {
    let above = |name: &str| {
        let above = path.strip_suffix(name);
        above
            .and_then(|above| above.strip_suffix('.'))
            .unwrap_or(path)
    };
    let found = match mistake {
        Mistake::Expression(flaw) => {
            let at = outline.locate(path);
            let piece = within_text(&outline.text[at.clone()], flaw.span.clone());
            Some(at.start + piece.start..at.start + piece.end)
        }
        Mistake::Name(name, _) => match above(name) {
            list @ "system.states" => outline.text_in(list, name),
            above => outline.key_of(above, name),
        },
        Mistake::NoState(name) => outline.key_of(above(name), name),
        Mistake::NoMode(name) => outline.text_in(path, name),
        Mistake::NoRate(state) => Some(outline.locate(&format!("{path}.{state}"))),
        _ => None,
    };
    found.unwrap_or_else(|| outline.locate(path))
}
