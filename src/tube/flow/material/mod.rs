//! Sliding with material damping β > 0: a singular perturbation, in closed form.
//!
//! With V̂ = V + βV̇ in (M) the equation of a sliding zone is of third order,
//!
//! ```text
//! −βã V⃛ + m V̈ + s₁V̇ + hV = σfgδ,   P = gδ + κ(V̇ + βV̈),      ã = a/c²,
//! m = m_a − βσfκ,   s₁ = α + βh − σfκ,
//! ```
//!
//! and V, V̇, V̈ are continuous wherever the surface stays in contact: V̇ = 1 and V̈ = 0 at both ends
//! of stick, while Q jumps there. One exponent, 1/ρ ≈ m/(βã), is large: a solution of it grows by
//! e^{T/ρ} over a zone and can neither be followed forward nor be left out, since it carries V̈ to the
//! value the next zone asks for. Taken out of the cubic,
//!
//! ```text
//! −βãr³ + mr² + s₁r + h = (1 − ρr)(m̂r² + ŝr + h),   ŝ = s₁ + ρh,  m̂ = m + ρŝ,  −βã + mρ + s₁ρ² + hρ³ = 0,
//! ```
//!
//! it leaves an oscillator like that of the undamped equation, solved forward from the entry, and the
//! layer G e^{(s−T)/ρ} in V̈, given by its value G at the end of the zone:
//!
//! ```text
//! (Y, W, V̈) = oscillator + G e^{(s−T)/ρ} (ρ², ρ, 1).
//! ```
//!
//! Every number is of order one for any β, and β = 0 is a regular point: ρ = 0 there and the layer has
//! no thickness. (On the dichotomy of two-point problems: Ascher, Mattheij & Russell, Numerical
//! Solution of Boundary Value Problems for ODEs, 1995, chapters 3 and 10.)

mod extremes;

use crate::continuation::zero::zero_by_slope;

use super::contact::{ContactFlow, SHORT_TERMS, SHORT_ZONE};
use super::jet::{DURATION, ENTRY_W, ENTRY_Y, EXCESS, Jet, LAYER, MultiDual, SOURCES};
use super::{FlowError, Frame, Slide, Unsolved, ZoneEnd};

/// Smallest positive root ρ of −d + mρ + s₁ρ² + hρ³ with d = βã ≥ 0 and h > 0: the reciprocal of the
/// largest exponent of the sliding equation. `None` where a coefficient is not finite. For d < 0, where a
/// step may end that passes β = 0, the root goes on smoothly: it is the negative one next to d/m, or `None`.
pub(crate) fn layer_time(d: f64, m: f64, s: f64, h: f64) -> Option<f64> {
    let at = |x: f64| -d + x * (m + x * (s + x * h));
    let slope = |x: f64| m + x * (2.0 * s + x * (3.0 * h));
    if d == 0.0 && m > 0.0 {
        return Some(0.0);
    }
    let rounded = |step: f64, x: f64| step <= 2.0 * f64::EPSILON * x.abs();
    // the cubic with the other sign is negative at the upper end
    let falling = |x: f64| (-at(x), -slope(x));
    if d < 0.0 {
        let beyond = 2.0 * d / m;
        let (_, root) = (m > 0.0 && at(beyond) < 0.0)
            .then(|| zero_by_slope((0.0, beyond), d / m, rounded, falling))?;
        return Some(root);
    }
    // the cubic rises from −d to infinity; where it has extremes, the root lies before the maximum
    // or after the minimum
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let discriminant = s * s - 3.0 * h * m;
    if discriminant > 0.0 {
        let root = discriminant.sqrt();
        let minimum = if s > 0.0 {
            -m / (s + root)
        } else {
            (root - s) / (3.0 * h)
        };
        let maximum = m / (3.0 * h) / minimum;
        if minimum > 0.0 {
            if maximum > 0.0 && at(maximum) >= 0.0 {
                high = maximum;
            } else {
                low = minimum;
            }
        }
    }
    if high.is_infinite() {
        high = low + (d / h).cbrt().max(f64::MIN_POSITIVE);
        while at(high) < 0.0 {
            high = low + 2.0 * (high - low);
        }
    }
    if !(high.is_finite() && at(high) >= 0.0) {
        return None;
    }
    let guess = if m > 0.0 {
        (d / m).clamp(low, high)
    } else {
        high
    };
    let (_, root) = zero_by_slope((high, low), guess, rounded, falling);
    Some(root)
}

