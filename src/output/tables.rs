//! Rows of the tables. Numbers carry 17 significant digits, so that reading them back gives the
//! same double.

pub use crate::branch::BRANCH_HEADER;
use crate::branch::{BranchPoint, Event, ParameterValues, ProfileSample, Stability};
use crate::map::{Cell, CellPoint};
use crate::problem::FrictionLaw;
use crate::stability::eigenfunction::Eigenfunction;

/// Header of `events.csv`.
const EVENTS_HEADER: &str = "label,type,mismatch,friction,mass_damping,stiffness_damping,\
gamma,nu,xi,speed,sector,omega,regimes_before,regimes_after,uncertainty,what";

/// Header of `events.csv` for a model: a regularised friction law adds a column.
pub fn events_header(law: FrictionLaw) -> String {
    match law {
        FrictionLaw::Regularised { .. } => format!("{EVENTS_HEADER},smoothing"),
        _ => EVENTS_HEADER.to_string(),
    }
}

/// Header of `spectrum.csv`.
pub const SPECTRUM_HEADER: &str = "label,sector,re,im,error";

/// Header of a profile.
pub const PROFILE_HEADER: &str = "theta,U,V,U_dot,V_dot,P,Q,regime";

/// A number with 17 significant digits; empty where it is not finite.
pub fn number(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.16e}")
    } else {
        String::new()
    }
}

fn optional<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

fn parameters(values: &ParameterValues) -> [String; 7] {
    [
        number(values.mismatch),
        number(values.friction),
        number(values.mass_damping),
        number(values.stiffness_damping),
        values.gamma.map_or_else(String::new, number),
        values.nu.map_or_else(String::new, number),
        values.xi.map_or_else(String::new, number),
    ]
}

/// ε of the regularised friction law stands last: few problems have one.
fn smoothing(values: &ParameterValues) -> String {
    values.smoothing.map_or_else(String::new, number)
}

/// A record as a line of CSV.
pub(super) fn line(fields: &[String]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::with_capacity(512));
    // writing to memory does not fail
    let _ = writer.write_record(fields);
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8(bytes).unwrap_or_default()
}

fn switches(point: &BranchPoint) -> String {
    let switches: Vec<String> = point.switches.iter().map(|theta| number(*theta)).collect();
    switches.join(" ")
}

/// A verdict as a word.
pub fn verdict(stable: Stability) -> &'static str {
    match stable {
        Stability::Yes => "yes",
        Stability::No => "no",
        Stability::Undecided => "undecided",
    }
}

/// The columns from `regimes` to `lead_sector`: a wave and its stability.
fn wave(point: &BranchPoint) -> Vec<String> {
    let mut fields = vec![point.regimes.clone()];
    fields.extend(parameters(&point.parameters));
    fields.extend([
        number(point.speed),
        switches(point),
        number(point.min_pressure),
        number(point.max_gap),
        number(point.amplitude),
        point.stable.map_or("", verdict).to_string(),
        optional(point.unstable),
        point.lead.map_or_else(String::new, |lead| number(lead.re)),
        point.lead.map_or_else(String::new, |lead| number(lead.im)),
        optional(point.lead.map(|lead| lead.sector)),
    ]);
    fields
}

/// What a verdict rests on, where that is not plain.
fn why(point: &BranchPoint) -> String {
    let reasons: Vec<String> = point.why.iter().map(ToString::to_string).collect();
    reasons.join("; ")
}

/// A row of `branch.csv`.
pub fn branch_row(point: &BranchPoint, leg: usize) -> String {
    let mut fields = vec![
        point.point.to_string(),
        optional(point.label),
        optional(point.kind),
    ];
    fields.extend(wave(point));
    fields.extend([
        point.newton.to_string(),
        number(point.residual),
        leg.to_string(),
        smoothing(&point.parameters),
    ]);
    let (condition, error) = point.conditioning.unzip();
    fields.extend([condition, error].map(|value| value.map_or_else(String::new, number)));
    fields.push(why(point));
    line(&fields)
}

