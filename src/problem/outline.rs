//! The text of a problem file as a tree of values with their places.
//!
//! `ron` decides what a text means; the outline only tells where things stand. It is tolerant:
//! every text has one, up to the first bracket, text or comment that does not end.

use std::ops::Range;

use super::error::Flaw;

/// A value of the text.
struct OutlineNode {
    parent: Option<usize>,
    /// What stands before the colon.
    key: Option<Range<usize>>,
    /// The whole value, with the name before its bracket.
    span: Range<usize>,
}

/// What a problem is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Subject {
    /// Waves of a tube: `model` or `tube`, and `wave`.
    Tube,
    /// A system of one's own: `system` and `orbit`.
    System,
}

pub(super) struct Outline<'a> {
    pub text: &'a str,
    /// Every value, a bracketed one before those it holds.
    nodes: Vec<OutlineNode>,
    /// Something that does not end, and the offset from which on nothing makes sense for it.
    broken: Option<(usize, Flaw)>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Token {
    /// White space or a comment.
    Blank,
    /// A number or a bare name.
    Word,
    Text,
    /// A bracket, a colon or a comma.
    Mark(u8),
    /// A comment or a string without an end, in words, and how to end it.
    Endless(&'static str, &'static str),
}

const ENDLESS_COMMENT: Token = Token::Endless(
    "the comment that begins here never ends",
    "end it with `*/`; comments may contain comments, each with its own end",
);
const ENDLESS_TEXT: Token = Token::Endless(
    "the text that begins here never ends",
    "end it with `\"`, and as many `#` as it begins with",
);

impl<'a> Outline<'a> {
    pub fn of(text: &'a str) -> Self {
        let mut outline = Outline {
            text,
            nodes: Vec::new(),
            broken: None,
        };
        // The brackets that are open, what stood before a colon, and the last value as far as it may turn
        // out to be a key, or the name of a group, which only a word can.
        let mut open: Vec<usize> = Vec::new();
        let mut key = None;
        let (mut word, mut text_or_word) = (false, false);
        let mut at = 0;
        while at < text.len() && outline.broken.is_none() {
            let (token, length) = next_token(&text[at..]);
            let span = at..at + length;
            at = span.end;
            match token {
                Token::Blank => continue,
                Token::Word | Token::Text => outline.push(&open, key.take(), span),
                Token::Mark(b'(') if word => open.push(outline.nodes.len() - 1),
                Token::Mark(b'(' | b'[' | b'{') => {
                    open.push(outline.nodes.len());
                    outline.push(&open[..open.len() - 1], key.take(), span);
                }
                Token::Mark(b':') if text_or_word => key = outline.take_key(),
                Token::Mark(b':' | b',') => key = None,
                Token::Mark(_) => {
                    key = None;
                    outline.close(open.pop(), span);
                }
                Token::Endless(message, help) => {
                    let flaw = Flaw::new(span.start..span.start + 1, message, help);
                    outline.broken = Some((span.start, flaw));
                }
            }
            word = token == Token::Word;
            text_or_word = word || token == Token::Text;
        }
        for &node in &open {
            outline.nodes[node].span.end = text.len();
        }
        if let (Some(&innermost), None) = (open.last(), &outline.broken) {
            let message = "the bracket opened here is never closed";
            let help = "close it where its section ends";
            let flaw = Flaw::new(outline.bracket(innermost), message, help);
            outline.broken = Some((text.trim_end().len(), flaw));
        }
        outline
    }

    fn push(&mut self, open: &[usize], key: Option<Range<usize>>, span: Range<usize>) {
        self.nodes.push(OutlineNode {
            parent: open.last().copied(),
            key,
            span,
        });
    }

    /// Takes back the last value, a word or a text, as the key of the next.
    fn take_key(&mut self) -> Option<Range<usize>> {
        Some(self.nodes.pop()?.span)
    }

