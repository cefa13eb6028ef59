//! Rules of problem files that hold for waves and for systems of one's own.

use std::fmt::Debug;

use super::PlaneAxis;
use super::error::{Flaw, excerpt};
use super::expectation::MAX_EXPECTATIONS;
use super::explanation::known;
use super::fields::not_admitted;
use super::map::MAX_MAP_POINTS;
use super::outline::Outline;
use super::tube::place_of;
use super::{Continuation, Expectation, MAX_USER_POINTS, Map, MapPoints, Toward, UserPoint};

pub(super) type Check = Result<(), Flaw>;

pub(super) const ORDER: &str =
    "write the lower end first and the upper end, which must be greater, second";

/// Refuses lists without end, before anything is done with their entries.
pub(super) fn lengths<P>(
    continuation: Option<&Continuation<P>>,
    expect: &[Expectation],
    outline: &Outline,
) -> Check {
    let points = continuation.map_or(0, |section| section.stop_at.len());
    for (path, count, most) in [
        ("continuation.stop_at", points, MAX_USER_POINTS),
        ("expect", expect.len(), MAX_EXPECTATIONS),
    ] {
        if count > most {
            let message = format!("`{path}` has {count} entries");
            let help = format!("write at most {most}");
            return Err(Flaw::new(outline.locate(path), message, help));
        }
    }
    Ok(())
}

/// A problem of either kind, and the text that it comes from.
pub(super) struct Checks<'a, P> {
    pub problem: &'a P,
    pub outline: &'a Outline<'a>,
}

