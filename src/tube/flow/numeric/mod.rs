//! Flows by a numerical method: for friction laws without a closed form, and for comparison.

pub mod collocation;
pub mod equations;
mod gauss;
pub(crate) mod series;
pub mod shooting;

use std::cell::RefCell;
use std::collections::VecDeque;

use super::jet::{Jet, JetNumber, MultiDual};
use super::{FlowError, Frame, ZoneEnd};
use crate::tube::flow::method::Method;
use crate::tube::model::FrictionLaw;
use collocation::Mesh;
use equations::{Separated, SlidingEquations, VectorField};
use shooting::ShootingSteps;

/// How a zone is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Integrator {
    /// Explicit Runge–Kutta method of order 8.
    Shooting(ShootingSteps),
    /// Gauss–Legendre collocation on a mesh.
    Collocation(Mesh),
}

impl Integrator {
    /// The integrator of a method under a friction law; `None` for the exact flow.
    pub(crate) fn of(method: Method, law: FrictionLaw) -> Option<Integrator> {
        match method {
            Method::Exact => None,
            Method::Shooting { tolerance } => Some(Integrator::Shooting(ShootingSteps {
                tolerance,
                longest: 1.0,
            })),
            Method::Collocation { intervals, degree } => Some(Integrator::Collocation(Mesh {
                intervals,
                degree,
                // friction that changes within ε of V̇ = 1 makes layers, found in several passes
                passes: match law {
                    FrictionLaw::Regularised { .. } => 4,
                    _ => 1,
                },
            })),
        }
    }
}

impl Integrator {
    /// x(1) of dx/dτ = F(x), x(0) = 0, with all derivatives of `field`; `frozen` is the same field
    /// without them, and S = 6D.
    fn jets<const D: usize, const S: usize>(
        self,
        field: &impl VectorField<D, Jet>,
        frozen: &impl VectorField<D, MultiDual<D>>,
        duration: f64,
    ) -> Result<[Jet; D], FlowError> {
        match self {
            Integrator::Shooting(steps) => shooting::jets::<D, S>(field, steps, duration),
            Integrator::Collocation(mesh) => collocation::jets(field, frozen, mesh, duration),
        }
    }

    /// x(1) without derivatives.
    fn values<const D: usize>(
        self,
        field: &impl VectorField<D, f64>,
        frozen: &impl VectorField<D, MultiDual<D>>,
        duration: f64,
    ) -> Result<[f64; D], FlowError> {
        match self {
            Integrator::Shooting(steps) => shooting::values(field, steps, duration),
            Integrator::Collocation(mesh) => collocation::values(frozen, mesh, duration),
        }
    }
}

/// Samples of a sliding zone in which sign changes of V̈ and W are looked for. Between two zeros of V̈
/// a quarter of a period passes; a zone of a wave has few of them.
const SAMPLES: usize = 96;

/// Zones that a thread keeps: few waves have more in contact.
const KEPT: usize = 4;

/// All that the end of a zone in contact depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ContactZone {
    frame: Frame,
    law: FrictionLaw,
    sigma: f64,
    integrator: Integrator,
    entry: [f64; 2],
    duration: f64,
    order: usize,
}

thread_local! {
    /// The zones solved last, with their ends. Where Newton's method has arrived, the tangent, the conditions and the
    /// linearisation of a wave need the zones that its last step has solved, bit by bit.
    static SOLVED: RefCell<VecDeque<(ContactZone, [Jet; 3])>> = const { RefCell::new(VecDeque::new()) };
}

/// Times and states along a zone.
type Samples = Vec<(f64, [f64; 2])>;

/// Flow in contact in one sliding direction.
#[derive(Clone, Debug)]
pub struct NumericalContact {
    frame: Frame,
    law: FrictionLaw,
    sigma: f64,
    integrator: Integrator,
    /// The last zone sampled, by entry and duration: its examination asks several times.
    sampled: RefCell<Option<([f64; 3], Samples)>>,
}

impl NumericalContact {
    /// The equation for σ = +1 (slip) or −1 (reverse slip).
    pub fn new(
        frame: &Frame,
        law: FrictionLaw,
        sigma: f64,
        integrator: Integrator,
    ) -> NumericalContact {
        NumericalContact {
            frame: *frame,
            law,
            sigma,
            integrator,
            sampled: RefCell::new(None),
        }
    }