    fn close(&mut self, node: Option<usize>, span: Range<usize>) {
        let found = &self.text[span.clone()];
        let Some(node) = node else {
            let message = format!("`{found}` closes a bracket that is not open");
            let help = "remove it, or look for one too many before";
            self.broken = Some((span.start, Flaw::new(span, message, help)));
            return;
        };
        self.nodes[node].span.end = span.end;
        let bracket = self.bracket(node);
        let opened = &self.text[bracket.clone()];
        let closing = match opened {
            "(" => ")",
            "[" => "]",
            _ => "}",
        };
        if found != closing {
            let line = 1 + self.text[..bracket.start].matches('\n').count();
            let message = format!("`{found}` does not close the `{opened}` of line {line}");
            let help = format!("write `{closing}` here, or close that bracket before");
            self.broken = Some((span.start, Flaw::new(span, message, help)));
        }
    }

    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty() && self.broken.is_none()
    }

    /// What does not end, when that is noticed at or before the offset.
    pub(crate) fn broken_before(&self, offset: usize) -> Option<Flaw> {
        let (noticed, flaw) = self.broken.as_ref()?;
        (*noticed <= offset).then(|| flaw.clone())
    }

    /// The innermost value around the offset.
    pub(crate) fn innermost(&self, offset: usize) -> Option<usize> {
        self.nodes
            .iter()
            .rposition(|node| node.span.contains(&offset))
    }

    /// The value that ends at the offset.
    pub(crate) fn ending(&self, offset: usize) -> Option<usize> {
        self.nodes.iter().rposition(|node| node.span.end == offset)
    }

    pub fn span(&self, node: usize) -> Range<usize> {
        self.nodes[node].span.clone()
    }

    pub fn source(&self, node: usize) -> &'a str {
        &self.text[self.span(node)]
    }

    /// The end of the white space and the comments at the offset.
    pub(crate) fn after_blank(&self, mut offset: usize) -> usize {
        while offset < self.text.len()
            && let (Token::Blank, length) = next_token(&self.text[offset..])
        {
            offset += length;
        }
        offset
    }

    /// The word or the mark at the offset; nothing at the end of the text.
    pub(crate) fn token(&self, offset: usize) -> Range<usize> {
        let length = match &self.text[offset..] {
            "" => 0,
            rest => next_token(rest).1,
        };
        offset..offset + length
    }

    /// Whether the offset lies within a word, or between the name of a group and its values.
    pub(crate) fn splits(&self, node: usize, offset: usize) -> bool {
        let span = self.span(node);
        span.start < offset && offset < span.end && offset <= self.bracket(node).start
    }

    /// Whether the value stands in a list or between parentheses, without a key.
    pub(crate) fn is_entry(&self, node: usize) -> bool {
        self.nodes[node].key.is_none() && self.nodes[node].parent.is_some()
    }

    /// Whether the value stands between parentheses without a key.
    pub(crate) fn is_bare(&self, node: usize) -> bool {
        let parent = self.nodes[node].parent;
        self.is_entry(node) && parent.is_some_and(|group| &self.text[self.bracket(group)] == "(")
    }

    /// Names of the fields on the way to a value, joined by dots.
    pub fn path(&self, node: usize) -> String {
        let way = std::iter::successors(Some(node), |&node| self.nodes[node].parent);
        let mut names: Vec<&str> = way.filter_map(|node| self.key(node)).collect();
        names.reverse();
        names.join(".")
    }

    /// Every value with a key, as written, after the path of what it belongs to.
    pub fn fields(&self) -> impl Iterator<Item = (String, String)> {
        (0..self.nodes.len()).filter_map(|node| {
            let parent = self.nodes[node].parent?;
            let key = &self.text[self.nodes[node].key.clone()?];
            let field = format!("{key}: {}", self.source(node));
            Some((self.path(parent), field))
        })
    }

    /// What is written as the value with this path, and as the values that it holds.
    pub fn below(&self, path: &str) -> impl Iterator<Item = &'a str> {
        let top = self.at(path).map(|node| self.span(node));
        (0..self.nodes.len())
            .filter(move |&node| {
                let span = self.span(node);
                let within = |top: &Range<usize>| top.start <= span.start && span.end <= top.end;
                top.as_ref().is_some_and(within)
            })
            .map(|node| self.source(node))
    }

    /// The place of the value with this path, or the beginning of the nearest one around it.
    ///
    /// A path is made of names of fields and numbers of entries, joined by dots.
    pub fn locate(&self, path: &str) -> Range<usize> {
        let Some(mut node) = self.root() else {
            return 0..0;
        };
        for step in path.split('.') {
            match self.child(node, step) {
                Some(child) => node = child,
                None => return self.head(node),
            }
        }
        self.span(node)
    }

    /// The name before the colon of a value below this path, as it is written; the last of several.
    pub fn key_of(&self, path: &str, name: &str) -> Option<Range<usize>> {
        let home = match path {
            "" => self.root(),
            path => self.at(path),
        };
        let named = |child: &usize| self.key(*child) == Some(name);
        let child = self.children(home?).filter(named).last()?;
        self.nodes[child].key.clone()
    }

    /// The last text of a list with this path that says something.
    pub fn text_in(&self, path: &str, text: &str) -> Option<Range<usize>> {
        let says = |child: &usize| unquoted(self.source(*child)) == text;
        let child = self.children(self.at(path)?).filter(says).last()?;
        Some(self.span(child))
    }

    /// What the problem is about, as far as its sections tell.
    pub fn subject(&self) -> Subject {
        match ["system", "orbit", "equilibrium"]
            .iter()
            .any(|section| self.has(section))
        {
            true => Subject::System,
            false => Subject::Tube,
        }
    }

    /// Whether the value with this path is written.
    pub fn has(&self, path: &str) -> bool {
        self.at(path).is_some()
    }

    /// The beginning of a value, up to its bracket.
    pub fn head(&self, node: usize) -> Range<usize> {
        self.span(node).start..self.bracket(node).end
    }

    /// The entries of the list with this path, each with the name of its first field.
    pub fn entries(&self, path: &str) -> impl Iterator<Item = Option<&'a str>> {
        self.at(path)
            .into_iter()
            .flat_map(|list| self.children(list))
            .map(|entry| {
                self.children(entry)
                    .next()
                    .and_then(|field| self.key(field))
            })
    }

    fn at(&self, path: &str) -> Option<usize> {
        path.split('.')
            .try_fold(self.root()?, |node, step| self.child(node, step))
    }

    /// The whole problem; attributes may stand before it.
    fn root(&self) -> Option<usize> {
        self.nodes.iter().rposition(|node| node.parent.is_none())
    }

    fn key(&self, node: usize) -> Option<&'a str> {
        let name = &self.text[self.nodes[node].key.clone()?];
        Some(match name.ends_with(['"', '#']) {
            true => unquoted(name),
            false => name.strip_prefix("r#").unwrap_or(name),
        })
    }

    fn children(&self, node: usize) -> impl Iterator<Item = usize> {
        let end = self.nodes.get(node).map_or(0, |node| node.span.end);
        (node + 1..self.nodes.len())
            .take_while(move |&child| self.nodes[child].span.start < end)
            .filter(move |&child| self.nodes[child].parent == Some(node))
    }

    fn child(&self, node: usize, step: &str) -> Option<usize> {
        match step.parse() {
            Ok(index) => self.children(node).nth(index),
            Err(_) => self
                .children(node)
                .find(|&child| self.key(child) == Some(step)),
        }
    }

    /// The bracket that a value opens with, or the end of a value without one.
    fn bracket(&self, node: usize) -> Range<usize> {
        let span = self.span(node);
        let open = self.text[span.clone()].find(['(', '[', '{']);
        open.map_or(span.end..span.end, |open| {
            span.start + open..span.start + open + 1
        })
    }
}

