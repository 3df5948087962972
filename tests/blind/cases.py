"""Cases: a robot, its sensors, motions and hidden effects drawn by a seed, and the folder that dynid is given.

    python tests/blind/cases.py KIND SEED FOLDER [--baseline]

KIND: null, single, pair, outside or the name of an effect. The folder holds robot.yaml, recording.yaml and its CSV,
baseline.yaml where there is one; the truth is written beside the folder, FOLDER.truth.json.
"""

import argparse
import json
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import devices
import laws
import motions
import sensors
from plant import Sight, simulate
from robots import ROBOTS

EFFECTS = laws.CATALOGUE | devices.CATALOGUE
STANDING = ("stribeck", "torque_ripple", "position_dependent_friction", "nonlinear_viscous")
SIZES = (2.5, 6.0)  # what can be seen, in units of the noise in the band
BANDS = (0.02, 0.005)  # s: blocks over which torques are averaged to measure that, 25 and 100 Hz


@dataclass
class Scene:
    """What a builder of effects may know: the robot, the motions of the recording, its rate, the largest torques."""

    robot: object
    motions: list
    baseline: list
    rate: int
    most_torque: np.ndarray
    sensors: object


class NotVisible(Exception):
    """No size of the effect within its bounds can be seen in these motions."""


def draw(seed, kind, baseline):
    """The case of a seed: scene, hidden effects, effects that stand in both recordings, what is visible of each."""
    for attempt in range(40):
        # zlib.crc32 and not hash(): the same seed gives the same bytes in every process.
        rng = np.random.default_rng([seed, zlib.crc32(kind.encode()), int(baseline), attempt])
        names = _names(rng, seed, kind)
        try:
            return _draw(rng, names, baseline)
        except NotVisible:
            continue
    raise NotVisible(f"{kind}, seed {seed}: nothing visible in 40 draws")


def _names(rng, seed, kind):
    if kind == "single":
        return [list(EFFECTS)[seed % len(EFFECTS)]]
    if kind == "pair":
        return [str(x) for x in rng.choice([e for e in EFFECTS if e != "wrong_sample_rate"], 2, replace=False)]
    if kind == "outside":
        return [list(devices.OUTSIDE)[seed % len(devices.OUTSIDE)]]
    return [] if kind == "null" else [kind]


def _draw(rng, names, baseline):
    robot = ROBOTS[int(rng.integers(len(ROBOTS)))]
    seen_by = sensors.draw(rng)
    known = EFFECTS | devices.OUTSIDE
    one_motion = any(n in ("friction_drift", "torque_constant_drift", "heating") for n in names)
    stops = "friction_after_rest" in names
    count = 1 if one_motion else int(rng.integers(1, 4))
    recorded = _motions(rng, robot, count, 0, stops)
    before = _motions(rng, robot, int(rng.integers(1, 4)), -10, stops)
    most = np.max([np.abs(simulate(robot, m).torque).max(0) for m in recorded], 0)
    scene = Scene(robot, recorded, before if baseline else [], seen_by.rate, most, seen_by)
    hidden, sizes = [], []
    drawn = [known[name](rng, scene) for name in names]
    if any("no_baseline" in e.needs for e in drawn):
        scene.baseline = []
    elif any("baseline" in e.needs for e in drawn):
        scene.baseline = before
    for effect in drawn:
        effect, seen = _scaled(rng, scene, effect, float(rng.choice(SIZES)))
        hidden.append(effect)
        sizes.append(seen)
    standing = []
    if scene.baseline and rng.random() < 0.6:
        effect = EFFECTS[str(rng.choice(STANDING))](rng, scene)
        try:
            standing.append(_scaled(rng, scene, effect, rng.uniform(0.5, 2.0))[0])
        except NotVisible:
            pass
    return scene, hidden, sizes, standing


def _motions(rng, robot, count, first, stops):
    kinds = ["pick_and_place", "s_curve"] if stops else list(motions.KINDS)
    weights = None if stops else [0.35, 0.25, 0.2, 0.08, 0.12]
    total = rng.uniform(9, 28)
    lengths = rng.dirichlet(np.full(count, 8.0)) * total
    drawn = [str(rng.choice(kinds, p=weights)) for _ in range(count)]
    if count == 1 and drawn[0] in ("slow", "sweep"):
        lengths = lengths + 8
    return [motions.draw(rng, robot, k, max(s, 5.0), first + i) for i, (k, s) in enumerate(zip(drawn, lengths))]


