//! Outcomes as JUnit XML, which continuous-integration servers read.

use std::fmt::Write;

use crate::output::report::escaped;

/// How a test case has come out.
pub(crate) enum CaseVerdict {
    Passed,
    /// With what was found instead.
    Failed(String),
    /// With what went wrong.
    Error(String),
    /// With the reason.
    Skipped(String),
}

/// The test cases of a file, each with its name.
pub(crate) struct Suite {
    pub name: String,
    pub cases: Vec<(String, CaseVerdict)>,
}

/// The counts of test cases as attributes.
fn counts<'a>(cases: impl Iterator<Item = &'a (String, CaseVerdict)>) -> String {
    let verdicts: Vec<&CaseVerdict> = cases.map(|(_, verdict)| verdict).collect();
    let count = |of: fn(&&&CaseVerdict) -> bool| verdicts.iter().filter(of).count();
    format!(
        "tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\"",
        verdicts.len(),
        count(|verdict| matches!(verdict, CaseVerdict::Failed(_))),
        count(|verdict| matches!(verdict, CaseVerdict::Error(_))),
        count(|verdict| matches!(verdict, CaseVerdict::Skipped(_)))
    )
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
        for (name, verdict) in &suite.cases {
            let name = attribute(name);
            let head = format!("        <testcase name=\"{name}\" classname=\"{file}\"");
            let (tag, message) = match verdict {
                CaseVerdict::Passed => {
                    let _ = writeln!(text, "{head}/>");
                    continue;
                }
                CaseVerdict::Failed(message) => ("failure", message),
                CaseVerdict::Error(message) => ("error", message),
                CaseVerdict::Skipped(message) => ("skipped", message),
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
    let text = escaped(text).replace('\n', "&#10;");
    let admitted = |c: &char| !(c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'));
    text.chars().filter(admitted).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_names_is_escaped() {
        let suite = Suite {
            name: "a<b>&\"c\".ron".to_owned(),
            cases: vec![
                ("HB".to_owned(), CaseVerdict::Passed),
                (
                    "LP".to_owned(),
                    CaseVerdict::Failed("one\ntwo\u{1}".to_owned()),
                ),
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
