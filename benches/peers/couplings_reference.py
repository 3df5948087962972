"""Torques by MuJoCo of random chains with friction between links and springs: `tests/couplings.json`.

    peers/bin/pip install mujoco numpy
    peers/bin/python benches/peers/couplings_reference.py

A combination of joints is a fixed tendon there, with damping, frictionloss, stiffness and springlength. frictionloss is a
constraint that saturates; states are fast enough for it, and its time constant is short.
"""

import json
import os

import mujoco
import numpy as np

FILE = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "tests/couplings.json")
GRAVITY = [0.0, -3.0, -9.0]


def chain(random):
    """Rows of a table and bodies at the frames: mass, centre, inertia at the centre."""
    rows = []
    for k in range(int(random.integers(2, 7))):
        prismatic = k > 0 and random.random() < 0.25
        number = lambda low, high: round(float(random.uniform(low, high)), 3)
        row = {"sigma": int(prismatic), "alpha": number(-2, 2), "d": number(-0.4, 0.4), "theta": number(-2, 2), "r": number(-0.3, 0.3)}
        half = random.uniform(0.02, 0.2, (3, 3))
        spread = half @ half.T + 0.01 * np.eye(3)
        row |= {"mass": number(0.5, 5), "centre": [number(-0.2, 0.2) for _ in range(3)], "inertia": np.trace(spread) * np.eye(3) - spread}
        rows.append(row)
    return rows


def combinations(random, rows):
    """Entries of friction and springs, their stiffnesses independent."""
    n, entries, directions = len(rows), [], []
    for law in ["friction"] * int(random.integers(1, 3)) + ["spring"] * int(random.integers(1, 3)):
        while True:
            joints = sorted(random.choice(n, int(random.integers(1 if law == "spring" else 2, n + 1)), replace=False))
            terms = {int(j): float(random.choice([1, -1, 0.5, -2])) for j in joints}
            first = next(iter(terms.values()))
            direction = (law, tuple((j, c / first) for j, c in terms.items()))
            if direction not in directions:
                break
        directions.append(direction)
        entry = {"law": law, "terms": terms, "name": f"c{len(entries)}"}
        if law == "friction":
            entry |= {"viscous": float(random.uniform(0.5, 3)), "dry": float(random.uniform(0.5, 4))}
        else:
            entry |= {"stiffness": float(random.uniform(5, 80)), "rest": float(random.uniform(-1, 1)), "known": bool(random.random() < 0.5)}
        entries.append(entry)
    return entries


def mjcf(rows, entries):
    quaternion = lambda axis, angle: np.r_[np.cos(angle / 2), np.sin(angle / 2) * np.array(axis)]
    text = lambda values: " ".join(repr(float(x)) for x in values)
    out = f'<mujoco><compiler angle="radian" inertiafromgeom="false"/><option gravity="{text(GRAVITY)}"/><worldbody>'
    for k, row in enumerate(rows, 1):
        place = [row["d"], -np.sin(row["alpha"]) * row["r"], np.cos(row["alpha"]) * row["r"]]
        turn = np.zeros(4)
        mujoco.mju_mulQuat(turn, quaternion([1, 0, 0], row["alpha"]), quaternion([0, 0, 1], row["theta"]))
        inertia = row["inertia"]
        full = [inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[0, 2], inertia[1, 2]]
        kind = "slide" if row["sigma"] else "hinge"
        out += f'<body pos="{text(place)}" quat="{text(turn)}"><inertial pos="{text(row["centre"])}" mass="{row["mass"]}" fullinertia="{text(full)}"/>'
        out += f'<joint name="q{k}" type="{kind}" axis="0 0 1"/>'
    out += "</body>" * len(rows) + "</worldbody><tendon>"
    for entry in entries:
        if entry["law"] == "friction":
            law = f'damping="{entry["viscous"]!r}" frictionloss="{entry["dry"]!r}" solreffriction="0.0001 1"'
        else:
            law = f'stiffness="{entry["stiffness"]!r}" springlength="{entry["rest"]!r}"'
        joints = "".join(f'<joint joint="q{j + 1}" coef="{c!r}"/>' for j, c in entry["terms"].items())
        out += f'<fixed name="{entry["name"]}" {law}>{joints}</fixed>'
    return out + "</tendon></mujoco>"


def yaml(rows, entries):
    lines = [f"name: random\ngravity: {GRAVITY}\nframes:"]
    parameters = {}
    for j, row in enumerate(rows, 1):
        theta, r = [f"{row[key]}" + (f" + q{j}" if row["sigma"] == sigma else "") for sigma, key in enumerate(["theta", "r"])]
        lines.append(f"  - {{j: {j}, sigma: {row['sigma']}, alpha: {row['alpha']}, d: {row['d']}, theta: {theta}, r: {r}}}")
        mass, centre = row["mass"], np.array(row["centre"])
        tensor = row["inertia"] + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
        names = ["XX", "XY", "XZ", "YY", "YZ", "ZZ"]
        values = [tensor[0, 0], tensor[0, 1], tensor[0, 2], tensor[1, 1], tensor[1, 2], tensor[2, 2]]
        parameters |= {f"{name}{j}": value for name, value in zip(names, values)}
        parameters |= {f"M{axis}{j}": mass * x for axis, x in zip("XYZ", centre)} | {f"M{j}": mass}
    for key in ["friction", "springs"]:
        chosen = [e for e in entries if (e["law"] == "friction") == (key == "friction")]
        lines.append(f"{key}:")
        for entry in chosen:
            joints = ", ".join(f"q{j + 1}: {c}" for j, c in entry["terms"].items())
            rest = f", rest: {entry['rest']!r}" if entry.get("known") else ""
            lines.append(f"  - {{joints: {{{joints}}}{rest}, name: {entry['name']}}}")
            if key == "friction":
                parameters |= {f"Fvc_{entry['name']}": entry["viscous"], f"Fcc_{entry['name']}": entry["dry"]}
            else:
                parameters[f"K_{entry['name']}"] = entry["stiffness"]
                if not entry["known"]:
                    parameters[f"KR_{entry['name']}"] = entry["stiffness"] * entry["rest"]
    values = ", ".join(f"{name}: {float(value)!r}" for name, value in parameters.items())
    return "\n".join(lines) + f"\nnominal: {{parameters: {{{values}}}}}\n"


def main():
    random = np.random.default_rng(14)
    cases = []
    for _ in range(16):
        rows = chain(random)
        entries = combinations(random, rows)
        model = mujoco.MjModel.from_xml_string(mjcf(rows, entries))
        data, states, torques = mujoco.MjData(model), [], []
        while len(states) < 4:
            q, dq, ddq = (random.uniform(-2, 2, len(rows)) for _ in range(3))
            speeds = [sum(c * dq[j] for j, c in e["terms"].items()) for e in entries]
            if min(abs(s) for s in speeds) < 0.3:
                continue
            data.qpos[:], data.qvel[:], data.qacc[:] = q, dq, ddq
            mujoco.mj_inverse(model, data)
            dry = [e["dry"] for e in entries if e["law"] == "friction"]
            assert np.allclose(np.abs(data.efc_force), dry, rtol=1e-12), (data.efc_force, dry)
            states.append([list(map(float, x)) for x in (q, dq, ddq)])
            torques.append(list(map(float, data.qfrc_inverse)))
        cases.append({"yaml": yaml(rows, entries), "states": states, "torques": torques})
    with open(FILE, "w") as file:
        file.write("[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]\n")
    print(f"{len(cases)} tables: {FILE}")


if __name__ == "__main__":
    main()
