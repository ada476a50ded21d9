//! The `handc` command.

use clap::{Args, Parser, Subcommand, ValueEnum};
use handc::command::atlas::AtlasOptions;
use handc::command::export::{ExportOptions, Format};
use handc::command::pose::PoseOptions;
use handc::command::posture::PostureOptions;
use handc::command::strength::{OffAxis, Plane, StrengthOptions};
use handc::command::{self, Stage};
use handc::stage::DEFAULT_BUDGET;
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
        /// Operations written as straight lines at most; what does not fit loops over tables, which takes
        /// fewer lines, builds faster and runs slower
        #[arg(long, value_name = "N", default_value_t = DEFAULT_BUDGET)]
        budget: usize,
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
    /// Tabulate and draw length, moment arm and tension of strands over the ranges of joints
    Atlas {
        #[command(flatten)]
        source: Source,
        #[command(flatten)]
        posture: Posture,
        /// Sweep this joint, over its limits or over LO:HI; may be repeated [default: all with limits]
        #[arg(long, value_name = "JOINT[=LO:HI]")]
        joint: Vec<String>,
        /// Only this strand; may be repeated
        #[arg(long, value_name = "STRAND")]
        strand: Vec<String>,
        /// Sweep two joints together
        #[arg(long, num_args = 2, value_names = ["JOINT", "JOINT"])]
        grid: Option<Vec<String>>,
        /// Values over each range
        #[arg(long, value_name = "N", default_value_t = 61, value_parser = clap::value_parser!(u64).range(2..=100_000))]
        points: u64,
        /// Natural length of a strand for its tension; may be repeated
        #[arg(long, value_name = "STRAND=LENGTH")]
        rest: Vec<String>,
        /// Files are STEM.csv, STEM.svg, STEM.png [default: beside the model]
        #[arg(long, value_name = "STEM")]
        out: Option<PathBuf>,
    },
    /// Where a model comes to rest; with --hold, the tensions that hold it in a pose
    Pose {
        #[command(flatten)]
        source: Source,
        #[command(flatten)]
        posture: Posture,
        /// Natural length of a strand; may be repeated
        #[arg(long, value_name = "STRAND=LENGTH")]
        rest: Vec<String>,
        /// Shorten the natural length of a strand; may be repeated
        #[arg(long, value_name = "STRAND=LENGTH")]
        pull: Vec<String>,
        /// Tension of a strand instead of its law; may be repeated
        #[arg(long, value_name = "STRAND=FORCE")]
        tension: Vec<String>,
        /// A force that acts on a frame, world axes (N); may be repeated
        #[arg(long, value_name = "FRAME=FX,FY,FZ")]
        load: Vec<String>,
        /// Tell about this frame too; may be repeated
        #[arg(long, value_name = "FRAME")]
        at: Vec<String>,
        /// Find the least tensions that hold the pose, and natural lengths for them
        #[arg(long)]
        hold: bool,
        /// Largest tension of a strand; may be repeated
        #[arg(long, value_name = "STRAND=FORCE")]
        limit: Vec<String>,
        /// Largest tension of every other strand
        #[arg(long, value_name = "FORCE", allow_hyphen_values = true)]
        limit_all: Option<String>,
        /// A strand that pulls by its own law instead; may be repeated
        #[arg(long, value_name = "STRAND")]
        passive: Vec<String>,
        /// Write STEM.coordinates.csv, STEM.strands.csv, STEM.svg and STEM.png
        #[arg(long, value_name = "STEM")]
        out: Option<PathBuf>,
    },
    /// The largest force at a point within limits of tension, in the directions of a plane
    Strength {
        #[command(flatten)]
        source: Source,
        #[command(flatten)]
        posture: Posture,
        /// The frame that exerts the force, or a point in its axes
        #[arg(long, value_name = "FRAME[=X,Y,Z]")]
        at: String,
        /// The plane of the directions [default: where the point moves most]
        #[arg(long, value_enum)]
        plane: Option<PlaneName>,
        /// The frame whose axes are meant [default: the world]
        #[arg(long, value_name = "FRAME")]
        axes: Option<String>,
        /// Directions around the plane
        #[arg(long, value_name = "N", default_value_t = 360, value_parser = clap::value_parser!(u64).range(4..=100_000))]
        directions: u64,
        /// This direction instead of a plane; may be repeated
        #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
        direction: Vec<String>,
        /// Largest tension of a strand; may be repeated
        #[arg(long, value_name = "STRAND=FORCE")]
        limit: Vec<String>,
        /// Largest tension of every other strand
        #[arg(long, value_name = "FORCE", allow_hyphen_values = true)]
        limit_all: Option<String>,
        /// A strand that pulls by its own law instead; may be repeated
        #[arg(long, value_name = "STRAND")]
        passive: Vec<String>,
        /// Force across the direction
        #[arg(long, value_enum, default_value_t = OffAxisName::Zero)]
        off_axis: OffAxisName,
        /// A force that acts on a frame, world axes (N); may be repeated
        #[arg(long, value_name = "FRAME=FX,FY,FZ")]
        load: Vec<String>,
        /// Natural length of a passive strand; may be repeated
        #[arg(long, value_name = "STRAND=LENGTH")]
        rest: Vec<String>,
        /// Write STEM.csv, STEM.svg, STEM.png and STEM.tensions.svg, .png
        #[arg(long, value_name = "STEM")]
        out: Option<PathBuf>,
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

/// At which pose a model is looked at. Values are SI, or have a unit: 0.35, 20deg, 5mm.
#[derive(Args)]
struct Posture {
    /// Whose start, poses and parameters; a single scenario needs no name
    #[arg(long, value_name = "S")]
    scenario: Option<String>,
    /// One of the scenario's poses [default: its start]
    #[arg(long, value_name = "NAME")]
    pose: Option<String>,
    /// A coordinate of the pose; may be repeated
    #[arg(long, value_name = "JOINT=VALUE")]
    start: Vec<String>,
    /// Set a parameter (SI units); may be repeated
    #[arg(long, value_name = "PARAM=VALUE", value_parser = assignment)]
    set: Vec<(String, f64)>,
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
    /// Write mean, deviation and quantiles over the copies as CSV, every N-th step
    #[arg(long, value_name = "F.csv", requires = "instances")]
    summary: Option<PathBuf>,
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

impl Posture {
    fn options(self, source: Source) -> PostureOptions {
        let Posture { scenario, pose, start, set } = self;
        let Source { file, root } = source;
        PostureOptions { file, root, scenario, pose, start, set, ..PostureOptions::default() }
    }
}

impl From<Choice> for Settings {
    fn from(choice: Choice) -> Settings {
        let Choice { scenario, set, step, duration } = choice;
        Settings { scenario, set, step, duration, ..Settings::default() }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum ExportFormat {
    /// MuJoCo's XML
    Mjcf,
}

#[derive(Clone, Copy, ValueEnum)]
enum PlaneName {
    /// x to y
    Xy,
    /// y to z
    Yz,
    /// x to z
    Xz,
}

impl From<PlaneName> for Plane {
    fn from(name: PlaneName) -> Plane {
        match name {
            PlaneName::Xy => Plane::Xy,
            PlaneName::Yz => Plane::Yz,
            PlaneName::Xz => Plane::Xz,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum OffAxisName {
    /// There is none
    Zero,
    /// It may be anything
    Free,
}

impl From<OffAxisName> for OffAxis {
    fn from(name: OffAxisName) -> OffAxis {
        match name {
            OffAxisName::Zero => OffAxis::Zero,
            OffAxisName::Free => OffAxis::Free,
        }
    }
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
                summary: self.summary,
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
        Command::Compile { source, out, force, budget } => {
            let (root, out) = (source.root.as_deref(), out.as_deref());
            command::compile::compile(&source.file, root, out, force, budget)
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
        Command::Atlas { source, posture, joint, strand, grid, points, rest, out } => {
            let pair = |names: Vec<String>| <[String; 2]>::try_from(names).ok();
            command::atlas::atlas(&AtlasOptions {
                posture: PostureOptions { rest, ..posture.options(source) },
                joints: joint,
                strands: strand,
                grid: grid.and_then(pair),
                points: points as usize,
                out,
            })
        }
        Command::Pose {
            source,
            posture,
            rest,
            pull,
            tension,
            load,
            at,
            hold,
            limit,
            limit_all,
            passive,
            out,
        } => command::pose::pose(&PoseOptions {
            posture: PostureOptions { rest, load, ..posture.options(source) },
            pull,
            tension,
            at,
            hold,
            limit,
            limit_all,
            passive,
            out,
        }),
        Command::Strength {
            source,
            posture,
            at,
            plane,
            axes,
            directions,
            direction,
            limit,
            limit_all,
            passive,
            off_axis,
            load,
            rest,
            out,
        } => command::strength::strength(&StrengthOptions {
            posture: PostureOptions { rest, load, ..posture.options(source) },
            at,
            plane: plane.map(Into::into),
            axes,
            directions: directions as usize,
            direction,
            limit,
            limit_all,
            passive,
            off_axis: off_axis.into(),
            out,
        }),
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
