//! The `brakewave` binary.

fn main() -> std::process::ExitCode {
    brakewave::cli::main()
}