/// A layer thinner than this fraction of the time scale of the oscillator, and the number of layers
/// in which it decays below rounding.
pub(super) const THIN: f64 = 1e-12;
const LAYERS: f64 = 50.0;

/// The sliding equation of one direction in one frame.
#[derive(Clone, Debug)]
pub struct MaterialFlow {
    /// The oscillator m̂ÿ + ŝẏ + hy = 0.
    pub slow: ContactFlow,
    /// ρ: time in which the layer decays by e.
    pub rho: f64,
    rho_by: [f64; 2],
    /// Material damping β > 0, in units of 1/Ω.
    pub beta: f64,
}

/// V and its derivatives at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialState {
    /// (Y, W) = (V − fgδ/h, V̇).
    pub state: [f64; 2],
    /// V̈, in units of RΩ².
    pub acceleration: f64,
    /// V⃛, in units of RΩ³.
    pub jerk: f64,
}

/// e^{−u}, exactly zero where u is infinite or its exponential underflows.
fn decayed(u: f64) -> f64 {
    if u > 708.0 { 0.0 } else { (-u).exp() }
}

/// time/ρ, which is 0/0 = 0 at the very end of a layer without thickness, and infinite beside it.
fn ratio(time: f64, rho: f64) -> f64 {
    if time == 0.0 {
        0.0
    } else if rho <= 0.0 {
        f64::INFINITY
    } else {
        time / rho
    }
}

/// φ(x) = (1 − e^{−x})/x and χ(x) = (1 − φ)/x.
fn quotients(x: f64) -> [f64; 2] {
    /// Below it the series Σ (−x)^j/(j + 2)! of χ: 14 terms leave 0.5¹⁴/16! ≈ 3e-18.
    const SMALL: f64 = 0.5;
    if x.abs() < SMALL {
        let mut chi = 0.0;
        for j in (0..14).rev() {
            // ratio of terms j + 1 and j is −x/(j + 3)
            chi = 1.0 - chi * x / (f64::from(j) + 3.0);
        }
        chi *= 0.5;
        return [1.0 - x * chi, chi];
    }
    let phi = -(-x).exp_m1() / x;
    [phi, (1.0 - phi) / x]
}

impl MaterialFlow {
    /// The equation for σ = +1 (slip) or −1 (reverse slip). Where its exponents cannot be told apart ρ
    /// is not a number, and [`MaterialFlow::zone`] says so.
    pub(crate) fn new(frame: &Frame, sigma: f64) -> MaterialFlow {
        let beta = frame.number(|of| of.material);
        let h = frame.number(|of| of.h);
        let drive = frame.number(|of| of.friction) * frame.number(|of| of.kappa) * sigma;
        let d = beta * frame.number(|of| of.stress);
        let m = frame.number(|of| of.ma) - beta * drive;
        let s = frame.number(|of| of.damping) + beta * h - drive;
        let time = layer_time(d.value, m.value, s.value, h.value).unwrap_or(f64::NAN);
        let slope = m.value + time * (2.0 * s.value + time * (3.0 * h.value));
        let fixed = d - (m + (s + h * time) * time) * time;
        let mut rho = MultiDual {
            value: time,
            by: fixed.by.map(|by| by / slope),
        };
        let s_hat = s + rho * h;
        // term by term
        let m_hat = MultiDual {
            value: m.value + time * s_hat.value,
            by: std::array::from_fn(|i| m.by[i] + rho.by[i] * s_hat.value + time * s_hat.by[i]),
        };
        // m̂ > 0 follows from ρ being the smallest root
        if !(slope > 0.0 && m_hat.value > 0.0) {
            rho.value = f64::NAN;
        }
        MaterialFlow {
            slow: ContactFlow::of(frame, sigma, m_hat, -s_hat),
            rho: rho.value,
            rho_by: rho.by,
            beta: beta.value,
        }
    }

