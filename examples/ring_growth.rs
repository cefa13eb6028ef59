//! temp
use brakewave::simulation::growth::{self, Request};
use brakewave::simulation::profile::Profile;
use brakewave::simulation::ring::{Law, Order, Setup};
use brakewave::problem;
use std::path::Path;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let dir = Path::new(&args[1]);
    let mismatch: f64 = args[2].parse().unwrap();
    let points: usize = args[3].parse().unwrap();
    let order = match args[4].as_str() { "2" => Order::Second, "4" => Order::Fourth, _ => Order::Sixth };
    let courant: f64 = args[5].parse().unwrap();
    let pairs: usize = args[6].parse().unwrap();
    let sector: usize = args[7].parse().unwrap();
    let amplitude: f64 = args[8].parse().unwrap();
    let shift: usize = points / args[9].parse::<usize>().unwrap();
    let (problem, _) = problem::read(Path::new("problems/mode4_mismatch.ron")).unwrap();
    let _ = problem;
    // find label
    let mut reader = csv::Reader::from_path(dir.join("branch.csv")).unwrap();
    let mut best = (f64::MAX, String::new(), 0.0);
    for row in reader.records() {
        let row = row.unwrap();
        if row[1].is_empty() { continue; }
        let value: f64 = row[4].parse().unwrap();
        if (value - mismatch).abs() < best.0 { best = ((value - mismatch).abs(), row[1].to_string(), row[11].parse().unwrap()); }
    }
    assert!(best.0 < 1e-9, "{best:?}");
    let profile = Profile::read(&dir.join(format!("profiles/{}.csv", best.1)), best.2).unwrap();
    let parameters = brakewave::model::Parameters {
        coefficients: brakewave::model::coefficients::Geometry { nu: 0.3, xi: 1.5, gamma: 1.0 }.coefficients(),
        friction: 0.5, mismatch, mass_damping: 0.0 };
    let setup = Setup { points: 0, angle: 0.0, order, time_step: 0.0, law: Law::Coulomb, watched: false };
    let request = Request { points, waves: if sector == 0 { 1 } else { 4 }, sector, shift, courant, amplitude, pairs, settling: 1.0 };
    let start = std::time::Instant::now();
    let found = growth::averaged(&parameters, &setup, &profile, &request).unwrap();
    for value in found.iter().filter(|v| v.im >= -1e-9 || sector != 0).filter(|v| v.im.abs() < 12.0).take(24) {
        println!("{:+.5} {:+.5}i  residual {:.1e} scatter {:.1e}", value.re, value.im, value.residual, value.scatter);
    }
    eprintln!("{:.2?}", start.elapsed());
}