/// A text without its quotes, escapes as they are written.
fn unquoted(text: &str) -> &str {
    let inside = text.trim_start_matches('r').trim_matches('#');
    let inside = inside
        .strip_prefix('"')
        .and_then(|text| text.strip_suffix('"'));
    inside.unwrap_or(text)
}

/// Where a piece of what a text says, in bytes, is written within its quotes: escapes take several bytes for
/// one character.
pub(super) fn within_text(written: &str, piece: Range<usize>) -> Range<usize> {
    let open = written.find('"').map_or(0, |quote| quote + 1);
    if written.starts_with('r') {
        let place = |offset: usize| (open + offset).min(written.len());
        return place(piece.start)..place(piece.end);
    }
    let mut said = 0;
    let mut places = [None; 2];
    let mut rest = written[open..].char_indices();
    while let Some((at, letter)) = rest.next() {
        for (place, wanted) in places.iter_mut().zip([piece.start, piece.end]) {
            if place.is_none() && said >= wanted {
                *place = Some(open + at);
            }
        }
        let mut meant = letter;
        if letter == '\\' {
            let digits: String = match rest.next() {
                Some((_, 'x')) => rest.by_ref().take(2).map(|(_, digit)| digit).collect(),
                Some((_, 'u')) => {
                    let digits = rest.by_ref().skip(1).map(|(_, digit)| digit);
                    digits.take_while(|digit| *digit != '}').collect()
                }
                // a line break, a quote and the like, one byte each
                _ => String::new(),
            };
            let code = u32::from_str_radix(&digits, 16).ok();
            meant = code.and_then(char::from_u32).unwrap_or(' ');
        }
        said += meant.len_utf8();
    }
    let [start, end] = places.map(|place| place.unwrap_or(written.len().saturating_sub(1)));
    start.min(end)..end
}