    /// ρ as a jet.
    fn rho_jet(&self) -> Jet {
        Jet::lifted(MultiDual {
            value: self.rho,
            by: self.rho_by,
        })
    }

    /// e^{−T/ρ}: what the layer leaves at the entry.
    fn at_entry(&self, slide: &Slide) -> f64 {
        decayed(ratio(slide.duration, self.rho))
    }

    /// (Y, W) of the oscillator at the entry.
    fn slow_entry(&self, slide: &Slide) -> [f64; 2] {
        let rest = slide.layer * self.at_entry(slide);
        [
            slide.entry[0] - self.rho * self.rho * rest,
            slide.entry[1] - self.rho * rest,
        ]
    }

    fn slow_rates(&self, state: [f64; 2]) -> [f64; 2] {
        let acceleration = self.slow.acceleration(state);
        let jerk = 2.0 * self.slow.p * acceleration - self.slow.q * state[1];
        [acceleration, jerk]
    }

    /// The motion at a time t after the entry.
    pub(crate) fn motion(&self, slide: &Slide, t: f64) -> MaterialState {
        let [y, w] = self.slow.state(self.slow_entry(slide), t);
        let [acceleration, jerk] = self.slow_rates([y, w]);
        let fast = slide.layer * decayed(ratio(slide.duration - t, self.rho));
        MaterialState {
            state: [y + self.rho * self.rho * fast, w + self.rho * fast],
            acceleration: acceleration + fast,
            jerk: if fast == 0.0 {
                jerk
            } else {
                jerk + fast / self.rho
            },
        }
    }

    /// The layer G of a zone of no duration that is entered with this V̈.
    pub(crate) fn layer_of(&self, entry: [f64; 2], acceleration: f64) -> f64 {
        let ContactFlow { p, q, .. } = self.slow;
        let rho = self.rho;
        (acceleration - self.slow.acceleration(entry)) / (1.0 - rho * (2.0 * p - rho * q))
    }

    /// (Y, W) of the oscillator at the entry as jets, and what is left of the layer there.
    fn slow_entry_jets(&self, slide: &Slide) -> [Jet; 3] {
        let (rho, layer) = (self.rho, slide.layer);
        let u = ratio(slide.duration, rho);
        let rest = self.fast_jet(slide, u);
        // ρG e^{−u} and ρ²G e^{−u}: the derivative in T is finite as ρ → 0
        let scaled = |power: i32| {
            let size = rho.powi(power);
            let e = decayed(u);
            let mut jet = Jet::constant(size * rest.value);
            jet.by[DURATION] = -rho.powi(power - 1) * layer * e;
            jet.by[LAYER] = size * e;
            for index in 0..2 {
                jet.by[EXCESS + index] = rho.powi(power - 1)
                    * layer
                    * weighted(e, f64::from(power) + u)
                    * self.rho_by[index];
            }
            jet
        };
        [
            Jet::variable(slide.entry[0], ENTRY_Y) - scaled(2),
            Jet::variable(slide.entry[1], ENTRY_W) - scaled(1),
            rest,
        ]
    }

    /// G e^{−u}, where ρu is a time that moves with T.
    fn fast_jet(&self, slide: &Slide, u: f64) -> Jet {
        let e = decayed(u);
        let mut jet = Jet::constant(slide.layer * e);
        jet.by[LAYER] = e;
        if e != 0.0 && self.rho > 0.0 {
            jet.by[DURATION] = -slide.layer * e / self.rho;
            for index in 0..2 {
                jet.by[EXCESS + index] = slide.layer * e * u / self.rho * self.rho_by[index];
            }
        }
        jet
    }

    /// V̈ of the oscillator as a jet.
    fn slow_acceleration(&self, [y, w]: [Jet; 2]) -> Jet {
        let [p, q] = self.slow.coefficients();
        p * w - q * (y + self.slow.shift)
    }

