//! Folders, processes and tables for the tests of the command line.
#![allow(dead_code, reason = "each test uses its share")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// An empty folder of one test.
pub(crate) struct Folder(pub(crate) PathBuf);

/// Makes one.
pub(crate) fn folder(name: &str) -> Folder {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("command").join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).expect("a folder");
    Folder(path)
}

impl Folder {
    /// Writes a file.
    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).expect("a file");
    }
    /// Reads one.
    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }
    /// Size of a file; zero where there is none.
    pub(crate) fn size(&self, name: &str) -> u64 {
        std::fs::metadata(self.0.join(name)).map_or(0, |data| data.len())
    }
    /// How many files and folders it holds.
    pub(crate) fn count(&self) -> usize {
        std::fs::read_dir(&self.0).expect("a folder").count()
    }
}

/// What a process said.
pub(crate) struct Said {
    /// Exit code; −1 after a signal.
    pub(crate) code: i32,
    /// Standard output.
    pub(crate) out: String,
    /// Standard error.
    pub(crate) err: String,
}

impl From<Output> for Said {
    fn from(output: Output) -> Said {
        Said {
            code: output.status.code().unwrap_or(-1),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

/// Runs `handc` in a folder.
pub(crate) fn handc(folder: &Folder, arguments: &[&str]) -> Said {
    let mut command = Command::new(env!("CARGO_BIN_EXE_handc"));
    let output = command.args(arguments).current_dir(&folder.0).output();
    output.expect("handc").into()
}

/// The steps of the line that ends every run, whose form is checked.
pub(crate) fn figures(said: &Said) -> usize {
    let last = said.err.trim_end().lines().last().unwrap_or_default();
    let words: Vec<&str> = last.split_whitespace().collect();
    let [a, steps, b, wall, c, d, each, e, newton] = words[..] else { panic!("{}", said.err) };
    assert_eq!([a, b, c, d, e], ["steps", "wall", "s", "us/step", "newton/step"], "{last}");
    for number in [wall, each, newton] {
        assert!(number.parse::<f64>().is_ok_and(|x| x >= 0.0), "{last}");
    }
    assert!(last.contains("  wall ") && last.contains(" s  us/step "), "{last}");
    steps.parse().expect("steps")
}

/// Header and rows of a table of numbers, all of one width.
pub(crate) fn table(text: &str) -> (String, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let header = lines.next().expect("a header").to_string();
    let width = header.split(',').count();
    let number = |cell: &str| cell.parse().unwrap_or_else(|_| panic!("`{cell}`"));
    let rows: Vec<Vec<f64>> = lines.map(|l| l.split(',').map(number).collect()).collect();
    assert!(rows.iter().all(|row| row.len() == width), "rows of different width");
    assert!(text.ends_with('\n'), "the last row is cut off");
    (header, rows)
}
