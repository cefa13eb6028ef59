//! A range of admitted numbers, and what it is called in messages.

use std::ops::Bound::{self, Excluded, Included, Unbounded};
use std::ops::RangeBounds;

/// A range of admitted numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AdmittedRange {
    least: Bound<f64>,
    most: Bound<f64>,
}

impl AdmittedRange {
    pub const fn above(least: f64) -> AdmittedRange {
        AdmittedRange {
            least: Excluded(least),
            most: Unbounded,
        }
    }

    pub const fn from(least: f64) -> AdmittedRange {
        AdmittedRange {
            least: Included(least),
            most: Unbounded,
        }
    }

    pub(crate) const fn upto(most: f64) -> AdmittedRange {
        AdmittedRange {
            least: Unbounded,
            most: Included(most),
        }
    }

    pub const fn below(self, most: f64) -> AdmittedRange {
        AdmittedRange {
            most: Excluded(most),
            ..self
        }
    }

    pub const fn to(self, most: f64) -> AdmittedRange {
        AdmittedRange {
            most: Included(most),
            ..self
        }
    }

    /// Whether a number lies within; not a number lies nowhere.
    pub(crate) fn admits(self, value: f64) -> bool {
        (self.least, self.most).contains(&value)
    }

    /// A rule with the range in words in place of `{}`.
    pub fn rule(self, rule: &str) -> String {
        let number = |value: f64| match value.fract() {
            0.0 => format!("{value:.0}"),
            _ => format!("{value:?}"),
        };
        let words = match (self.least, self.most) {
            (Included(least), Included(most)) => format!("{} to {}", number(least), number(most)),
            (Excluded(least), Excluded(most)) => {
                let (least, most) = (number(least), number(most));
                format!("between {least} and {most}, both excluded")
            }
            (least, most) => {
                let least = match least {
                    Included(least) => Some(format!("at least {}", number(least))),
                    Excluded(least) => Some(format!("greater than {}", number(least))),
                    Unbounded => None,
                };
                let most = match most {
                    Included(most) => Some(format!("at most {}", number(most))),
                    Excluded(most) => Some(format!("less than {}", number(most))),
                    Unbounded => None,
                };
                let words: Vec<String> = least.into_iter().chain(most).collect();
                words.join(" and ")
            }
        };
        rule.replace("{}", &words)
    }
}
