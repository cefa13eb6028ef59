//! The folder of a simulation: time series, regimes, snapshots, measures, checkpoint.
//!
//! Rows are appended as samples are taken. `checkpoint.ron` holds the state of the body; it is
//! replaced as a whole, never seen half written. A resumed simulation cuts everything back to the
//! last checkpoint and goes on through the same steps as an uninterrupted one, to the same bytes.

use serde::{Deserialize, Serialize};

use super::layout::{self, END, MEASURES, REGIMES, SERIES, SNAPSHOTS, START};
use super::render::Format;
use super::store::{Checkpoint, FolderKind, GrowingFile, Store, StoreError, damaged};
use super::{npy, vtk};
use crate::problem::Problem;
use crate::simulation::line::Line;
use crate::simulation::measure::TimeSample;
use crate::simulation::motion::{Saved, SimulatedMotion};
use crate::table::{self, Table};

/// Most columns of the array of regimes.
const COLUMNS: usize = 512;

/// Every how many points one is kept in the array of regimes.
fn stride(points: usize) -> usize {
    points.div_ceil(COLUMNS).max(1)
}

/// Columns of the array of regimes.
pub(crate) fn columns(points: usize) -> usize {
    points.div_ceil(stride(points))
}

/// Content of `checkpoint.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SimulationCheckpoint {
    /// Version of brakewave that wrote it.
    pub version: String,
    /// The problem with all its settings.
    pub problem: Problem,
    /// Samples taken, the one at the beginning included.
    pub samples: usize,
    pub snapshots: usize,
    pub steps: u64,
    pub energy: f64,
    pub state: Saved,
}

impl Checkpoint for SimulationCheckpoint {
    type Problem = Problem;

    const FILE: &'static str = "checkpoint.ron";

    fn problem(&self) -> &Problem {
        &self.problem
    }
}

/// The folder of a simulation being written.
#[derive(Debug)]
pub(crate) struct SimulationFolder {
    store: Store,
    series: GrowingFile,
    regimes: GrowingFile,
    samples: usize,
    snapshots: usize,
    columns: usize,
}

/// A contact line by its columns.
fn columns_of<'a>(angles: &'a [f64], line: &'a Line) -> [(&'static str, &'a [f64]); 7] {
    [
        ("phi", angles),
        ("U", &line.radial),
        ("V", &line.tangential),
        ("U_dot", &line.radial_rate),
        ("V_dot", &line.tangential_rate),
        ("P", &line.pressure),
        ("Q", &line.shear),
    ]
}

fn angles(line: &Line) -> Vec<f64> {
    let points = 0..line.radial.len();
    points.map(|point| line.width * point as f64).collect()
}

/// All fail when a file cannot be written.
impl SimulationFolder {
    /// What an interrupted simulation left; a kill before the first checkpoint leaves a header and the
    /// sample at the beginning.
    ///
    /// # Errors
    /// When that is damaged.
    pub(crate) fn interrupted(
        store: &Store,
        problem: &Problem,
    ) -> Result<Option<SimulationCheckpoint>, StoreError> {
        store.interrupted(problem, SERIES, 2)
    }

    /// Begins a simulation, in place of an earlier one.
    pub(crate) fn create(
        store: Store,
        problem: &Problem,
        points: usize,
    ) -> Result<SimulationFolder, StoreError> {
        let checkpoint = SimulationCheckpoint::FILE;
        let tables = [SERIES, REGIMES, START, checkpoint, END, MEASURES];
        let pictures = layout::pictures(FolderKind::Simulation, problem, Format::Svg);
        store.begin(&tables, pictures, Some(SNAPSHOTS))?;
        let columns = columns(points);
        Ok(SimulationFolder {
            series: store.table(SERIES, &table::header::<TimeSample>(), None)?,
            regimes: store.create(REGIMES, &npy::header(npy::NpyType::Byte, 0, columns))?,
            store,
            samples: 0,
            snapshots: 0,
            columns,
        })
    }

    /// Goes on with an interrupted simulation, cut back to its checkpoint; returns the samples taken so
    /// far as well.
    pub(crate) fn reopen(
        store: Store,
        points: usize,
        checkpoint: &SimulationCheckpoint,
    ) -> Result<(SimulationFolder, Vec<TimeSample>), StoreError> {
        let (columns, count) = (columns(points), checkpoint.samples);
        let series = store.lines(SERIES, Some(count + 1))?;
        let samples = Table::parse(&series).and_then(|table| table.rows());
        let samples =
            samples.map_err(|error| damaged(&store.path().join(SERIES), error.to_string()))?;
        let folder = SimulationFolder {
            series: store.cut(SERIES, series.len())?,
            regimes: store.cut(REGIMES, npy::HEADER + columns * count)?,
            samples: count,
            snapshots: checkpoint.snapshots,
            columns,
            store,
        };
        folder
            .store
            .keep_numbered(SNAPSHOTS, checkpoint.snapshots)?;
        Ok((folder, samples))
    }

    pub(crate) fn store(&self) -> &Store {
        &self.store
    }

    pub(crate) fn snapshots(&self) -> usize {
        self.snapshots
    }

    pub(crate) fn sample(&mut self, sample: &TimeSample, line: &Line) -> Result<(), StoreError> {
        self.series.row(sample)?;
        let kept = line.regimes.iter().step_by(stride(line.regimes.len()));
        let codes: Vec<u8> = kept.map(|regime| regime.code()).collect();
        self.regimes.push(&codes)?;
        self.samples += 1;
        Ok(())
    }

    /// Writes the contact line as a table.
    pub(crate) fn line(&self, name: &str, line: &Line) -> Result<(), StoreError> {
        let angles = angles(line);
        let columns = columns_of(&angles, line);
        let names = columns.iter().map(|(name, _)| *name).chain(["regime"]);
        let mut text = table::line_of(&names.map(str::to_owned).collect::<Vec<_>>());
        for (point, regime) in line.regimes.iter().enumerate() {
            let numbers = columns
                .iter()
                .map(|(_, values)| table::number(values[point]));
            let cells: Vec<String> = numbers.chain([regime.name().to_owned()]).collect();
            text.push_str(&table::line_of(&cells));
        }
        self.store.replace(name, text.as_bytes())
    }

    /// Writes a snapshot: an array of φ, U, V, U̇, V̇, P, Q for a ring, the mesh for an annulus.
    pub(crate) fn snapshot(&mut self, motion: &SimulatedMotion) -> Result<(), StoreError> {
        let number = self.snapshots + 1;
        let (extension, content) = match motion {
            SimulatedMotion::Ring(_) => {
                let line = motion.line();
                let angles = angles(&line);
                let columns = columns_of(&angles, &line).map(|(_, values)| values);
                ("npy", npy::doubles(&columns))
            }
            SimulatedMotion::Annulus(annulus) => {
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
    pub(crate) fn checkpoint(
        &mut self,
        checkpoint: &SimulationCheckpoint,
    ) -> Result<(), StoreError> {
        let header = npy::header(npy::NpyType::Byte, self.samples, self.columns);
        self.regimes.rewrite_head(&header)?;
        self.regimes.sync()?;
        self.series.sync()?;
        self.store.save(SimulationCheckpoint::FILE, checkpoint)
    }

    /// Writes a table of what was found.
    pub(crate) fn table<Row: Serialize + Default + Copy>(
        &self,
        name: &str,
        rows: &[Row],
    ) -> Result<(), StoreError> {
        let text = table::table(rows.iter().copied());
        self.store.replace(name, text.as_bytes())
    }
}
