"""dynid, Pinocchio and CasADi on the TX-40: regressor, torques, accelerations; same states, times. See README.md beside this."""

import ctypes
import functools
import json
import math
import os
import subprocess
import tempfile
import timeit
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
H = math.pi / 2
# alpha, d, theta, r: Table I without the payload frame.
TABLE = [
    (0, 0, 0, 0),
    (-H, 0, -H, 0),
    (0, 0.225, H, 0.035),
    (H, 0, 0, 0.225),
    (-H, 0, 0, 0),
    (H, 0, 0, 0),
]
GRAVITY = (0, 0, -9.81)
KINDS = ["XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M"]
# The same ten in Pinocchio's order: m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz.
PINOCCHIO = ["M", "MX", "MY", "MZ", "XX", "XY", "YY", "XZ", "YZ", "ZZ"]


def dynid(folder):
    """States, regressors and times of our own bench."""
    file = folder / "dynid.json"
    command = ["cargo", "bench", "--bench", "regressors", "--", "tx40", "--write", str(file)]
    subprocess.run(command, check=True, cwd=ROOT)
    return json.loads(file.read_text())


def place(name, kinds):
    """Index of a parameter such as XX2 among the standard ones, ten a link."""
    link = int(name[len(name.rstrip("0123456789")) :])
    return 10 * (link - 1) + kinds.index(name.rstrip("0123456789"))


def pinocchio_model():
    import pinocchio as pin

    model = pin.Model()
    parent = 0
    for j, (alpha, d, theta, r) in enumerate(TABLE):
        turn_x = pin.AngleAxis(alpha, np.array([1.0, 0, 0])).matrix()
        turn_z = pin.AngleAxis(theta, np.array([0, 0, 1.0])).matrix()
        at = pin.SE3(turn_x @ turn_z, np.array([d, 0, 0]) + turn_x @ np.array([0, 0, r]))
        parent = model.addJoint(parent, pin.JointModelRZ(), at, f"joint{j + 1}")
    model.gravity.linear = np.array(GRAVITY, dtype=float)
    return pin, model


def pinocchio(states, columns, _):
    pin, model = pinocchio_model()
    data = model.createData()
    states = [[np.array(s[x]) for x in ("q", "dq", "ddq")] for s in states]
    order = [place(name, PINOCCHIO) for name in columns]
    found = [pin.computeJointTorqueRegressor(model, data, *s)[:, order].copy() for s in states]

    def run():
        for q, dq, ddq in states:
            pin.computeJointTorqueRegressor(model, data, q, dq, ddq)

    return found, run, len(states)


CPP = """
#if __has_include(<pinocchio/multibody.hpp>)
#include <pinocchio/multibody.hpp>
#else
#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/model.hpp>
#endif
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>
namespace pin = pinocchio;
static pin::Model model;
static pin::Data *data;
extern "C" void init(const double *places, int n, const double *gravity) {
    pin::JointIndex parent = 0;
    for (int j = 0; j < n; j++) {
        pin::SE3 at(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(places + 12 * j),
                    Eigen::Map<const Eigen::Vector3d>(places + 12 * j + 9));
        parent = model.addJoint(parent, pin::JointModelRZ(), at, "joint" + std::to_string(j));
    }
    model.gravity.linear(Eigen::Map<const Eigen::Vector3d>(gravity));
    data = new pin::Data(model);
}
extern "C" void run(const double *states, double *out, int samples, int rounds) {
    const int n = model.nv;
    Eigen::VectorXd q(n), dq(n), ddq(n);
    for (int k = 0; k < rounds * samples; k++) {
        const double *s = states + 3 * n * (k % samples);
        q = Eigen::Map<const Eigen::VectorXd>(s, n);
        dq = Eigen::Map<const Eigen::VectorXd>(s + n, n);
        ddq = Eigen::Map<const Eigen::VectorXd>(s + 2 * n, n);
        const auto &y = pin::computeJointTorqueRegressor(model, *data, q, dq, ddq);
        if (k < samples) Eigen::Map<Eigen::MatrixXd>(out + y.size() * k, y.rows(), y.cols()) = y;
    }
}
// ten numbers a link, in Pinocchio's order
extern "C" void bodies(const double *parameters) {
    for (int j = 0; j < model.nv; j++)
        model.inertias[j + 1] = pin::Inertia::FromDynamicParameters(Eigen::Map<const Eigen::VectorXd>(parameters + 10 * j, 10));
    delete data;
    data = new pin::Data(model);
}
extern "C" void torques(const double *states, double *out, int samples, int rounds, int forward) {
    const int n = model.nv;
    Eigen::VectorXd q(n), dq(n), last(n);
    for (int k = 0; k < rounds * samples; k++) {
        const double *s = states + 3 * n * (k % samples);
        q = Eigen::Map<const Eigen::VectorXd>(s, n);
        dq = Eigen::Map<const Eigen::VectorXd>(s + n, n);
        last = Eigen::Map<const Eigen::VectorXd>(s + 2 * n, n);
        Eigen::Map<Eigen::VectorXd> to(out + n * (k % samples), n);
        if (forward) to = pin::aba(model, *data, q, dq, last);
        else to = pin::rnea(model, *data, q, dq, last);
    }
}
"""


