//! What `ron` says about a text, in words for those who write problem files.

use std::ops::Range;

use ron::Error;
use ron::error::{Position, SpannedError};

use super::error::{Flaw, excerpt};
use super::examples::{example, home, variant};
use super::outline::{Outline, Subject};

/// The meaning of the event types, for those who ask for one that does not exist.
fn event_help(subject: Subject) -> &'static str {
    match subject {
        Subject::Tube => {
            "EP end point, MX failure, UZ user point, LP fold, HB complex pair crosses, BP real \
             eigenvalue crosses, GR take-off, RV reverse slip, CO switching points coalesce, ST stick \
             vanishes"
        }
        Subject::System => {
            "EP end point, MX failure, UZ user point, LP fold, PD period doubling, NS torus, BP \
             branch point, GR grazing, CO switches coalesce, SL a switch leads elsewhere"
        }
    }
}

/// Finds the place and the words for what `ron` refused.
pub(super) fn explain(outline: &Outline, error: &SpannedError) -> Flaw {
    let text = outline.text;
    let subject = outline.subject();
    if outline.is_empty() {
        let help = "`brakewave new` prints a problem file to start from";
        return Flaw::new(0..0, "the file is empty: there is no problem in it", help);
    }
    if let Some(flaw) = outline.broken_before(offset_of(text, error.span.end)) {
        return flaw;
    }
    let start = offset_of(text, error.span.start);
    let offset = outline.after_blank(start);
    let around = outline.innermost(offset);
    let section = around.map_or(String::new(), |node| outline.path(node));
    let quoted = quoted(&section);
    let token = outline.token(offset);
    match &error.code {
        Error::NoSuchStructField {
            expected, found, ..
        } => {
            let (message, help) = unknown_field(subject, &section, found, expected);
            Flaw::new(token, message, help)
        }
        Error::DuplicateStructField { field, .. } => Flaw::new(
            token,
            format!("`{field}` is given twice in {quoted}"),
            "keep one of the two",
        ),
        Error::MissingStructField { field, .. } => Flaw::new(
            around.map_or(0..0, |node| outline.head(node)),
            format!("missing field `{field}` in {quoted}"),
            format!(
                "add for example `{}`",
                example(subject, &section, field).unwrap_or(field.to_string())
            ),
        ),
        Error::NoSuchEnumVariant {
            expected, found, ..
        } => Flaw::new(
            token,
            format!(
                "unknown choice `{}` for {quoted}{}",
                excerpt(found),
                known(found, expected)
            ),
            if expected.contains(&"EP") {
                event_help(subject).to_owned()
            } else {
                write_as(subject, &section)
            },
        ),
        code => refused_value(outline, offset, code),
    }
}

/// A value of another kind than its field has, or a mark that is missing.
fn refused_value(outline: &Outline, offset: usize, code: &Error) -> Flaw {
    let subject = outline.subject();
    let token = outline.token(offset);
    let found = excerpt(&outline.text[token.clone()]);
    // Some values are refused only at the mark after them.
    let before = outline.ending(outline.text[..offset].trim_end().len());
    let around = outline.innermost(offset);
    let at_mark = matches!(found.as_str(), "" | "," | ":" | ")" | "]" | "}");
    let node = if at_mark { before } else { around };
    let path = node
        .or(around)
        .map_or(String::new(), |node| outline.path(node));

    let nodes = RefusedNodes {
        node,
        before,
        around,
    };
    let wanted = match expected(outline, offset, code, nodes) {
        Ok(wanted) => wanted,
        Err(flaw) => return flaw,
    };
    let length = matches!(code, Error::ExpectedDifferentLength { .. });
    let Some(node) = (if length { around } else { node }) else {
        let message = format!("{wanted} should stand before `{found}`");
        return Flaw::new(token, message, write_as(subject, &path));
    };
    let source = excerpt(outline.source(node));
    let span = outline.span(node);
    if *code == Error::ExpectedStructLike && at_mark {
        let message = format!("`{source}` must be followed by {wanted}");
        let help = match variant(subject, outline.source(node)) {
            Some(example) => format!("write it as in `{example}`"),
            None => write_as(subject, &path),
        };
        return Flaw::new(span, message, help);
    }
    if wanted == "a name" && (span.start < offset || outline.is_bare(node)) {
        // Either the key within a section is no name, or a value has no key.
        let at = if span.start < offset { token } else { span };
        let message = format!(
            "{} holds named fields, found `{}`",
            quoted(&path),
            excerpt(&outline.text[at.clone()])
        );
        let help = "write `name: value`; numbers have a decimal point, no comma";
        return Flaw::new(at, message, help);
    }
    let is_inside = outline.head(node).end <= offset;
    if is_inside && !length && !matches!(code, Error::InvalidValueForType { .. }) {
        // what stands there has become part of a key
        let message = format!("{wanted} should stand here, found `{found}`");
        return Flaw::new(token, message, write_as(subject, &path));
    }
    let entry = if outline.is_entry(node) {
        "an entry of "
    } else {
        ""
    };
    let mut help = write_as(subject, &path);
    if source.starts_with('"') {
        help.push_str(", without quotes around it");
    }
    let message = format!(
        "{entry}{} must be {wanted}, found `{source}`",
        quoted(&path)
    );
    Flaw::new(span, message, help)
}

