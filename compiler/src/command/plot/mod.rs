//! `handc plot`: figures of a trajectory, or of a model that is run for them.

mod series;
pub(crate) mod skeleton;

use handc_core::simulation::Settings;
use handc_dsl::hir;
use handc_plot::{Picture, TimePlot, save, table};
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::Mechanism;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What to draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlotOptions {
    /// A trajectory (`.csv`) or a model.
    pub file: PathBuf,
    /// Folder that imports may not leave.
    pub root: Option<PathBuf>,
    /// Where figures go, without extension; `None`: beside the file, under its name.
    pub out: Option<PathBuf>,
    /// Scenario, parameters, step and duration of a model's run.
    pub settings: Settings,
}

/// Draws figures: `STEM.svg` and `STEM.png` over time, and for a model `STEM.pose.svg` and
/// `STEM.pose.png`.
pub fn plot(options: &PlotOptions) -> u8 {
    let is_table = options.file.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    if is_table {
        return match of_table(options) {
            Ok(()) => 0,
            Err(message) => {
                eprintln!("error: {message}");
                2
            }
        };
    }
    match super::mechanism(&options.file, options.root.as_deref()) {
        Ok((checked, mechanism)) => match &checked.model {
            Some(model) => of_model(options, model, mechanism),
            None => 1,
        },
        Err(code) => code,
    }
}

/// Path of a figure without extension.
fn stem(options: &PlotOptions) -> PathBuf {
    options.out.clone().unwrap_or_else(|| options.file.with_extension(""))
}

fn with_suffix(stem: &Path, suffix: &str) -> PathBuf {
    let mut name = stem.as_os_str().to_os_string();
    name.push(suffix);
    PathBuf::from(name)
}

fn write(picture: &dyn Picture, stem: &Path) -> Result<(), String> {
    let paths = save(picture, stem)?;
    paths.iter().for_each(|path| eprintln!("wrote {}", path.display()));
    Ok(())
}

fn of_table(options: &PlotOptions) -> Result<(), String> {
    let settings = &options.settings;
    if *settings != Settings::default() {
        return Err(
            "`--scenario`, `--set`, `--step` and `--duration` need a model, not a CSV".into()
        );
    }
    let name = options.file.display();
    let file = std::fs::File::open(&options.file)
        .map_err(|error| format!("cannot read `{name}`: {error}"))?;
    let table = table::read(std::io::BufReader::with_capacity(1 << 20, file))
        .map_err(|error| format!("`{name}`: {error}"))?;
    let title = options.file.file_stem().unwrap_or_default().to_string_lossy();
    let plot = table.plot(&title);
    if plot.quantities.iter().all(|quantity| quantity.curves.is_empty()) {
        return Err(format!("`{name}`: there is no column to draw beside the time"));
    }
    write(&plot, &stem(options))
}

fn of_model(options: &PlotOptions, model: &hir::Model, mechanism: Mechanism) -> u8 {
    let mechanism = Arc::new(mechanism);
    let mut run = match series::run(Interpreter::new(mechanism), &options.settings) {
        Ok(run) => run,
        Err(error) => {
            eprintln!("error: {error}");
            return error.exit_code() as u8;
        }
    };
    let scenario = run.simulation.scenario().and_then(|s| model.scenarios.get(s));
    let title = match scenario {
        Some(scenario) => format!("{}: {}", model.name.text, scenario.name.text),
        None => model.name.text.clone(),
    };
    let quantities = series::quantities(&run, model);
    let plot = TimePlot { title: title.clone(), time: run.time.clone(), quantities };
    let poses = skeleton::figure(&mut run, model, title);
    let stem = stem(options);
    let written = write(&plot, &stem).and_then(|()| write(&poses, &with_suffix(&stem, ".pose")));
    if let Err(message) = written {
        eprintln!("error: {message}");
        return 3;
    }
    match run.failure {
        None => 0,
        Some(error) => {
            eprintln!("error: {error}\nthe figures show the run up to there");
            error.exit_code() as u8
        }
    }
}