    fn field<N: JetNumber>(&self, order: usize, entry: [f64; 2], t: f64) -> SlidingEquations<N> {
        SlidingEquations::new(&self.frame, self.law, self.sigma, order, entry, t)
    }

    /// (Y, W) and the switching function (W − 1)/t^m at the end of a zone, with all derivatives.
    pub(crate) fn zone(&self, entry: [f64; 2], t: f64, m: usize) -> Result<[Jet; 3], FlowError> {
        let zone = ContactZone {
            frame: self.frame,
            law: self.law,
            sigma: self.sigma,
            integrator: self.integrator,
            entry,
            duration: t,
            order: m,
        };
        let known = SOLVED.with_borrow(|solved| {
            let same = solved.iter().find(|(known, _)| *known == zone);
            same.map(|(_, end)| *end)
        });
        if let Some(end) = known {
            return Ok(end);
        }
        let field: SlidingEquations<Jet> = self.field(m, entry, t);
        let frozen: SlidingEquations<MultiDual<2>> = self.field(m, entry, t);
        let x = self.integrator.jets::<2, 12>(&field, &frozen, t)?;
        let end = field.end(&x);
        SOLVED.with_borrow_mut(|solved| {
            solved.truncate(KEPT - 1);
            solved.push_front((zone, end));
        });
        Ok(end)
    }

    /// (Y, W) after a time t from the entry (Y, W).
    pub fn state(&self, entry: [f64; 2], t: f64) -> Result<[f64; 2], FlowError> {
        if t == 0.0 {
            return Ok(entry);
        }
        let field: SlidingEquations<f64> = self.field(0, entry, t);
        let frozen: SlidingEquations<MultiDual<2>> = self.field(0, entry, t);
        let x = self.integrator.values(&field, &frozen, t)?;
        let [y, w, _] = field.end(&x);
        Ok([y, w])
    }

    /// (Y, W) after a time t within a zone: on a mesh from the solution of the whole zone, which is
    /// then known.
    pub(crate) fn within(
        &self,
        entry: [f64; 2],
        duration: f64,
        t: f64,
    ) -> Result<[f64; 2], FlowError> {
        match self.integrator {
            Integrator::Collocation(_) if t > 0.0 => Ok(self.states(entry, duration, &[t])?[0]),
            _ => self.state(entry, t),
        }
    }

    /// V̈ at a state.
    pub(crate) fn acceleration(&self, [y, w]: [f64; 2]) -> f64 {
        self.field::<f64>(0, [y, w], 0.0).acceleration(y, w)
    }

    /// The third derivative of V at a state: V̈ differentiated along the flow.
    pub(crate) fn jerk(&self, [y, w]: [f64; 2]) -> f64 {
        let field: SlidingEquations<MultiDual<2>> = self.field(0, [y, w], 0.0);
        let along = |value: f64, slope: f64| MultiDual {
            value,
            by: [slope, 0.0],
        };
        let acceleration = self.acceleration([y, w]);
        field.acceleration(along(y, w), along(w, acceleration)).by[0]
    }

    /// Times and states along a zone: at equal distances, or at the mesh points.
    fn samples(&self, entry: [f64; 2], duration: f64) -> Result<Samples, FlowError> {
        let zone = [entry[0], entry[1], duration];
        if let Some((known, samples)) = &*self.sampled.borrow()
            && *known == zone
        {
            return Ok(samples.clone());
        }
        let samples = self.sample(entry, duration)?;
        self.sampled.replace(Some((zone, samples.clone())));
        Ok(samples)
    }

    fn sample(&self, entry: [f64; 2], duration: f64) -> Result<Samples, FlowError> {
        if let Integrator::Collocation(mesh) = self.integrator {
            let plain: SlidingEquations<f64> = self.field(0, entry, duration);
            let field: SlidingEquations<MultiDual<2>> = self.field(0, entry, duration);
            let solution = collocation::at_mesh_points(&field, mesh, duration)?;
            return Ok(solution
                .into_iter()
                .map(|(tau, x)| {
                    let [y, w, _] = plain.end(&x);
                    (tau * duration, [y, w])
                })
                .collect());
        }
        let mut states = vec![(0.0, entry)];
        let mut state = entry;
        let step = duration / SAMPLES as f64;
        for index in 1..=SAMPLES {
            state = self.state(state, step)?;
            states.push((index as f64 * step, state));
        }
        Ok(states)
    }

