"""Torques by Pinocchio that the tests of the import are compared with: `tests/urdf/*.json`, one beside each URDF.

    peers/bin/pip install pin numpy
    peers/bin/python benches/peers/urdf_reference.py

Joints that mimic others are moved as they say, and their torques are those of the joints that they follow.
"""

import json
import os
import xml.etree.ElementTree as xml

import numpy as np
from load import by_pinocchio

FOLDER = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "tests/urdf")


def joints_of(path):
    """Names of the moving joints in the order of the file, which is the table's for these robots, and (leader, multiplier,
    offset) of each."""
    joints = [j for j in xml.parse(path).getroot().findall("joint") if j.get("type") != "fixed"]
    mimics = {j.get("name"): j.find("mimic") for j in joints}

    def leader(name):
        mimic = mimics[name]
        if mimic is None:
            return name, 1.0, 0.0
        of, times, offset = leader(mimic.get("joint"))
        k, c = float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0))
        return of, k * times, k * offset + c

    return [j.get("name") for j in joints], {name: leader(name) for name in mimics}


def torques(path, every, leaders, names, states):
    place = {name: k for k, name in enumerate(names)}

    def moved(q, constant):
        return [leaders[j][1] * q[place[leaders[j][0]]] + constant * leaders[j][2] for j in every]

    full = [[moved(q, 1), moved(dq, 0), moved(ddq, 0)] for q, dq, ddq in states]
    projected = []
    for row in by_pinocchio(path, every, full):
        sums = [0.0] * len(names)
        for j, torque in zip(every, row):
            sums[place[leaders[j][0]]] += leaders[j][1] * torque
        projected.append(sums)
    return projected


def main():
    random = np.random.default_rng(5)
    for file in sorted(os.listdir(FOLDER)):
        if not file.endswith(".urdf"):
            continue
        path = os.path.join(FOLDER, file)
        every, leaders = joints_of(path)
        names = [name for name in every if leaders[name][0] == name]
        states = [[list(random.uniform(-s, s, len(names)).round(3)) for s in (1.5, 2.0, 5.0)] for _ in range(5)]
        with open(path.replace(".urdf", ".json"), "w") as out:
            found = torques(path, every, leaders, names, states)
            json.dump({"joints": names, "states": states, "torques": found}, out, indent=1)
            out.write("\n")


if __name__ == "__main__":
    main()
