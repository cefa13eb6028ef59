//! How every field may be written, for the help in messages.

use super::outline::{Outline, Subject};

const OF_TUBES: &str = include_str!("examples.ron");
const OF_SYSTEMS: &str = include_str!("examples_system.ron");

/// Fields that hold a map: what stands in it has names of the user's own.
const MAPS: [&str; 11] = [
    "contacts",
    "monitor",
    "parameters",
    "define",
    "modes",
    "sliding",
    "rates",
    "reset",
    "state",
    "within",
    "numbers",
];

/// Every field in use, each with the section it stands in.
pub(super) fn examples(subject: Subject) -> Vec<(String, String)> {
    let text = match subject {
        Subject::Tube => OF_TUBES,
        Subject::System => OF_SYSTEMS,
    };
    Outline::of(text).fields().collect()
}

/// A path with `*` for every name of the user's own.
fn general(path: &str) -> String {
    let mut own = false;
    let steps = path.split('.').map(|step| {
        let shown = if own { "*" } else { step };
        own = !own && MAPS.contains(&step);
        shown
    });
    steps.collect::<Vec<_>>().join(".")
}

/// The field of a section in use, in one line.
pub(super) fn example(subject: Subject, section: &str, field: &str) -> Option<String> {
    let section = general(section);
    let mut examples = examples(subject).into_iter();
    let of_map = section
        .split('.')
        .next_back()
        .is_some_and(|last| MAPS.contains(&last));
    let found = examples
        .find(|(home, example)| general(home) == section && (of_map || is_of(example, field)))?;
    let words: Vec<&str> = found.1.split_whitespace().collect();
    Some(words.join(" ").replace("( ", "(").replace(", )", ")"))
}

/// The section that a field belongs to, when there is only one.
pub(super) fn home(subject: Subject, field: &str) -> Option<String> {
    let mut homes = examples(subject);
    homes.retain(|(_, example)| is_of(example, field));
    // the steps of a curve are those of a continuation, where one thinks of them first
    if homes.iter().any(|(home, _)| home == "continuation") {
        homes.retain(|(home, _)| home != "curve");
    }
    let (home, _) = homes.first()?.clone();
    homes
        .iter()
        .all(|(other, _)| *other == home)
        .then_some(home)
}

/// A field with this variant, when values follow its name in parentheses.
pub(super) fn variant(subject: Subject, name: &str) -> Option<String> {
    let head = format!(": {name}(");
    let in_list = format!(", {name}(");
    let mut examples = examples(subject)
        .into_iter()
        .filter(|(home, _)| !home.is_empty());
    let found = examples.find(|(_, example)| example.contains(&head) || example.contains(&in_list));
    Some(found?.1)
}

fn is_of(example: &str, field: &str) -> bool {
    example.split(':').next() == Some(field)
}
