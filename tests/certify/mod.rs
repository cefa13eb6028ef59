//! What is called proven: the laws of intervals; special points of branches against figures of other
//! origin; what must not be proven; the command line.

mod arcs;
mod command;
mod count;
mod equilibria;
mod laws;
mod layers;
mod orbits;
mod waves;
