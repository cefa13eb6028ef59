//! The folder of a certificate: a table of what is proven, and all that it takes to check it.

use std::path::Path;

use serde::Serialize;

use super::layout::CERTIFICATES as TABLE;
use super::store::{self, GrowingFile, Store, StoreError, damaged, decode};
use super::theorem::{Stated, enclosing, theorems, written};
use crate::certify::{
    ArcOutcome, Certificate, CertifiedPoint, Counted, GrowthCount, ProofOutcome, Provable,
    ProvenEigenvalue, ProvenVerdict, WaveProof, equilibrium, orbit,
};
use crate::interval::Interval;
use crate::table;

/// What is proven of a kind of orbits, as a table and in words.
pub(crate) trait Certified: Stated {
    /// A row of the table.
    type Row: Serialize + Default;

    /// The row of a point.
    fn row(point: &CertifiedPoint<Self>) -> Self::Row;

    /// What is proven of a point, in lines.
    fn sentence(point: &CertifiedPoint<Self>) -> String;
}

/// What a point is, in every table.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct PointColumns {
    label: usize,
    r#type: String,
    parameter: String,
    low: Option<f64>,
    high: Option<f64>,
}

/// What is said of its orbit, in every table.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Said {
    unique: Option<f64>,
    inequalities: Option<usize>,
    proven: &'static str,
    why: String,
}

/// What is said of the branch before it, in every table.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct ArcColumns {
    arc: &'static str,
    arc_why: String,
}

impl PointColumns {
    fn new<P: Provable>(
        point: &CertifiedPoint<P>,
        parameter: &str,
        value: Option<Interval>,
    ) -> PointColumns {
        let (low, high) = ends(value);
        PointColumns {
            label: point.label,
            r#type: point.kind.to_string(),
            parameter: parameter.to_owned(),
            low,
            high,
        }
    }
}

impl Said {
    fn new<P: Provable>(point: &CertifiedPoint<P>, of: impl Fn(&P) -> (f64, usize)) -> Said {
        let (said, why) = match &point.outcome {
            ProofOutcome::Proven(proof) => (Some(of(proof)), ""),
            ProofOutcome::Open(reason) => (None, &**reason),
        };
        Said {
            unique: said.map(|(unique, _)| unique),
            inequalities: said.map(|(_, inequalities)| inequalities),
            proven: if said.is_some() { "yes" } else { "no" },
            why: why.to_owned(),
        }
    }
}

impl ArcColumns {
    fn new<P: Provable>(point: &CertifiedPoint<P>) -> ArcColumns {
        let (arc, why) = match &point.arc {
            None => ("", ""),
            Some(ArcOutcome::Proven) => ("yes", ""),
            Some(ArcOutcome::Open(reason)) => ("no", &**reason),
        };
        ArcColumns {
            arc,
            arc_why: why.to_owned(),
        }
    }
}

/// What is said of the branch before a point, in a line; `others` are events that are not looked for on it.
fn before<P: Provable>(point: &CertifiedPoint<P>, others: &str) -> String {
    match &point.arc {
        None => String::new(),
        Some(ArcOutcome::Proven) => format!("  no other event but {others} before it: proven\n"),
        Some(ArcOutcome::Open(reason)) => {
            format!("  no other event before it: not proven; {reason}\n")
        }
    }
}

/// The ends of an interval as they are written.
fn ends(interval: Option<Interval>) -> (Option<f64>, Option<f64>) {
    let interval = interval.map(enclosing);
    (
        interval.map(|interval| interval.low),
        interval.map(|interval| interval.high),
    )
}

/// A row of the table of an orbit of a system.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct CertifiedOrbitRow {
    head: PointColumns,
    period_low: Option<f64>,
    period_high: Option<f64>,
    said: Said,
    outside: Option<usize>,
    angle_low: Option<f64>,
    angle_high: Option<f64>,
    arc: ArcColumns,
}

impl Certified for orbit::OrbitProof {
    type Row = CertifiedOrbitRow;

    fn row(point: &CertifiedPoint<orbit::OrbitProof>) -> CertifiedOrbitRow {
        let said = point.proof().map(|proof| &proof.statement);
        let (period_low, period_high) = ends(said.map(|said| said.period));
        let (angle_low, angle_high) = ends(said.and_then(|said| said.angle));
        CertifiedOrbitRow {
            head: PointColumns::new(point, &point.parameter, said.map(|said| said.parameter)),
            period_low,
            period_high,
            said: Said::new(point, |proof| {
                (proof.statement.unique, proof.statement.inequalities)
            }),
            outside: said.and_then(|said| said.outside),
            angle_low,
            angle_high,
            arc: ArcColumns::new(point),
        }
    }

