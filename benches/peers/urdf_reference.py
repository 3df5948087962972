"""Torques by Pinocchio that the tests of the import are compared with: `tests/urdf/*.json`, one beside each URDF.

    peers/bin/pip install pin numpy
    peers/bin/python benches/peers/urdf_reference.py
"""

import json
import os

import numpy as np
import pinocchio as pin

FOLDER = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "tests/urdf")


def torques(path, states, names):
    """Inverse dynamics, joints in the order of names."""
    model = pin.buildModelFromUrdf(path)
    data = model.createData()
    joints = [model.joints[model.getJointId(name)] for name in names]
    result = []
    for q, dq, ddq in states:
        full, v, a = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
        for i, joint in enumerate(joints):
            if joint.nq == 2:
                full[joint.idx_q:joint.idx_q + 2] = np.cos(q[i]), np.sin(q[i])
            else:
                full[joint.idx_q] = q[i]
            v[joint.idx_v], a[joint.idx_v] = dq[i], ddq[i]
        tau = pin.rnea(model, data, full, v, a)
        result.append([float(tau[joint.idx_v]) for joint in joints])
    return result


def main():
    random = np.random.default_rng(5)
    for file in sorted(os.listdir(FOLDER)):
        if not file.endswith(".urdf"):
            continue
        path = os.path.join(FOLDER, file)
        with open(path) as text:
            # The order of the file, which is the table's for these robots.
            words = text.read().split('<joint name="')[1:]
        names = [word.split('"')[0] for word in words if 'type="fixed"' not in word.split(">")[0]]
        states = [[list(random.uniform(-s, s, len(names)).round(3)) for s in (1.5, 2.0, 5.0)] for _ in range(5)]
        with open(path.replace(".urdf", ".json"), "w") as out:
            json.dump({"joints": names, "states": states, "torques": torques(path, states, names)}, out, indent=1)
            out.write("\n")


if __name__ == "__main__":
    main()
