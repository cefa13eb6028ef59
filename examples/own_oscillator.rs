//! An oscillator that hits a stop, built in code and followed: `cargo run --no-default-features --example own_oscillator`.
//!
//! As its force falls the orbit with an impact turns back and grazes the stop, where A = |1 + icω − ω²|d = 0.1.

use brakewave::EventType;
use brakewave::affine::orbit::start::{Beginning, Search, Wanted, first};
use brakewave::affine::system::{ModeSource, Source, SwitchSource, System};
use brakewave::orbit::follow::{Follower, Limits};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let impact = SwitchSource {
        zero: "d - x".into(),
        to: "free".into(),
        reset: [("v", "-e*v")].into(),
        ..SwitchSource::default()
    };
    let free = ModeSource {
        rates: [("x", "v"), ("v", "A*cos(phase) - c*v - x")].into(),
        until: vec![impact],
    };
    let system = System::new(Source {
        states: vec!["x".into(), "v".into()],
        parameters: [("A", 1.0), ("c", 0.1), ("w", 1.0), ("d", 1.0), ("e", 0.8)].into(),
        forcing: Some("w".into()),
        modes: [("free", free)].into(),
        ..Source::default()
    })?;
    let range = (0.05, 1.0);
    let wanted = Wanted::new(system, "A", range).ok_or("no such parameter")?;
    let rest = Beginning {
        mode: 0,
        state: vec![0.0, 0.0],
        phase: 0.0,
    };
    // the first orbit is what a motion from rest comes to within 200 periods
    let (orbit, point) = first(&wanted, &rest, Search::Settles(200.0))?;
    let mut graze = None;
    for point in Follower::new(orbit, &point, false, Limits::within(range))?.points() {
        if let Some(kind) = point.kind() {
            let (value, sequence) = (point.parameter, &point.orbit.sequence);
            println!("{kind} A = {value:.15}  {sequence}");
            graze = (kind == EventType::GR).then_some(value).or(graze);
        }
    }
    assert!(graze.is_some_and(|value| (value - 0.1).abs() < 1e-12));
    Ok(())
}