def _noise_in_band(scene, block):
    """Standard deviation of the torque noise of each joint in blocks of `block` s."""
    m = scene.motions[0]
    ideal = simulate(scene.robot, m).torque[:: motions.RATE // scene.rate]
    noise = scene.sensors.torque_noise(np.random.default_rng(0), scene.robot, ideal)
    rows = max(int(round(block * scene.rate)), 1)
    n = len(noise) // rows
    return noise[: n * rows].reshape(n, rows, -1).mean(1).std(0) + 1e-12


def _scaled(rng, scene, effect, aim):
    """The effect in a size that makes about `aim` of it visible, and by joint what is visible."""
    ideals = scene.baseline + scene.motions
    target = range(len(scene.baseline), len(ideals))
    before = [simulate(scene.robot, m) for m in ideals]
    bands = [(b, _noise_in_band(scene, b)) for b in BANDS if b * scene.rate >= 1]
    sight, seen, size = Sight(scene.robot, before, target, bands), None, abs(effect.size)
    for _ in range(7):
        effect = laws.resized(effect, size)
        after = [simulate(scene.robot, m, [effect] * (k in target)) for k, m in enumerate(ideals)]
        if not all(np.isfinite(i.torque).all() for i in after):
            raise NotVisible
        seen = sight.visible(after, effect.window)
        if abs(seen.max() / aim - 1) < 0.15:
            break
        if abs(effect.size) >= effect.most and seen.max() < aim or seen.max() < 1e-6:
            break
        size = abs(effect.size) * min(max(aim / seen.max(), 0.05), 20.0)
    if not 0.75 * aim < seen.max() < 1.5 * aim:
        raise NotVisible
    return effect, seen


def write(case, folder, seed):
    """Write what dynid is given into the folder, and the truth beside it."""
    scene, hidden, sizes, standing = case
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "robot.yaml").write_text(scene.robot.yaml())
    rng = np.random.default_rng([seed, 1])
    _recording(folder, "recording", scene, scene.motions, standing + hidden, rng)
    if scene.baseline:
        _recording(folder, "baseline", scene, scene.baseline, standing, rng)
    truth = {
        "robot": scene.robot.name,
        "sensors": vars(scene.sensors),
        "effects": [_told(e, [round(float(x), 2) for x in s]) for e, s in zip(hidden, sizes)],
        "standing": [_told(e, None) for e in standing],
        "baseline": bool(scene.baseline),
    }
    Path(f"{folder}.truth.json").write_text(json.dumps(truth, indent=1, default=str) + "\n")
    return truth


def _told(e, seen):
    told = {"effect": e.name, "joints": e.joints, "size": e.size, "shape": e.shape, "window": e.window}
    return told | ({"visible": max(seen), "visible_by_joint": seen} if seen else {})


def _recording(folder, name, scene, drawn, effects, rng):
    robot, seen_by = scene.robot, scene.sensors
    n = robot.joints
    gear = np.array(robot.gear, float) if seen_by.side != "joint" else np.ones(n)
    gain = np.round(0.2 * np.array(robot.coulomb) / gear, 9)  # N.m per ampere at the motor
    files = []
    for k, m in enumerate(drawn, 1):
        t, q, v, torque = seen_by.sample(rng, robot, simulate(robot, m, effects))
        torque = torque / gear / (gain if seen_by.side == "current" else 1.0)
        channels = {"q": q * gear} | ({"v": v * gear} if seen_by.speeds else {}) | {"m": torque}
        parts = [t[:, None]] * seen_by.stamps + list(channels.values())
        head = ["t"] * seen_by.stamps + [f"{c}{j}" for c in channels for j in range(1, n + 1)]
        files.append(f"{name}{k}.csv")
        np.savetxt(folder / files[-1], np.hstack(parts), "%.9g", ",", header=",".join(head), comments="")
    prismatic = [r.prismatic for r in robot.rows]
    on_motor = seen_by.side != "joint"
    unit = lambda metre, radian: [metre if p and not on_motor else radian for p in prismatic]
    columns = lambda c: "[" + ", ".join(f"{c}{j}" for j in range(1, n + 1)) + "]"
    torque = "A" if seen_by.side == "current" else _list(unit("N", "N.m"))
    lines = [
        "robot: ./robot.yaml",
        f"side: {'motor' if on_motor else 'joint'}",
        "time: {column: t, unit: s}" if seen_by.stamps else f"time: {{rate: {_declared(scene, effects)}}}",
        f"position: {{columns: {columns('q')}, unit: {_list(unit('m', 'rad'))}}}",
        f"velocity: {{columns: {columns('v')}, unit: {_list(unit('m/s', 'rad/s'))}}}" if seen_by.speeds else "",
        f"torque: {{columns: {columns('m')}, unit: {torque}"
        + (f", gain: {[float(g) for g in gain]}" if seen_by.side == "current" else "")
        + "}",
        "trajectories:",
    ] + [f"  - {{file: {f}}}" for f in files]
    (folder / f"{name}.yaml").write_text("\n".join(x for x in lines if x) + "\n")


def _declared(scene, effects):
    """The declared rate, Hz: not the real one where the time base is hidden to be wrong."""
    wrong = [e.size for e in effects if e.name == "wrong_sample_rate"]
    return f"{scene.rate / (1 + wrong[0]):.9g}" if wrong else scene.rate


def _list(items):
    return "[" + ", ".join(items) + "]"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind")
    parser.add_argument("seed", type=int)
    parser.add_argument("folder")
    parser.add_argument("--baseline", action="store_true")
    a = parser.parse_args()
    print(json.dumps(write(draw(a.seed, a.kind, a.baseline), a.folder, a.seed), indent=1, default=str))


if __name__ == "__main__":
    main()
