//! The `brakewave` binary.

/// A point of a branch takes hundreds of small vectors.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    brakewave::cli::main()
}
