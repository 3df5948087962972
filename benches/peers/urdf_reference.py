"""Torques by Pinocchio that the tests of the import are compared with: `tests/urdf/*.json`, one beside each URDF.

    peers/bin/pip install pin numpy
    peers/bin/python benches/peers/urdf_reference.py
"""

import json
import os

import numpy as np
from load import by_pinocchio

FOLDER = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "tests/urdf")


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
            json.dump({"joints": names, "states": states, "torques": by_pinocchio(path, names, states)}, out, indent=1)
            out.write("\n")


if __name__ == "__main__":
    main()
