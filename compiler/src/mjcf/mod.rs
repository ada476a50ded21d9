//! A mechanism as a MuJoCo model (MJCF).
//!
//! handc's coordinates are the joints' positions in MuJoCo, name by name, with zero at zero: a
//! joint of several coordinates is as many hinges and slides. Strands are spatial tendons through
//! sites, constraints are equalities, torques and forces are actuators, and the start is the key
//! `start`. Parameters stand at their values. What MJCF cannot say is collected as warnings with
//! the model's names; the file can be loaded nevertheless.

mod bodies;
mod equality;
mod inertia;
mod joint;
mod law;
mod load;
mod names;
mod start;
mod tendon;
mod tree;
mod xml;

use bodies::BodyPlan;
use handc_core::error::RunError;
use handc_core::model::Model;
use handc_core::simulation::Settings;
use handc_runtime::mechanism::Mechanism;
use handc_runtime::resolved::Resolved;
use handc_runtime::structure::Structure;
use names::Names;
use start::Start;
use std::sync::Arc;
use tree::Matter;
use xml::Element;

/// A MuJoCo model and what it does not say.
#[derive(Clone, Debug, PartialEq)]
pub struct Mjcf {
    /// The file.
    pub text: String,
    /// What the file cannot say or says otherwise, one sentence each.
    pub warnings: Vec<String>,
    /// Choices that were made.
    pub notes: Vec<String>,
}

/// Writes a mechanism as MJCF, with the parameters, start and step that a run with these settings
/// would have. The duration is not read. Of several scenarios the first is taken if none is named.
pub fn export(mechanism: &Arc<Mechanism>, settings: &Settings) -> Result<Mjcf, RunError> {
    let start = start::start(mechanism, settings)?;
    let structure = Structure::new(mechanism);
    let (bodies, is_body) = bodies::plan(mechanism, &structure);
    let links = mechanism.links.len();
    let mut exporter = Exporter {
        mechanism,
        numbers: Resolved::new(mechanism, start.model.params()),
        warnings: Vec::new(),
        start,
        structure,
        bodies,
        is_body,
        sites: vec![Vec::new(); links + 1],
        body_names: vec![String::new(); links],
        body_taken: Names::default(),
        site_names: Names::default(),
        geom_names: Names::default(),
        tendon_names: Names::default(),
        equality_names: Names::default(),
        actuator_names: Names::default(),
        world_site: String::new(),
        tendons: Vec::new(),
        equalities: Vec::new(),
        actuators: Vec::new(),
        advances: Vec::new(),
        screws: Vec::new(),
        elastic_limits: Vec::new(),
        matter: Matter::default(),
    };
    Ok(exporter.run())
}

/// An export in the making.
struct Exporter<'a> {
    mechanism: &'a Mechanism,
    numbers: Resolved<f64>,
    start: Start,
    structure: Structure,
    bodies: Vec<BodyPlan>,
    /// For every link, whether it has a body of its own.
    is_body: Vec<bool>,
    /// Sites and surfaces of the world, then of every link.
    sites: Vec<Vec<Element>>,
    /// For every link with a body, the body's name.
    body_names: Vec<String>,
    body_taken: Names,
    site_names: Names,
    geom_names: Names,
    tendon_names: Names,
    equality_names: Names,
    actuator_names: Names,
    /// Name of the site at the world's origin, once it is needed.
    world_site: String,
    tendons: Vec<Element>,
    equalities: Vec<Element>,
    /// Actuators with their control at the start.
    actuators: Vec<(Element, f64)>,
    /// Slides of screws with their positions (m) and rates (m/s) at the start.
    advances: Vec<(String, f64, f64)>,
    screws: Vec<String>,
    elastic_limits: Vec<String>,
    matter: Matter,
    warnings: Vec<String>,
}

