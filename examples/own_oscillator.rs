//! An oscillator that hits a stop, built in code and followed: `cargo run --no-default-features --example own_oscillator`.
//!
//! As its force falls the orbit with an impact turns back and grazes the stop, where A = |1 + icω − ω²|d = 0.1.

use brakewave::affine::orbit::start::{Beginning, Search, Wanted, first};
use brakewave::affine::system::{ModeSource, Ordered, Source, SwitchSource, System};
use brakewave::continuation::Steps;
use brakewave::orbit::follow::{Follower, Limits};

/// A map that keeps its order.
fn map<T: Clone, U: From<T>>(entries: &[(&str, T)]) -> Ordered<U> {
    let entries = entries.iter().cloned();
    Ordered(
        entries
            .map(|(name, value)| (name.to_owned(), value.into()))
            .collect(),
    )
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let impact = SwitchSource {
        zero: "d - x".to_owned(),
        to: "free".to_owned(),
        reset: map(&[("v", "-e*v")]),
        ..SwitchSource::default()
    };
    let free = ModeSource {
        rates: map(&[("x", "v"), ("v", "A*cos(phase) - c*v - x")]),
        until: vec![impact],
    };
    let system = System::new(Source {
        states: vec!["x".to_owned(), "v".to_owned()],
        parameters: map(&[("A", 1.0), ("c", 0.1), ("w", 1.0), ("d", 1.0), ("e", 0.8)]),
        forcing: Some("w".to_owned()),
        modes: map(&[("free", free)]),
        ..Source::default()
    })?;
    let values = system
        .source
        .parameters
        .0
        .iter()
        .map(|(_, value)| *value)
        .collect();
    let range = (0.05, 1.0);
    // the first orbit is what a motion from rest comes to within 200 periods
    let wanted = Wanted {
        system,
        values,
        parameter: 0,
        width: range.1 - range.0,
        periods: 1,
        stability: true,
    };
    let rest = Beginning {
        mode: 0,
        state: vec![0.0, 0.0],
        phase: 0.0,
    };
    let (orbit, point) = first(&wanted, &rest, Search::Settles(200.0))?;
    let steps = Steps {
        ds: 0.01,
        ds_min: 1e-12,
        ds_max: 0.05,
        tolerance: 1e-10,
    };
    let limits = Limits {
        range,
        stop_at: Vec::new(),
        steps,
    };
    let mut branch = Follower::new(orbit, &point, false, limits)?;
    let (mut graze, mut ended) = (f64::NAN, false);
    while !ended {
        let (found, end) = branch.step();
        ended = end.is_some();
        for point in &found {
            if let Some(event) = &point.special {
                println!(
                    "{} A = {:.15}  {}",
                    event.kind(),
                    point.parameter,
                    point.orbit.sequence
                );
                graze = if event.kind() == brakewave::EventType::GR {
                    point.parameter
                } else {
                    graze
                };
            }
        }
    }
    assert!((graze - 0.1).abs() < 1e-12);
    Ok(())
}
