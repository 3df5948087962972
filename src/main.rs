//! The `dynid` command.

fn main() -> std::process::ExitCode {
    dynid::commands::run()
}