    /// The same flow for a piece between two samples, where the solution is smooth.
    fn piece(&self) -> NumericalContact {
        NumericalContact {
            integrator: match self.integrator {
                Integrator::Collocation(mesh) => Integrator::Collocation(Mesh {
                    intervals: 2,
                    passes: 0,
                    ..mesh
                }),
                shooting => shooting,
            },
            sampled: RefCell::new(None),
            ..*self
        }
    }

    /// (Y, W) at increasing times within a zone.
    pub(crate) fn states(
        &self,
        entry: [f64; 2],
        duration: f64,
        times: &[f64],
    ) -> Result<Vec<[f64; 2]>, FlowError> {
        let samples = self.samples(entry, duration)?;
        let piece = self.piece();
        let mut last = 0;
        times
            .iter()
            .map(|&time| {
                while last + 1 < samples.len() && samples[last + 1].0 <= time {
                    last += 1;
                }
                let (start, state) = samples[last];
                piece.state(state, time - start)
            })
            .collect()
    }

    /// Zeros of a function of the state between samples, by regula falsi with bisection.
    fn zeros(
        &self,
        entry: [f64; 2],
        duration: f64,
        at_rest: bool,
        of: impl Fn([f64; 2]) -> f64,
    ) -> Result<Vec<f64>, FlowError> {
        let samples = self.samples(entry, duration)?;
        let piece = self.piece();
        let mut times = Vec::new();
        for pair in samples.windows(2).skip(usize::from(at_rest)) {
            let ((start, from), (end, to)) = (pair[0], pair[1]);
            let (mut left, mut right) = (of(from), of(to));
            if left == 0.0 || left * right >= 0.0 {
                continue;
            }
            let (mut low, mut high) = (0.0, end - start);
            for _ in 0..60 {
                let guess = low + (high - low) * left / (left - right);
                let middle = guess.clamp(low + 0.01 * (high - low), high - 0.01 * (high - low));
                let value = of(piece.state(from, middle)?);
                if value * left > 0.0 {
                    (low, left) = (middle, value);
                } else {
                    (high, right) = (middle, value);
                }
                // the place of an extreme moves its value by the square of this
                if high - low <= 1e-9 * duration || value == 0.0 {
                    break;
                }
            }
            times.push(start + 0.5 * (low + high));
        }
        Ok(times)
    }

    /// Times in (0, duration) at which V̈ vanishes, as far as the samples show.
    pub(crate) fn turning_points(
        &self,
        entry: [f64; 2],
        duration: f64,
        at_rest: bool,
    ) -> Result<Vec<f64>, FlowError> {
        self.zeros(entry, duration, at_rest, |state| self.acceleration(state))
    }

    /// Times in (0, duration) at which W vanishes, as far as the samples show.
    pub(crate) fn extremes(&self, entry: [f64; 2], duration: f64) -> Result<Vec<f64>, FlowError> {
        self.zeros(entry, duration, false, |[_, w]| w)
    }
}

/// Flow of a separation zone by a numerical method.
#[derive(Clone, Copy, Debug)]
pub struct NumericalSeparation {
    frame: Frame,
    norm: f64,
    integrator: Integrator,
}

impl NumericalSeparation {
    /// The equations in this frame; `norm` bounds their rates.
    pub(crate) fn new(frame: &Frame, norm: f64, integrator: Integrator) -> NumericalSeparation {
        NumericalSeparation {
            frame: *frame,
            norm,
            integrator,
        }
    }

    /// Radians per unit of time.
    pub(crate) fn norm(&self) -> f64 {
        self.norm
    }

    fn field<N: JetNumber>(&self, order: usize, entry: [f64; 2], t: f64) -> Separated<N> {
        Separated::new(&self.frame, order, entry, t)
    }

