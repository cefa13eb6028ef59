//! Waves over their wavelength, as sampled in the folder `profiles`.

use crate::output::render::{
    Extent, Key, Legend, Pen, Point, Quantity, drawable, number, ordered, range,
};
use std::ops::Range;
use std::path::Path;

use plotters::style::RGBColor;

use super::tables::{Tables, read_if_there};
use super::view::parameter_axis;
use crate::output::layout::PROFILES;
use crate::output::store::{self, StoreError};
use crate::tube::model::signature::Regime;

/// Most profiles shown in one picture.
const MOST: usize = 9;

/// Waves of the same regimes that are nearer than this, in parts of the axis of the parameter and in parts of
/// the range of speeds, look the same: one of them is shown.
const NEAR: f64 = 0.02;

/// What an empty picture says.
pub(super) const NONE: &str = "no profiles were asked for";

/// A wave at one place; what is not known is not a number.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DrawnSample {
    /// θ, always known.
    pub theta: f64,
    pub radial: f64,
    pub tangential: f64,
    /// V̇.
    pub rate: f64,
    pub pressure: f64,
    pub shear: f64,
    /// The regime, if it is a known one.
    pub regime: Option<Regime>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct DrawnProfile {
    pub label: String,
    /// Place along the branch; the second leg leads away from the first.
    pub position: i64,
    /// Value of the parameter on the axis of the diagrams, when known.
    pub parameter: Option<f64>,
    pub speed: Option<f64>,
    /// Mismatch δ, when known.
    pub mismatch: Option<f64>,
    /// Friction coefficient f, when known.
    pub friction: Option<f64>,
    pub regimes: String,
    /// Whether the wave was asked for by a value of the parameter.
    pub asked_for: bool,
    /// The samples in the order of θ.
    pub samples: Vec<DrawnSample>,
}

/// Stretch of samples in the same regime.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RegimeSpan {
    /// The regime, if it is a known one.
    pub regime: Option<Regime>,
    pub samples: Range<usize>,
    /// First θ.
    pub from: f64,
    /// Last θ.
    pub to: f64,
}

impl DrawnProfile {
    /// Reads a profile; none where a run was killed at the start of the file.
    fn read(path: &Path, label: &str, tables: &Tables) -> Result<Option<Self>, StoreError> {
        let columns = ["theta", "U", "V", "V_dot", "P", "Q", "regime"];
        let Some(table) = read_if_there(path, &columns)? else {
            return Ok(None);
        };
        let known = |cell: &str| cell.parse().ok().filter(|value| drawable(*value));
        let value = |cell| known(cell).unwrap_or(f64::NAN);
        let samples = table.select(columns).filter_map(
            |[theta, radial, tangential, rate, pressure, shear, regime]| {
                Some(DrawnSample {
                    theta: known(theta)?,
                    radial: value(radial),
                    tangential: value(tangential),
                    rate: value(rate),
                    pressure: value(pressure),
                    shear: value(shear),
                    regime: Regime::named(regime),
                })
            },
        );
        let samples: Vec<DrawnSample> = samples.collect();
        Ok((!samples.is_empty()).then(|| DrawnProfile {
            label: label.to_owned(),
            position: tables.position(label),
            parameter: tables.parameter_at(label),
            speed: tables.at_label(label, "speed"),
            mismatch: tables.at_label(label, "mismatch"),
            friction: tables.at_label(label, "friction"),
            asked_for: tables.asked_for(label),
            regimes: tables.regimes_at(label),
            samples,
        }))
    }

    /// What a function tells of the samples, over θ.
    pub(crate) fn over(&self, value: impl Fn(&DrawnSample) -> f64) -> Vec<Point> {
        let samples = self.samples.iter();
        samples
            .map(|sample| (sample.theta, value(sample)))
            .collect()
    }

    /// The zones in the order of θ.
    pub(crate) fn zones(&self) -> Vec<RegimeSpan> {
        let mut zones: Vec<RegimeSpan> = Vec::new();
        for samples in self
            .samples
            .chunk_by(|one, other| one.regime == other.regime)
        {
            let start = zones.last().map_or(0, |zone| zone.samples.end);
            zones.push(RegimeSpan {
                regime: samples[0].regime,
                samples: start..start + samples.len(),
                from: samples[0].theta,
                to: samples[samples.len() - 1].theta,
            });
        }
        // Switching points may be written once only: zones touch half-way then.
        for index in 1..zones.len() {
            let middle = 0.5 * (zones[index - 1].to + zones[index].from);
            zones[index - 1].to = middle;
            zones[index].from = middle;
        }
        zones
    }

    /// What gaps are measured from: δ, or the least U where δ is not known.
    pub(crate) fn contact(&self) -> f64 {
        let radial = self.samples.iter().map(|sample| sample.radial);
        let least = radial
            .filter(|value| drawable(*value))
            .fold(f64::INFINITY, f64::min);
        self.mismatch.unwrap_or(least)
    }
}

/// The profiles of a folder in the order of the parameter.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Profiles {
    pub parameter: Quantity,
    pub all: Vec<DrawnProfile>,
    /// Whether the axis of the parameter is logarithmic.
    pub logarithmic: bool,
    /// Labels of those to show; where there are none they are chosen.
    pub wanted: Vec<String>,
}

/// A profile among those shown, with what tells it from the others.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shown<'a> {
    pub profile: &'a DrawnProfile,
    /// Colour in the order of the parameter.
    pub colour: RGBColor,
    /// Value of the parameter as text.
    pub text: String,
}