/// Nodes of the outline that a refusal may be about.
#[derive(Clone, Copy)]
struct RefusedNodes {
    /// The value that is refused.
    node: Option<usize>,
    /// The one that ends before the place of the refusal.
    before: Option<usize>,
    /// The innermost one around it.
    around: Option<usize>,
}

/// What should stand in the place of a value that is refused.
///
/// # Errors
/// The flaw, where no value is missing.
fn expected<'a>(
    outline: &Outline,
    offset: usize,
    code: &'a Error,
    nodes: RefusedNodes,
) -> Result<&'a str, Flaw> {
    let subject = outline.subject();
    let token = || outline.token(offset);
    let RefusedNodes {
        node,
        before,
        around,
    } = nodes;
    let path = node
        .or(around)
        .map_or(String::new(), |node| outline.path(node));
    Ok(match code {
        Error::ExpectedFloat => "a number",
        Error::ExpectedInteger | Error::InvalidIntegerDigit { .. }
            if written_with_point(subject, &path) =>
        {
            "a number"
        }
        Error::ExpectedInteger | Error::InvalidIntegerDigit { .. } => "a whole number from 0 up",
        Error::IntegerOutOfBounds => "a whole number from 0 up, but not too large",
        // What is read of a value may end within it, where a comma would have to follow.
        Error::ExpectedComma if node.is_some_and(|node| outline.splits(node, offset)) => {
            let digits = node.is_some_and(|node| {
                outline
                    .source(node)
                    .starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
            });
            match (digits, written_with_point(subject, &path)) {
                (false, _) if excerpt(&outline.text[token()]) == "(" => {
                    "a name without parentheses"
                }
                (_, true) => "a number",
                (_, false) => "a whole number from 0 up",
            }
        }
        Error::UnexpectedChar(found) => {
            return Err(unexpected(outline, offset, *found, before.or(around)));
        }
        Error::ExpectedString => "a text in double quotes",
        Error::ExpectedArray => "a list in square brackets",
        Error::ExpectedMap => "a map in braces",
        Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) => "a name",
        Error::ExpectedStructLike => "values in parentheses",
        Error::ExpectedNamedStructLike(_) | Error::ExpectedDifferentStructName { .. } => {
            "a section of fields in parentheses"
        }
        Error::InvalidValueForType { expected, .. }
        | Error::ExpectedDifferentLength { expected, .. } => match expected.as_str() {
            "a tuple of size 2" if path.contains("sliding") => "two names in parentheses",
            "a tuple of size 2" => "two numbers in parentheses",
            expected => expected,
        },
        Error::ExpectedComma => return Err(missing_mark(outline, before, token(), ",")),
        Error::ExpectedMapColon => return Err(missing_mark(outline, None, token(), ":")),
        Error::ExpectedStructLikeEnd => return Err(missing_mark(outline, None, token(), ")")),
        code => {
            let mut message = code.to_string();
            // The messages of `ron` begin with a capital letter, ours do not.
            if let Some(first) = message.get_mut(..1) {
                first.make_ascii_lowercase();
            }
            return Err(Flaw::new(token(), message, write_as(subject, &path)));
        }
    })
}

/// The words for a character that nothing begins with; a slash is read as that of a comment.
fn unexpected(outline: &Outline, offset: usize, found: char, before: Option<usize>) -> Flaw {
    let token = outline.token(offset);
    let subject = outline.subject();
    let path = before.map_or(String::new(), |node| outline.path(node));
    if !outline.text[offset..].starts_with('/') {
        return Flaw::new(
            token,
            format!("`{found}` makes no sense here"),
            write_as(subject, &path),
        );
    }
    let message = "there is no arithmetic, and a single `/` begins no comment";
    let help = format!(
        "{}; 1/5 is 0.2, and a comment begins with `//`",
        write_as(subject, &path)
    );
    Flaw::new(token, message, help)
}

