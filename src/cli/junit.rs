//! Outcomes as JUnit XML, which continuous-integration servers read.

use std::fmt::Write;

/// How a test case has come out.
pub(crate) enum Verdict {
    Passed,
    /// With what was found instead.
    Failed(String),
    /// With what went wrong.
    Error(String),
    /// With the reason.
    Skipped(String),
}

/// A test case by its name.
pub(crate) struct Case {
    pub name: String,
    pub verdict: Verdict,
}

/// The test cases of a file.
pub(crate) struct Suite {
    pub name: String,
    pub cases: Vec<Case>,
}

/// The counts of test cases as attributes.
fn counts<'a>(cases: impl Iterator<Item = &'a Case>) -> String {
    let (mut tests, mut failures, mut errors, mut skipped) = (0, 0, 0, 0);
    for case in cases {
        tests += 1;
        match case.verdict {
            Verdict::Passed => {}
            Verdict::Failed(_) => failures += 1,
            Verdict::Error(_) => errors += 1,
            Verdict::Skipped(_) => skipped += 1,
        }
    }
    format!("tests=\"{tests}\" failures=\"{failures}\" errors=\"{errors}\" skipped=\"{skipped}\"")
}

/// All suites as a report.
pub(crate) fn report(suites: &[Suite]) -> String {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let all = counts(suites.iter().flat_map(|suite| &suite.cases));
    // writing to a string does not fail
    let _ = writeln!(text, "<testsuites name=\"brakewave check\" {all}>");
    for suite in suites {
        let (file, counts) = (attribute(&suite.name), counts(suite.cases.iter()));
        let _ = writeln!(text, "    <testsuite name=\"{file}\" {counts}>");
        for case in &suite.cases {
            let name = attribute(&case.name);
            let head = format!("        <testcase name=\"{name}\" classname=\"{file}\"");
            let (tag, message) = match &case.verdict {
                Verdict::Passed => {
                    let _ = writeln!(text, "{head}/>");
                    continue;
                }
                Verdict::Failed(message) => ("failure", message),
                Verdict::Error(message) => ("error", message),
                Verdict::Skipped(message) => ("skipped", message),
            };
            let message = attribute(message);
            let _ = writeln!(
                text,
                "{head}>\n            <{tag} message=\"{message}\"/>\n        </testcase>"
            );
        }
        text.push_str("    </testsuite>\n");
    }
    text.push_str("</testsuites>\n");
    text
}

/// The value of an attribute: markup and line ends escaped, what XML does not admit left out.
fn attribute(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push_str("&#10;"),
            '\u{fffe}' | '\u{ffff}' => {}
            other if other.is_control() => {}
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_names_is_escaped() {
        let case = |name: &str, verdict| Case {
            name: name.to_owned(),
            verdict,
        };
        let suite = Suite {
            name: "a<b>&\"c\".ron".to_owned(),
            cases: vec![
                case("HB", Verdict::Passed),
                case("LP", Verdict::Failed("one\ntwo\u{1}".to_owned())),
            ],
        };
        let text = report(&[suite]);
        assert!(text.contains(
            "<testsuite name=\"a&lt;b&gt;&amp;&quot;c&quot;.ron\" tests=\"2\" failures=\"1\" errors=\"0\""
        ));
        assert!(text.contains("<failure message=\"one&#10;two\"/>"));
        assert!(
            text.contains("<testcase name=\"HB\" classname=\"a&lt;b&gt;&amp;&quot;c&quot;.ron\"/>")
        );
    }
}
