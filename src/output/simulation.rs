//! The folder of a simulation: time series, regimes, snapshots, measures, checkpoint.
//!
//! Rows are appended as samples are taken. `checkpoint.ron` holds the state of the body; it is
//! replaced as a whole, never seen half written. A resumed simulation cuts everything back to the
//! last checkpoint and goes on through the same steps as an uninterrupted one, to the same bytes.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::pictures;
use super::render::Format;
use super::store::{self, Store, StoreError, VERSION, damaged, io_error};
use super::{npy, vtk};
use crate::problem::Problem;
use crate::simulation::growth::GrowthRow;
use crate::simulation::line::Line;
use crate::simulation::measure::{Measure, Sample};
use crate::simulation::motion::{Motion, Saved};
use crate::table::{self, Table};

/// Name of the checkpoint.
pub const CHECKPOINT: &str = "checkpoint.ron";
/// Name of the time series.
pub const SERIES: &str = "series.csv";
/// Name of the array of regimes.
pub const REGIMES: &str = "regimes.npy";
/// Name of the contact line at the beginning.
pub const START: &str = "start.csv";
/// Name of the contact line at the end.
pub const END: &str = "end.csv";
/// Name of the table of measures.
pub const MEASURES: &str = "measures.csv";
const GROWTH: &str = "growth.csv";
const SNAPSHOTS: &str = "snapshots";

/// Most columns of the array of regimes.
const COLUMNS: usize = 512;

/// Content of `checkpoint.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Version of brakewave that wrote it.
    pub version: String,
    /// The problem with all its settings.
    pub problem: Problem,
    /// Samples taken, the one at the beginning included.
    pub samples: usize,
    /// Snapshots written.
    pub snapshots: usize,
    /// Steps taken.
    pub steps: u64,
    /// Energy at the beginning.
    pub energy: f64,
    /// State of the body.
    pub state: Saved,
}

impl Checkpoint {
    /// Reads the checkpoint of a folder.
    ///
    /// # Errors
    /// When it is missing or damaged.
    pub fn read(folder: &Path) -> Result<Checkpoint, StoreError> {
        let path = folder.join(CHECKPOINT);
        ron::from_str(&store::read(&path)?)
            .map_err(|error| damaged(&path, format!("it is no checkpoint: {error}")))
    }
}

/// The folder of a simulation being written.
#[derive(Debug)]
pub struct SimulationFolder {
    store: Store,
    series: File,
    regimes: File,
    samples: usize,
    snapshots: usize,
    columns: usize,
}

/// Every how many points one is kept in the array of regimes.
fn stride(points: usize) -> usize {
    points.div_ceil(COLUMNS).max(1)
}

/// Columns of the array of regimes.
pub fn columns(points: usize) -> usize {
    points.div_ceil(stride(points))
}

const WRITE: &str = "write it";

