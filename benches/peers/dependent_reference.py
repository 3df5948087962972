"""Torques by Pinocchio of random tables whose frames move with several joint variables: `tests/dependent.json`.

    peers/bin/pip install pin numpy
    peers/bin/python benches/peers/dependent_reference.py

Pinocchio has no dependent joints: every frame that moves is a joint of its own there, with positions G q + c, and its torques
are projected: tau = GT rnea(G q, G dq, G ddq).
"""

import json
import os

import numpy as np
import pinocchio as pin

FILE = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "tests/dependent.json")


def table(random):
    """Rows of a table, and its joints: numbers of the frames that have a variable of their own."""
    count = int(random.integers(4, 10))
    kinds = ["revolute"] + list(random.choice(["revolute", "revolute", "revolute", "prismatic", "fixed"], count - 1))
    own = [k == 0 or kinds[k] != "fixed" and random.random() < 0.55 for k in range(count)]
    joints = [k for k in range(count) if own[k]]
    angle = lambda: float(random.choice([0, np.pi / 2, -np.pi / 2, np.pi, round(random.uniform(-2, 2), 3)]))
    length = lambda: float(random.choice([0, 0.3, -0.17, round(random.uniform(-0.5, 0.5), 3)]))
    rows = []
    for k in range(count):
        branch = random.random() < 0.3
        row = {"parent": int(random.integers(0, k + 1)) if branch else k, "kind": kinds[k], "alpha": angle(), "d": length()}
        row |= {"theta": angle(), "r": length(), "gamma": angle() if branch else 0.0, "b": length() if branch else 0.0}
        terms = {}
        if kinds[k] != "fixed":
            for joint in joints:
                fits = kinds[k] == "prismatic" or kinds[joint] == "revolute"
                if (joint == k or random.random() < 0.4) and fits and len(terms) < 4:
                    whole = kinds[k] == "revolute"
                    terms[joint] = float(random.choice([1, -1, 2] if whole else [1, -1, 0.35]))
            if own[k] and k not in terms:
                terms = {k: 1.0}
            if not terms:
                row["kind"] = "fixed"
        row["terms"] = terms
        rows.append(row)
    return rows, joints


def yaml(rows, gravity):
    lines = [f"name: random\ngravity: {gravity}\nframes:"]
    for j, row in enumerate(rows, 1):
        variables = "".join(f"{c:+}*q{k + 1} " for k, c in row["terms"].items())
        entry = lambda key, kind: (variables if row["kind"] == kind else "") + f"{row[key]:+}"
        sigma = {"revolute": 0, "prismatic": 1, "fixed": 2}[row["kind"]]
        lines.append(
            f"  - {{j: {j}, parent: {row['parent']}, sigma: {sigma}, gamma: {row['gamma']}, b: {row['b']}, "
            f"alpha: {row['alpha']}, d: {row['d']}, theta: {entry('theta', 'revolute')}, r: {entry('r', 'prismatic')}}}"
        )
    return "\n".join(lines) + "\n"


def turned(axis, angle):
    return pin.SE3(pin.utils.rotate(axis, angle), np.zeros(3))


def moved(*along):
    return pin.SE3(np.eye(3), np.array(along))


class Engine:
    def __init__(self, rows, joints, gravity, bodies):
        self.model = pin.Model()
        self.model.gravity.linear = np.array(gravity)
        at, self.g = [(0, pin.SE3.Identity())], []
        for k, row in enumerate(rows):
            joint, place = at[row["parent"]]
            place = place * turned("z", row["gamma"]) * moved(0, 0, row["b"]) * turned("x", row["alpha"])
            place = place * moved(row["d"], 0, 0) * turned("z", row["theta"]) * moved(0, 0, row["r"])
            if row["kind"] != "fixed":
                moves = pin.JointModelRZ() if row["kind"] == "revolute" else pin.JointModelPZ()
                joint, place = self.model.addJoint(joint, moves, place, f"frame{k + 1}"), pin.SE3.Identity()
                self.g.append([row["terms"].get(j, 0.0) for j in joints])
            at.append((joint, place))
        self.g = np.array(self.g)
        for (joint, place), (xx, xy, xz, yy, yz, zz, mx, my, mz, m) in zip(at[1:], bodies):
            if joint:
                body = pin.Inertia.FromDynamicParameters(np.array([m, mx, my, mz, xx, xy, yy, xz, yz, zz]))
                self.model.inertias[joint] = self.model.inertias[joint] + place.act(body)
        self.data = self.model.createData()

    def torques(self, q, dq, ddq):
        g = self.g
        return g.T @ pin.rnea(self.model, self.data, g @ q, g @ dq, g @ ddq)


def bodies(random, count):
    return [list(np.append(random.uniform(-1, 1, 9), random.uniform(0.5, 3)).round(3)) for _ in range(count)]


def main():
    random = np.random.default_rng(14)
    cases = []
    while len(cases) < 24:
        rows, joints = table(random)
        if all(row["terms"] in ({}, {k: 1.0}) for k, row in enumerate(rows)):
            continue
        gravity = [0.0, 0.0, -9.81] if len(cases) % 2 else [1.3, -4.0, 8.0]
        own = bodies(random, len(rows))
        engine = Engine(rows, joints, gravity, own)
        states = [[list(random.uniform(-s, s, len(joints)).round(3)) for s in (2.5, 2.0, 5.0)] for _ in range(3)]
        torques = [[float(x) for x in engine.torques(*map(np.array, state))] for state in states]
        cases.append({"yaml": yaml(rows, gravity), "bodies": own, "states": states, "torques": torques})
    with open(FILE, "w") as out:
        json.dump(cases, out, indent=None, separators=(",", ":"))
        out.write("\n")


if __name__ == "__main__":
    main()