    /// (Y, W) of the oscillator at a time t as jets; `moving` if t is the duration.
    fn slow_jets(&self, entry: &[Jet; 3], t: f64, moving: bool) -> Result<[Jet; 2], FlowError> {
        let at = self.slow.advance([entry[0].value, entry[1].value], t)?;
        Ok(at.map(|jet| {
            let mut by = [0.0; SOURCES];
            for (index, slot) in by.iter_mut().enumerate() {
                *slot = jet.by[ENTRY_Y] * entry[0].by[index] + jet.by[ENTRY_W] * entry[1].by[index];
            }
            for index in [EXCESS, EXCESS + 1] {
                by[index] += jet.by[index];
            }
            if moving {
                by[DURATION] += jet.by[DURATION];
            }
            Jet {
                value: jet.value,
                by,
            }
        }))
    }

    /// Y, W and V̈ at a fixed time t inside the zone, with all derivatives.
    pub(crate) fn inside(&self, slide: &Slide, t: f64) -> Result<[Jet; 3], FlowError> {
        let entry = self.slow_entry_jets(slide);
        let [y, w] = self.slow_jets(&entry, t, false)?;
        let acceleration = self.slow_acceleration([y, w]);
        let fast = self.fast_jet(slide, ratio(slide.duration - t, self.rho));
        let rho = self.rho_jet();
        let rate = rho * fast;
        let sum = [y + rho * rate, w + rate, acceleration + fast];
        if sum.iter().any(|jet| !jet.value.is_finite()) {
            return Err(FlowError::Overflow { duration: t });
        }
        Ok(sum)
    }

    /// V̈ and V⃛ at the entry.
    pub(crate) fn entry_rates(&self, slide: &Slide) -> [Jet; 2] {
        let entry = self.slow_entry_jets(slide);
        let [p, q] = self.slow.coefficients();
        let slow = self.slow_acceleration([entry[0], entry[1]]);
        let jerk = p * slow - q * entry[1];
        let rest = entry[2];
        let jerk = if rest.value == 0.0 {
            jerk
        } else {
            let (rho, by) = (self.rho, self.rho_by);
            let inverse = MultiDual {
                value: 1.0 / rho,
                by: by.map(|by| -by / (rho * rho)),
            };
            jerk + rest * Jet::lifted(inverse)
        };
        [slow + rest, jerk]
    }

    /// The end of a zone. The switching function is W − 1; behind a reversal (m = 1), where W = 1 at
    /// the entry too, (W − 1)/T, and if the zone ends in stick (`arrested`), where V̈ = 0 besides,
    ///
    /// ```text
    /// (V̈ − (W − 1)/T)/T:
    /// ```
    ///
    /// both stay regular while the zone shrinks to nothing.
    pub(crate) fn zone(
        &self,
        slide: &Slide,
        m: usize,
        arrested: bool,
    ) -> Result<ZoneEnd, FlowError> {
        let entry = self.slow_entry_jets(slide);
        let t = slide.duration;
        if self.rho.is_nan() {
            return Err(FlowError::Integration {
                duration: t,
                reason: Unsolved::SlidingExponents,
            });
        }
        if !entry.iter().all(|jet| jet.value.is_finite()) {
            return Err(FlowError::Overflow { duration: t });
        }
        let slow = self.slow_jets(&entry, t, true)?;
        let slow_acceleration = self.slow_acceleration(slow);
        let rho = self.rho_jet();
        let layer = Jet::variable(slide.layer, LAYER);
        let rate = rho * layer;
        let w = slow[1] + rate;
        let switching = if m == 1 {
            let [first, second] = self.slow_quotients(&entry, [slow[1], slow_acceleration], t);
            let [fast_first, fast_second] = self.fast_quotients(slide);
            if arrested {
                second + fast_second
            } else {
                first + fast_first
            }
        } else {
            w - 1.0
        };
        Ok(ZoneEnd {
            y: slow[0] + rho * rate,
            w,
            acceleration: slow_acceleration + layer,
            switching,
            ..ZoneEnd::default()
        })
    }

