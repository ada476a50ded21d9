//! Torques on coordinates and forces at points, given by expressions.
//!
//! An expression brings its derivatives along ([`Function`]); the chain rule through strand lengths
//! and through the motion of the point is done here. With p_j the derivative of the point by
//! coordinate j and ω_j the axis of its joint, F_j = f·p_j and ∂F_j/∂q_k = f·(ω_outer × p_inner) for
//! a force in world axes; one fixed in a link turns with it, ∂f/∂q_k = ω_k × f.

use super::{At, Mechanics, Terms, Workspace};
use crate::expression::{Function, Variable};
use crate::vector::Vec3;
use handc_core::scalar::Scalar;

/// Derivatives of a function of the state: by coordinate, by rate, and by what the strand that owns
/// it does ([`Own`](crate::expression::Own)).
#[derive(Clone, Debug)]
pub(crate) struct Slopes<S> {
    pub(crate) dq: Vec<(usize, S)>,
    pub(crate) dv: Vec<(usize, S)>,
    pub(crate) own: [S; 3],
}

impl<S: Scalar> Mechanics<'_, S> {
    fn read(&self, workspace: &Workspace<S>, at: &At<S>, variable: Variable) -> S {
        match variable {
            Variable::Time => at.t,
            Variable::Param(i) => self.numbers.params[i as usize],
            Variable::Input(i) => at.inputs[i as usize],
            Variable::Coordinate(i) => at.q[i as usize],
            Variable::Rate(i) => at.v[i as usize],
            Variable::Length(i) => workspace.strand.lengths[i as usize],
            Variable::Multiplier(_) | Variable::Own(_) | Variable::Strand(..) => S::zero(),
        }
    }

    /// Value of a function of the state, and its derivatives if `slopes`.
    fn function(
        &self,
        workspace: &mut Workspace<S>,
        at: &At<S>,
        function: &Function,
        slopes: bool,
    ) -> (S, Slopes<S>) {
        self.function_of(workspace, at, function, [S::zero(); 3], slopes)
    }

    /// As [`Mechanics::function`], for one that belongs to a strand which does `own`.
    pub(crate) fn function_of(
        &self,
        workspace: &mut Workspace<S>,
        at: &At<S>,
        function: &Function,
        own: [S; 3],
        slopes: bool,
    ) -> (S, Slopes<S>) {
        let mut values = std::mem::take(&mut workspace.values);
        let read = |variable| match variable {
            Variable::Own(which) => own[which as usize],
            other => self.read(workspace, at, other),
        };
        function.program.evaluate(read, &mut values);
        let value = function.program.output(&values, 0);
        let mut found = Slopes { dq: Vec::new(), dv: Vec::new(), own: [S::zero(); 3] };
        if slopes {
            for (k, variable) in function.gradient.iter().enumerate() {
                let slope = function.program.output(&values, k + 1);
                match *variable {
                    Variable::Coordinate(i) => found.dq.push((i as usize, slope)),
                    Variable::Rate(i) => found.dv.push((i as usize, slope)),
                    Variable::Own(which) => found.own[which as usize] = slope,
                    Variable::Length(s) => {
                        let path = &self.structure.strands[s as usize];
                        let length_dq = &workspace.strand.length_dq[path.span.clone()];
                        for (&coordinate, &dq) in path.coordinates.iter().zip(length_dq) {
                            found.dq.push((coordinate, slope * dq));
                        }
                    }
                    _ => {}
                }
            }
        }
        workspace.values = values;
        (value, found)
    }

    /// Value and coordinate derivatives of a constraint's function; strand lengths must be current.
    pub(crate) fn equation(
        &self,
        workspace: &mut Workspace<S>,
        q: &[S],
        t: S,
        function: &Function,
        slopes: bool,
    ) -> (S, Vec<(usize, S)>) {
        let at = At { q, v: &[], t, rest: &[], inputs: &[] };
        let (value, slopes) = self.function(workspace, &at, function, slopes);
        (value, slopes.dq)
    }

    fn add_slopes(&self, terms: &mut Terms<S>, row: usize, weight: S, slopes: &Slopes<S>) {
        let Some((h, _)) = terms.matrix else { return };
        let quarter = h.scale(0.25);
        for &(column, slope) in &slopes.dq {
            terms.add(self.structure, row, column, quarter * weight * slope);
        }
        for &(column, slope) in &slopes.dv {
            let half = S::constant(0.5 * self.structure.rate_weight(column));
            terms.add(self.structure, row, column, half * weight * slope);
        }
    }

    /// Adds the torques; strand lengths must be current.
    pub(crate) fn add_torques(
        &self,
        workspace: &mut Workspace<S>,
        at: &At<S>,
        terms: &mut Terms<S>,
    ) {
        let wanted = terms.matrix.is_some();
        for torque in &self.mechanism.torques {
            let (value, slopes) = self.function(workspace, at, &torque.value, wanted);
            let row = torque.coordinate as usize;
            terms.force[row] += value;
            self.add_slopes(terms, row, S::one(), &slopes);
        }
    }

    /// Adds the forces at points.
    pub(crate) fn add_forces(
        &self,
        workspace: &mut Workspace<S>,
        at: &At<S>,
        terms: &mut Terms<S>,
    ) {
        if self.mechanism.forces.is_empty() {
            return;
        }
        self.world_links(workspace, at.q, |link| self.structure.world_links[link]);
        let wanted = terms.matrix.is_some();
        for force in &self.mechanism.forces {
            let components =
                [0, 1, 2].map(|i| self.function(workspace, at, &force.value[i], wanted));
            let world_from_axes = self.world_from(workspace, force.axes).rotation;
            let f = world_from_axes * Vec3([0, 1, 2].map(|i| components[i].0));
            let point = self.numbers.vector(&force.point.position);
            let point = self.world_from(workspace, force.point.link).point(point);
            let chain = self.structure.chain(force.point.link);
            for (inner, &j) in chain.iter().enumerate() {
                let row = self.structure.coordinate_of[j as usize];
                let p_j = self.point_dq(workspace, j, point);
                terms.force[row] += f.dot(p_j);
                let Some((h, _)) = terms.matrix else { continue };
                let quarter = h.scale(0.25);
                for &k in &chain[inner..] {
                    let column = self.structure.coordinate_of[k as usize];
                    let value = f.dot(workspace.world[k as usize].angular.cross(p_j)) * quarter;
                    terms.add(self.structure, row, column, value);
                    if k != j {
                        terms.add(self.structure, column, row, value);
                    }
                }
                for k in self.structure.chain(force.axes) {
                    let column = self.structure.coordinate_of[k as usize];
                    let turned = workspace.world[k as usize].angular.cross(f);
                    terms.add(self.structure, row, column, turned.dot(p_j) * quarter);
                }
                for (i, (_, slopes)) in components.iter().enumerate() {
                    let weight = world_from_axes.column(i).dot(p_j);
                    self.add_slopes(terms, row, weight, slopes);
                }
            }
        }
    }
}