    fn sentence(point: &CertifiedPoint<orbit::OrbitProof>) -> String {
        let (kind, before) = (point.kind, before(point, "PD and NS"));
        let said = match &point.outcome {
            ProofOutcome::Proven(proof) => &proof.statement,
            ProofOutcome::Open(reason) => return format!("{before}{kind}: not proven; {reason}\n"),
        };
        let angle = said
            .angle
            .map(|angle| format!("; angle in {}", written(angle)));
        let outside = said.outside.map(|outside| match outside {
            0 => "; stable".to_owned(),
            _ => format!("; {outside} multipliers outside the unit circle"),
        });
        format!(
            "{before}{kind}: proven; {} in {}, unique within {:.0e}; period in {}{}{}; {} inequalities proven\n",
            point.parameter,
            written(said.parameter),
            said.unique,
            written(said.period),
            angle.unwrap_or_default(),
            outside.unwrap_or_default(),
            said.inequalities,
        )
    }
}

/// A row of the table of an equilibrium of a system.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct CertifiedEquilibriumRow {
    head: PointColumns,
    said: Said,
    growing: Option<usize>,
    omega_low: Option<f64>,
    omega_high: Option<f64>,
    lyapunov_low: Option<f64>,
    lyapunov_high: Option<f64>,
    beyond: String,
    persists: &'static str,
    arc: ArcColumns,
}

impl Certified for equilibrium::EquilibriumProof {
    type Row = CertifiedEquilibriumRow;

    fn row(point: &CertifiedPoint<equilibrium::EquilibriumProof>) -> CertifiedEquilibriumRow {
        let said = point.proof().map(|proof| &proof.statement);
        let (omega_low, omega_high) = ends(said.and_then(|said| said.omega));
        let lyapunov = said.and_then(|said| said.lyapunov);
        let (lyapunov_low, lyapunov_high) = ends(lyapunov.map(|lyapunov| match lyapunov {
            equilibrium::ProvenLyapunov::Within(interval) => interval,
            equilibrium::ProvenLyapunov::Vertical => Interval::ZERO,
        }));
        let beyond = point.proof().and_then(|proof| proof.beyond.as_ref());
        CertifiedEquilibriumRow {
            head: PointColumns::new(point, &point.parameter, said.map(|said| said.parameter)),
            said: Said::new(point, |proof| {
                (proof.statement.unique, proof.statement.inequalities)
            }),
            growing: said.and_then(|said| said.growing),
            omega_low,
            omega_high,
            lyapunov_low,
            lyapunov_high,
            beyond: beyond.map(|one| one.mode.clone()).unwrap_or_default(),
            persists: beyond.map_or("", |one| if one.persists { "yes" } else { "no" }),
            arc: ArcColumns::new(point),
        }
    }

    fn sentence(point: &CertifiedPoint<equilibrium::EquilibriumProof>) -> String {
        let (kind, before) = (point.kind, before(point, "HB"));
        let (said, beyond) = match &point.outcome {
            ProofOutcome::Proven(proof) => (&proof.statement, &proof.beyond),
            ProofOutcome::Open(reason) => return format!("{before}{kind}: not proven; {reason}\n"),
        };
        let beyond = beyond.as_ref().map(|beyond| match beyond.persists {
            true => format!("; persistence, beyond it `{}`", beyond.mode),
            false => format!("; a nonsmooth fold with `{}`", beyond.mode),
        });
        let omega = said.omega.map(|omega| format!("; ω in {}", written(omega)));
        let lyapunov = said.lyapunov.map(|lyapunov| match lyapunov {
            equilibrium::ProvenLyapunov::Within(interval) => {
                format!("; l₁ in {}", written(interval))
            }
            equilibrium::ProvenLyapunov::Vertical => "; a vertical family".to_owned(),
        });
        let growing = said.growing.map(|growing| match growing {
            1 => "; 1 eigenvalue grows".to_owned(),
            _ => format!("; {growing} eigenvalues grow"),
        });
        format!(
            "{before}{kind}: proven; {} in {}, unique within {:.0e}{}{}{}{}; {} inequalities proven\n",
            point.parameter,
            written(said.parameter),
            said.unique,
            beyond.unwrap_or_default(),
            omega.unwrap_or_default(),
            lyapunov.unwrap_or_default(),
            growing.unwrap_or_default(),
            said.inequalities,
        )
    }
}

/// A row of the table of a wave.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct CertifiedWaveRow {
    head: PointColumns,
    speed_low: Option<f64>,
    speed_high: Option<f64>,
    said: Said,
    unstable: &'static str,
    arc: ArcColumns,
    growing: Option<usize>,
    stable: &'static str,
    stable_why: String,
}

impl Certified for WaveProof {
    type Row = CertifiedWaveRow;

