//! The command line: verbs, messages, exit codes.

mod accuracy;
mod certify;
mod check;
mod curve;
mod failure;
mod interrupt;
mod junit;
mod motion;
mod options;
mod plot;
mod prepare;
mod progress;
mod report;
mod rows;
mod run;
mod sequences;
#[cfg(feature = "completions")]
mod shell;
mod simulate;
mod spectrum;
mod steady;
mod summary;
mod verify;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{
    ArgMatches, Args, Command, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum,
};

use crate::output::store::Offers;
use crate::problem::{self, SystemProblem};
use failure::{EXIT_CODES, VerbExit, VerbFailure};

/// Continuation and bifurcation of friction-driven travelling waves (brake squeal).
#[derive(Debug, Parser)]
#[command(version, about, after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Follow the branch of a problem file and write tables, restart file and pictures
    Run(run::RunArguments),
    /// Run problem files and compare with their `expect` lists
    Check(check::CheckArguments),
    /// Follow a branch and prove its special points in interval arithmetic, or verify such proofs
    Certify(certify::CertifyArguments),
    /// Draw the pictures of a result folder again
    Plot(plot::PlotArguments),
    /// The wave at one parameter value and its eigenvalues, as CSV on standard output
    Spectrum(spectrum::SpectrumArguments),
    /// Error against run time of every method on a problem file
    Accuracy(accuracy::AccuracyArguments),
    /// Follow an event of the branch in two parameters
    Curve(curve::CurveArguments),
    /// Which waves exist where in a plane of two parameters and which of them are stable, or what motions of a system settle on there
    Map(rows::RowsArguments),
    /// What motions of a system settle on, for many values of a parameter
    Scan(rows::RowsArguments),
    /// Equilibria of every mode of a system, or the stability of steady sliding of a tube, mode by mode, as CSV on standard output
    Steady(steady::SteadyArguments),
    /// Simulate the motion in time as the section `simulation` of a problem file says
    Simulate(simulate::SimulateArguments),
    /// Write one page of HTML with everything of a result folder, to be opened without a network
    Report(report::ReportArguments),
    /// Print a commented problem file
    New(NewArguments),
    /// Print what a shell needs to complete verbs and options
    #[cfg(feature = "completions")]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual: the pages of the program and of its verbs; or write it with the completions into files
    #[cfg(feature = "completions")]
    Man(shell::ManualArguments),
}

#[derive(Debug, Args)]
struct NewArguments {
    /// The verb that the file is for: its section is there, those of others are comments
    #[arg(long = "for", value_enum, default_value_t = Purpose::Run, value_name = "VERB")]
    purpose: Purpose,
}

/// What a new problem file is for: a verb that reads one, or the folder of a run.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Purpose {
    Run,
    Check,
    Certify,
    Plot,
    Spectrum,
    Accuracy,
    Curve,
    Map,
    Steady,
    Simulate,
    Report,
    Scan,
    /// Any verb, with a system of one's own in the place of a tube
    System,
}

impl Purpose {
    /// The problem file.
    fn template(self) -> String {
        match self {
            Purpose::Scan | Purpose::System => problem::SYSTEM_TEMPLATE.to_owned(),
            other => problem::template(other.sections()),
        }
    }

    /// The optional sections that it takes.
    fn sections(self) -> &'static [&'static str] {
        match self {
            Purpose::Run | Purpose::Check | Purpose::Plot | Purpose::Report => {
                &["continuation", "expect"]
            }
            Purpose::Certify | Purpose::Spectrum => &["continuation", "stability"],
            Purpose::Accuracy => &["continuation"],
            Purpose::Curve => &["continuation", "curve"],
            Purpose::Map => &["map"],
            Purpose::Steady => &[],
            Purpose::Simulate => &["simulation"],
            Purpose::Scan | Purpose::System => &[],
        }
    }
}

/// Runs the command line of this process and returns its exit code.
pub fn main() -> ExitCode {
    let matches = Arguments::command().get_matches();
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    if offers(&Arguments::command(), &matches).resume {
        interrupt::say_how_to_go_on();
    }
    let result = match arguments.verb {
        Verb::Run(arguments) => run::run(&arguments),
        Verb::Check(arguments) => check::check(&arguments),
        Verb::Certify(arguments) => certify::certify(&arguments),
        Verb::Plot(arguments) => plot::plot(&arguments),
        Verb::Spectrum(arguments) => spectrum::spectrum(&arguments),
        Verb::Accuracy(arguments) => accuracy::accuracy(&arguments),
        Verb::Curve(arguments) => curve::curve(&arguments),
        Verb::Map(arguments) => rows::map(&arguments),
        Verb::Scan(arguments) => rows::rows::<SystemProblem>(&arguments),
        Verb::Steady(arguments) => steady::steady(&arguments),
        Verb::Simulate(arguments) => simulate::simulate(&arguments),
        Verb::Report(arguments) => report::report(&arguments),
        Verb::New(arguments) => print(&arguments.purpose.template()).map(|()| VerbExit::Done),
        #[cfg(feature = "completions")]
        Verb::Completions { shell } => shell::completions(shell),
        #[cfg(feature = "completions")]
        Verb::Man(arguments) => shell::manual(&arguments),
    };
    match result {
        Ok(exit) => exit.into(),
        Err(failure) => {
            let cure = failure.cure(offers(&Arguments::command(), &matches));
            let _ = writeln!(io::stderr(), "error: {failure}{cure}");
            failure.exit().into()
        }
    }
}

/// Which options the verb of a command line has that help.
fn offers(command: &Command, matches: &ArgMatches) -> Offers {
    let verb = matches.subcommand();
    if let Some((verb, matches)) =
        verb.and_then(|(name, matches)| Some((command.find_subcommand(name)?, matches)))
    {
        return offers(verb, matches);
    }
    let has = |name: &str| command.get_arguments().any(|one| one.get_id() == name);
    Offers {
        out: has("out"),
        resume: has("resume"),
    }
}

/// Writes to standard output.
fn print(text: &str) -> Result<(), VerbFailure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        // the reader may close the pipe early; files and exit code are due all the same
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(VerbFailure::Output(error)),
        _ => Ok(()),
    }
}

/// A text below the title of its problem.
fn titled(title: Option<&str>, text: &str) -> String {
    title.map_or_else(|| text.to_owned(), |title| format!("{title}\n\n{text}"))
}

/// Ends a verb that could not compute what was asked for.
fn stopped(reason: &impl ToString) -> Result<VerbExit, VerbFailure> {
    warn(&reason.to_string());
    Ok(VerbExit::Numerical)
}

/// Writes a warning to standard error.
fn warn(text: &str) {
    let _ = writeln!(io::stderr(), "warning: {text}");
}
