//! The command line `vofkit`.

use std::process::ExitCode;

fn main() -> ExitCode {
    vofkit::cli::main()
}
