//! The `mve` command: one file a subcommand, and what they share.

mod check;
mod clean;
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
mod rate;
mod report;
mod run;
mod scaffold;
mod schema;
mod stop;
mod table;
mod view;

use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue};
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
  mve rate mve-out/first-sizes          make a page on which people mark results
  mve clean mve-out/first-sizes         list what its results do not need
  mve modules Simplificator             read what a module does
  mve edit first.json                   open it in the window
  mve view bunny.obj                    look at a mesh

Exit codes:
  0    all done
  1    a node or a step failed
  2    wrong usage of the command
  3    the map or the program has problems; nothing was run
  4    a file or folder could not be read or written
  5    the program is not complete: other processes have steps, or left some
  130  interrupted; a program resumes when the same command runs again

Color and live progress appear on terminals only; NO_COLOR=1 turns color off.";

/// Run maps and programs of mve, check them, and read their documentation
#[derive(Parser)]
#[command(name = "mve", version, long_about = LONG_ABOUT, after_help = AFTER_HELP)]
#[command(max_term_width = 100)]
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
    Rate(rate::Args),
    Clean(clean::Args),
    Check(check::Args),
    Modules(modules::Args),
    Schema(schema::Args),
    New(new::Args),
    Edit(edit::Args),
    View(view::Args),
    Completions(manual::CompletionsArgs),
    Man(manual::ManArgs),
}

fn main() -> ExitCode {
    mve_core::contain_panics();
    let cli = Cli::try_parse().unwrap_or_else(|error| with_hint(error).exit());
    let exit = dispatch(cli).unwrap_or_else(|stop| {
        if !stop.message.is_empty() {
            out::complain(&stop.message);
        }
        stop.exit
    });
    ExitCode::from(exit as u8)
}

/// Offers the command that a mistyped one is a slip of the pen away from: clap knows no slip in
/// words of two and three letters.
fn with_hint(mut error: clap::Error) -> clap::Error {
    if let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidSubcommand)
        && error.get(ContextKind::SuggestedSubcommand).is_none()
    {
        let cli = Cli::command();
        let near = mve_core::nearest(typed, cli.get_subcommands().map(clap::Command::get_name));
        if let Some(near) = near.map(str::to_owned) {
            error.insert(ContextKind::SuggestedSubcommand, ContextValue::Strings(vec![near]));
        }
    }
    error
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
        Some(Command::Rate(args)) => rate::run(&args, cli.quiet),
        Some(Command::Clean(args)) => clean::run(&args),
        Some(Command::Check(args)) => check::run(&args),
        Some(Command::Modules(args)) => modules::run(&args),
        Some(Command::Schema(args)) => schema::run(&args),
        Some(Command::New(args)) => new::run(&args),
        Some(Command::Edit(args)) => edit::run(&args),
        Some(Command::View(args)) => view::run(&args),
        Some(Command::Completions(args)) => manual::completions(Cli::command(), &args),
        Some(Command::Man(args)) => manual::pages(Cli::command(), &args),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistyped_command_is_offered_the_right_one() {
        let error = Cli::try_parse_from(["mve", "rn"]).err().map(with_hint).unwrap();
        assert!(error.to_string().contains("'run'"), "{error}");
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
