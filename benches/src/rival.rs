//! MuJoCo's side: one Python process that answers requests, a line each way.

use handc_tests::load::repository;
use handc_tests::python::environment;
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// MuJoCo, ready to be asked.
#[derive(Debug)]
pub(crate) struct Rival {
    child: Child,
    to: Option<ChildStdin>,
    from: BufReader<ChildStdout>,
}

impl Rival {
    /// Sets up the environment if need be, and starts the process.
    pub(crate) fn start(folder: &Path) -> Result<Self, String> {
        let requirements = repository("tests/witness/requirements.txt");
        let python = environment(&folder.join("venv"), &requirements)?;
        let script = repository("benches/rival.py").canonicalize().map_err(|e| e.to_string())?;
        let mut child = Command::new(python)
            .arg(script)
            // MuJoCo writes its log where it runs.
            .current_dir(folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| e.to_string())?;
        let (to, from) = (child.stdin.take(), child.stdout.take());
        let from = BufReader::new(from.ok_or("no pipe")?);
        Ok(Rival { child, to, from })
    }

    /// Asks; the answer is what Python made of it.
    pub(crate) fn ask(&mut self, request: &Value) -> Result<Value, String> {
        let to = self.to.as_mut().ok_or("closed")?;
        writeln!(to, "{request}").and_then(|()| to.flush()).map_err(|e| e.to_string())?;
        let mut line = String::new();
        self.from.read_line(&mut line).map_err(|e| e.to_string())?;
        let answer: Value = serde_json::from_str(&line).map_err(|_| "no answer".to_string())?;
        match answer.get("error").and_then(Value::as_str) {
            Some(error) => Err(error.to_string()),
            None if answer["diverged"] == true => Err("diverges".into()),
            None => Ok(answer),
        }
    }
}

impl Drop for Rival {
    fn drop(&mut self) {
        // The process ends with its input.
        self.to = None;
        let _ = self.child.wait();
    }
}
