//! Nodes: free points that strands share.
//!
//! A node is entered like a joint of up to three translations, along the axes of the frame it is in.
//! Its coordinates are its position in that frame, so it starts at the position it is declared at;
//! tied to a plane or a line of the frame it keeps the others.

use super::Checker;
use super::depend::May;
use super::expect::named_axis;
use super::range::NOT_NEGATIVE;
use super::scope::{Entry, ScopeId};
use super::{Item, constant, number, zero_vector};
use crate::ast::{self, Block, DeclKind, ExprKind as Ast};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{self, Coordinate, JointKind, MassKind, MotionKind, Name, Placement};
use std::ops::Range;

const OPTIONS: [&str; 4] = ["mass", "on", "velocity", "damping"];
const AXES: [&str; 3] = ["x", "y", "z"];

/// Axes of its frame along which a node moves; `None` if what is written makes no sense.
fn free_axes(block: &Block) -> Option<[bool; 3]> {
    let on = block.settings.iter().find(|s| matches!(&s.name.parts[..], [n] if n.text == "on"));
    let Some(on) = on else { return Some([true; 3]) };
    let Ast::Call(word, arguments) = &on.value.kind else { return None };
    let [axis] = arguments.as_slice() else { return None };
    let axis = named_axis(axis)?.iter().position(|&a| a != 0.0)?;
    match word.text.as_str() {
        "plane" => Some([0, 1, 2].map(|i| i != axis)),
        "line" => Some([0, 1, 2].map(|i| i == axis)),
        _ => None,
    }
}

impl<'a> Checker<'a> {
    pub(super) fn enter_node(
        &mut self,
        scope: ScopeId,
        item: Item<'a>,
        placement: &'a ast::Placement,
        block: &'a Block,
    ) -> Entry {
        let free = free_axes(block).unwrap_or([true; 3]);
        let parts: Vec<&str> = AXES.iter().zip(free).filter(|a| a.1).map(|a| *a.0).collect();
        self.enter_moving(scope, item, Some(JointKind::Node), &parts, placement)
    }

    fn node_axes(&self, joint: usize) -> Option<[bool; 3]> {
        match &self.joints[joint].item.decl.kind {
            DeclKind::Node(_, block) => Some(free_axes(block).unwrap_or([true; 3])),
            _ => None,
        }
    }

    /// What is constant in a node's place: its position along the axes it cannot move along.
    pub(super) fn node_placement(&mut self, joint: usize, placement: Placement) -> Placement {
        let Some(free) = self.node_axes(joint) else { return placement };
        let mut at = placement.at.clone();
        for (value, free) in at.iter_mut().zip(free) {
            if free {
                *value = number(0.0, Dimension::LENGTH, value.span);
            }
        }
        self.node_positions.insert(joint, placement.at);
        Placement { at, rotations: placement.rotations }
    }

    /// Its coordinates and their options.
    pub(super) fn node(
        &mut self,
        scope: ScopeId,
        joint: usize,
        name: &Name,
        block: &'a Block,
        range: Range<usize>,
    ) -> Vec<Coordinate> {
        let options = self.options(block, "a node", &OPTIONS);
        if let Some(on) = options.get("on")
            && free_axes(block).is_none()
        {
            let message = "a node is on a plane or a line of its frame";
            let error = Diagnostic::error("node", on.span, message);
            self.report(error.help(
                "write `on = plane(z)` with the plane's normal, or `on = line(x)`, along an axis of \
                 the frame; put the node in a turned frame for another direction",
            ));
        }
        let free = self.node_axes(joint).unwrap_or([true; 3]);
        let axes: Vec<usize> = (0..3).filter(|&i| free[i]).collect();
        let motions = axes.iter().map(|&axis| {
            let unit = |i| number(if i == axis { 1.0 } else { 0.0 }, Dimension::NONE, name.span);
            (MotionKind::Prismatic, [0, 1, 2].map(unit))
        });
        let mut own = self.bare_coordinates(joint, name, motions.collect(), range.start);
        if let Some(position) = self.node_positions.get(&joint) {
            for (coordinate, &axis) in own.iter_mut().zip(&axes) {
                coordinate.start = position[axis].clone();
            }
        }
        self.coordinate_options(scope, &options, &mut own, &name.text);
        own
    }

    /// Point masses of the nodes that have one.
    pub(super) fn finish_node_masses(&mut self) -> Vec<hir::Mass> {
        let mut masses = Vec::new();
        for index in 0..self.joints.len() {
            let raw = &self.joints[index];
            let DeclKind::Node(_, block) = &raw.item.decl.kind else { continue };
            let (scope, name, span) = (raw.item.scope, raw.item.name.clone(), raw.item.decl.span);
            let frame = self.frame_ids[raw.frame];
            let mass = block.settings.iter().find(|s| s.name.parts[0].text == "mass");
            let Some(mass) = mass else { continue };
            let what = "`mass` of a node";
            let Some(mass) = self.expect(scope, &mass.value, Dimension::MASS, what, May::PARAMS)
            else {
                continue;
            };
            self.must(&mass, NOT_NEGATIVE, "a mass cannot be negative");
            if constant(&mass) == Some(0.0) {
                continue;
            }
            let at = zero_vector(Dimension::LENGTH, name.span);
            let kind = MassKind::Explicit { mass, at, inertia: None };
            masses.push(hir::Mass { name, frame, kind, span });
        }
        masses
    }
}
