//! What is called proven: the laws of intervals; special points of branches against figures of other
//! origin; what must not be proven; the command line.

mod command;
mod laws;
mod waves;
