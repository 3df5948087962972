//! `dynid completions SHELL` and `dynid man`: what the parser of the command line knows, for shells and manuals.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::Cli;
use crate::failure::Failure;
use crate::output::print_bytes;

/// Which shell.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The shell
    shell: Shell,
}

/// Prints the completions of a shell.
pub(super) fn completions(arguments: &Arguments) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "dynid", &mut text);
    print_bytes(&text);
    Ok(())
}

/// Prints the manual: the program, then each command.
pub(super) fn manual() -> Result<(), Failure> {
    let mut command = Cli::command();
    command.build();
    let mut text = Vec::new();
    let failed = |error: std::io::Error| Failure::Input(format!("the manual cannot be written: {error}"));
    clap_mangen::Man::new(command.clone()).render(&mut text).map_err(failed)?;
    for command in command.get_subcommands().filter(|command| command.get_name() != "help") {
        let heading = format!(".SH \"DYNID {}\"\n", command.get_name().to_uppercase());
        text.extend(heading.bytes());
        let man = clap_mangen::Man::new(command.clone());
        man.render_description_section(&mut text).map_err(failed)?;
        man.render_options_section(&mut text).map_err(failed)?;
    }
    print_bytes(&text);
    Ok(())
}
