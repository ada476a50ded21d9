//! A virtual environment with the Python packages that some checks ask for.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Interpreters that may make the environment, in order.
const PYTHONS: [&str; 3] = ["python3.11", "python3", "python"];

/// The interpreter of an environment in `folder` with the packages of a requirements file, made if
/// it is not there yet; or why there is none.
pub fn environment(folder: &Path, requirements: &Path) -> Result<PathBuf, String> {
    let wanted = std::fs::read_to_string(requirements).map_err(|e| e.to_string())?;
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let stamp = folder.join("requirements.txt");
    if python.exists() && std::fs::read_to_string(&stamp).is_ok_and(|made| made == wanted) {
        return Ok(python);
    }
    let mut reason = "there is no Python".to_string();
    let made = PYTHONS.iter().any(|maker| {
        match run(Command::new(maker).args(["-m", "venv", "--clear"]).arg(folder)) {
            Ok(()) => true,
            Err(said) => {
                reason = format!("`{maker} -m venv` fails: {said}");
                false
            }
        }
    });
    if !made {
        return Err(reason);
    }
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--retries", "1"];
    let from = ["--timeout", "20", "--only-binary", ":all:", "--requirement"];
    run(Command::new(&python).args(pip).args(from).arg(requirements))
        .map_err(|said| format!("pip cannot install the packages: {said}"))?;
    std::fs::write(&stamp, wanted).map_err(|e| e.to_string())?;
    Ok(python)
}

/// Runs a command; an error is the last line that it wrote.
fn run(command: &mut Command) -> Result<(), String> {
    let output = command.output().map_err(|e| e.to_string())?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    Err(said.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("no reason").to_string())
}