impl SimulationFolder {
    /// Begins a simulation, in place of an earlier one.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn create(store: Store, points: usize) -> Result<SimulationFolder, StoreError> {
        let tables = [SERIES, REGIMES, START, CHECKPOINT, END, MEASURES];
        let pictures = pictures::simulation_names(Format::Svg);
        let names = tables.map(str::to_owned).into_iter().chain(pictures);
        store.begin(names, Some(SNAPSHOTS))?;
        let columns = columns(points);
        let header = table::header::<Sample>();
        Ok(SimulationFolder {
            series: store.create(SERIES, header.as_bytes())?,
            regimes: store.create(REGIMES, &npy::header(npy::Kind::Byte, 0, columns))?,
            store,
            samples: 0,
            snapshots: 0,
            columns,
        })
    }

    /// Goes on with an interrupted simulation, cut back to its checkpoint; returns the samples taken so
    /// far as well.
    ///
    /// # Errors
    /// When a file is damaged or cannot be written.
    pub fn reopen(
        store: Store,
        points: usize,
        checkpoint: &Checkpoint,
    ) -> Result<(SimulationFolder, Vec<Sample>), StoreError> {
        let columns = columns(points);
        let count = checkpoint.samples;
        let (samples, length) = read_series(&store.path().join(SERIES), count)?;
        let folder = SimulationFolder {
            series: store.cut(SERIES, length)?,
            regimes: store.cut(REGIMES, npy::HEADER + columns * count)?,
            samples: count,
            snapshots: checkpoint.snapshots,
            columns,
            store,
        };
        folder.store.retain(|name| {
            let number = name.strip_prefix(SNAPSHOTS).and_then(|name| {
                let (number, _) = name.strip_prefix('/')?.split_once('.')?;
                number.parse::<usize>().ok()
            });
            number.is_none_or(|number| number <= checkpoint.snapshots)
        })?;
        Ok((folder, samples))
    }

    /// What keeps the files.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// Samples written.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Snapshots written.
    pub fn snapshots(&self) -> usize {
        self.snapshots
    }

    /// Appends a sample.
    pub fn sample(&mut self, sample: &Sample, line: &Line) -> Result<(), StoreError> {
        let path = self.store.path().join(SERIES);
        let row = table::line(sample);
        (self.series.write_all(row.as_bytes())).map_err(io_error(WRITE, &path))?;
        let codes: Vec<u8> = line
            .regimes
            .iter()
            .step_by(stride(line.regimes.len()))
            .map(|regime| regime.code())
            .collect();
        let path = self.store.path().join(REGIMES);
        (self.regimes.write_all(&codes)).map_err(io_error(WRITE, &path))?;
        self.samples += 1;
        Ok(())
    }

    /// Writes the contact line as a table.
    pub fn line(&self, name: &str, line: &Line) -> Result<(), StoreError> {
        let rows = (0..line.radial.len()).map(|point| LineRow {
            phi: line.width * point as f64,
            radial: line.radial[point],
            tangential: line.tangential[point],
            radial_rate: line.radial_rate[point],
            tangential_rate: line.tangential_rate[point],
            pressure: line.pressure[point],
            shear: line.shear[point],
            regime: line.regimes[point].name(),
        });
        self.store.replace(name, table::table(rows).as_bytes())
    }

    /// Writes a snapshot: an array of φ, U, V, U̇, V̇, P, Q for a ring, the mesh for an annulus.
    pub fn snapshot(&mut self, motion: &Motion) -> Result<(), StoreError> {
        let number = self.snapshots + 1;
        let (extension, content) = match motion {
            Motion::Ring(_) => {
                let line = motion.line();
                let angles: Vec<f64> = (0..line.radial.len())
                    .map(|point| line.width * point as f64)
                    .collect();
                let columns: [&[f64]; 7] = [
                    &angles,
                    &line.radial,
                    &line.tangential,
                    &line.radial_rate,
                    &line.tangential_rate,
                    &line.pressure,
                    &line.shear,
                ];
                ("npy", npy::doubles(&columns))
            }
            Motion::Annulus(annulus) => {
                let title = format!("brakewave annulus, t = {}", motion.time());
                ("vtk", vtk::annulus(annulus, &title).into_bytes())
            }
        };
        let name = format!("{SNAPSHOTS}/{number:04}.{extension}");
        self.store.replace(&name, &content)?;
        self.snapshots = number;
        Ok(())
    }

    /// Saves the state, after what leads to it.
    pub fn checkpoint(
        &mut self,
        problem: &Problem,
        energy: f64,
        motion: &Motion,
    ) -> Result<(), StoreError> {
        let header = npy::header(npy::Kind::Byte, self.samples, self.columns);
        let regimes = &mut self.regimes;
        regimes
            .seek(SeekFrom::Start(0))
            .and_then(|_| regimes.write_all(&header))
            .and_then(|()| regimes.seek(SeekFrom::End(0)))
            .and_then(|_| regimes.sync_data())
            .map_err(io_error(WRITE, &self.store.path().join(REGIMES)))?;
        (self.series.sync_data()).map_err(io_error(WRITE, &self.store.path().join(SERIES)))?;
        let checkpoint = Checkpoint {
            version: VERSION.to_string(),
            problem: problem.clone(),
            samples: self.samples,
            snapshots: self.snapshots,
            steps: motion.steps(),
            energy,
            state: motion.saved(),
        };
        self.store.replace_ron(CHECKPOINT, &checkpoint)
    }

    /// Writes what was measured.
    pub fn measures(&self, measures: &[Measure]) -> Result<(), StoreError> {
        let rows = measures.iter().copied();
        self.store.replace(MEASURES, table::table(rows).as_bytes())
    }

    /// Writes eigenvalues by sector, each with its residual and its difference from a coarser grid.
    pub fn growth(&self, rows: &[GrowthRow]) -> Result<(), StoreError> {
        let rows = rows.iter().copied();
        self.store.replace(GROWTH, table::table(rows).as_bytes())
    }
}

/// A row of a contact line.
#[derive(Default, Serialize)]
struct LineRow {
    phi: f64,
    #[serde(rename = "U")]
    radial: f64,
    #[serde(rename = "V")]
    tangential: f64,
    #[serde(rename = "U_dot")]
    radial_rate: f64,
    #[serde(rename = "V_dot")]
    tangential_rate: f64,
    #[serde(rename = "P")]
    pressure: f64,
    #[serde(rename = "Q")]
    shear: f64,
    regime: &'static str,
}

/// The first rows of a time series, and the bytes they take with the header.
pub fn read_series(path: &Path, rows: usize) -> Result<(Vec<Sample>, usize), StoreError> {
    let bytes = store::bytes(path)?;
    let ends = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
    let length = ends.map(|(index, _)| index + 1).nth(rows);
    let length = length.ok_or_else(|| damaged(path, "fewer rows than the checkpoint says"))?;
    let samples = Table::parse(&bytes[..length]).and_then(|table| table.rows());
    let samples = samples.map_err(|error| damaged(path, error.to_string()))?;
    Ok((samples, length))
}

/// Names of the pictures of a simulation, without extension.
pub const PICTURES: [&str; 3] = ["space_time", "phase_plane", "profiles"];
