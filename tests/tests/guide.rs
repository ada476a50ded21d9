//! The guide and the README say what is true: their models run, their commands exist, their links lead somewhere.

use handc::lower::lower;
use handc_core::model::Model;
use handc_core::runner::OPTIONS;
use handc_core::simulation::{Settings, Simulation};
use handc_dsl::check_text;
use handc_runtime::interpreter::Interpreter;
use handc_tests::load::{interpreter, models, repository, said};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::read_to_string;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Steps taken of each scenario of a model in the text.
const STEPS: usize = 100;

/// A document: where it is and what it says.
struct Page {
    path: PathBuf,
    text: String,
}

/// A fenced block: the words after the fence, its text, and its line.
struct Block {
    info: String,
    text: String,
    line: usize,
}

fn read(path: &str) -> Page {
    let path = repository(path);
    let text = read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    Page { path, text }
}

/// Every page of the guide.
fn guide() -> Vec<Page> {
    let folder = repository("docs/guide/src");
    let entries = std::fs::read_dir(&folder).expect("the guide");
    let mut names: Vec<String> = entries
        .map(|entry| entry.expect("a readable folder").file_name().to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".md"))
        .collect();
    names.sort();
    names.iter().map(|name| read(&format!("docs/guide/src/{name}"))).collect()
}

/// Every document of the repository that is for users.
fn pages() -> Vec<Page> {
    let mut pages = guide();
    pages.extend(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(read));
    pages
}

impl Page {
    fn name(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = Vec::new();
        let mut open: Option<Block> = None;
        for (number, line) in self.text.lines().enumerate() {
            match (line.strip_prefix("```"), open.take()) {
                (Some(_), Some(block)) => blocks.push(block),
                (Some(info), None) => {
                    let info = info.trim().to_string();
                    open = Some(Block { info, text: String::new(), line: number + 1 });
                }
                (None, Some(mut block)) => {
                    block.text.push_str(line);
                    block.text.push('\n');
                    open = Some(block);
                }
                (None, None) => {}
            }
        }
        assert!(open.is_none(), "{}: a fence is not closed", self.name());
        blocks
    }

    /// The text without what stands in fences and between backticks.
    fn prose(&self) -> String {
        let mut out = String::new();
        let mut fenced = false;
        for line in self.text.lines() {
            if line.starts_with("```") {
                fenced = !fenced;
            } else if !fenced {
                out.extend(line.split('`').step_by(2));
                out.push('\n');
            }
        }
        out
    }

    /// The names by which headings can be linked to.
    fn anchors(&self) -> BTreeSet<String> {
        let headings = self.text.lines().filter_map(|line| line.strip_prefix('#'));
        headings
            .map(|heading| {
                let heading = heading.trim_start_matches('#').trim().to_lowercase();
                let kept = |c: char| c.is_alphanumeric() || c == '-' || c == ' ' || c == '_';
                heading.chars().filter(|&c| kept(c)).collect::<String>().replace(' ', "-")
            })
            .collect()
    }
}

#[test]
fn models_in_the_text_run() {
    let mut count = 0;
    for page in pages() {
        for block in page.blocks().into_iter().filter(|b| b.info == "hdl") {
            let name = format!("{}:{}", page.name(), block.line);
            let checked = check_text(&name, &block.text);
            let said = said(&checked);
            assert!(said.is_empty(), "{name}\n{said}");
            let model = checked.model.unwrap_or_else(|| panic!("{name} holds no model"));
            let mechanism = lower(&model, &checked.sources);
            let lints = handc::lint::lint(&model, &mechanism);
            assert!(lints.is_empty(), "{name}: {lints:?}");
            let interpreter = Interpreter::new(Arc::new(mechanism));
            assert!(!model.scenarios.is_empty(), "{name} has no scenario");
            for scenario in &model.scenarios {
                let scenario = scenario.name.text.clone();
                let settings = Settings { scenario: Some(scenario.clone()), ..Settings::default() };
                let mut run = Simulation::new(interpreter.clone(), &settings)
                    .unwrap_or_else(|e| panic!("{name}, `{scenario}`: {e}"));
                for _ in 0..run.steps.min(STEPS) {
                    run.step().unwrap_or_else(|e| panic!("{name}, `{scenario}`: {e}"));
                }
                assert!(run.energy().is_finite(), "{name}, `{scenario}`");
            }
            count += 1;
        }
    }
    assert!(count >= 6, "only {count} models found");
}

