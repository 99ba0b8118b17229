//! The `mve` command: one file a subcommand, and what they share.

mod check;
mod edit;
mod exit;
mod load;
mod machine;
mod manual;
mod modules;
mod new;
mod out;
mod program;
mod program_report;
mod progress;
mod report;
mod run;
mod scaffold;
mod schema;
mod stop;
mod table;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use exit::{Exit, Stop};

const LONG_ABOUT: &str = "\
Runs maps of mve, a laboratory for triangle-mesh simplification.

A map wires modules through ports into one JSON file. `mve run` runs it once; `mve program` runs \
every combination of parameters that one of its programs names, and gives one table; `mve report` \
makes a page of it.";

const AFTER_HELP: &str = "\
Examples:
  mve new map first.json                write a small map to start from
  mve check first.json                  list all problems of a map
  mve run first.json                    run it
  mve program first.json                run its program into a table and a report
  mve report mve-out/first-sizes        write the report of a program again
  mve modules Simplificator             read what a module does
  mve edit first.json                   open it in the window

Exit codes:
  0    all done
  1    a node or a step failed
  2    wrong usage of the command
  3    the map or the program has problems; nothing was run
  4    a file or folder could not be read or written
  130  interrupted; a program resumes when the same command runs again

Color and live progress appear on terminals only; NO_COLOR=1 turns color off.";

/// Run maps and programs of mve, check them, and read their documentation
#[derive(Parser)]
#[command(name = "mve", version, long_about = LONG_ABOUT, after_help = AFTER_HELP)]
#[command(disable_help_subcommand = true, max_term_width = 100)]
struct Cli {
    /// Show no progress; warnings and errors stay
    #[arg(short, long, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    Run(run::Args),
    Program(program::Args),
    Report(report::Args),
    Check(check::Args),
    Modules(modules::Args),
    Schema(schema::Args),
    New(new::Args),
    Edit(edit::Args),
    Completions(manual::CompletionsArgs),
    Man(manual::ManArgs),
}

fn main() -> ExitCode {
    mve_core::contain_panics();
    let cli = Cli::parse();
    let exit = dispatch(cli).unwrap_or_else(|stop| {
        if !stop.message.is_empty() {
            out::complain(&stop.message);
        }
        stop.exit
    });
    ExitCode::from(exit as u8)
}

fn dispatch(cli: Cli) -> Result<Exit, Stop> {
    match cli.command {
        None => {
            // Like any reader, one that goes away is no error.
            let _ = Cli::command().print_help();
            Ok(Exit::Done)
        }
        Some(Command::Run(args)) => run::run(&args, cli.quiet),
        Some(Command::Program(args)) => program::run(&args, cli.quiet),
        Some(Command::Report(args)) => report::run(&args),
        Some(Command::Check(args)) => check::run(&args),
        Some(Command::Modules(args)) => modules::run(&args),
        Some(Command::Schema(args)) => schema::run(&args),
        Some(Command::New(args)) => new::run(&args),
        Some(Command::Edit(args)) => edit::run(&args),
        Some(Command::Completions(args)) => manual::completions(Cli::command(), &args),
        Some(Command::Man(args)) => manual::pages(Cli::command(), &args),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