/// Header of `map.csv`.
pub const MAP_HEADER: &str = "row,column,start,passage,regimes,mismatch,friction,mass_damping,\
stiffness_damping,gamma,nu,xi,speed,switches,min_pressure,max_gap,amplitude,stable,unstable,\
lead_re,lead_im,lead_sector,why";

/// A row of `map.csv`.
pub fn map_row(cell: &Cell) -> String {
    let mut fields = vec![
        cell.row.to_string(),
        cell.column.to_string(),
        cell.start.to_owned(),
        cell.passage.to_string(),
    ];
    match &cell.found {
        CellPoint::Wave(point) => {
            fields.extend(wave(point));
            fields.push(why(point));
        }
        CellPoint::Nothing {
            parameters: values,
            why,
        } => {
            fields.push(String::new());
            fields.extend(parameters(values));
            fields.extend(std::iter::repeat_n(String::new(), 10));
            fields.push(why.clone());
        }
    }
    line(&fields)
}

/// A row of `events.csv`.
pub fn event_row(event: &Event) -> String {
    let mut fields = vec![event.label.to_string(), event.kind.to_string()];
    fields.extend(parameters(&event.parameters));
    fields.extend([
        number(event.speed),
        optional(event.sector),
        event.omega.map_or_else(String::new, number),
        event.regimes_before.clone(),
        event.regimes_after.clone(),
        number(event.uncertainty),
        event.what.clone(),
    ]);
    fields.extend(event.parameters.smoothing.map(number));
    line(&fields)
}

/// A row of `spectrum.csv`, or of the output of `spectrum` where there is no label.
pub fn spectrum_row(label: Option<usize>, sector: usize, [re, im, error]: [f64; 3]) -> String {
    line(&[
        optional(label),
        sector.to_string(),
        number(re),
        number(im),
        number(error),
    ])
}

/// A whole profile.
pub fn profile(samples: &[ProfileSample]) -> String {
    use std::fmt::Write;
    let mut text = String::with_capacity(samples.len() * 180 + 64);
    text.push_str(PROFILE_HEADER);
    text.push('\n');
    for sample in samples {
        for value in [
            sample.theta,
            sample.radial,
            sample.tangential,
            sample.radial_rate,
            sample.tangential_rate,
            sample.pressure,
            sample.shear,
        ] {
            // writing to a string does not fail
            let _ = write!(text, "{value:.16e},");
        }
        text.push_str(sample.regime);
        text.push('\n');
    }
    text
}

/// A row of `brakewave spectrum`: an eigenvalue with its error, the wave it belongs to and, where
/// they are known, its stability, unstable count and what they rest on.
pub fn eigenvalue_row(
    sector: usize,
    [re, im, error]: [f64; 3],
    point: &BranchPoint,
    stability: Option<(Stability, usize)>,
) -> String {
    let mut fields = vec![
        sector.to_string(),
        number(re),
        number(im),
        number(error),
        point.regimes.clone(),
    ];
    fields.extend(parameters(&point.parameters));
    fields.extend([
        number(point.speed),
        switches(point),
        stability
            .map_or("", |(stable, _)| verdict(stable))
            .to_string(),
        optional(stability.map(|(_, unstable)| unstable)),
        why(point),
    ]);
    line(&fields)
}

/// An eigenfunction as rows: sector, λ, θ, ψ, ψ′.
pub fn mode_rows(sector: usize, [re, im, _]: [f64; 3], mode: &Eigenfunction) -> String {
    mode.samples
        .iter()
        .map(|sample| {
            let numbers = [
                re,
                im,
                sample.theta,
                sample.psi.re,
                sample.psi.im,
                sample.slope.re,
                sample.slope.im,
            ];
            let fields: Vec<String> = numbers.iter().map(|value| number(*value)).collect();
            format!("{sector},{}\n", fields.join(","))
        })
        .collect()
}