#[test]
fn models_in_the_text_are_formatted() {
    for page in pages() {
        for block in page.blocks().into_iter().filter(|b| b.info == "hdl") {
            let formatted = handc_dsl::format::format_text(&block.text).expect("a model");
            assert_eq!(block.text, formatted, "{}:{}", page.name(), block.line);
        }
    }
}

/// Subcommands and their long options, as `compiler/src/main.rs` declares them.
fn commands() -> BTreeMap<String, BTreeSet<String>> {
    let text = read("compiler/src/main.rs").text;
    let mut groups: BTreeMap<String, (BTreeSet<String>, Vec<String>)> = BTreeMap::new();
    let mut group = String::new();
    let mut long = false;
    for line in
        text.lines().take_while(|line| !line.starts_with("fn ") && !line.starts_with("impl "))
    {
        let word = line.trim();
        if let Some(name) = word.strip_suffix(" {") {
            group = name.rsplit(' ').next().unwrap_or(name).to_string();
            groups.entry(group.clone()).or_default();
        } else if let Some(argument) = word.strip_prefix("#[arg(") {
            long = argument.starts_with("long");
        } else if let Some((field, kind)) = word.split_once(": ")
            && !field.starts_with("//")
        {
            let (options, flattened) = groups.entry(group.clone()).or_default();
            if std::mem::take(&mut long) {
                options.insert(field.replace('_', "-"));
            }
            flattened.push(kind.trim_end_matches(',').to_string());
        }
    }
    let files = [
        "check", "run", "compile", "dump", "fmt", "new", "plot", "info", "export", "atlas", "pose",
        "strength",
    ];
    let mut commands = BTreeMap::new();
    for name in files {
        let variant = format!("{}{}", name[..1].to_uppercase(), &name[1..]);
        assert!(groups.contains_key(&variant), "no `{name}`");
        // Its own options and those of the groups in it, and of the groups in these.
        let mut seen = vec![variant];
        let mut all = BTreeSet::new();
        let mut next = 0;
        while let Some(kind) = seen.get(next).cloned() {
            next += 1;
            let Some((options, flattened)) = groups.get(&kind) else { continue };
            all.extend(options.iter().cloned());
            for inner in flattened {
                if !seen.contains(inner) {
                    seen.push(inner.clone());
                }
            }
        }
        commands.insert(name.to_string(), all);
    }
    commands
}

/// `--option` or `--option=value` without dashes and value.
fn option(word: &str) -> Option<&str> {
    word.strip_prefix("--").filter(|o| !o.is_empty()).map(|o| o.split('=').next().unwrap_or(o))
}

/// Checks one command line of a document.
fn check_command(line: &str, commands: &BTreeMap<String, BTreeSet<String>>) -> Result<(), String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let rest = match words.as_slice() {
        ["handc", rest @ ..] | ["cargo", "run", "--release", "--", rest @ ..] => rest,
        ["cargo", "run", "--release", "--manifest-path", _, "--", rest @ ..] => {
            for name in rest.iter().filter_map(|word| option(word)) {
                if !OPTIONS.contains(&format!("--{name} ")) {
                    return Err(format!("a runner has no option `--{name}`"));
                }
            }
            return Ok(());
        }
        _ => return Ok(()),
    };
    let Some((command, arguments)) = rest.split_first() else { return Ok(()) };
    let known = commands.get(*command).ok_or_else(|| format!("no command `{command}`"))?;
    for (index, word) in arguments.iter().enumerate() {
        match option(word) {
            Some(name) if !known.contains(name) => {
                return Err(format!("`{command}` has no option `--{name}`"));
            }
            _ => {}
        }
        let is_model = word.starts_with("models/");
        if is_model && !repository(word).exists() {
            return Err(format!("there is no `{word}`"));
        }
        if *word == "--scenario"
            && let Some(name) = arguments.get(index + 1)
            && let Some(model) = arguments.iter().find(|a| a.starts_with("models/"))
        {
            let text = read(model).text;
            if !text.contains(&format!("scenario {name} ")) {
                return Err(format!("`{model}` has no scenario `{name}`"));
            }
        }
    }
    Ok(())
}

