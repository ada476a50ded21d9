"""MuJoCo for the benchmark: reads one JSON request a line, writes one JSON answer a line.

speed: seconds of `steps` steps of `instances` copies on `threads` threads, all within MuJoCo's C
       code (`rollout`), natural lengths fed from a file where the scenario moves them.
swing: positions and energies along a run, and seconds; joints by name.
"""

import json
import sys
import time

import mujoco
import numpy as np
from mujoco import rollout

INTEGRATORS = {name: getattr(mujoco.mjtIntegrator, f"mjINT_{name.upper()}")
               for name in ("Euler", "RK4", "implicitfast")}
STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


def load(request):
    model = mujoco.MjModel.from_xml_path(request["xml"])
    model.opt.integrator = INTEGRATORS[request["integrator"]]
    if "step" in request:
        model.opt.timestep = request["step"]
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    return model, data


def full_state(model, data):
    state = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, state, STATE)
    return state


def diverged(out, copies):
    """Whether a run went wrong: MuJoCo warns, and `rollout` ends it there."""
    return not np.isfinite(out).all() or any(w.number for d in copies for w in d.warning)


def speed(request):
    model, data = load(request)
    steps, instances = request["steps"], request["instances"]
    threads = request["threads"]
    control = None
    if request.get("controls"):
        control = np.fromfile(request["controls"]).reshape(-1, model.nu)
        # A shorter step: every control as many times.
        control = np.repeat(control, request["repeat"], axis=0)[:steps]
        control = np.ascontiguousarray(control)[None]
        steps = control.shape[1]
    elif model.nu:
        control = np.tile(data.ctrl, (1, steps, 1))
    start = np.tile(full_state(model, data), (instances, 1))
    # Copies that differ, as they do on the other side.
    noise = np.random.default_rng(1).normal(0.0, 1e-4, (instances, model.nq))
    start[:, 1:1 + model.nq] += noise if instances > 1 else 0.0
    copies = [mujoco.MjData(model) for _ in range(threads)]
    with rollout.Rollout(nthread=threads if threads > 1 else 0) as pool:
        out = np.empty((instances, steps, start.shape[1]))
        began = time.perf_counter()
        if control is None:
            pool.rollout(model, copies, start, nstep=steps, state=out)
        else:
            pool.rollout(model, copies, start, control, state=out)
        seconds = time.perf_counter() - began
    return {"seconds": seconds, "steps": steps * instances, "diverged": diverged(out, copies)}


def swing(request):
    model, data = load(request)
    steps, every = request["steps"], request["every"]
    start = full_state(model, data)
    control = np.tile(data.ctrl, (1, steps, 1)) if model.nu else None
    out = np.empty((1, steps, len(start)))
    with rollout.Rollout(nthread=0) as pool:
        began = time.perf_counter()
        if control is None:
            pool.rollout(model, [data], start[None], nstep=steps, state=out)
        else:
            pool.rollout(model, [data], start[None], control, state=out)
        seconds = time.perf_counter() - began
    wrong = diverged(out, [data])
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    rows = np.vstack([start[None], out[0][every - 1::every]])
    energy, gap = [], 0.0
    for row in rows:
        if not np.isfinite(row).all():
            energy.append(None)
            continue
        mujoco.mj_setState(model, data, row, STATE)
        mujoco.mj_forward(model, data)
        energy.append(float(data.energy.sum()))
        if data.ne:
            gap = max(gap, float(np.abs(data.efc_pos[:data.ne]).max()))
    names = [model.joint(i).name for i in range(model.njnt)]
    q = rows[:, 1:1 + model.nq]
    return {
        "seconds": seconds,
        "joints": names,
        "q": np.where(np.isfinite(q), q, 1e300).tolist(),
        "energy": energy,
        "gap": gap,
        "diverged": wrong,
    }


def version(_):
    return {"version": mujoco.__version__}


def main():
    commands = {"speed": speed, "swing": swing, "version": version}
    for line in sys.stdin:
        request = json.loads(line)
        try:
            answer = commands[request["ask"]](request)
        except Exception as error:  # The other side decides what a failure means.
            answer = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
