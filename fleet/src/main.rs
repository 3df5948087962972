//! The `dynid-fleet` command.

fn main() -> std::process::ExitCode {
    dynid_fleet::commands::run()
}
