//! The folder of a curve: `curve.csv` and a picture, `curve.svg` unless another format is asked for.

use std::fmt::Write;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::plots::{self, Format, PlotError};
use super::tables::{line, number};
use crate::curve::{Curve, Point};

/// Name of the table.
pub const TABLE: &str = "curve.csv";
/// Name of the picture without extension.
pub const PICTURE: &str = "curve";

/// What is wrong with a folder.
#[derive(Debug, thiserror::Error)]
pub enum CurveFolderError {
    /// The operating system refused.
    #[error("{}: {error}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What the system said.
        error: io::Error,
    },
    /// There are results already.
    #[error("{} holds files already; --force replaces a curve, --out DIR takes another folder", .0.display())]
    Exists(PathBuf),
    /// The picture was not drawn.
    #[error("{0}")]
    Plot(#[from] PlotError),
}

fn io_error(path: &Path) -> impl FnOnce(io::Error) -> CurveFolderError + '_ {
    move |error| CurveFolderError::Io {
        path: path.to_path_buf(),
        error,
    }
}

/// Whether a curve may be written to a folder: it is new, empty, or may be replaced.
///
/// # Errors
/// When it holds files and `force` is not given, or cannot be read.
pub fn admit(path: &Path, force: bool) -> Result<(), CurveFolderError> {
    if !path.exists() {
        return Ok(());
    }
    let occupied = !path.is_dir() || fs::read_dir(path).map_err(io_error(path))?.next().is_some();
    if occupied && !force {
        return Err(CurveFolderError::Exists(path.to_path_buf()));
    }
    Ok(())
}

/// Writes table and picture.
///
/// # Errors
/// When a file cannot be written.
pub fn write(
    path: &Path,
    curve: &Curve,
    ranges: [(f64, f64); 2],
    title: Option<&str>,
    format: Format,
) -> Result<(), CurveFolderError> {
    fs::create_dir_all(path).map_err(io_error(path))?;
    let file = path.join(TABLE);
    let beside = path.join("curve.csv.new");
    fs::write(&beside, table(curve)).map_err(io_error(&beside))?;
    fs::rename(&beside, &file).map_err(io_error(&file))?;
    let picture = path.join(PICTURE).with_extension(format.extension());
    plots::draw_curve(&picture, format, curve, ranges, title)?;
    Ok(())
}

/// The curve as CSV, from one end to the other.
pub fn table(curve: &Curve) -> String {
    let [first, second] = curve.parameters.map(|parameter| parameter.column());
    let mut text = format!(
        "point,type,{first},{second},speed,regimes_before,regimes_after,sector,omega,newton,\
         residual,what\n"
    );
    for index in 0..curve.points.len() {
        let point = &curve.points[index];
        text.push_str(&line(&[
            (index + 1).to_string(),
            point.kind.clone().unwrap_or_default(),
            number(point.parameters[0]),
            number(point.parameters[1]),
            number(point.speed),
            point.before.clone(),
            point.after.clone(),
            curve
                .sector
                .map_or_else(String::new, |sector| sector.to_string()),
            point.omega.map_or_else(String::new, number),
            point.newton.to_string(),
            number(point.residual),
            words(curve, index),
        ]));
    }
    text
}

/// What happens at a point; the reason of an end stands at the first and at the last one.
fn words(curve: &Curve, index: usize) -> String {
    let mut text = curve.points[index].what.clone();
    let last = curve.points.len() - 1;
    for (place, end) in [(0, &curve.ends[0]), (last, &curve.ends[1])] {
        if place == index && !text.contains(end.as_str()) {
            if !text.is_empty() {
                text.push_str("; ");
            }
            text.push_str(end);
        }
    }
    text
}

/// The special points, a line each.
pub fn summary(curve: &Curve) -> String {
    let mut text = String::new();
    let [first, second] = curve.parameters.map(|parameter| parameter.column());
    let _ = writeln!(
        text,
        "{} points; event, {first}, {second}, speed",
        curve.points.len()
    );
    let last = curve.points.len().saturating_sub(1);
    for (index, point) in curve.points.iter().enumerate() {
        let end = index == 0 || index == last;
        let Point {
            kind: Some(kind), ..
        } = point
        else {
            if end {
                let _ = writeln!(text, "  end: {}", words(curve, index));
            }
            continue;
        };
        let [one, other] = point.parameters;
        let _ = write!(
            text,
            "  {kind:<6} {one:.12}  {other:.12}  {:.12}",
            point.speed
        );
        if let Some(omega) = point.omega {
            let _ = write!(text, "  ω {omega:.12}");
        }
        let _ = writeln!(text, "  {}", words(curve, index));
    }
    text
}