#[test]
fn commands_in_the_text_exist() {
    let commands = commands();
    assert!(commands["run"].contains("scenario") && commands["check"].contains("root"));
    for page in pages() {
        for block in page.blocks().into_iter().filter(|b| b.info == "sh") {
            for line in block.text.lines() {
                check_command(line, &commands)
                    .unwrap_or_else(|e| panic!("{}:{}: `{line}`: {e}", page.name(), block.line));
            }
        }
    }
}

#[test]
fn the_readme_opens_with_the_job_and_the_tests() {
    let blocks = read("README.md").blocks();
    let shell: Vec<&str> =
        blocks.iter().filter(|b| b.info == "sh").map(|b| b.text.trim()).take(2).collect();
    assert_eq!(
        shell,
        [
            "cargo run --release -- run models/hand.hdl --out hand.csv",
            "cargo test --release --workspace"
        ]
    );
}

#[test]
fn links_lead_somewhere() {
    for page in pages() {
        let folder = page.path.parent().unwrap_or(Path::new("."));
        let prose = page.prose();
        for target in prose.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if target.starts_with("https://") {
                continue;
            }
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let path = if file.is_empty() { page.path.clone() } else { folder.join(file) };
            assert!(path.exists(), "{}: no `{target}`", page.name());
            if !anchor.is_empty() {
                let text = read_to_string(&path).expect("a page");
                let linked = Page { path, text };
                assert!(linked.anchors().contains(anchor), "{}: no `{target}`", page.name());
            }
        }
    }
}

#[test]
fn the_summary_lists_every_page() {
    let summary = read("docs/guide/src/SUMMARY.md").text;
    for page in guide() {
        let name = page.name();
        assert!(name == "SUMMARY.md" || summary.contains(&format!("({name})")), "{name}");
    }
}

#[test]
fn the_tour_names_every_model_and_scenario() {
    let tour = read("docs/guide/src/models.md").text;
    for path in models("models") {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let lines = || tour.lines().filter(|line| line.contains(&format!("`{name}`")));
        assert!(lines().next().is_some(), "the tour does not name `{name}`");
        if !read_to_string(&path).expect("a model").contains("\nmodel ") {
            continue;
        }
        for scenario in &interpreter(&path).layout().scenarios {
            let named = lines().any(|line| line.contains(&format!("`{}`", scenario.name)));
            assert!(named, "the tour does not name `{}` of `{name}`", scenario.name);
        }
    }
}

/// The kinds of diagnostics that a folder of sources makes.
fn kinds(folder: &Path, found: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() {
            kinds(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = read_to_string(&path).expect("a source");
            for opening in ["Diagnostic::error(", "Diagnostic::warning("] {
                let rest = text.split(opening).skip(1);
                let names = rest.filter_map(|rest| rest.trim_start().strip_prefix('"'));
                found.extend(names.filter_map(|rest| rest.split('"').next()).map(str::to_string));
            }
        }
    }
}

#[test]
fn every_kind_of_diagnostic_is_explained() {
    let mut found = BTreeSet::new();
    kinds(&repository("dsl/src"), &mut found);
    kinds(&repository("compiler/src/lint"), &mut found);
    for entry in std::fs::read_dir(repository("tests/bad")).expect("wrong models") {
        let path = entry.expect("a readable folder").path();
        if path.extension().is_some_and(|e| e == "stderr") {
            let text = read_to_string(&path).expect("a message");
            for line in text.lines() {
                let rest = line.strip_prefix("error[").or_else(|| line.strip_prefix("warning["));
                let kind = rest.and_then(|rest| rest.split(']').next());
                found.extend(kind.map(str::to_string));
            }
        }
    }
    assert!(found.len() > 50, "{found:?}");
    let page = read("docs/guide/src/diagnostics.md").text;
    let missing: Vec<_> =
        found.iter().filter(|kind| !page.contains(&format!("`{kind}`"))).collect();
    assert!(missing.is_empty(), "add to docs/guide/src/diagnostics.md: {missing:?}");
}