/// The words for a mark that should stand between the value before and the token.
fn missing_mark(outline: &Outline, before: Option<usize>, token: Range<usize>, mark: &str) -> Flaw {
    if let Some(text) = before.filter(|&node| outline.source(node).contains('\n')) {
        // A forgotten quote turns the file inside out from there on.
        if outline.source(text).starts_with('"') {
            let message = "this text runs over several lines, and what follows it makes no sense";
            let help = "end it with `\"` on the line where it begins";
            return Flaw::new(outline.span(text), message, help);
        }
    }
    let found = excerpt(&outline.text[token.clone()]);
    let message = format!("`{mark}` should stand before `{found}`");
    let help = "write `name: value`, separate entries by commas, and close every bracket";
    Flaw::new(token, message, help)
}

/// The name of a section for messages.
fn quoted(path: &str) -> String {
    match path {
        "" => "the problem".to_owned(),
        path => format!("`{}`", excerpt(path)),
    }
}

/// How the field with this path is written.
fn write_as(subject: Subject, path: &str) -> String {
    match example_of(subject, path) {
        Some(example) => format!("write it as in `{example}`"),
        None => "`brakewave new` prints a complete example".to_owned(),
    }
}

fn example_of(subject: Subject, path: &str) -> Option<String> {
    let (section, field) = path.rsplit_once('.').unwrap_or(("", path));
    example(subject, section, field)
}

/// Whether the numbers of a field have a decimal point.
fn written_with_point(subject: Subject, path: &str) -> bool {
    example_of(subject, path).is_some_and(|example| example.contains('.') || example.contains("e-"))
}

/// The words and the help for a field that a section does not have.
pub(super) fn unknown_field(
    subject: Subject,
    section: &str,
    found: &str,
    expected: &[&str],
) -> (String, String) {
    let message = format!(
        "unknown field `{}` in {}{}",
        excerpt(found),
        quoted(section),
        known(found, expected)
    );
    (message, help_for_unknown(subject, section, found, expected))
}

fn help_for_unknown(subject: Subject, section: &str, found: &str, expected: &[&str]) -> String {
    let home = home(subject, found).filter(|home| *home != section);
    match (home, nearest(found, expected).first()) {
        (Some(home), _) => {
            let home = quoted(&home);
            format!("`{found}` belongs to {home}; is a bracket out of place?")
        }
        (None, Some(near)) => {
            let near = example(subject, section, near).unwrap_or(near.to_string());
            format!("write for example `{near}`")
        }
        (None, None) => "remove it, or use one of the known names".to_owned(),
    }
}

/// The end of a message about an unknown name: the nearest ones, and all there are; nothing where there are none.
pub(super) fn known(found: &str, expected: &[&str]) -> String {
    if expected.is_empty() {
        return String::new();
    }
    let quoted = |names: &[&str], comma| {
        let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        names.join(comma)
    };
    let near = match nearest(found, expected).as_slice() {
        [] => ";".to_owned(),
        near => format!("; did you mean {}?", quoted(near, " or ")),
    };
    format!("{near} known: {}", quoted(expected, ", "))
}

/// The names that differ least from the one found, if they differ little.
fn nearest<'a>(found: &str, names: &[&'a str]) -> Vec<&'a str> {
    // The comparison takes time and memory in proportion to the length.
    if found.len() > 64 {
        return Vec::new();
    }
    let reach = (found.chars().count() / 2).clamp(1, 3);
    let distance =
        |name: &str| strsim::damerau_levenshtein(&found.to_lowercase(), &name.to_lowercase());
    // a name of which no letter is right says nothing
    let alike = |name: &&&str| distance(name) < found.chars().count().max(name.chars().count());
    let names: Vec<&str> = names.iter().filter(alike).copied().collect();
    let least = names.iter().map(|name| distance(name)).min();
    names
        .into_iter()
        .filter(|name| Some(distance(name)) == least && least <= Some(reach))
        .collect()
}

/// The offset of a line and a column.
fn offset_of(text: &str, position: Position) -> usize {
    let line: usize = text
        .split_inclusive('\n')
        .take(position.line.saturating_sub(1))
        .map(str::len)
        .sum();
    text[line..]
        .char_indices()
        .nth(position.col.saturating_sub(1))
        .map_or(text.len(), |(column, _)| line + column)
}
