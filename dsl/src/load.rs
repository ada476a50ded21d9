//! Reads a file and what it imports, and never anything outside the root.

use crate::ast::{Decl, DeclKind, File, Ident};
use crate::diagnostic::Diagnostic;
use crate::guard::{MAX_BYTES, too_large};
use crate::parse::parse;
use crate::read::{read, reason};
use crate::source::{FileId, SourceMap, Span};
use std::path::{Component, Path, PathBuf};

/// Most files of one compilation.
const MAX_FILES: usize = 256;

/// A parsed file.
pub(crate) struct Parsed {
    pub(crate) file: File,
    /// Indices of the files it imports.
    pub(crate) imports: Vec<usize>,
}

/// All files of a compilation; the first is the one given.
pub(crate) struct Loader {
    pub(crate) sources: SourceMap,
    pub(crate) parsed: Vec<Parsed>,
    pub(crate) out: Vec<Diagnostic>,
    /// Canonical path of each parsed file.
    paths: Vec<PathBuf>,
    /// The files being read, each importing the next.
    trail: Vec<usize>,
    /// What imports may not leave; `None` where nothing may be imported.
    root: Option<PathBuf>,
}

impl Loader {
    /// Parses a text that has no folder, so imports nothing.
    pub(crate) fn from_text(name: &str, text: &str) -> Loader {
        let mut loader = Loader::new();
        if text.len() > MAX_BYTES {
            let file = loader.sources.add(name, "");
            let span = Span::new(file, 0, 0);
            loader.out.push(too_large(span, &format!("`{name}`"), text.len() as u64));
            return loader;
        }
        loader.parse(name, text, PathBuf::new());
        loader
    }

    /// Parses a file and its imports.
    pub(crate) fn from_file(path: &Path, root: Option<&Path>) -> Loader {
        let mut loader = Loader::new();
        let shown = path.display().to_string();
        let canonical = match path.canonicalize() {
            Ok(canonical) => canonical,
            Err(error) => {
                loader.unreadable(&shown, &format!("cannot read `{shown}`: {}", reason(&error)));
                return loader;
            }
        };
        let folder = canonical.parent().unwrap_or(Path::new("/")).to_path_buf();
        match root.map(Path::canonicalize) {
            None => loader.root = Some(folder),
            Some(Ok(root)) => loader.root = Some(root),
            Some(Err(error)) => {
                let root = root.map(|r| r.display().to_string()).unwrap_or_default();
                let reason = reason(&error);
                loader.unreadable(&shown, &format!("cannot read the root `{root}`: {reason}"));
                return loader;
            }
        }
        match read(&canonical) {
            Ok(text) => {
                loader.parse(&shown, &text, canonical);
            }
            Err(problem) => {
                let file = loader.sources.add(&*shown, "");
                loader.out.push(problem.diagnostic(Span::new(file, 0, 0), &shown));
            }
        }
        loader
    }

    fn new() -> Loader {
        Loader {
            sources: SourceMap::default(),
            parsed: Vec::new(),
            out: Vec::new(),
            paths: Vec::new(),
            trail: Vec::new(),
            root: None,
        }
    }

    fn unreadable(&mut self, path: &str, message: &str) {
        let file = self.sources.add(path, "");
        self.out.push(Diagnostic::error("cannot-read", Span::new(file, 0, 0), message));
    }

    fn parse(&mut self, name: &str, text: &str, canonical: PathBuf) -> usize {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let id: FileId = self.sources.add(name, text);
        let file = parse(text, id, &mut self.out);
        let mut imports: Vec<(String, Span)> = Vec::new();
        collect_imports(&file.items, &mut imports);
        let index = self.parsed.len();
        self.parsed.push(Parsed { file, imports: Vec::new() });
        self.paths.push(canonical);
        self.trail.push(index);
        for (path, span) in imports {
            if let Some(import) = self.import(index, name, &path, span)
                && !self.parsed[index].imports.contains(&import)
            {
                self.parsed[index].imports.push(import);
            }
        }
        self.trail.pop();
        index
    }

    fn import(&mut self, from: usize, name: &str, path: &str, span: Span) -> Option<usize> {
        let Some(root) = self.root.clone() else {
            let message = "a text that is no file cannot import";
            self.out.push(Diagnostic::error("import", span, message));
            return None;
        };
        let folder = self.paths[from].parent()?.to_path_buf();
        let outside = || {
            Diagnostic::error("import-outside", span, format!("`{path}` lies outside of the model's folder"))
                .help("an import stays in the folder of the file given on the command line, or of `--root`")
        };
        let relative = Path::new(path);
        let plain = |c: Component<'_>| {
            matches!(c, Component::Normal(_) | Component::CurDir | Component::ParentDir)
        };
        if path.is_empty() || !relative.components().all(plain) || path.contains('\\') {
            let message = format!("`{path}` is not a path relative to this file");
            self.out.push(
                Diagnostic::error("import", span, message)
                    .help("write `import \"folder/file.hdl\";`"),
            );
            return None;
        }
        // Looked at as text first, so that nothing outside is even asked for.
        if !normal(&folder.join(relative)).starts_with(&root) {
            self.out.push(outside());
            return None;
        }
        let canonical = match folder.join(relative).canonicalize() {
            Ok(canonical) => canonical,
            Err(error) => {
                let message = format!("cannot read `{path}`: {}", reason(&error));
                self.out.push(Diagnostic::error("cannot-read", span, message));
                return None;
            }
        };
        if !canonical.starts_with(&root) {
            self.out.push(outside());
            return None;
        }
        if let Some(known) = self.paths.iter().position(|p| *p == canonical) {
            if let Some(start) = self.trail.iter().position(|&i| i == known) {
                let mut names: Vec<String> =
                    self.trail[start..].iter().map(|&i| file_name(&self.paths[i])).collect();
                names.push(file_name(&canonical));
                let message = format!("files import each other: {}", names.join(" -> "));
                self.out.push(Diagnostic::error("import-cycle", span, message));
                return None;
            }
            return Some(known);
        }
        if self.parsed.len() >= MAX_FILES {
            let message = format!("more than {MAX_FILES} files are imported");
            self.out.push(Diagnostic::error("too-large", span, message));
            return None;
        }
        match read(&canonical) {
            Ok(text) => {
                let shown = Path::new(name).parent().unwrap_or(Path::new("")).join(relative);
                Some(self.parse(&shown.display().to_string(), &text, canonical))
            }
            Err(problem) => {
                self.out.push(problem.diagnostic(span, path));
                None
            }
        }
    }
}

fn collect_imports(items: &[Decl], out: &mut Vec<(String, Span)>) {
    for item in items {
        match &item.kind {
            DeclKind::Import(path) => {
                let Ident { span, .. } = item.name;
                out.push((path.clone(), span));
            }
            DeclKind::Model(body) => collect_imports(body, out),
            _ => {}
        }
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}

/// A path without `.` and `..`, by text alone.
fn normal(path: &Path) -> PathBuf {
    let mut result = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                result.pop();
            }
            Component::CurDir => {}
            other => result.push(other),
        }
    }
    result
}