/// The token at the beginning of a text that is not empty, with its length.
fn next_token(text: &str) -> (Token, usize) {
    let all = text.len();
    // The same characters as in `ron`: a no-break space, say, is not among them.
    let is_blank = |c: char| {
        c.is_ascii_whitespace() || "\u{0B}\u{85}\u{200E}\u{200F}\u{2028}\u{2029}".contains(c)
    };
    let until = |end: Option<usize>| end.unwrap_or(all);
    let first = text.as_bytes()[0];
    match first {
        b'(' | b')' | b'[' | b']' | b'{' | b'}' | b':' | b',' => return (Token::Mark(first), 1),
        b'"' => return string(text),
        b'/' if text.starts_with("//") => return (Token::Blank, until(text.find('\n'))),
        b'/' if text.starts_with("/*") => return block_comment(text),
        _ => {}
    }
    match until(text.find(|c| !is_blank(c))) {
        0 => {}
        blank => return (Token::Blank, blank),
    }
    let word = until(text.find(|c| is_blank(c) || "()[]{}:,\"/".contains(c))).max(1);
    match text[..word].strip_prefix('r') {
        Some(hashes) if hashes.bytes().all(|b| b == b'#') && text[word..].starts_with('"') => {
            let end = format!("\"{hashes}");
            match text[word + 1..].find(&end) {
                Some(body) => (Token::Text, word + 1 + body + end.len()),
                None => (ENDLESS_TEXT, all),
            }
        }
        _ => (Token::Word, word),
    }
}

fn string(text: &str) -> (Token, usize) {
    let mut escaped = false;
    for (offset, byte) in text.bytes().enumerate().skip(1) {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => return (Token::Text, offset + 1),
            _ => {}
        }
    }
    (ENDLESS_TEXT, text.len())
}

fn block_comment(text: &str) -> (Token, usize) {
    let (mut depth, mut at) = (0_usize, 0);
    while let Some(mark) = text.as_bytes().get(at..at + 2) {
        match mark {
            b"/*" => depth += 1,
            b"*/" => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return (Token::Blank, at);
        }
    }
    (ENDLESS_COMMENT, text.len())
}
