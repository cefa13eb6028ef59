//! Commented problem files to start from.

/// A commented problem file to start from, with every section; see [`template`].
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(super) const TEMPLATE: &str = include_str!("template.ron");

/// The same with a system of one's own.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) const SYSTEM_TEMPLATE: &str = include_str!("template_system.ron");

/// Sections of [`TEMPLATE`] that may be comments.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(super) const OPTIONAL: [&str; 6] = [
    "continuation",
    "stability",
    "map",
    "curve",
    "simulation",
    "expect",
];

/// A commented problem file in which these sections are in use and other optional ones are comments.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) fn template(sections: &[&str]) -> String {
    let mut inside = None;
    let lines = TEMPLATE.lines().map(|line| {
        let comment = line.strip_prefix("    // ");
        let text = comment.or(line.strip_prefix("    ")).unwrap_or(line);
        let opens = |name: &&str| {
            let rest = text.strip_prefix(*name);
            rest.is_some_and(|rest| rest.starts_with(": (") || rest.starts_with(": ["))
        };
        inside = inside.or(OPTIONAL.into_iter().find(opens));
        let line = match (inside.map(|name| sections.contains(&name)), comment) {
            (Some(true), Some(_)) => format!("    {text}\n"),
            (Some(false), None) => format!("    // {text}\n"),
            _ => format!("{line}\n"),
        };
        let ends = text == ")," || text == "]," || (text.ends_with("),") && !text.starts_with(' '));
        inside = inside.filter(|_| !ends);
        line
    });
    lines.collect()
}
