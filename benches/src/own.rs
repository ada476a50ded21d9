//! handc's side: compiling, building and running, all by its command lines.

use handc_tests::load::repository;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// The command and the folder in which crates are built.
#[derive(Clone, Debug)]
pub(crate) struct Own {
    /// The `handc` binary.
    pub(crate) handc: PathBuf,
    /// Where models, crates and builds go.
    pub(crate) folder: PathBuf,
}

/// A model compiled to a crate.
#[derive(Clone, Debug)]
pub(crate) struct Crate {
    /// Name of the model.
    pub(crate) name: String,
    /// The crate.
    pub(crate) folder: PathBuf,
    /// What `handc compile` said.
    pub(crate) report: String,
    /// How long it took (s).
    pub(crate) seconds: f64,
}

/// What a run says of itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// Steps taken, of all instances.
    pub(crate) steps: f64,
    /// Time of the stepping (s).
    pub(crate) wall: f64,
}

impl Own {
    /// Builds `handc` and finds it beside this program.
    pub(crate) fn build(folder: &Path) -> Result<Self, String> {
        let status = Command::new(env!("CARGO"))
            .args(["build", "--release", "--quiet", "-p", "handc", "--manifest-path"])
            .arg(repository("Cargo.toml"))
            .status();
        if !status.is_ok_and(|status| status.success()) {
            return Err("`cargo build --release -p handc` fails".into());
        }
        let own = std::env::current_exe().map_err(|e| e.to_string())?;
        let target = own.parent().and_then(Path::parent).ok_or("no target folder")?;
        Ok(Own { handc: target.join("release/handc"), folder: folder.to_path_buf() })
    }

    /// `handc compile`.
    pub(crate) fn compile(&self, model: &Path, limit: Duration) -> Result<Crate, String> {
        let name = model.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let folder = self.folder.join("crates").join(&name);
        let mut command = Command::new(&self.handc);
        command.arg("compile").arg(model).arg("--out").arg(&folder);
        let began = Instant::now();
        let output = limited(&mut command, limit)?;
        let seconds = began.elapsed().as_secs_f64();
        let report = String::from_utf8_lossy(&output.stdout).into_owned();
        Ok(Crate { name, folder, report, seconds })
    }

    /// `cargo build --release` of a crate; with `fresh` into an empty target folder. Returns seconds.
    pub(crate) fn make(&self, made: &Crate, fresh: bool, limit: Duration) -> Result<f64, String> {
        let target = self.target(made, fresh);
        if fresh {
            let _ = std::fs::remove_dir_all(&target);
        }
        let mut command = Command::new(env!("CARGO"));
        command.args(["build", "--release", "--quiet", "--manifest-path"]);
        command.arg(made.folder.join("Cargo.toml")).env("CARGO_TARGET_DIR", &target);
        let began = Instant::now();
        limited(&mut command, limit)?;
        Ok(began.elapsed().as_secs_f64())
    }

    /// Forgets an earlier build of a crate, so that the next is timed in full; the core stays built.
    pub(crate) fn forget(&self, made: &Crate) -> Result<(), String> {
        let mut command = Command::new(env!("CARGO"));
        command.args(["clean", "--release", "--quiet", "-p", &made.name, "--manifest-path"]);
        command.arg(made.folder.join("Cargo.toml"));
        command.env("CARGO_TARGET_DIR", self.target(made, false));
        limited(&mut command, Duration::from_secs(60)).map(|_| ())
    }

    fn target(&self, made: &Crate, fresh: bool) -> PathBuf {
        self.folder.join(if fresh { format!("fresh-{}", made.name) } else { "target".into() })
    }

    /// The runner of a crate that was made, not freshly.
    pub(crate) fn runner(&self, made: &Crate) -> PathBuf {
        self.target(made, false).join("release").join(&made.name)
    }

    /// Runs a crate's runner.
    pub(crate) fn run(&self, made: &Crate, options: &[&str]) -> Result<Run, String> {
        run(Command::new(self.runner(made)).args(options))
    }

    /// Runs the interpreter.
    pub(crate) fn interpret(&self, model: &Path, options: &[&str]) -> Result<Run, String> {
        run(Command::new(&self.handc).arg("run").arg(model).args(options))
    }

    /// Exports a model to MJCF.
    pub(crate) fn export(&self, model: &Path, scenario: &str) -> Result<PathBuf, String> {
        let stem = model.file_stem().unwrap_or_default().to_string_lossy();
        let xml = self.folder.join(format!("{stem}-{scenario}.xml"));
        let mut command = Command::new(&self.handc);
        command.arg("export").arg(model).args(["--format", "mjcf", "--scenario", scenario]);
        limited(command.arg("--out").arg(&xml), Duration::from_secs(60))?;
        Ok(xml)
    }
}

/// Lines of Rust in a crate's `src`.
pub(crate) fn lines(folder: &Path) -> usize {
    let Ok(entries) = std::fs::read_dir(folder) else { return 0 };
    let paths = entries.filter_map(Result::ok).map(|entry| entry.path());
    paths
        .map(|path| match path.is_dir() {
            true => lines(&path),
            false => std::fs::read_to_string(&path).map_or(0, |text| text.lines().count()),
        })
        .sum()
}

/// Runs to the end and reads the line `steps N  wall S s  us/step X …` from standard error.
fn run(command: &mut Command) -> Result<Run, String> {
    let output = limited(command, Duration::from_secs(300))?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = said.lines().rfind(|line| line.starts_with("steps ")).ok_or("no summary")?;
    let number = |after: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let at = words.iter().position(|word| *word == after)?;
        words.get(at + 1)?.parse::<f64>().ok()
    };
    match (number("steps"), number("wall")) {
        (Some(steps), Some(wall)) => Ok(Run { steps, wall }),
        _ => Err(format!("a summary that cannot be read: {line}")),
    }
}

/// The output of a command that must succeed within a time.
fn limited(command: &mut Command, limit: Duration) -> Result<Output, String> {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|e| format!("{command:?}: {e}"))?;
    let began = Instant::now();
    // What is written is little; a pipe holds it until the end.
    loop {
        match child.try_wait() {
            Ok(Some(_)) => break,
            Ok(None) if began.elapsed() > limit => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(format!("not done in {:.0} s", limit.as_secs_f64()));
            }
            Ok(None) => std::thread::sleep(Duration::from_millis(2)),
            Err(error) => return Err(error.to_string()),
        }
    }
    let output = child.wait_with_output().map_err(|e| e.to_string())?;
    if output.status.success() {
        return Ok(output);
    }
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    Err(said.lines().rfind(|l| !l.trim().is_empty()).unwrap_or("failed without a word").to_string())
}
