//! How every field may be written, for the help in messages.

use super::outline::Outline;

const EXAMPLES: &str = include_str!("examples.ron");

/// Every field in use, each with the section it stands in.
pub(super) fn examples() -> Vec<(String, String)> {
    Outline::of(EXAMPLES).fields().collect()
}

/// The field of a section in use, in one line.
pub(super) fn example(section: &str, field: &str) -> Option<String> {
    let mut examples = examples().into_iter();
    let found = examples.find(|(home, example)| home == section && is_of(example, field))?;
    let words: Vec<&str> = found.1.split_whitespace().collect();
    Some(words.join(" ").replace("( ", "(").replace(", )", ")"))
}

/// The section that a field belongs to, when there is only one.
pub(super) fn home(field: &str) -> Option<String> {
    let mut homes = examples();
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
pub(super) fn variant(name: &str) -> Option<String> {
    let head = format!(": {name}(");
    let in_list = format!(", {name}(");
    let mut examples = examples().into_iter().filter(|(home, _)| !home.is_empty());
    let found = examples.find(|(_, example)| example.contains(&head) || example.contains(&in_list));
    Some(found?.1)
}

fn is_of(example: &str, field: &str) -> bool {
    example.split(':').next() == Some(field)
}