    fn row(point: &CertifiedPoint) -> CertifiedWaveRow {
        let proof = point.proof();
        let said = proof.map(|proof| &proof.statement);
        let (speed_low, speed_high) = ends(said.map(|said| said.speed));
        let unstable = proof.is_some_and(WaveProof::is_unstable);
        let (growing, stable, stable_why) = match &point.growth {
            None => (None, "", String::new()),
            Some(Counted::Open(reason)) => (None, "", reason.clone()),
            Some(Counted::Proven(growth)) => {
                let stable = match growth.verdict {
                    ProvenVerdict::Stable { .. } => "yes",
                    ProvenVerdict::Unstable => "no",
                    ProvenVerdict::Neutral | ProvenVerdict::HighFrequency => "",
                };
                let why = undecided(growth.verdict).unwrap_or("").to_owned();
                (Some(growth.on_circle()), stable, why)
            }
        };
        let name = point.parameter.column();
        CertifiedWaveRow {
            head: PointColumns::new(point, name, said.map(|said| said.parameter)),
            speed_low,
            speed_high,
            said: Said::new(point, |proof| {
                (proof.statement.unique, proof.statement.inequalities)
            }),
            unstable: if unstable { "yes" } else { "" },
            arc: ArcColumns::new(point),
            growing,
            stable,
            stable_why,
        }
    }

    /// Further lines are for its eigenvalues and for the branch before it.
    fn sentence(point: &CertifiedPoint) -> String {
        let symbol = point.parameter.symbol();
        let mut lines = before(point, "HB and BP");
        match &point.outcome {
            ProofOutcome::Proven(proof) => {
                let said = &proof.statement;
                let omega = said.omega.map(|omega| format!("; ω in {}", written(omega)));
                lines.push_str(&format!(
                    "{}: proven; {symbol} in {}, unique within {:.0e}; c in {}{}; {} inequalities proven\n",
                    point.kind,
                    written(said.parameter),
                    said.unique,
                    written(said.speed),
                    omega.unwrap_or_default(),
                    said.inequalities
                ));
                for eigenvalue in &proof.eigenvalues {
                    let ProvenEigenvalue {
                        sector,
                        growth,
                        omega,
                        ..
                    } = eigenvalue;
                    let unstable = if growth.is_positive() {
                        ": the wave is unstable"
                    } else {
                        ""
                    };
                    lines.push_str(&format!(
                        "  eigenvalue in sector {sector}: Re λ in {}, Im λ in {}{unstable}\n",
                        written(*growth),
                        written(*omega),
                    ));
                }
            }
            ProofOutcome::Open(reason) => {
                lines.push_str(&format!("{}: not proven; {reason}\n", point.kind))
            }
        }
        match &point.growth {
            Some(Counted::Proven(growth)) => lines.push_str(&growing(growth)),
            Some(Counted::Open(reason)) => {
                lines.push_str(&format!("  growing eigenvalues not counted; {reason}\n"));
            }
            None => {}
        }
        lines
    }
}

/// Why stability is undecided where no eigenvalue grows in the window.
fn undecided(verdict: ProvenVerdict) -> Option<&'static str> {
    match verdict {
        ProvenVerdict::Stable { .. } | ProvenVerdict::Unstable => None,
        ProvenVerdict::Neutral => Some("undecided: an eigenvalue is on the imaginary axis"),
        ProvenVerdict::HighFrequency => Some("undecided: growth beyond the window is not excluded"),
    }
}

/// The eigenvalues that grow, in a line.
fn growing(growth: &GrowthCount) -> String {
    let GrowthCount {
        window,
        counts,
        leading,
        verdict,
        ..
    } = growth;
    let sectors: Vec<String> = counts.iter().map(usize::to_string).collect();
    let leads: Vec<String> = leading.iter().map(|one| one.sector.to_string()).collect();
    let leads = match leads.is_empty() {
        true => String::new(),
        false => format!("; the eigenvalues of sectors {} lead", leads.join(" ")),
    };
    let follows = match verdict {
        ProvenVerdict::Stable { beyond } => {
            format!("none beyond, by a bound from |λ| = {beyond:.4} on: the wave is stable")
        }
        ProvenVerdict::Unstable => "the wave is unstable".to_owned(),
        verdict => undecided(*verdict).unwrap_or("").to_owned(),
    };
    format!(
        "  growing with |Im λ| up to {window}: {}, in sectors from 0 on {}{leads}; {follows}\n",
        growth.on_circle(),
        sectors.join(" "),
    )
}

#[derive(Debug)]
pub(crate) struct CertificateFolder {
    store: Store,
    table: GrowingFile,
}

impl CertificateFolder {
    pub(crate) const FILE: &'static str = "certificate.ron";
    pub(crate) const THEOREMS: &'static str = "theorem.md";

