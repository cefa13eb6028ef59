//! Systems that a user writes down: their motion against figures of an independent program in 40 digits, their
//! derivatives against differences, and what is refused.

#![allow(clippy::excessive_precision)] // figures as they are printed

mod bounds;
mod branches;
mod clocks;
mod closings;
mod contacts;
mod counts;
mod crossings;
mod cycles;
mod ending;
mod equilibria;
mod exponents;
mod fits;
mod growth;
mod held;
mod homoclinic;
mod matrices;
mod monitors;
mod motion;
mod nonlinear;
mod orbits;
mod origins;
mod passing;
mod prescribed;
mod problems;
mod refusals;
mod rests;
mod roundings;
mod shooting;
mod sliding;
mod stacks;
mod start;
mod steady;
mod steep;
mod switch;
mod systems;
mod values;
