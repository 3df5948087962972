"""Pinocchio and CasADi on the TX-40 regressor, one line a tool. See README.md beside this file."""

import ctypes
import math
import subprocess
import tempfile
import timeit
from pathlib import Path

H = math.pi / 2
# sigma, alpha, d, theta, r: Table I without the payload frame.
TABLE = [
    (0, 0, 0, 0, 0),
    (0, -H, 0, -H, 0),
    (0, 0, 0.225, H, 0.035),
    (0, H, 0, 0, 0.225),
    (0, -H, 0, 0, 0),
    (0, H, 0, 0, 0),
]
GRAVITY = (0, 0, -9.81)
SAMPLES = 64


def state(t):
    """q, dq and ddq of sample t, as in benches/regressors.rs."""
    return [[2 * math.sin(0.37 * (7 * t + 13 * j) + p) for j in range(6)] for p in (0.0, 1.0, 2.0)]


def base_columns():
    """Columns kept of the 60 inertial ones: ZZ1, then all but YY, MZ and M of links 2 to 6."""
    return [5] + [10 * j + k for j in range(1, 6) for k in (0, 1, 2, 4, 5, 6, 7)]


def pinocchio():
    import numpy as np
    import pinocchio as pin

    model = pin.Model()
    parent = 0
    for j, (_, alpha, d, theta, r) in enumerate(TABLE):
        turn_x = pin.AngleAxis(alpha, np.array([1.0, 0, 0])).matrix()
        turn_z = pin.AngleAxis(theta, np.array([0, 0, 1.0])).matrix()
        place = pin.SE3(turn_x @ turn_z, np.array([d, 0, 0]) + turn_x @ np.array([0, 0, r]))
        parent = model.addJoint(parent, pin.JointModelRZ(), place, f"joint{j + 1}")
    model.gravity.linear = np.array(GRAVITY, dtype=float)
    data = model.createData()
    states = [[np.array(x) for x in state(t)] for t in range(SAMPLES)]

    def run():
        for q, dq, ddq in states:
            pin.computeJointTorqueRegressor(model, data, q, dq, ddq)

    return run, 1


def casadi_c():
    import casadi as ca

    q, dq, ddq = (ca.SX.sym(name, 6) for name in ("q", "dq", "ddq"))
    rows = regressor(ca, q, dq, ddq)
    function = ca.Function("idm", [q, dq, ddq], [ca.sparsify(rows)])
    print(f"CasADi: {function.n_instructions()} instructions, {function.nnz_out(0)} entries")
    folder = Path(tempfile.mkdtemp())
    generator = ca.CodeGenerator("idm.c")
    generator.add(function)
    generator.generate(str(folder) + "/")
    loop = f"""
    #include "idm.c"
    void run(const double *states, double *out, int count) {{
        for (int t = 0; t < count; t++) {{
            const double *s = states + 18 * (t % {SAMPLES});
            const double *arg[] = {{s, s + 6, s + 12}};
            double *res[] = {{out}};
            idm(arg, res, 0, 0, 0);
        }}
    }}
    """
    (folder / "run.c").write_text(loop)
    library = folder / "run.so"
    subprocess.run(
        ["cc", "-O3", "-march=native", "-shared", "-fPIC", str(folder / "run.c"), "-o", str(library), "-lm"], check=True
    )
    run_c = ctypes.CDLL(str(library)).run
    flat = [x for t in range(SAMPLES) for part in state(t) for x in part]
    states = (ctypes.c_double * len(flat))(*flat)
    out = (ctypes.c_double * function.nnz_out(0))()
    # Many samples a call, so that the call from Python does not count.
    repeats = 100
    return lambda: run_c(states, out, repeats * SAMPLES), repeats


def regressor(ca, q, dq, ddq):
    """Base columns of the inertial part, by Newton-Euler on symbols."""
    frames = []
    w, dw, a = ca.SX.zeros(3), ca.SX.zeros(3), -ca.SX(GRAVITY)
    for j, (_, alpha, d, theta, r) in enumerate(TABLE):
        angle = q[j] + theta
        c, s = ca.cos(angle), ca.sin(angle)
        # Cosines and sines of quarter turns are exact.
        ca_, sa = round(math.cos(alpha)), round(math.sin(alpha))
        rotation = ca.vertcat(
            ca.horzcat(c, -s, 0), ca.horzcat(s * ca_, c * ca_, -sa), ca.horzcat(s * sa, c * sa, ca_)
        )
        p = ca.vertcat(d, -r * sa, r * ca_)
        z = ca.SX([0, 0, 1])
        a = rotation.T @ (a + ca.cross(dw, p) + ca.cross(w, ca.cross(w, p)))
        inner = rotation.T @ w
        dw = rotation.T @ dw + ca.cross(inner, z * dq[j]) + z * ddq[j]
        w = inner + z * dq[j]
        frames.append((rotation, p, w, dw, a))
    columns = []
    for column in base_columns():
        link, kind = divmod(column, 10)
        _, _, w, dw, a = frames[link]
        force, moment = ca.SX.zeros(3), ca.SX.zeros(3)
        if kind < 6:
            i, k = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)][kind]
            inertia = ca.SX.zeros(3, 3)
            inertia[i, k] = inertia[k, i] = 1
            moment = inertia @ dw + ca.cross(w, inertia @ w)
        else:
            axis = ca.SX([float(kind - 6 == i) for i in range(3)])
            force = ca.cross(dw, axis) + ca.cross(w, ca.cross(w, axis))
            moment = ca.cross(axis, a)
        torques = [0] * 6
        for i in range(link, -1, -1):
            torques[i] = moment[2]
            rotation, p = frames[i][:2]
            force = rotation @ force
            moment = rotation @ moment + ca.cross(p, force)
        columns.append(ca.vertcat(*torques))
    return ca.horzcat(*columns)


def main():
    for name, prepare in (("Pinocchio, 60 standard columns", pinocchio), ("CasADi C, 36 base columns", casadi_c)):
        try:
            run, repeats = prepare()
        except ImportError as missing:
            print(f"{name}: left out, {missing}")
            continue
        seconds = min(timeit.repeat(run, number=5, repeat=50)) / 5
        print(f"{name}: {seconds / (repeats * SAMPLES) * 1e9:.0f} ns a sample")


if __name__ == "__main__":
    main()