    /// Begins in place of an earlier one.
    ///
    /// # Errors
    /// When a file cannot be written, like all that follow.
    pub(crate) fn create<P: Certified>(store: Store) -> Result<CertificateFolder, StoreError> {
        store.begin(&[TABLE, Self::FILE, Self::THEOREMS], Vec::new(), None)?;
        let table = store.table(TABLE, &table::header::<P::Row>(), None)?;
        Ok(CertificateFolder { store, table })
    }

    pub(crate) fn write<P: Certified>(
        &mut self,
        point: &CertifiedPoint<P>,
    ) -> Result<(), StoreError> {
        self.table.row(&P::row(point))
    }

    pub(crate) fn finish<P: Certified>(
        &self,
        certificate: &Certificate<P>,
    ) -> Result<(), StoreError> {
        let theorems = theorems(&certificate.points, certificate.system.as_ref());
        self.store.replace(Self::THEOREMS, theorems.as_bytes())?;
        let path = self.store.path().join(Self::FILE);
        let text = ron::ser::to_string_pretty(
            certificate as &dyn erased_serde::Serialize,
            ron::ser::PrettyConfig::default(),
        );
        let text = text.map_err(|error| damaged(&path, error.to_string()))?;
        self.store.replace(Self::FILE, text.as_bytes())
    }
}

/// Whether the theorems beside a certificate, if there are any, are those of its points in the words of this version.
///
/// # Errors
/// When they cannot be read.
pub(crate) fn theorems_agree<P: Certified>(
    path: &Path,
    certificate: &Certificate<P>,
) -> Result<bool, StoreError> {
    let path = path.with_file_name(CertificateFolder::THEOREMS);
    if !path.is_file() {
        return Ok(true);
    }
    let expected = theorems(&certificate.points, certificate.system.as_ref());
    Ok(store::read(&path)?.lines().eq(expected.lines()))
}

/// Whether the table beside a certificate has the rows of its points: the same cells, but for ends of intervals that may lie
/// farther out. `None` where there is no table.
///
/// # Errors
/// When it cannot be read.
pub(crate) fn table_agrees<P: Certified>(
    path: &Path,
    points: &[CertifiedPoint<P>],
) -> Result<Option<bool>, StoreError> {
    if !path.is_file() {
        return Ok(None);
    }
    let expected = table::table(points.iter().map(P::row));
    let expected = table::Table::parse(expected.as_bytes());
    let expected = expected.map_err(|error| damaged(path, error.to_string()))?;
    let bytes = store::bytes(path)?;
    let stored = table::Table::parse(&bytes);
    let stored = stored.map_err(|error| damaged(path, error.to_string()))?;
    // cells without a column, or a line without an end, are read by none but stand there
    let width = stored.columns().count();
    let is_whole = |row: usize| stored.row(row).count() == width;
    let is_whole = bytes.ends_with(b"\n") && (0..stored.len()).all(is_whole);
    let agrees = |row: usize, column: &str| {
        let ends: [Option<f64>; 2] = [&stored, &expected].map(|table| table.field(row, column));
        match ends {
            [Some(stored), None] if stored.is_infinite() => expected.text(row, column).is_empty(),
            [Some(stored), Some(expected)] if column.ends_with("low") => stored <= expected,
            [Some(stored), Some(expected)] if column.ends_with("high") => stored >= expected,
            // a number may be written otherwise
            [Some(stored), Some(expected)] => stored == expected,
            _ => stored.text(row, column) == expected.text(row, column),
        }
    };
    let rows_agree = |row: usize| expected.columns().all(|column| agrees(row, column));
    Ok(Some(
        is_whole
            && stored.columns().eq(expected.columns())
            && stored.len() == expected.len()
            && (0..stored.len()).all(rows_agree),
    ))
}

/// A certificate of any kind.
pub(crate) enum Read {
    Waves(Certificate),
    Orbits(Certificate<orbit::OrbitProof>),
    Equilibria(Certificate<equilibrium::EquilibriumProof>),
}

impl Read {
    /// Whether it has no points.
    pub(crate) fn is_empty(&self) -> bool {
        match self {
            Read::Waves(certificate) => certificate.points.is_empty(),
            Read::Orbits(certificate) => certificate.points.is_empty(),
            Read::Equilibria(certificate) => certificate.points.is_empty(),
        }
    }
}

/// Reads a certificate.
///
/// # Errors
/// When it cannot be read, or is none.
pub(crate) fn read(path: &Path) -> Result<Read, StoreError> {
    if let Ok(certificate) = decode(path) {
        return Ok(Read::Orbits(Certificate::spread(certificate)));
    }
    if let Ok(certificate) = decode(path) {
        return Ok(Read::Equilibria(Certificate::spread(certificate)));
    }
    // that of waves says what is wrong with one of no kind
    Ok(Read::Waves(decode(path)?))
}
