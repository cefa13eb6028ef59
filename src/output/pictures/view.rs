//! What part of a branch a diagram shows, and on which axes.

use super::tables::{Tables, column};
use crate::output::render::{Axis, Extent, Point, range};
use crate::problem::{Plot, Problem};
use crate::tube::model::Parameter;

/// What of a column of `branch.csv` is drawn.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct View {
    pub column: String,
    /// Part of the horizontal axis.
    pub range: (f64, f64),
    /// Whether the horizontal axis is logarithmic; where nothing is said the values decide.
    pub logarithmic: Option<bool>,
    /// Part of the vertical axis.
    pub height: (f64, f64),
    /// Whether the vertical axis is logarithmic.
    pub logarithmic_height: bool,
}

/// Why a view would show nothing, or not what was asked for.
#[derive(Debug, thiserror::Error)]
pub(crate) enum NoView {
    /// The column has no numbers.
    #[error("column `{column}` of branch.csv has no values{}", needed.as_ref().map_or(String::new(), |(needed, cure)| format!(" without {needed}: {cure}, and run anew")))]
    Empty {
        column: String,
        /// What it needs, and how the problem file asks for it.
        needed: Option<(&'static str, String)>,
    },
    #[error("no point has `{column}` from {} to {}: it goes from {} to {}", asked.0, asked.1, there.0, there.1)]
    Outside {
        column: String,
        /// Ends of the axis that are asked for.
        asked: (f64, f64),
        there: (f64, f64),
    },
    /// A logarithmic axis has no place for a value.
    #[error("`{column}` is {value} at a point, which a logarithmic axis cannot show")]
    NotPositive {
        column: String,
        /// A value that is not greater than 0.
        value: f64,
    },
}

/// Ratio of the ends of a branch from which on its axis is logarithmic, for else all that happens at
/// small values is one blob.
const WIDE: f64 = 100.0;

/// The same for ε of a smoothed friction law, a scale that goes to zero.
const WIDE_SCALE: f64 = 2.0;

impl View {
    /// All of the horizontal axis.
    pub(crate) const EVERYWHERE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

    /// A column over the whole branch.
    pub(super) fn whole(column: &str) -> View {
        View {
            column: column.to_owned(),
            range: View::EVERYWHERE,
            logarithmic: None,
            height: View::EVERYWHERE,
            logarithmic_height: false,
        }
    }

    /// Refuses a view of nothing, and a logarithmic axis for what is not positive.
    pub(super) fn check(&self, problem: &Problem, tables: &Tables) -> Result<(), NoView> {
        let axes = [
            (
                &tables.parameter,
                self.range,
                self.logarithmic == Some(true),
            ),
            (&self.column, self.height, self.logarithmic_height),
        ];
        for (name, asked, logarithmic) in axes {
            let name = name.clone();
            let values = column(&tables.branch, &name);
            let Some(there) = range(values.iter().copied()) else {
                let needed = problem.lacks(&Plot::Column(name.clone()));
                return Err(NoView::Empty {
                    column: name,
                    needed,
                });
            };
            let shown = |value: &&f64| (asked.0..=asked.1).contains(*value);
            let mut shown = values.iter().filter(shown).peekable();
            if shown.peek().is_none() {
                return Err(NoView::Outside {
                    column: name,
                    asked,
                    there,
                });
            }
            if let Some(&value) = shown.find(|value| logarithmic && **value <= 0.0) {
                return Err(NoView::NotPositive {
                    column: name,
                    value,
                });
            }
        }
        Ok(())
    }

    /// The view with its axis decided.
    pub(super) fn decided(&self, tables: &Tables) -> View {
        let values = column(&tables.branch, &tables.parameter);
        let wide = match tables.wave_parameter() {
            Some(Parameter::Smoothing) => WIDE_SCALE,
            Some(_) => WIDE,
            None => f64::INFINITY,
        };
        let logarithmic = range(values).is_some_and(|(low, high)| low > 0.0 && high > wide * low);
        View {
            logarithmic: self.logarithmic.or(Some(logarithmic)),
            ..self.clone()
        }
    }

    pub(super) fn shows(&self, (x, y): &Point) -> bool {
        let (low, high) = self.height;
        self.shows_at(*x) && (low..=high).contains(y) && (*y > 0.0 || !self.logarithmic_height)
    }

    pub(super) fn shows_at(&self, x: f64) -> bool {
        let (low, high) = self.range;
        (low..=high).contains(&x) && (x > 0.0 || self.logarithmic != Some(true))
    }

    pub(super) fn axis(&self, tables: &Tables) -> Axis {
        let extent = match self.logarithmic {
            Some(true) => Extent::Logarithmic(0.04),
            _ => Extent::Data(0.04),
        };
        Axis::new(tables.quantity(&tables.parameter), extent)
    }
}

/// The horizontal axis of pictures over the whole branch.
pub(super) fn parameter_axis(tables: &Tables) -> Axis {
    View::whole("").decided(tables).axis(tables)
}