@functools.cache
def pinocchio_library(folder):
    """Pinocchio behind three functions of C, with the TX-40 in it."""
    pin, model = pinocchio_model()
    prefix = Path(pin.__file__).resolve().parents[4]
    headers = [prefix / "include", *(p for p in prefix.glob("include/eigen*"))]
    if not any((p / "Eigen" / "Core").is_file() for p in headers):
        raise ImportError("no headers of Eigen (pip install cmeel-eigen)")
    (folder / "pin.cpp").write_text(CPP)
    library = folder / "pin.so"
    flags = ["-O3", "-march=native", "-DNDEBUG", "-std=c++17", "-shared", "-fPIC", "-w"]
    # Pinocchio has more joint types, and visitors of more arguments, than Boost allows unless told.
    flags += ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]
    flags += ["-DBOOST_FUSION_INVOKE_MAX_ARITY=10"]
    paths = [f"-I{p}" for p in headers]
    libraries = sorted(prefix.glob("lib/libpinocchio_default.so*"))[:1]
    link = [str(p) for p in libraries] + [f"-Wl,-rpath,{prefix / 'lib'}"]
    build(["c++", *flags, str(folder / "pin.cpp"), *paths, *link, "-o", str(library)])
    code = ctypes.CDLL(str(library))
    places = np.concatenate(
        [np.r_[p.rotation.flatten(), p.translation] for p in list(model.jointPlacements)[1:]]
    ).astype(float)
    code.init(as_pointer(places), model.nv, as_pointer(np.array(GRAVITY, dtype=float)))
    return code, model


def as_pointer(array):
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def pinocchio_cpp(states, columns, folder):
    code, model = pinocchio_library(folder)
    n, flat = model.nv, flatten(states)
    out = np.zeros((len(states), 10 * n, n))
    rounds = 20
    run = lambda: code.run(as_pointer(flat), as_pointer(out), len(states), rounds)
    run()
    order = [place(name, PINOCCHIO) for name in columns]
    return [y.T[:, order] for y in out], run, rounds * len(states)


def pinocchio_dynamics(states, parameters, folder, forward):
    """rnea, or aba, of C++ with these inertial parameters (by name)."""
    code, model = pinocchio_library(folder)
    bodies = np.zeros(10 * model.nv)
    for name, value in parameters.items():
        kind = name.rstrip("0123456789")
        if kind in PINOCCHIO and int(name[len(kind) :]) <= model.nv:
            bodies[place(name, PINOCCHIO)] = value
    code.bodies(as_pointer(bodies))
    flat, out, rounds = flatten(states), np.zeros((len(states), model.nv)), 20
    run = lambda: code.torques(as_pointer(flat), as_pointer(out), len(states), rounds, int(forward))
    run()
    return out, run, rounds * len(states)


def build(command):
    """Compiles; the compiler's first complaint is enough."""
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        complaints = [line for line in done.stderr.splitlines() if "error" in line]
        raise OSError(f"{command[0]}: {(complaints or ['it failed'])[0]}")


def flatten(states):
    return np.array([[*s["q"], *s["dq"], *s["ddq"]] for s in states]).ravel()


