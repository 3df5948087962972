"""How long the regressor of many states takes from Python: ns a sample, the least of several runs. Beside
`cargo run --release --example dense`, and Pinocchio's loop where it is installed."""

import sys
import time

import numpy as np

import dynid

samples = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
r = dynid.Robot("tx40")
at = np.arange(samples)[:, None] * np.arange(1, r.joints + 1) * 1e-3
in_rows = [np.sin(w * at) for w in (1.0, 1.3, 1.7)]
in_columns = [np.asfortranarray(x) for x in in_rows]
room = np.zeros((samples, r.joints, len(r.names)))


def report(what, run, rounds=15, samples=samples):
    wall, busy = np.inf, np.inf
    for _ in range(rounds):
        began, worked = time.perf_counter(), time.process_time()
        run()
        wall, busy = min(wall, time.perf_counter() - began), min(busy, time.process_time() - worked)
    print(f"{what}: {1e9 * wall / samples:.0f} ns a sample, {1e9 * busy / samples:.0f} of a processor")


report("entries, fresh memory, arrays in columns", lambda: r.regressor_entries(*in_columns))
report("entries, fresh memory, arrays in rows", lambda: r.regressor_entries(*in_rows))
for threads, how in [(1, "one thread"), (0, "all threads")]:
    report(f"dense, arrays in columns, {how}", lambda: r.regressor(*in_columns, threads=threads))
    report(f"dense, arrays in rows, {how}", lambda: r.regressor(*in_rows, threads=threads))
    report(f"dense, out= the same array again, {how}", lambda: r.regressor(*in_rows, out=room, threads=threads))
# The first one has what the last call left.
kept = [r.regressor(*in_columns)]
report("dense, fresh memory, all threads", lambda: kept.append(r.regressor(*in_columns)), rounds=3)
kept.clear()
report("torques, arrays in rows", lambda: r.torque(r.chi, *in_rows))


def pinocchio_loop(most=5000):
    """The regressor of the same axes (60 standard inertial columns) by a loop in Python, as there is none over states."""
    import pinocchio as pin

    quarter = np.pi / 2
    table = [(0, 0, 0, 0), (-quarter, 0, -quarter, 0), (0, 0.225, quarter, 0.035), (quarter, 0, 0, 0.225)]
    table += [(-quarter, 0, 0, 0), (quarter, 0, 0, 0)]
    model, parent = pin.Model(), 0
    for j, (alpha, d, theta, r) in enumerate(table):
        turn = pin.AngleAxis(alpha, np.eye(3)[0]).matrix()
        offset = np.array([d, 0, 0]) + turn @ np.array([0, 0, r])
        place = pin.SE3(turn @ pin.AngleAxis(theta, np.eye(3)[2]).matrix(), offset)
        parent = model.addJoint(parent, pin.JointModelRZ(), place, f"joint{j + 1}")
    data, samples = model.createData(), min(most, len(in_rows[0]))
    q, dq, ddq = (x[:samples] for x in in_rows)
    out = np.empty((samples, 6, 60))

    def run():
        for k in range(samples):
            out[k] = pin.computeJointTorqueRegressor(model, data, q[k], dq[k], ddq[k])

    report("Pinocchio, a loop in Python", run, samples=samples)


try:
    pinocchio_loop()
except ImportError:
    print("Pinocchio is not installed (pip install pin): no loop to compare with")
