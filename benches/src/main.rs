//! Measures handc beside MuJoCo and prints tables. `benches/README.md` says how and what.
//!
//! Both sides run in turn, round after round, on the same machine and the same models: handc by its
//! command lines, MuJoCo by its own C loops from one Python process on the exported models.

mod accuracy;
mod growth;
mod models;
mod own;
mod rival;
mod speed;
mod table;
mod tendon_models;
mod tendons;

use own::{Crate, Own};
use rival::Rival;
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

const USAGE: &str = "\
usage: table [--rounds N] [--only speed|tendons|growth|accuracy]
  --rounds N   rounds of measuring (default 5)
  --only PART  one part of the report";

/// What was asked for.
struct Options {
    rounds: usize,
    only: Option<String>,
}

impl Options {
    fn parse() -> Result<Self, String> {
        let mut options = Options { rounds: 5, only: None };
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("`{argument}` needs a value"));
            match argument.as_str() {
                "--rounds" => {
                    options.rounds = value()?.parse().map_err(|_| "`--rounds` needs a number")?;
                }
                "--only" => options.only = Some(value()?),
                other => return Err(format!("unknown option `{other}`")),
            }
        }
        Ok(options)
    }

    fn wants(&self, part: &str) -> bool {
        self.only.as_ref().is_none_or(|only| only == part)
    }
}

/// Where models, crates and the virtual environment go: beside the build.
fn folder() -> Result<PathBuf, String> {
    let own = std::env::current_exe().map_err(|e| e.to_string())?;
    let target = own.ancestors().nth(2).ok_or("no target folder")?;
    Ok(target.join("benches"))
}

fn crates(own: &Own) -> Result<Vec<Crate>, String> {
    let limit = Duration::from_secs(600);
    let mut crates = Vec::new();
    for name in ["hand", "finger", "grasp"] {
        let made = own.compile(&own.folder.join(format!("models/{name}.hdl")), limit)?;
        own.make(&made, false, limit)?;
        crates.push(made);
    }
    Ok(crates)
}

/// What else keeps the machine busy, where it can be told: a table of a busy machine is worth little.
fn load() -> String {
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    match std::fs::read_to_string("/proc/loadavg") {
        Ok(load) => {
            let load = load.split(' ').next().unwrap_or_default().to_string();
            format!("{cores} cores, load average {load}")
        }
        Err(_) => format!("{cores} cores"),
    }
}

fn report(options: &Options) -> Result<(), String> {
    let folder = folder()?;
    models::write_fixtures(&folder.join("models"))?;
    let own = Own::build(&folder)?;
    let mut rival = Rival::start(&folder);
    match &mut rival {
        Ok(rival) => {
            let version = rival.ask(&json!({ "ask": "version" }))?;
            println!("MuJoCo {}", version["version"].as_str().unwrap_or("?"));
        }
        Err(reason) => println!("MuJoCo cannot be asked: {reason}"),
    }
    println!("{}", load());
    let crates = crates(&own)?;
    if options.wants("speed") {
        println!("\n## Speed\n\n{} rounds.\n", options.rounds);
        print!("{}", table::markdown(&speed::rows(&own, &mut rival, &crates, options.rounds)?));
    }
    if options.wants("tendons") {
        println!("\n## Elements of tendons");
        print!("{}", tendons::report(&own, &mut rival, options.rounds)?);
        print!("{}", tendon_models::report(&own, options.rounds)?);
    }
    if options.wants("growth") {
        println!("\n## Growth");
        print!("{}", growth::report(&own, options.rounds));
    }
    if options.wants("accuracy")
        && let Ok(rival) = &mut rival
    {
        println!("\n## Accuracy beside speed");
        print!("{}", accuracy::report(&own, rival, &crates)?);
    }
    println!("\n{}", load());
    Ok(())
}

fn main() -> ExitCode {
    let options = match Options::parse() {
        Ok(options) => options,
        Err(error) => {
            eprintln!("error: {error}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match report(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(3)
        }
    }
}