    fn solve(&self, entry: [f64; 2], t: f64, m: usize) -> Result<[Jet; 5], FlowError> {
        let field: Separated<Jet> = self.field(m, entry, t);
        let frozen: Separated<MultiDual<4>> = self.field(m, entry, t);
        let x = self.integrator.jets::<4, 24>(&field, &frozen, t)?;
        Ok(field.end(&x))
    }

    /// (U, U̇, Y, W) after a time t with all derivatives.
    pub(crate) fn advance(&self, entry: [f64; 2], t: f64) -> Result<[Jet; 4], FlowError> {
        let [u, rate, y, w, _] = self.solve(entry, t, 0)?;
        Ok([u, rate, y, w])
    }

    /// (U, U̇, Y, W) after a time t.
    pub(crate) fn state(&self, entry: [f64; 2], t: f64) -> Result<[f64; 4], FlowError> {
        let field: Separated<f64> = self.field(0, entry, t);
        if t == 0.0 {
            return Ok([self.frame.at.mismatch, 0.0, entry[0], entry[1]]);
        }
        let frozen: Separated<MultiDual<4>> = self.field(0, entry, t);
        let x = self.integrator.values(&field, &frozen, t)?;
        let [u, rate, y, w, _] = field.end(&x);
        Ok([u, rate, y, w])
    }

