"""Compares strand lengths, moment arms, mass matrices and forces of handc with MuJoCo's.

Usage: compare.py FOLDER [BOUND]

FOLDER/poses.json holds what handc computed (SI units, coordinates in declaration order) and names
the MJCF file of every model. Prints one line for each model with the largest relative differences;
exit code 1 if one exceeds BOUND (default 1e-10). What a difference is relative to:

- of a length, the length;
- of a moment arm, the largest arm of that strand at that pose;
- of an entry (i, j) of the mass matrix, sqrt(M_ii * M_jj); coordinates whose inertia is left out
  for quasi-static strands are not compared, nor is what the export gives to bodies without mass;
- of a generalized force at rest (springs, strands, gravity, torques, forces), the largest one at
  that pose; models with a force that MJCF cannot say have none.
"""

import json
import pathlib
import sys

import mujoco
import numpy as np


# The mass (kg) and moment (kg m^2) that the export gives to bodies without mass.
LEAST = 1e-15


def coordinates_to_joints(model, names):
    """The matrix that takes handc's coordinates to MuJoCo's positions.

    It is a permutation but for screws, whose slide `NAME.advance` is a multiple of the hinge `NAME`:
    the equality that couples them holds the pitch. Fibres and activations of muscles move no joint.
    """
    matrix = np.zeros((model.nv, len(names)))
    for column, name in enumerate(names):
        if not name.endswith((".fibre", ".activation")):
            matrix[model.joint(name).dofadr[0], column] = 1.0
    for joint in range(model.njnt):
        name = model.joint(joint).name
        if name.endswith(".advance"):
            column = names.index(name.removesuffix(".advance"))
            pitch = model.equality(name).data[1]
            matrix[model.joint(joint).dofadr[0], column] = pitch
    return matrix


def dense_moment_arms(model, data):
    """d(tendon length)/d(position), tendons by rows."""
    arms = np.zeros((model.ntendon, model.nv))
    for tendon in range(model.ntendon):
        first = model.ten_J_rowadr[tendon]
        entries = slice(first, first + model.ten_J_rownnz[tendon])
        arms[tendon, model.ten_J_colind[entries]] = data.ten_J[entries]
    return arms


class Worst:
    """The largest of several numbers; none yet is None, and NaN is larger than all."""

    def __init__(self):
        self.value = None

    def add(self, numbers):
        largest = float(np.max(numbers))
        if np.isnan(largest):
            largest = float("inf")
        self.value = largest if self.value is None else max(self.value, largest)

    def exceeds(self, bound):
        return self.value is not None and self.value > bound

    def __str__(self):
        return f"{'-':>9}" if self.value is None else f"{self.value:9.1e}"


def wrapped_objects(model, tendon):
    """The kinds of objects on a tendon's path."""
    first = model.tendon_adr[tendon]
    return model.wrap_type[first : first + model.tendon_num[tendon]]


def is_alike(data, tendon, sites, bends):
    """Whether a tendon touches as many surfaces as the strand does: two more points for each."""
    return bends is not None and data.ten_wrapnum[tendon] == sites + 2 * bends


def differences(model, case):
    """The largest relative differences over all poses: lengths, moment arms, masses, forces; and how
    often a strand is left out, because it goes another way round a surface in MuJoCo."""
    data = mujoco.MjData(model)
    # The controls of the start.
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qvel[:] = 0.0
    names = case["coordinates"]
    joints = coordinates_to_joints(model, names)
    strands = [model.tendon(name).id for name in case["strands"]]
    sites = [int(np.sum(wrapped_objects(model, strand) == mujoco.mjtWrap.mjWRAP_SITE)) for strand in strands]
    free = [i for i, kinematic in enumerate(case["kinematic"]) if not kinematic]
    moved = [i for i in free if i not in case["without_inertia"]]
    added = LEAST * np.sum(model.body_mass[1:] <= LEAST)
    lengths_worst, arms_worst, masses_worst, forces_worst = worst = [Worst() for _ in range(4)]
    left_out = 0
    for pose in case["poses"]:
        data.qpos[:] = joints @ np.array(pose["q"])
        mujoco.mj_forward(model, data)
        alike = [is_alike(data, *one) for one in zip(strands, sites, pose["bends"])]
        left_out += alike.count(False)
        if free and pose["force"] and all(alike):
            own = np.array(pose["force"])
            total = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
            gap = np.abs(joints.T @ total - own)[free]
            forces_worst.add(gap / max(np.abs(own[free]).max(), 1e-6))
        if strands:
            chosen = np.array(strands)[alike]
            lengths = np.array(pose["lengths"])[alike]
            if len(chosen):
                lengths_worst.add(np.abs(data.ten_length[chosen] - lengths) / np.abs(lengths))
                arms = np.array(pose["arms"]).reshape(len(strands), len(names))[alike]
                gap = np.abs(dense_moment_arms(model, data)[chosen] @ joints - arms)
                scale = np.abs(arms).max(axis=1, keepdims=True)
                arms_worst.add(gap / np.where(scale > 1e-6 * lengths.max(), scale, lengths.max()))
        if moved:
            full = np.zeros((model.nv, model.nv))
            mujoco.mj_fullM(model, data, full)
            own = np.array(pose["mass"]).reshape(len(names), len(names))
            gap = np.abs(joints.T @ full @ joints - own)[np.ix_(moved, moved)]
            gap = np.maximum(gap - added, 0.0)
            size = np.sqrt(np.diag(own)[moved])
            # A coordinate that moves no matter has no scale of its own.
            size[size == 0.0] = 1.0
            masses_worst.add(gap / np.outer(size, size))
    return worst, left_out


def main():
    folder = pathlib.Path(sys.argv[1])
    bound = float(sys.argv[2]) if len(sys.argv) > 2 else 1e-10
    cases = json.loads((folder / "poses.json").read_text())
    failed = False
    print(f"mujoco {mujoco.__version__}; largest relative differences, bound {bound:g}")
    print(f"{'model':36} {'poses':>5} {'lengths':>9} {'arms':>9} {'masses':>9} {'forces':>9} {'left out':>9}")
    for case in cases:
        model = mujoco.MjModel.from_xml_path(str(folder / case["mjcf"]))
        worst, left_out = differences(model, case)
        wrong = any(one.exceeds(bound) for one in worst)
        failed = failed or wrong
        figures = " ".join(str(one) for one in worst)
        note = "  WRONG" if wrong else ""
        print(f"{case['file']:36} {len(case['poses']):5} {figures} {left_out:9}{note}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