    /// D₁ = (W(T) − W(0))/T and D₂ = (V̈(T) − D₁)/T of the oscillator, by power series for short
    /// zones.
    fn slow_quotients(&self, entry: &[Jet; 3], end: [Jet; 2], t: f64) -> [Jet; 2] {
        let [p, q] = self.slow.coefficients();
        if (self.slow.q.sqrt() + p.value.abs()) * t.abs() > SHORT_ZONE {
            let over = |jet: Jet| {
                let mut jet = jet * (1.0 / t);
                jet.by[DURATION] -= jet.value / t;
                jet
            };
            let first = over(end[0] - entry[1]);
            return [first, over(end[1] - first)];
        }
        // W_{j+1} = 2pW_j − qW_{j−1} from W_{−1} = y, W_0 = W
        let (mut before, mut current) = (entry[0] + self.slow.shift, entry[1]);
        let (mut first, mut second) = (Jet::default(), Jet::default());
        let mut factorial = 1.0;
        for j in 1..SHORT_TERMS as i32 {
            let n = f64::from(j);
            factorial *= n;
            let next = p * current - q * before;
            before = current;
            current = next;
            // D₁ = Σ W_j T^{j−1}/j!,  D₂ = Σ W_j T^{j−2}(j − 1)/j!
            first = first + current * (t.powi(j - 1) / factorial);
            if j > 1 {
                let weight = (n - 1.0) * t.powi(j - 2) / factorial;
                first.by[DURATION] += weight * current.value;
                second = second + current * weight;
            }
            if j > 2 {
                let weight = (n - 1.0) * (n - 2.0) * t.powi(j - 3) / factorial;
                second.by[DURATION] += weight * current.value;
            }
        }
        [first, second]
    }

    /// The same of the layer: Gφ(x) and G(1 − φ(x))/T = Gχ(x)/ρ, x = T/ρ.
    fn fast_quotients(&self, slide: &Slide) -> [Jet; 2] {
        let (g, rho, t) = (slide.layer, self.rho, slide.duration);
        let x = ratio(t, rho);
        let e = decayed(x);
        let [phi, chi] = quotients(x);
        // φ′ = (e^{−x} − φ)/x = −(χ + xχ′),  χ′ = −(φ′ + χ)/x
        let small = x.abs() < 0.5;
        let (phi_slope, chi_slope);
        if small {
            let mut slope = 0.0;
            for j in (0..14).rev() {
                let n = f64::from(j);
                // χ′ = −Σ (j+1)(−x)^j/(j+3)!; ratio of terms −x(j+2)/((j+1)(j+4))
                slope = 1.0 - slope * x * (n + 2.0) / ((n + 1.0) * (n + 4.0));
            }
            chi_slope = -slope / 6.0;
            phi_slope = -(chi + x * chi_slope);
        } else {
            phi_slope = (e - phi) / x;
            chi_slope = -(phi_slope + chi) / x;
        }
        let mut first = Jet::constant(g * phi);
        first.by[LAYER] = phi;
        let mut second = Jet::default();
        if small {
            second.value = g * chi / rho;
            second.by[LAYER] = chi / rho;
            first.by[DURATION] = g * phi_slope / rho;
            second.by[DURATION] = g * chi_slope / (rho * rho);
        } else {
            second.value = g * (1.0 - phi) / t;
            second.by[LAYER] = (1.0 - phi) / t;
            first.by[DURATION] = g * (e - phi) / t;
            second.by[DURATION] = -g * ((e - phi) / t + (1.0 - phi) / t) / t;
        }
        for index in 0..2 {
            let moved = self.rho_by[index];
            // ∂φ/∂ρ = −φ′x/ρ = (1 − e^{−x})/T − e^{−x}/ρ
            let by = if small {
                -phi_slope * x / rho
            } else {
                (1.0 - e) / t - if e == 0.0 { 0.0 } else { e / rho }
            };
            first.by[EXCESS + index] = g * by * moved;
            second.by[EXCESS + index] = if small {
                -g * (chi + x * chi_slope) / (rho * rho) * moved
            } else {
                -g * by / t * moved
            };
        }
        [first, second]
    }
}

/// e·x where e may be exactly zero and x infinite.
fn weighted(e: f64, x: f64) -> f64 {
    if e == 0.0 { 0.0 } else { e * x }
}
