//! Many generated crates linked into one program, the battery, that answers [`probe`] requests.
//!
//! Each model becomes a crate just as `handc compile` writes it; the battery depends on them all by
//! path. Crates that did not change are not built again. Warnings are errors.
//!
//! [`probe`]: crate::probe

use crate::load::repository;
use crate::probe::{Answer, Request, read_answer, write_request};
use handc::emit::package::{Sources, package, write_crate};
use handc_runtime::mechanism::Mechanism;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The program, built.
#[derive(Debug)]
pub struct Battery {
    folder: PathBuf,
}

/// Builds a battery of models whose names differ, each with its budget of straight lines, in a folder of
/// its own.
pub fn build(folder: &Path, models: &[(Mechanism, usize)]) -> Battery {
    let runtime = repository("runtime").canonicalize().expect("the runtime");
    let sources = Sources::in_checkout(runtime.to_str().expect("a path in UTF-8"));
    let core = &sources.core;
    let mut dependencies = format!("handc-core = {{ path = {core:?} }}\n");
    let mut arms = String::new();
    for (model, budget) in models {
        let name = &model.name;
        let made =
            package(model, &sources, *budget).unwrap_or_else(|error| panic!("{name}: {error}"));
        let place = folder.join("models").join(name);
        write_crate(&place, &made.files, true).unwrap_or_else(|error| panic!("{name}: {error}"));
        let library = &made.files.iter().find(|f| f.path == "src/lib.rs").expect("a library").text;
        let item = library.split("pub use model::").nth(1).expect("the model's struct");
        let item = item.split(';').next().unwrap_or_default();
        // Writing to a string cannot fail.
        let _ = writeln!(dependencies, "{name} = {{ path = \"../models/{name}\" }}");
        let _ = writeln!(arms, "        {name:?} => answer({name}::{item}::new(), request),");
    }
    let manifest = format!(
        "[workspace]\n\n[package]\nname = \"battery\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n\
         [dependencies]\n{dependencies}\n[profile.dev]\nopt-level = 0\ndebug = false\n\
         incremental = false\n"
    );
    let probe = repository("tests/src/probe.rs").canonicalize().expect("the probe");
    let main = MAIN.replace("PROBE", &format!("{probe:?}")).replace("        ARMS\n", &arms);
    keep(&folder.join("battery/Cargo.toml"), &manifest);
    keep(&folder.join("battery/src/main.rs"), &main);
    let built = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--manifest-path"])
        .arg(folder.join("battery/Cargo.toml"))
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .env("RUSTFLAGS", "-D warnings")
        .output()
        .expect("cargo");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    Battery { folder: folder.to_path_buf() }
}

impl Battery {
    /// Asks all requests at once; the answers come in their order. Vectors have at most so many lanes.
    pub fn ask(&self, requests: &[Request], lanes: usize) -> Vec<Vec<Answer>> {
        let mut text = String::new();
        requests.iter().for_each(|request| write_request(request, &mut text));
        // Several tests may ask at once.
        static ASKED: AtomicUsize = AtomicUsize::new(0);
        let number = ASKED.fetch_add(1, Ordering::Relaxed);
        let file = self.folder.join(format!("requests{number}.txt"));
        std::fs::write(&file, text).expect("room for the requests");
        let program = self.folder.join("target/debug/battery");
        let output =
            Command::new(program).arg(&file).arg(lanes.to_string()).output().expect("the battery");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "the battery failed: {said}");
        let text = String::from_utf8(output.stdout).expect("text");
        let mut answers: Vec<Vec<Answer>> = Vec::new();
        for line in text.lines() {
            match (line, answers.last_mut()) {
                ("answer", _) => answers.push(Vec::new()),
                (line, Some(last)) => last.push(read_answer(line)),
                _ => panic!("unexpected line: {line}"),
            }
        }
        assert_eq!(answers.len(), requests.len());
        answers
    }
}

/// Writes a file unless it is there already, so that cargo does not build it again.
fn keep(path: &Path, text: &str) {
    if std::fs::read(path).is_ok_and(|old| old == text.as_bytes()) {
        return;
    }
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    std::fs::write(path, text).expect("a file");
}

const MAIN: &str = r#"//! Answers requests about compiled models; written by the tests.

#[allow(dead_code)]
#[path = PROBE]
mod probe;

use probe::{answer, read_requests, write_answer};
use std::io::Write;

fn main() {
    let file = std::env::args().nth(1).expect("a file of requests");
    let lanes = std::env::args().nth(2).and_then(|lanes| lanes.parse().ok()).expect("lanes");
    handc_core::lane::use_at_most(lanes);
    let text = std::fs::read_to_string(file).expect("requests");
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    for request in &read_requests(&text) {
        let answers = match request.model.as_str() {
        ARMS
            other => panic!("no model {other}"),
        };
        writeln!(out, "answer").expect("a reader");
        for answer in &answers {
            write!(out, "{}", write_answer(answer)).expect("a reader");
        }
    }
}
"#;