def casadi_c(states, columns, folder):
    import casadi as ca

    q, dq, ddq = (ca.SX.sym(name, 6) for name in ("q", "dq", "ddq"))
    rows = regressor(ca, q, dq, ddq, [place(name, KINDS) for name in columns])
    function = ca.Function("idm", [q, dq, ddq], [ca.sparsify(rows)])
    print(f"CasADi {ca.__version__}: {function.n_instructions()} instructions, {function.nnz_out(0)} entries")
    generator = ca.CodeGenerator("idm.c")
    generator.add(function)
    generator.generate(str(folder) + os.sep)
    loop = """
    #include "idm.c"
    void run(const double *states, double *out, int samples, int rounds, int entries) {
        for (int k = 0; k < rounds * samples; k++) {
            const double *s = states + 18 * (k % samples);
            const double *arg[] = {s, s + 6, s + 12};
            double *res[] = {out + entries * (k % samples)};
            idm(arg, res, 0, 0, 0);
        }
    }
    """
    (folder / "run.c").write_text(loop)
    library = folder / "run.so"
    flags = ["-O3", "-march=native", "-shared", "-fPIC"]
    build(["cc", *flags, str(folder / "run.c"), "-o", str(library), "-lm"])
    code = ctypes.CDLL(str(library))
    flat = flatten(states)
    entries = function.nnz_out(0)
    out = np.zeros((len(states), entries))
    pointer = ctypes.POINTER(ctypes.c_double)
    # Many samples a call, so that the call from Python does not count.
    rounds = 20
    run = lambda: code.run(
        flat.ctypes.data_as(pointer), out.ctypes.data_as(pointer), len(states), rounds, entries
    )
    run()
    row, column = (np.array(x) for x in function.sparsity_out(0).get_triplet())
    found = []
    for values in out:
        dense = np.zeros((6, len(columns)))
        dense[row, column] = values
        found.append(dense)
    return found, run, rounds * len(states)


def casadi_rnea(states, parameters, folder):
    """CasADi's generated C of Newton-Euler with the same inertial parameters, those that are zero left out."""
    import casadi as ca

    q, dq, ddq = (ca.SX.sym(name, 6) for name in ("q", "dq", "ddq"))
    names = list(parameters)
    chi = ca.SX.sym("chi", len(names))
    links = [[ca.SX(0) for _ in range(10)] for _ in range(6)]
    for k, name in enumerate(names):
        links[place(name, KINDS) // 10][place(name, KINDS) % 10] = chi[k]
    frames, wrenches = motions(ca, q, dq, ddq), []
    for (_, _, w, dw, a), (xx, xy, xz, yy, yz, zz, mx, my, mz, m) in zip(frames, links):
        inertia = ca.vertcat(ca.horzcat(xx, xy, xz), ca.horzcat(xy, yy, yz), ca.horzcat(xz, yz, zz))
        ms = ca.vertcat(mx, my, mz)
        force = m * a + ca.cross(dw, ms) + ca.cross(w, ca.cross(w, ms))
        wrenches.append((force, inertia @ dw + ca.cross(w, inertia @ w) + ca.cross(ms, a)))
    torques, force, moment = [0] * 6, ca.SX.zeros(3), ca.SX.zeros(3)
    for i in range(5, -1, -1):
        force, moment = force + wrenches[i][0], moment + wrenches[i][1]
        torques[i] = moment[2]
        rotation, p = frames[i][:2]
        force = rotation @ force
        moment = rotation @ moment + ca.cross(p, force)
    function = ca.Function("rnea", [chi, q, dq, ddq], [ca.vertcat(*torques)])
    print(f"CasADi rnea: {function.n_instructions()} instructions")
    generator = ca.CodeGenerator("rnea.c")
    generator.add(function)
    generator.generate(str(folder) + os.sep)
    loop = """
    #include "rnea.c"
    void run(const double *chi, const double *states, double *out, int samples, int rounds) {
        for (int k = 0; k < rounds * samples; k++) {
            const double *s = states + 18 * (k % samples);
            const double *arg[] = {chi, s, s + 6, s + 12};
            double *res[] = {out + 6 * (k % samples)};
            rnea(arg, res, 0, 0, 0);
        }
    }
    """
    (folder / "run_rnea.c").write_text(loop)
    library = folder / "run_rnea.so"
    build(["cc", "-O3", "-march=native", "-shared", "-fPIC", str(folder / "run_rnea.c"), "-o", str(library), "-lm"])
    code = ctypes.CDLL(str(library))
    flat, out, rounds = flatten(states), np.zeros((len(states), 6)), 20
    values = np.array([parameters[name] for name in names])
    run = lambda: code.run(as_pointer(values), as_pointer(flat), as_pointer(out), len(states), rounds)
    run()
    return out, run, rounds * len(states)


def regressor(ca, q, dq, ddq, columns):
    """Standard columns of the inertial part, by Newton-Euler on symbols."""
    frames = motions(ca, q, dq, ddq)
    result = []
    for column in columns:
        link, kind = divmod(column, 10)
        _, _, w, dw, a = frames[link]
        force, moment = ca.SX.zeros(3), ca.SX.zeros(3)
        if kind < 6:
            i, k = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)][kind]
            inertia = ca.SX.zeros(3, 3)
            inertia[i, k] = inertia[k, i] = 1
            moment = inertia @ dw + ca.cross(w, inertia @ w)
        elif kind < 9:
            axis = ca.SX([float(kind - 6 == i) for i in range(3)])
            force = ca.cross(dw, axis) + ca.cross(w, ca.cross(w, axis))
            moment = ca.cross(axis, a)
        else:
            force = a
        torques = [0] * 6
        for i in range(link, -1, -1):
            torques[i] = moment[2]
            rotation, p = frames[i][:2]
            force = rotation @ force
            moment = rotation @ moment + ca.cross(p, force)
        result.append(ca.vertcat(*torques))
    return ca.horzcat(*result)


