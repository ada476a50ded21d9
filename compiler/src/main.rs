//! The `handc` command.

use clap::{Args, Parser, Subcommand, ValueEnum};
use handc::command::export::{ExportOptions, Format};
use handc::command::{self, Stage};
use handc_core::ensemble;
use handc_core::runner::{RunOptions, assignment};
use handc_core::simulation::Settings;
use std::path::PathBuf;
use std::process::ExitCode;

/// Compiler and interpreter for declarative mechanical models of the hand and of anything built alike.
#[derive(Parser)]
#[command(name = "handc", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Report every diagnostic of a model; exit code 1 on any error
    Check {
        #[command(flatten)]
        source: Source,
    },
    /// Simulate a model with the interpreter
    Run {
        #[command(flatten)]
        source: Source,
        #[command(flatten)]
        run: Run,
    },
    /// Emit a crate of specialised Rust with a library and a runner
    Compile {
        #[command(flatten)]
        source: Source,
        /// Folder of the crate [default: generated/<model>]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Overwrite a folder that was not written by this command
        #[arg(long)]
        force: bool,
    },
    /// Print what a stage of the compiler sees
    Dump {
        #[command(flatten)]
        source: Source,
        /// The stage
        #[arg(long, value_enum, default_value_t = DumpStage::Mechanism)]
        stage: DumpStage,
    },
    /// Format model files in place
    Fmt {
        /// Model files
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// Change nothing; exit code 1 if a file is not formatted
        #[arg(long)]
        check: bool,
    },
    /// Write a commented starter model
    New {
        /// Name of the model; the file is NAME.hdl
        name: String,
    },
    /// Draw angles, lengths, tensions and energy over time, and poses of a model, as SVG and PNG
    Plot {
        /// A trajectory (.csv) or a model (.hdl), which is run
        file: PathBuf,
        /// Folder that imports may not leave [default: the file's]
        #[arg(long, value_name = "DIR")]
        root: Option<PathBuf>,
        /// Figures go to STEM.svg, STEM.png, ... [default: beside the file]
        #[arg(long, value_name = "STEM")]
        out: Option<PathBuf>,
        #[command(flatten)]
        choice: Choice,
    },
    /// Write a model for another program
    Export {
        #[command(flatten)]
        source: Source,
        /// The format
        #[arg(long, value_enum)]
        format: ExportFormat,
        /// The file; without it the text goes to standard output
        #[arg(long, value_name = "F.xml")]
        out: Option<PathBuf>,
        /// Whose start, step and parameters; of several scenarios the first if left out
        #[arg(long, value_name = "S")]
        scenario: Option<String>,
        /// Set a parameter (SI units); may be repeated
        #[arg(long, value_name = "PARAM=VALUE", value_parser = assignment)]
        set: Vec<(String, f64)>,
        /// Step instead of the scenario's
        #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
        step: Option<f64>,
    },
    /// Print the tree, coordinates, strands, masses and degrees of freedom
    Info {
        #[command(flatten)]
        source: Source,
    },
}

#[derive(Args)]
struct Source {
    /// Model file
    file: PathBuf,
    /// Folder that imports may not leave [default: the file's]
    #[arg(long, value_name = "DIR")]
    root: Option<PathBuf>,
}

/// What is simulated.
#[derive(Args)]
struct Choice {
    /// Which scenario; a single one needs no name
    #[arg(long, value_name = "S")]
    scenario: Option<String>,
    /// Set a parameter (SI units); may be repeated
    #[arg(long, value_name = "PARAM=VALUE", value_parser = assignment)]
    set: Vec<(String, f64)>,
    /// Step instead of the scenario's
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    step: Option<f64>,
    /// Duration instead of the scenario's
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    duration: Option<f64>,
}

#[derive(Args)]
struct Run {
    #[command(flatten)]
    choice: Choice,
    /// Write the trajectory as CSV; without it nothing is written
    #[arg(long, value_name = "F.csv")]
    out: Option<PathBuf>,
    /// A row for every N-th step
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    /// Run N copies
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    instances: Option<u64>,
    /// Threads for copies [default: all cores]
    #[arg(long, value_name = "T", requires = "instances", value_parser = clap::value_parser!(u64).range(1..))]
    threads: Option<u64>,
    /// Spread a parameter (PARAM=LO:HI) or the start (start=SIGMA) over copies; may be repeated
    #[arg(long, value_name = "SPREAD", requires = "instances", value_parser = ensemble::Spread::parse)]
    spread: Vec<ensemble::Spread>,
}

#[derive(Clone, Copy, ValueEnum)]
enum DumpStage {
    /// Syntax tree
    Ast,
    /// Checked model
    Hir,
    /// Mechanism: constant data
    Mechanism,
    /// Symbolic graph of the step
    Graph,
    /// Generated Rust
    Rust,
}

impl From<Choice> for Settings {
    fn from(choice: Choice) -> Settings {
        let Choice { scenario, set, step, duration } = choice;
        Settings { scenario, set, step, duration, start_offset: Vec::new() }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum ExportFormat {
    /// MuJoCo's XML
    Mjcf,
}

impl Run {
    fn options(self) -> RunOptions {
        RunOptions {
            settings: self.choice.into(),
            out: self.out,
            every: self.every as usize,
            ensemble: self.instances.map(|instances| ensemble::Plan {
                instances: instances as usize,
                threads: self.threads.map(|t| t as usize),
                spread: self.spread,
            }),
        }
    }
}

fn dispatch(command: Command) -> u8 {
    match command {
        Command::Check { source } => command::check::check(&source.file, source.root.as_deref()),
        Command::Run { source, run } => {
            command::run::run(&source.file, source.root.as_deref(), &run.options())
        }
        Command::Compile { source, out, force } => {
            command::compile::compile(&source.file, source.root.as_deref(), out.as_deref(), force)
        }
        Command::Dump { source, stage } => {
            let stage = match stage {
                DumpStage::Ast => Stage::Ast,
                DumpStage::Hir => Stage::Hir,
                DumpStage::Mechanism => Stage::Mechanism,
                DumpStage::Graph => Stage::Graph,
                DumpStage::Rust => Stage::Rust,
            };
            command::dump::dump(&source.file, source.root.as_deref(), stage)
        }
        Command::Fmt { files, check } => command::fmt::fmt(&files, check),
        Command::New { name } => command::new::new(&name),
        Command::Plot { file, root, out, choice } => {
            let settings = choice.into();
            command::plot::plot(&command::plot::PlotOptions { file, root, out, settings })
        }
        Command::Export { source, format, out, scenario, set, step } => {
            let format = match format {
                ExportFormat::Mjcf => Format::Mjcf,
            };
            let settings = Settings { scenario, set, step, ..Settings::default() };
            let Source { file, root } = source;
            command::export::export(&ExportOptions { file, root, format, out, settings })
        }
        Command::Info { source } => command::info::info(&source.file, source.root.as_deref()),
    }
}

/// Stack of the working thread: long sums are deep trees.
const STACK: usize = 256 << 20;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let worker = std::thread::Builder::new().stack_size(STACK).spawn(|| dispatch(cli.command));
    match worker.map(std::thread::JoinHandle::join) {
        Ok(Ok(code)) => ExitCode::from(code),
        _ => ExitCode::from(101),
    }
}