impl<P> Checks<'_, P> {
    pub fn refuse(&self, path: &str, message: impl Into<String>, help: impl Into<String>) -> Check {
        let at = self.outline.locate(&self.place(path));
        Err(Flaw::new(at, message, help))
    }

    /// Where the file has what the problem has at a path.
    fn place(&self, path: &str) -> String {
        place_of(path, self.outline)
    }

    /// Refuses the value at the path unless it holds to the rule.
    pub fn admit(&self, path: &str, value: impl Debug, holds: bool, rule: &str) -> Check {
        if holds {
            return Ok(());
        }
        // messages name the fields only; the place tells the entry of a list
        let is_field = |step: &&str| step.parse::<usize>().is_err();
        let path = self.place(path);
        let fields: Vec<&str> = path.split('.').filter(is_field).collect();
        let message = not_admitted(&fields.join("."), &format!("{value:?}"));
        self.refuse(&path, message, rule)
    }

    /// Refuses an entry that stands in its list already.
    pub fn once<T: Debug + PartialEq>(&self, path: &str, index: usize, list: &[T]) -> Check {
        if !list[..index].contains(&list[index]) {
            return Ok(());
        }
        let message = format!("{} is listed twice", excerpt(&format!("{:?}", list[index])));
        self.refuse(path, message, "list each once")
    }

    /// Refuses a plane of one parameter or state, or with points without end.
    pub fn plane<X: PlaneAxis, S>(&self, section: &Map<X, S>) -> Check {
        let (name, field) = section.second.written();
        let differ = section.first.written() != section.second.written();
        let rule = format!("the two {field}s of a map must be different");
        self.admit(
            &format!("map.second.{field}"),
            format_args!("{name}"),
            differ,
            &rule,
        )?;
        let MapPoints::Grid { rows, columns } = section.points else {
            return Ok(());
        };
        let rule = format!("a map has at most {MAX_MAP_POINTS} points");
        let holds = rows.saturating_mul(columns) <= MAX_MAP_POINTS;
        self.admit("map.points", section.points, holds, &rule)
    }

    /// Refuses the number of an event along the branch where a label names the event of a curve.
    pub fn label_without_index(&self, is_label: bool) -> Check {
        if !(is_label && self.outline.has("curve.index")) {
            return Ok(());
        }
        self.refuse(
            "curve.index",
            "`curve.index` is given beside a label",
            "leave it out: the label names one event",
        )
    }

    /// Refuses steps [ds, ds_min, ds_max] that are out of order.
    pub fn steps(&self, section: &str, [ds, ds_min, ds_max]: [f64; 3]) -> Check {
        let [ds, ds_min, ds_max] = [("ds", ds), ("ds_min", ds_min), ("ds_max", ds_max)];
        for ((low_name, low), (high_name, high)) in [(ds_min, ds_max), (ds_min, ds), (ds, ds_max)] {
            if low > high {
                let message = format!("`{low_name}` is {low:?} but `{high_name}` is {high:?}");
                let path = format!("{section}.{low_name}");
                return self.refuse(&path, message, "choose ds_min <= ds <= ds_max");
            }
        }
        Ok(())
    }

    /// Refuses a branch that does not begin within its range, or has nothing before it; `widen` says what helps
    /// against the first.
    pub fn beginning<Q>(
        &self,
        section: &Continuation<Q>,
        column: &str,
        value: f64,
        widen: impl FnOnce() -> String,
    ) -> Check {
        let (lower, upper) = section.range;
        let begins = format!("the branch starts at {column} = {value:?}");
        if !(lower..=upper).contains(&value) {
            let message = format!("{begins}, outside the range from {lower:?} to {upper:?}");
            return self.refuse("continuation.range", message, widen());
        }
        let (edge, opposite) = match section.toward {
            Toward::Down if value == lower => ("lower", "Up"),
            Toward::Up if value == upper => ("upper", "Down"),
            _ => return Ok(()),
        };
        let message = format!("{begins}, the {edge} end of the range: nothing in this direction");
        let help = format!("write `toward: {opposite}`, or move this end of the range");
        self.refuse("continuation.toward", message, help)
    }

    /// Refuses user points of another parameter, outside the range, of a monitor that there is not, or listed twice.
    pub fn user_points<Q>(
        &self,
        section: &Continuation<Q>,
        column: &str,
        monitors: &[&str],
    ) -> Check {
        let (lower, upper) = section.range;
        let rule = format!("user points must lie within the range from {lower:?} to {upper:?}");
        let names = self.outline.entries("continuation.stop_at");
        for (index, (point, name)) in section.stop_at.iter().zip(names).enumerate() {
            let path = format!("continuation.stop_at.{index}");
            let value = match point {
                UserPoint::Parameter(value) => *value,
                UserPoint::Monitor(monitor, _) if monitors.contains(&monitor.as_str()) => {
                    self.once(&path, index, &section.stop_at)?;
                    continue;
                }
                UserPoint::Monitor(monitor, value) => {
                    let message = format!(
                        "`{}` is no monitor{}",
                        excerpt(monitor),
                        known(monitor, monitors)
                    );
                    let help = format!(
                        "name an entry of the section `monitor`, or write a value of `{column}` as `{value:?}`"
                    );
                    return self.refuse(&path, message, help);
                }
            };
            if let Some(name) = name.filter(|name| *name != column) {
                let name = excerpt(name);
                let message =
                    format!("the user point names `{name}`, but the branch is in `{column}`");
                let help = match monitors.contains(&name.as_str()) {
                    true => format!("write `(\"{name}\", {value:?})`"),
                    false => format!("write `({column}: {value:?})` or the bare number"),
                };
                return self.refuse(&path, message, help);
            }
            self.admit(&path, value, (lower..=upper).contains(&value), &rule)?;
            // the list is short, and -0 is 0
            self.once(&path, index, &section.stop_at)?;
        }
        Ok(())
    }

    /// Refuses an expectation without numbers; `names` are those it may have.
    pub fn compared(&self, path: &str, event: &Expectation, names: &[&str]) -> Check {
        if event.numbers().next().is_some() {
            return Ok(());
        }
        let message = format!("nothing to compare this {} event with", event.event);
        let help = format!("add at least one number: {}", names.join(", "));
        self.refuse(path, message, help)
    }

    /// Refuses an expectation that every branch meets: where all that it expects stays as it is, as `varies` and
    /// `other`, what else could be expected, tell; or where the whole range of the branch's parameter would do.
    pub fn fallible<Q>(
        &self,
        path: &str,
        event: &Expectation,
        section: &Continuation<Q>,
        column: &str,
        varies: impl Fn(&str) -> bool,
        (whole, other): (&str, Option<&str>),
    ) -> Check {
        if !event.numbers().any(|(name, _)| varies(name)) {
            let message = format!(
                "only values of the {whole} are expected of this {} event, and a branch in \
                 `{column}` keeps them",
                event.event
            );
            let other = other.map_or_else(String::new, |other| format!(" or `{other}`"));
            let help = format!("add `{column}`{other}, which the branch changes");
            return self.refuse(path, message, help);
        }
        let (lower, upper) = section.range;
        for (name, value) in event.numbers().filter(|(name, _)| *name == column) {
            let [least, most] = event.admitted(value);
            if least <= lower && most >= upper {
                let message = format!(
                    "with this tolerance `{name}` may be anything from {least:?} to {most:?}, \
                     which is the whole range"
                );
                let path = format!("{path}.tolerance");
                return self.refuse(&path, message, "take a smaller tolerance");
            }
        }
        Ok(())
    }
}