def motions(ca, q, dq, ddq):
    """Rotation, origin, angular velocity and acceleration, acceleration of the origin, of every frame."""
    frames = []
    w, dw, a = ca.SX.zeros(3), ca.SX.zeros(3), -ca.SX(GRAVITY)
    for j, (alpha, d, theta, r) in enumerate(TABLE):
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
    return frames


def main():
    folder = Path(tempfile.mkdtemp())
    ours = dynid(folder)
    states, columns = ours["states"], ours["columns"]
    expected = [np.array(s["regressor"]) for s in states]
    scale = max(np.abs(e).max() for e in expected)
    lines = [
        (f"dynid, one sample, {ours['base_parameters']} base columns with friction", ours["ns"]["scalar"], ""),
        (f"dynid, batch, {ours['base_parameters']} base columns with friction", ours["ns"]["batch"], ""),
    ]
    peers = [
        ("Pinocchio from Python, 60 standard inertial columns", pinocchio),
        ("Pinocchio from C++, 60 standard inertial columns", pinocchio_cpp),
        (f"CasADi's generated C, {len(columns)} base inertial columns", casadi_c),
    ]
    failed = False
    for name, prepare in peers:
        try:
            found, run, samples = prepare(states, columns, folder)
        except (ImportError, OSError) as missing:
            print(f"{name}: left out, {missing}")
            continue
        worst = max(np.abs(f - e).max() for f, e in zip(found, expected)) / scale
        failed |= not worst < 1e-12
        seconds = min(timeit.repeat(run, number=1, repeat=200))
        lines.append((name, seconds / samples * 1e9, f"{worst:.1e}"))
    print("\n| TX-40 regressor, one state | ns | : dynid one sample | : dynid batch | largest relative difference |")
    print("|---|--:|--:|--:|--:|")
    one, batch = ours["ns"]["scalar"], ours["ns"]["batch"]
    for name, ns, worst in lines:
        print(f"| {name} | {ns:.0f} | {ns / one:.1f} | {ns / batch:.1f} | {worst} |")
    failed |= dynamics(ours, states, dict(zip(columns, ours["chi"])), folder)
    if failed:
        raise SystemExit("the numbers do not agree")


def dynamics(ours, states, parameters, folder):
    """Torques and accelerations; whether torques differ."""
    torques = np.array([s["torque"] for s in states])
    accelerations = np.array([s["acceleration"] for s in states])
    ns, standard = ours["ns"], ours["standard"]
    lines = [
        ("dynid tau, one sample, with friction and rotors", ns["torque"], ""),
        ("dynid tau, batch", ns["torque_batch"], ""),
        ("dynid acceleration: M, torques and Cholesky, with friction", ns["acceleration"], ""),
    ]
    peers = [
        ("Pinocchio rnea from C++", lambda: pinocchio_dynamics(states, standard, folder, False), torques),
        (f"CasADi's generated C of rnea in {len(parameters)} base parameters", lambda: casadi_rnea(states, parameters, folder), torques),
        ("Pinocchio aba from C++", lambda: pinocchio_dynamics(states, standard, folder, True), accelerations),
    ]
    failed = False
    for name, prepare, expected in peers:
        try:
            found, run, samples = prepare()
        except (ImportError, OSError) as missing:
            print(f"{name}: left out, {missing}")
            continue
        worst = np.abs(found - expected).max() / np.abs(expected).max()
        # An acceleration loses the digits of the mass matrix's condition.
        failed |= not worst < (1e-9 if expected is accelerations else 1e-12)
        seconds = min(timeit.repeat(run, number=1, repeat=200))
        lines.append((name, seconds / samples * 1e9, f"{worst:.1e}"))
    print("\n| TX-40, one state | ns | : dynid tau | largest relative difference |")
    print("|---|--:|--:|--:|")
    for name, time, worst in lines:
        print(f"| {name} | {time:.0f} | {time / ns['torque']:.1f} | {worst} |")
    return failed


if __name__ == "__main__":
    main()
