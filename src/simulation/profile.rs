//! A wave as tabulated in the folder of a run, to begin a simulation with.
//!
//! The table has θ from release in the direction in which time passes at a point, over one
//! wavelength, with both sides of every switch. A wave of speed c is at the place φ and the time t
//! what the table says at θ = −(φ − ct) sgn c. Between two rows of one zone U and V are cubic with the
//! rates as slopes, ∂/∂θ = (1/|c|)∂/∂t, and the rates are the slopes of that; across a switch nothing
//! is interpolated.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What is wrong with a table.
#[derive(Debug, thiserror::Error)]
pub enum ProfileError {
    /// The file cannot be read as a table.
    #[error("{}: {source}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// What the reader said.
        source: csv::Error,
    },
    /// A column is missing, or a cell is no number.
    #[error("{}: {reason}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

/// Relative difference of places that is rounding of the sum of zones before them.
const SAME_PLACE: f64 = 1e-12;

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ProfileRow {
    theta: f64,
    radial: f64,
    tangential: f64,
    radial_rate: f64,
    tangential_rate: f64,
    contact: bool,
}

/// A travelling wave over one wavelength.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    speed: f64,
    rows: Vec<ProfileRow>,
}

/// U, V and their rates at a place, and whether it is in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSample {
    /// U, V, U̇, V̇.
    pub values: [f64; 4],
    /// Whether U = δ.
    pub contact: bool,
}

impl Profile {
    /// Reads `profiles/LABEL.csv` of a wave of this speed, c ≠ 0.
    ///
    /// # Errors
    /// There is no such file, or it holds no wave.
    pub fn read(path: &Path, speed: f64) -> Result<Profile, ProfileError> {
        let file = File::open(path).map_err(|error| ProfileError::Table {
            path: path.to_owned(),
            source: error.into(),
        })?;
        Profile::of_table(file, path, speed)
    }

    /// The wave of a table like `profiles/LABEL.csv`; `path` is what messages call it.
    ///
    /// # Errors
    /// It holds no wave.
    pub(crate) fn of_table(
        table: impl Read,
        path: &Path,
        speed: f64,
    ) -> Result<Profile, ProfileError> {
        let fault = |source| ProfileError::Table {
            path: path.to_owned(),
            source,
        };
        let content = |reason: String| ProfileError::Content {
            path: path.to_owned(),
            reason,
        };
        if !(speed.is_finite() && speed != 0.0) {
            return Err(content(format!("{speed} is not the speed of a wave")));
        }
        let mut reader = csv::Reader::from_reader(table);
        let header = reader.headers().map_err(fault)?.clone();
        let column = |name: &str| {
            header
                .iter()
                .position(|field| field == name)
                .ok_or_else(|| content(format!("there is no column {name}")))
        };
        let numbers = [
            column("theta")?,
            column("U")?,
            column("V")?,
            column("U_dot")?,
            column("V_dot")?,
        ];
        let regime = column("regime")?;
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(fault)?;
            let mut values = [0.0; 5];
            for (value, &index) in values.iter_mut().zip(&numbers) {
                let cell = record.get(index).unwrap_or_default();
                *value = cell
                    .parse()
                    .ok()
                    .filter(|value: &f64| value.is_finite())
                    .ok_or_else(|| content(format!("`{cell}` is not a number")))?;
            }
            let [theta, radial, tangential, radial_rate, tangential_rate] = values;
            rows.push(ProfileRow {
                theta,
                radial,
                tangential,
                radial_rate,
                tangential_rate,
                contact: record.get(regime) != Some("separation"),
            });
        }
        // the two sides of a switch may differ by rounding
        let mut falls = false;
        for index in 1..rows.len() {
            let before = rows[index - 1].theta;
            falls |= rows[index].theta < before - SAME_PLACE * before.abs();
            rows[index].theta = rows[index].theta.max(before);
        }
        if rows.len() < 2 || falls {
            return Err(content("θ must rise from row to row".to_owned()));
        }
        Ok(Profile { speed, rows })
    }

    /// Speed c of the wave.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Length of the wave as an angle.
    pub fn wavelength(&self) -> f64 {
        let last = self.rows.len() - 1;
        self.rows[last].theta - self.rows[0].theta
    }

    /// The wave at a place and a time.
    pub fn at(&self, place: f64, time: f64) -> SurfaceSample {
        let first = self.rows[0].theta;
        let theta = -(place - self.speed * time) * self.speed.signum();
        let theta = first + (theta - first).rem_euclid(self.wavelength());
        let after = self.rows.partition_point(|row| row.theta <= theta);
        let right = &self.rows[after.clamp(1, self.rows.len() - 1)];
        let left = &self.rows[after.clamp(1, self.rows.len() - 1) - 1];
        let width = right.theta - left.theta;
        let duration = width / self.speed.abs();
        let part = if width > 0.0 {
            ((theta - left.theta) / width).clamp(0.0, 1.0)
        } else {
            1.0
        };
        let (u, u_rate) = cubic(
            part,
            duration,
            [left.radial, right.radial],
            [left.radial_rate, right.radial_rate],
        );
        let (v, v_rate) = cubic(
            part,
            duration,
            [left.tangential, right.tangential],
            [left.tangential_rate, right.tangential_rate],
        );
        SurfaceSample {
            values: [u, v, u_rate, v_rate],
            contact: left.contact && right.contact,
        }
    }
}

/// The cubic with these values and slopes at the ends of an interval, and its slope, at a part of
/// the interval.
fn cubic(part: f64, length: f64, [y0, y1]: [f64; 2], [s0, s1]: [f64; 2]) -> (f64, f64) {
    if length <= 0.0 {
        return (y1, s1);
    }
    let rise = y1 - y0;
    let (m0, m1) = (s0 * length, s1 * length);
    let square = 3.0 * rise - 2.0 * m0 - m1;
    let cube = m0 + m1 - 2.0 * rise;
    (
        y0 + part * (m0 + part * (square + part * cube)),
        (m0 + part * (2.0 * square + 3.0 * part * cube)) / length,
    )
}
