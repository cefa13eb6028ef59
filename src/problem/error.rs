//! Why a problem file was refused, shown with the line it is about.

use std::fmt;
use std::ops::Range;

/// Why a problem file was refused; its display is a complete message of several lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProblemError {
    name: String,
    message: String,
    help: String,
    place: Option<TextPlace>,
}

/// Where in the text, and what that looks like.
#[derive(Clone, Debug, PartialEq, Eq)]
struct TextPlace {
    line: usize,
    column: usize,
    /// The source line, and below it the carets.
    sketch: String,
}

/// Something wrong with a range of bytes of the text.
#[derive(Clone, Debug)]
pub(super) struct Flaw {
    pub at: Range<usize>,
    pub message: String,
    pub help: String,
}

impl Flaw {
    pub fn new(at: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> Self {
        Flaw {
            at,
            message: message.into(),
            help: help.into(),
        }
    }
}

impl ProblemError {
    /// Line of the offending text, from 1; `None` when the file could not be read.
    pub fn line(&self) -> Option<usize> {
        self.place.as_ref().map(|place| place.line)
    }

    /// Column of the offending text in characters, from 1; `None` when the file could not be read.
    pub fn column(&self) -> Option<usize> {
        self.place.as_ref().map(|place| place.column)
    }

    /// What is wrong, in one sentence.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// What would be right.
    pub fn help(&self) -> &str {
        &self.help
    }

    /// An error about the file as a whole.
    pub(super) fn in_file(name: &str, message: String, help: &str) -> Self {
        ProblemError {
            name: name.to_owned(),
            message,
            help: help.to_owned(),
            place: None,
        }
    }

    /// An error about a place in the text.
    pub(super) fn in_text(name: &str, text: &str, flaw: Flaw) -> Self {
        ProblemError {
            name: name.to_owned(),
            message: flaw.message,
            help: flaw.help,
            place: Some(TextPlace::new(text, flaw.at)),
        }
    }
}

impl fmt::Display for ProblemError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ProblemError {
            name,
            message,
            help,
            place,
        } = self;
        match place {
            None => writeln!(formatter, "{name}: {message}")?,
            Some(place) => {
                let TextPlace {
                    line,
                    column,
                    sketch,
                } = place;
                writeln!(formatter, "{name}:{line}:{column}: {message}\n{sketch}")?;
            }
        }
        write!(formatter, "help: {help}")
    }
}

impl std::error::Error for ProblemError {}

impl TextPlace {
    /// Longest part of a line that is shown, in characters.
    const WINDOW: usize = 100;
    /// Characters kept before the place where a line is cut.
    const LEAD: usize = 40;

    fn new(text: &str, at: Range<usize>) -> Self {
        let line_start = text[..at.start]
            .rfind('\n')
            .map_or(0, |newline| newline + 1);
        let line = 1 + text[..line_start].matches('\n').count();
        let source = text[line_start..].lines().next().unwrap_or_default();
        let before = text[line_start..at.start].chars().count();
        let marked = text[at].lines().next().unwrap_or_default().chars().count();

        let total = source.chars().count();
        let first = if total > Self::WINDOW {
            before.saturating_sub(Self::LEAD)
        } else {
            0
        };
        let cut = |cut: bool| if cut { "…" } else { "" };
        let (left, right) = (cut(first > 0), cut(first + Self::WINDOW < total));
        let shown: String = printable(source).skip(first).take(Self::WINDOW).collect();
        let indent = left.chars().count() + before - first;
        let width = marked.clamp(1, (first + Self::WINDOW).saturating_sub(before).max(1));
        let gutter = line.to_string().len();
        TextPlace {
            line,
            column: before + 1,
            sketch: format!(
                "{line} | {left}{shown}{right}\n{:gutter$} | {:indent$}{:^<width$}",
                "", "", ""
            ),
        }
    }
}

/// A piece of the text, short and printable enough for a message.
pub(super) fn excerpt(text: &str) -> String {
    const LONGEST: usize = 60;
    let ellipsis = text.chars().nth(LONGEST).map(|_| '…');
    printable(text).take(LONGEST).chain(ellipsis).collect()
}

/// A message with what it quotes printable, and short enough to be read.
pub(super) fn line(text: &str) -> String {
    const LONGEST: usize = 600;
    let ellipsis = text.chars().nth(LONGEST).map(|_| '…');
    printable(text).take(LONGEST).chain(ellipsis).collect()
}

/// The characters with blanks for those that would move the caret, or worse.
fn printable(text: &str) -> impl Iterator<Item = char> {
    text.chars().map(|c| {
        if c.is_control() || !super::is_text(c) {
            ' '
        } else {
            c
        }
    })
}
