//! The program `asperity`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(asperity_cli::main_with(std::env::args_os()))
}