impl Profiles {
    /// Reads the profiles of a folder, if it has any.
    ///
    /// # Errors
    /// One of them cannot be read.
    pub(crate) fn read(
        folder: &Path,
        tables: &Tables,
        labels: &[usize],
    ) -> Result<Self, StoreError> {
        let files = store::numbered(&folder.join(PROFILES), ".csv")?;
        let mut all = Vec::new();
        for (label, path) in files {
            all.extend(DrawnProfile::read(&path, &label.to_string(), tables)?);
        }
        all.sort_by(|a, b| match (a.parameter, b.parameter) {
            (Some(a), Some(b)) => a.total_cmp(&b),
            (a, b) => b.is_some().cmp(&a.is_some()),
        });
        let axis = parameter_axis(tables);
        let logarithmic = matches!(axis.extent, Extent::Logarithmic(_));
        let wanted = labels.iter().map(usize::to_string).collect();
        Ok(Profiles {
            parameter: axis.quantity,
            logarithmic,
            all,
            wanted,
        })
    }

    /// Whether two waves look the same. Beyond a fold there is another wave at the same parameter: their
    /// speeds tell them apart.
    fn alike(&self, one: &DrawnProfile, other: &DrawnProfile) -> bool {
        let place = |profile: &DrawnProfile| {
            let value = profile.parameter.unwrap_or(f64::NAN);
            if self.logarithmic { value.ln() } else { value }
        };
        let speed = |profile: &DrawnProfile| profile.speed.unwrap_or(f64::NAN);
        let near = |of: &dyn Fn(&DrawnProfile) -> f64| {
            let width = range(self.all.iter().map(of)).map_or(0.0, |(low, high)| high - low);
            (of(one) - of(other)).abs() <= NEAR * width
        };
        one.regimes == other.regimes && near(&place) && near(&speed)
    }

    /// The profiles to show: those wanted, or else at most nine, one of every sequence of regimes before
    /// those that were asked for by a value and those in between; of waves that look the same one.
    fn chosen(&self) -> Vec<&DrawnProfile> {
        let all = &self.all;
        if !self.wanted.is_empty() {
            let wanted = all.iter().filter(|one| self.wanted.contains(&one.label));
            return wanted.collect();
        }
        let mut order: Vec<usize> = Vec::new();
        let regimes = |index: &usize| all[*index].regimes.as_str();
        for index in 0..all.len() {
            let of_kind: Vec<usize> = (0..all.len())
                .filter(|other| regimes(other) == regimes(&index))
                .collect();
            // the middle one of its kind, of those asked for if there are any
            let asked = of_kind.iter().filter(|other| all[**other].asked_for);
            let asked: Vec<usize> = asked.copied().collect();
            let from = if asked.is_empty() { of_kind } else { asked };
            if from[from.len() / 2] == index {
                order.push(index);
            }
        }
        order.extend((0..all.len()).filter(|index| all[*index].asked_for));
        order.extend(evenly(all.len(), MOST));
        let mut taken: Vec<usize> = Vec::new();
        for index in order {
            let mut others = taken.iter();
            let shown =
                others.any(|other| *other == index || self.alike(&all[*other], &all[index]));
            if taken.len() < MOST && !shown {
                taken.push(index);
            }
        }
        taken.sort_unstable();
        taken.into_iter().map(|index| &all[index]).collect()
    }

    /// The profiles to show, each with its look.
    pub(crate) fn shown(&self) -> Vec<Shown<'_>> {
        let chosen = self.chosen();
        let values: Vec<f64> = chosen
            .iter()
            .filter_map(|profile| profile.parameter)
            .collect();
        let mut texts = number::distinct(&values).into_iter();
        let last = chosen.len().saturating_sub(1).max(1) as f64;
        let show = |(index, profile): (usize, &&'_ DrawnProfile)| {
            let value = profile.parameter;
            let same = chosen.iter().filter(|other| other.parameter == value);
            let text = match value.and_then(|_| texts.next()) {
                // Past a fold there are two waves of the same parameter.
                Some(text) if same.count() > 1 => format!("{text} [{}]", profile.label),
                Some(text) => text,
                None => format!("label {}", profile.label),
            };
            (ordered(index as f64 / last), text)
        };
        let looks: Vec<(RGBColor, String)> = chosen.iter().enumerate().map(show).collect();
        let looks = looks.into_iter().zip(&chosen);
        looks
            .map(|((colour, text), profile)| Shown {
                profile,
                colour,
                text,
            })
            .collect()
    }

    /// Explains which colour belongs to which value of the parameter.
    pub(crate) fn legend(&self, shown: &[Shown<'_>]) -> Legend {
        let key = |one: &Shown<'_>| (Key::Line(Pen::solid(one.colour, 2.4)), one.text.clone());
        match shown {
            [] => Legend::default(),
            _ => Legend::default().with(
                &format!("{} =", self.parameter.short()),
                shown.iter().map(key),
            ),
        }
    }
}

/// At most `most` of the indices below `count`, evenly spread from the first to the last.
pub(super) fn evenly(count: usize, most: usize) -> Vec<usize> {
    if count <= most || most < 2 {
        return (0..count.min(most)).collect();
    }
    (0..most)
        .map(|index| (index * (count - 1) + (most - 1) / 2) / (most - 1))
        .collect()
}