impl Exporter<'_> {
    fn run(&mut self) -> Mjcf {
        self.name_frames();
        self.strands();
        self.constraints();
        self.loads();
        let world = self.world();
        self.tell_of_joints();
        self.hold_driven();
        let step = self.start.step;
        let gravity = self.numbers.vector(&self.mechanism.gravity).0;
        // Numbers stay as they are written: nothing is inferred, balanced, bounded or merged.
        let compiler = Element::new("compiler")
            .with("angle", "radian")
            .with("autolimits", "false")
            .with("inertiafromgeom", "false")
            .with("balanceinertia", "false")
            .with("boundmass", "0")
            .with("boundinertia", "0")
            .with("fusestatic", "false");
        let option = Element::new("option")
            .with_numbers("timestep", &[step])
            .with_numbers("gravity", &gravity);
        // As stiff as MuJoCo allows at this step; handc's constraints are rigid.
        let stiff = Element::new("equality")
            .with_numbers("solref", &[2.0 * step, 1.0])
            .with_numbers("solimp", &[0.9999, 0.9999, 0.001, 0.5, 2.0]);
        let mut parts = vec![compiler, option];
        if !self.equalities.is_empty() {
            parts.push(Element::new("default").with_children([stiff]));
        }
        let actuators = self.actuators.iter().map(|(element, _)| element.clone());
        let key = Element::new("keyframe").with_children([self.key(&world)]);
        let sections = [
            world,
            Element::new("tendon").with_children(std::mem::take(&mut self.tendons)),
            Element::new("equality").with_children(std::mem::take(&mut self.equalities)),
            Element::new("actuator").with_children(actuators),
            key,
        ];
        parts.extend(sections.into_iter().filter(|section| !section.is_empty()));
        let root = Element::new("mujoco")
            .with("model", &self.mechanism.name)
            .with_comment(self.opening())
            .with_children(parts);
        Mjcf {
            text: root.document(),
            warnings: self.warnings.clone(),
            notes: self.start.notes.clone(),
        }
    }

    /// The start, in the order of MuJoCo's joints.
    fn key(&self, world: &Element) -> Element {
        let (mut qpos, mut qvel) = (Vec::new(), Vec::new());
        for name in world.named("joint") {
            let coordinate = self.mechanism.coordinates.iter().position(|c| c.name == name);
            let advance = self.advances.iter().find(|(slide, ..)| slide == name);
            let (q, v) = match (coordinate, advance) {
                (Some(i), _) => (self.start.q[i], self.start.v[i]),
                (None, Some(&(_, q, v))) => (q, v),
                (None, None) => (0.0, 0.0),
            };
            qpos.push(q);
            qvel.push(v);
        }
        let key = Element::new("key").with("name", "start").with_numbers("qpos", &qpos);
        let key = key.with_numbers("qvel", &qvel);
        if self.actuators.is_empty() {
            return key;
        }
        let controls: Vec<f64> = self.actuators.iter().map(|(_, control)| *control).collect();
        key.with_numbers("ctrl", &controls)
    }

    /// The comment that opens the file.
    fn opening(&self) -> Vec<String> {
        let name = &self.mechanism.name;
        let mut lines =
            vec![format!("The handc model `{name}` for MuJoCo. Units: m, kg, s, rad, N.")];
        lines.extend(self.mechanism.doc.lines().map(|line| line.trim().to_string()));
        lines.extend(self.start.notes.iter().cloned());
        if !self.warnings.is_empty() {
            lines.push(String::new());
            lines.push("What this file cannot say, or says otherwise:".into());
            lines.extend(self.warnings.iter().map(|warning| format!("* {warning}")));
        }
        lines
    }

    fn warn(&mut self, warning: String) {
        self.warnings.push(warning);
    }

    /// One warning about several things, if there are any.
    fn warn_of(&mut self, what: &str, names: &[impl AsRef<str>]) {
        if !names.is_empty() {
            let names: Vec<String> = names.iter().map(|n| format!("`{}`", n.as_ref())).collect();
            self.warn(format!("{}: {what}", names.join(", ")));
        }
    }
}
