"""Torques by MuJoCo of random chains with springs between two points: `runtime/tests/data/between.json`.

    peers/bin/pip install mujoco numpy
    peers/bin/python benches/peers/between_reference.py

Such a spring is a spatial tendon between two sites there, with stiffness and springlength.
"""

import json
import os

import mujoco
import numpy as np
from couplings_reference import FILE as BESIDE
from couplings_reference import chain, mjcf, yaml

FILE = os.path.join(os.path.dirname(os.path.dirname(BESIDE)), "runtime/tests/data/between.json")


def springs(random, rows):
    """Points of two frames each; 0 is the base."""
    entries = []
    for k in range(int(random.integers(1, 3))):
        frames = sorted(int(f) for f in random.choice(len(rows) + 1, 2, replace=False))
        point = lambda: [round(float(x), 3) for x in random.uniform(-0.5, 0.5, 3)]
        entries.append({"name": f"s{k}", "frames": frames, "points": [point(), point()], "stiffness": float(random.uniform(50, 800)),
                        "rest": round(float(random.uniform(0, 0.6)), 3), "known": bool(random.random() < 0.4)})
    return entries


def with_springs(text, entries):
    tendons = ""
    for entry in entries:
        for end, (frame, point) in enumerate(zip(entry["frames"], entry["points"])):
            site = f'<site name="{entry["name"]}_{end}" pos="{" ".join(map(repr, point))}"/>'
            before = f'<joint name="q{frame}" ' if frame else "<body "
            text = text.replace(before, site + before, 1)
        ends = "".join(f'<site site="{entry["name"]}_{end}"/>' for end in (0, 1))
        tendons += f'<spatial stiffness="{entry["stiffness"]!r}" springlength="{entry["rest"]!r}">{ends}</spatial>'
    return text.replace("</tendon>", tendons + "</tendon>")


def table(rows, entries):
    lines, values = ["springs:"], ""
    for entry in entries:
        points = ", ".join(f"{{frame: {f}, point: {p}}}" for f, p in zip(entry["frames"], entry["points"]))
        rest = f", rest: {entry['rest']!r}" if entry["known"] else ""
        lines.append(f"  - {{between: [{points}]{rest}, name: {entry['name']}}}")
        values += f", K_{entry['name']}: {entry['stiffness']!r}"
        if not entry["known"]:
            values += f", KR_{entry['name']}: {entry['stiffness'] * entry['rest']!r}"
    text = yaml(rows, []).replace("friction:\nsprings:", "\n".join(lines))
    return text.replace("}}\n", values + "}}\n")


def main():
    random = np.random.default_rng(41)
    cases = []
    while len(cases) < 16:
        rows = chain(random)
        entries = springs(random, rows)
        model = mujoco.MjModel.from_xml_string(with_springs(mjcf(rows, []), entries))
        data, states, torques, lengths = mujoco.MjData(model), [], [], []
        for _ in range(4):
            q, dq, ddq = (random.uniform(-2, 2, len(rows)) for _ in range(3))
            data.qpos[:], data.qvel[:], data.qacc[:] = q, dq, ddq
            mujoco.mj_inverse(model, data)
            states.append([list(map(float, x)) for x in (q, dq, ddq)])
            torques.append(list(map(float, data.qfrc_inverse)))
            lengths.append(data.ten_length.copy())
        # A length that no joint changes is refused by the table's reader, and is another test.
        if np.ptp(lengths, axis=0).min() > 1e-3:
            cases.append({"yaml": table(rows, entries), "states": states, "torques": torques})
    with open(FILE, "w") as file:
        file.write("[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]\n")
    print(f"{len(cases)} tables: {FILE}")


if __name__ == "__main__":
    main()
