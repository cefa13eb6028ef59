//! Waves over their wavelength, as sampled in the folder `profiles`.

use std::fs;
use std::io;
use std::ops::Range;
use std::path::Path;

use super::axis::drawable;
use super::error::PlotError;
use super::number;
use super::palette;
use super::quantity::Quantity;
use super::tables::{Table, Tables};
use plotters::style::RGBColor;

/// Most profiles shown in one picture.
const MOST: usize = 9;

/// What an empty picture says.
pub const NONE: &str = "no profiles were asked for";

/// Samples of a wave.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profile {
    /// Label of its point.
    pub label: String,
    /// Place along the branch; the second leg leads away from the first.
    pub position: i64,
    /// Value of the parameter on the axis of the diagrams, when known.
    pub parameter: Option<f64>,
    /// Mismatch δ, when known.
    pub mismatch: Option<f64>,
    /// Friction coefficient f, when known.
    pub friction: Option<f64>,
    /// Whether the wave was asked for by a value of the parameter.
    pub asked_for: bool,
    /// θ of the samples.
    pub theta: Vec<f64>,
    /// U; not a number where a sample has none, like all that follow.
    pub radial: Vec<f64>,
    /// V.
    pub tangential: Vec<f64>,
    /// V̇.
    pub tangential_rate: Vec<f64>,
    /// P.
    pub pressure: Vec<f64>,
    /// Q.
    pub shear: Vec<f64>,
    /// Names of the regimes.
    pub regimes: Vec<String>,
}

/// Stretch of samples in the same regime.
#[derive(Clone, Debug, PartialEq)]
pub struct Zone<'a> {
    /// Name of the regime.
    pub regime: &'a str,
    /// Its samples.
    pub samples: Range<usize>,
    /// First θ.
    pub from: f64,
    /// Last θ.
    pub to: f64,
}

impl Profile {
    fn read(path: &Path, label: &str, tables: &Tables, parameter: &str) -> Result<Self, PlotError> {
        let table = Table::read(path)?;
        table.require(&["theta", "U", "V", "V_dot", "P", "Q", "regime"])?;
        let mut profile = Profile {
            label: label.to_owned(),
            position: tables.position(label),
            parameter: tables.at_label(label, parameter),
            mismatch: tables.at_label(label, "mismatch"),
            friction: tables.at_label(label, "friction"),
            asked_for: tables.asked_for(label),
            ..Profile::default()
        };
        for row in 0..table.len() {
            let Some(theta) = table.number(row, "theta") else {
                continue;
            };
            let value = |column: &str| table.number(row, column).unwrap_or(f64::NAN);
            profile.theta.push(theta);
            profile.radial.push(value("U"));
            profile.tangential.push(value("V"));
            profile.tangential_rate.push(value("V_dot"));
            profile.pressure.push(value("P"));
            profile.shear.push(value("Q"));
            profile.regimes.push(table.text(row, "regime").to_owned());
        }
        Ok(profile)
    }

    /// The zones in the order of θ.
    pub fn zones(&self) -> Vec<Zone<'_>> {
        let mut zones: Vec<Zone<'_>> = Vec::new();
        for (index, regime) in self.regimes.iter().enumerate() {
            match zones.last_mut() {
                Some(zone) if zone.regime == regime => {
                    zone.samples.end = index + 1;
                    zone.to = self.theta[index];
                }
                _ => zones.push(Zone {
                    regime,
                    samples: index..index + 1,
                    from: self.theta[index],
                    to: self.theta[index],
                }),
            }
        }
        // Switching points may be written once only: zones touch half-way then.
        for index in 1..zones.len() {
            let middle = 0.5 * (zones[index - 1].to + zones[index].from);
            zones[index - 1].to = middle;
            zones[index].from = middle;
        }
        zones
    }

    /// U − δ; U above its least value where δ is not known.
    pub fn gap(&self) -> Vec<f64> {
        let least = self
            .radial
            .iter()
            .copied()
            .filter(|value| drawable(*value))
            .fold(f64::INFINITY, f64::min);
        let reference = self.mismatch.unwrap_or(least);
        self.radial.iter().map(|value| value - reference).collect()
    }
}

/// The profiles of a folder in the order of the parameter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profiles {
    /// Those with samples.
    pub all: Vec<Profile>,
}

/// A profile among those shown, with what tells it from the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown<'a> {
    /// The profile.
    pub profile: &'a Profile,
    /// Colour in the order of the parameter.
    pub colour: RGBColor,
    /// Value of the parameter as text.
    pub text: String,
}

impl Profiles {
    /// Reads the profiles of a folder, if it has any.
    pub fn read(folder: &Path, tables: &Tables, parameter: &str) -> Result<Self, PlotError> {
        let directory = folder.join("profiles");
        let fault = |source| PlotError::Read {
            path: directory.clone(),
            source,
        };
        let entries = match fs::read_dir(&directory) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Self::default()),
            Err(error) => return Err(fault(error)),
        };
        let mut files = Vec::new();
        for entry in entries {
            let path = entry.map_err(fault)?.path();
            let label = path
                .file_stem()
                .map(|stem| stem.to_string_lossy().into_owned());
            if let (Some(label), true) = (label, path.extension().is_some_and(|e| e == "csv"))
                && let Ok(order) = label.parse::<u64>()
            {
                files.push((order, order.to_string(), path));
            }
        }
        files.sort();
        let mut all = Vec::new();
        for (_, label, path) in files {
            match Profile::read(&path, &label, tables, parameter) {
                Ok(profile) if !profile.theta.is_empty() => all.push(profile),
                // A run killed at the start of a file leaves it empty.
                Ok(_) | Err(PlotError::Empty { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        all.sort_by(|a, b| match (a.parameter, b.parameter) {
            (Some(a), Some(b)) => a.total_cmp(&b),
            (a, b) => b.is_some().cmp(&a.is_some()),
        });
        Ok(Profiles { all })
    }

    /// At most nine profiles, evenly chosen with both ends.
    pub fn shown(&self) -> Vec<Shown<'_>> {
        let chosen: Vec<&Profile> = evenly(self.all.len(), MOST)
            .into_iter()
            .map(|index| &self.all[index])
            .collect();
        let values: Vec<f64> = chosen
            .iter()
            .filter_map(|profile| profile.parameter)
            .collect();
        let mut texts = number::distinct(&values).into_iter();
        let last = chosen.len().saturating_sub(1).max(1) as f64;
        chosen
            .iter()
            .enumerate()
            .map(|(index, profile)| {
                let twice = profile.parameter.is_some()
                    && chosen
                        .iter()
                        .filter(|other| other.parameter == profile.parameter)
                        .count()
                        > 1;
                let text = match profile.parameter.and_then(|_| texts.next()) {
                    // Past a fold there are two waves of the same parameter.
                    Some(text) if twice => format!("{text} [{}]", profile.label),
                    Some(text) => text,
                    None => format!("label {}", profile.label),
                };
                Shown {
                    profile,
                    colour: palette::ordered(index as f64 / last),
                    text,
                }
            })
            .collect()
    }
}

/// At most `most` of the indices below `count`, evenly spread from the first to the last.
pub fn evenly(count: usize, most: usize) -> Vec<usize> {
    if count <= most || most < 2 {
        return (0..count.min(most)).collect();
    }
    (0..most)
        .map(|index| (index * (count - 1) + (most - 1) / 2) / (most - 1))
        .collect()
}

/// The quantity that is measured along the wave.
pub fn angle() -> Quantity {
    Quantity::new("position", "θ")
}
