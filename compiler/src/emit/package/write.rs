//! Writing a crate to disk.

use super::manifest::MARKER;
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A file of the crate: path inside it, with `/`, and text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Path.
    pub path: String,
    /// Text.
    pub text: String,
}

/// Why a crate was not written.
#[derive(Debug)]
pub enum WriteError {
    /// The folder holds something else; nothing was touched.
    Foreign(PathBuf),
    /// A file or folder could not be read or written.
    Io(PathBuf, io::Error),
}

impl fmt::Display for WriteError {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            WriteError::Foreign(path) => write!(
                formatter,
                "`{}` holds files that are not a generated crate\n  try: another folder with \
                 `--out`, or `--force` to write there all the same",
                path.display()
            ),
            WriteError::Io(path, error) => {
                write!(formatter, "cannot write `{}`: {error}", path.display())
            }
        }
    }
}

impl std::error::Error for WriteError {}

/// Writes the files of a crate and returns how many changed.
///
/// A folder that is neither empty nor a generated crate is refused unless `force`. Each file is
/// written beside its place and moved there; equal files are left alone, so that cargo does not
/// build them again. Generated files that no longer belong to the crate are removed.
pub fn write_crate(folder: &Path, files: &[File], force: bool) -> Result<usize, WriteError> {
    if !force && !is_ours(folder)? {
        return Err(WriteError::Foreign(folder.to_owned()));
    }
    let mut changed = 0;
    // The manifest carries the mark by which the folder is known, so it comes first.
    for file in files {
        let path = folder.join(&file.path);
        if fs::read(&path).is_ok_and(|text| text == file.text.as_bytes()) {
            continue;
        }
        replace(&path, &file.text).map_err(|error| WriteError::Io(path, error))?;
        changed += 1;
    }
    let source = folder.join("src");
    remove_stale(&source, folder, files).map_err(|error| WriteError::Io(source, error))?;
    Ok(changed)
}

/// Whether the folder is missing, empty or a generated crate.
fn is_ours(folder: &Path) -> Result<bool, WriteError> {
    let mut entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(true),
        Err(error) => return Err(WriteError::Io(folder.to_owned(), error)),
    };
    Ok(entries.next().is_none() || is_marked(&folder.join("Cargo.toml")))
}

/// Whether the file's first line carries the mark.
fn is_marked(path: &Path) -> bool {
    fs::read_to_string(path)
        .is_ok_and(|text| text.lines().next().is_some_and(|line| line.contains(MARKER)))
}

fn replace(path: &Path, text: &str) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let mut beside = path.as_os_str().to_owned();
    beside.push(".new");
    let beside = PathBuf::from(beside);
    fs::write(&beside, text)?;
    fs::rename(&beside, path).inspect_err(|_| drop(fs::remove_file(&beside)))
}

/// Removes marked sources that are not among `files`.
fn remove_stale(folder: &Path, root: &Path, files: &[File]) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            remove_stale(&path, root, files)?;
            continue;
        }
        let is_kept = files.iter().any(|file| root.join(&file.path) == path);
        let is_source = path.extension().is_some_and(|extension| extension == "rs");
        if !is_kept && is_source && is_marked(&path) {
            fs::remove_file(&path)?;
        }
    }
    Ok(())
}