    /// The zone to its end after a time t; the switching function is (U − δ)/t^m.
    pub(crate) fn zone(&self, entry: [f64; 2], t: f64, m: usize) -> Result<ZoneEnd, FlowError> {
        let [_, radial_rate, y, w, switching] = self.solve(entry, t, m)?;
        Ok(ZoneEnd {
            y,
            w,
            radial_rate,
            switching,
            ..ZoneEnd::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tube::flow::contact::ContactFlow;
    use crate::tube::flow::separation::SeparationFlow;
    use crate::tube::model::Constants;
    use crate::tube::model::coefficients::Geometry;

    const METHODS: [Method; 2] = [
        Method::Shooting { tolerance: 1e-14 },
        Method::Collocation {
            intervals: 40,
            degree: 4,
        },
    ];

    /// A frame in which everything depends on the parameter.
    fn frame(at: f64, excess: f64) -> Frame {
        let geometry = Geometry {
            nu: 0.3 + at,
            xi: 1.5,
            gamma: 1.0,
        };
        let parameters = Constants {
            coefficients: geometry.coefficients(),
            friction: 0.5 + 0.2 * at,
            mismatch: 0.05 + 0.3 * at,
            mass_damping: 0.1 + 0.1 * at,
            stiffness_damping: 0.0,
            smoothing: 0.3 + 0.5 * at,
        };
        let derivative = Constants {
            coefficients: geometry.derivative_in_nu(),
            friction: 0.2,
            mismatch: 0.3,
            mass_damping: 0.1,
            stiffness_damping: 0.0,
            smoothing: 0.5,
        };
        Frame::new(&parameters, &derivative, excess).unwrap()
    }

    /// The order taken out of a zone assumes W = 1 or P = 0 at its entry: there the derivatives in
    /// the entry rate differ from those of a flow that does not.
    fn same_value(name: &str, one: Jet, other: Jet, allowed: f64) {
        let size = 1.0 + one.value.abs();
        assert!(
            (one.value - other.value).abs() < allowed * size,
            "{name}: {one:?} {other:?}"
        );
    }

    fn close(name: &str, one: Jet, other: Jet, allowed: f64) {
        let size = 1.0 + one.value.abs();
        assert!(
            (one.value - other.value).abs() < allowed * size,
            "{name}: {one:?} {other:?}"
        );
        for index in 0..5 {
            let size = 1.0 + one.by[index].abs();
            assert!(
                (one.by[index] - other.by[index]).abs() < allowed * size,
                "{name}, derivative {index}: {one:?} {other:?}"
            );
        }
    }

    /// Under Coulomb's law both methods agree with the closed form, derivatives included, to the
    /// tolerance of one and the discretisation error h⁸ of the other.
    #[test]
    fn contact_agrees_with_the_closed_form() {
        let frame = frame(0.0, 0.19);
        for method in METHODS {
            let integrator = Integrator::of(method, FrictionLaw::Coulomb).unwrap();
            for sigma in [1.0, -1.0] {
                let exact = ContactFlow::new(&frame, sigma);
                let numerical =
                    NumericalContact::new(&frame, FrictionLaw::Coulomb, sigma, integrator);
                for (entry, m) in [([0.08, 0.4], 0), ([0.08, 1.0], 1)] {
                    for t in [-0.01, 1e-6, 0.2, 0.9] {
                        let [y, w] = exact.advance(entry, t).unwrap();
                        let reduced = if m == 0 {
                            w - 1.0
                        } else {
                            exact.reduced_rate(entry, t, m, w)
                        };
                        let found = numerical.zone(entry, t, m).unwrap();
                        close("Y", y, found[0], 1e-11);
                        close("W", w, found[1], 1e-11);
                        if m == 0 {
                            close("W − 1", reduced, found[2], 1e-11);
                        } else {
                            same_value("(W − 1)/t^m", reduced, found[2], 1e-11);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn separation_agrees_with_the_matrix_exponential() {
        let frame = frame(0.0, 0.19);
        let exact = SeparationFlow::new(&frame);
        // an entry at zero pressure
        let w = -frame.weight().value / frame.at.kappa;
        for method in METHODS {
            let integrator = Integrator::of(method, FrictionLaw::Coulomb).unwrap();
            let numerical = NumericalSeparation::new(&frame, exact.norm(), integrator);
            for t in [1e-6, 0.1, 0.6] {
                let one = exact.zone([0.08, w], t, 3).unwrap();
                let other = numerical.zone([0.08, w], t, 3).unwrap();
                same_value("Y", one.y, other.y, 1e-11);
                same_value("W", one.w, other.w, 1e-11);
                same_value("U̇", one.radial_rate, other.radial_rate, 1e-11);
                same_value("(U − δ)/t³", one.switching, other.switching, 1e-10);
                let one = exact.advance([0.08, w], t).unwrap();
                let other = numerical.advance([0.08, w], t).unwrap();
                for (one, other) in one.into_iter().zip(other) {
                    close("free flight", one, other, 1e-10);
                }
                let one = exact.zone([0.08, -0.2], t, 2).unwrap();
                let other = numerical.zone([0.08, -0.2], t, 2).unwrap();
                close("(U − δ)/t²", one.switching, other.switching, 1e-9);
            }
        }
    }

    /// Derivatives of the velocity-dependent laws against central differences of second order, whose
    /// error is about 1e-9 with steps of 1e-5.
    #[test]
    fn derivatives_of_the_other_laws_match_differences() {
        let laws = [
            FrictionLaw::Stribeck {
                ratio: 1.4,
                velocity: 0.5,
            },
            FrictionLaw::Regularised { epsilon: 0.3 },
        ];
        let step = 1e-5;
        for law in laws {
            for method in METHODS {
                let integrator = Integrator::of(method, FrictionLaw::Coulomb).unwrap();
                for (w0, order) in [(0.4, 0), (1.0, 2)] {
                    if order == 2 && law == (FrictionLaw::Regularised { epsilon: 0.3 }) {
                        continue;
                    }
                    let zone = |moved: [f64; 5]| {
                        let frame = frame(moved[4], 0.19 * moved[3].exp());
                        let flow = NumericalContact::new(&frame, law, 1.0, integrator);
                        let entry = [0.08 + moved[0], w0 + moved[1]];
                        flow.zone(entry, 0.5 + moved[2], order).unwrap()
                    };
                    let at = zone([0.0; 5]);
                    for index in 0..5 {
                        let shifted = |by: f64| {
                            let mut moved = [0.0; 5];
                            moved[index] = by;
                            zone(moved)
                        };
                        let (up, down) = (shifted(step), shifted(-step));
                        for row in 0..3 {
                            let difference = (up[row].value - down[row].value) / (2.0 * step);
                            let error = (at[row].by[index] - difference).abs();
                            assert!(
                                error < 1e-7 * (1.0 + difference.abs()),
                                "{law:?} {method:?} order {order}, row {row}, derivative {index}: {} {difference}",
                                at[row].by[index]
                            );
                        }
                    }
                }
            }
        }
    }
}
