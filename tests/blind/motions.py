"""Motions as a controller moves them: Fourier series, pick and place, slow moves, sweeps of one joint.

Positions, speeds and accelerations on a grid of 1 ms that agree. A joint at rest is held by stiction with
a part of its Coulomb friction that nobody knows; `slide` holds that part, and the direction of motion elsewhere.
"""

from dataclasses import dataclass

import numpy as np

RATE = 1000  # Hz, of the simulation
KINDS = ("fourier", "pick_and_place", "s_curve", "slow", "sweep")


@dataclass(frozen=True, eq=False)  # hashed by identity: what is computed of a motion is kept
class Motion:
    """t in s; q, v, a and slide by row and joint. slide: +1 or -1 while moving, the held part of stiction at rest.

    `number` tells the motions of a recording apart, those of a baseline are below 0.
    """

    number: int
    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    slide: np.ndarray
    rest: np.ndarray


def draw(rng, robot, kind, duration, number):
    """A motion of the kind, of about the duration in s."""
    if kind == "fourier":
        q, v, a = _fourier(rng, robot, duration)
    else:
        q, v, a = _through_points(rng, robot, kind, duration)
    rest = np.abs(v) < 1e-7
    return Motion(number, np.arange(len(q)) / RATE, q, v, a, _slide(rng, v, rest), rest)


def _fourier(rng, robot, duration):
    """Periodic series of 3 to 8 harmonics, scaled to the limits of travel, speed and acceleration."""
    t = np.arange(int(duration * RATE)) / RATE
    period = rng.uniform(0.5, 1.0) * max(duration, 6.0)
    harmonics = np.arange(1, rng.integers(3, 9))
    q, v, a = (np.empty((len(t), robot.joints)) for _ in range(3))
    pace = rng.uniform(0.5, 0.95)
    for j in range(robot.joints):
        w = 2 * np.pi * harmonics / period
        size = rng.uniform(0.2, 1.0, len(w)) / harmonics
        angle = np.outer(t, w) + rng.uniform(0, 2 * np.pi, len(w))
        x, dx, ddx = np.sin(angle) @ size, np.cos(angle) @ (size * w), -np.sin(angle) @ (size * w**2)
        scale = min(
            robot.reach[j] / np.abs(x).max(),
            robot.speed[j] / np.abs(dx).max(),
            robot.acceleration[j] / np.abs(ddx).max(),
        )
        scale *= pace * rng.uniform(0.7, 1.0)
        q[:, j], v[:, j], a[:, j] = robot.middle[j] + scale * x, scale * dx, scale * ddx
    return q, v, a


def _through_points(rng, robot, kind, duration):
    """Trapezoids of speed from point to point with dwells, smoothed over 20 ms (S-curves: 120 ms) as controllers do."""
    joints = robot.joints
    middle, reach = np.array(robot.middle), np.array(robot.reach)
    pace = rng.uniform(0.03, 0.12) if kind == "slow" else rng.uniform(0.5, 0.95)
    dwell = rng.uniform(0.1, 1.2)
    here = middle + rng.uniform(-0.5, 0.5, joints) * reach
    pieces = [_hold(here, rng.uniform(0.2, 0.6))]
    turn, side = 0, 1.0
    while sum(map(len, pieces)) < duration * RATE or kind == "sweep" and turn < 2 * joints:
        there = here.copy()
        if kind == "sweep":  # two strokes of every joint in turn
            j = (turn // 2) % joints
            there[j] = middle[j] + side * rng.uniform(0.4, 1.0) * reach[j]
            turn, side = turn + 1, -side
        elif kind == "slow":
            there = here + rng.uniform(-0.25, 0.25, joints) * reach
            there = np.clip(there, middle - reach, middle + reach)
        else:
            there = middle + rng.uniform(-1, 1, joints) * reach
        pieces.append(_move(robot, here, there, pace, rng.uniform(0.15, 0.45)))
        pieces.append(_hold(there, dwell * rng.uniform(0.5, 1.5)))
        here = there
    width = 120 if kind == "s_curve" else 20
    q = _smooth(_smooth(np.concatenate(pieces), width), width)
    # Differences of what was smoothed: exact to the positions, also where a corner lies between two rows.
    v, a = np.zeros_like(q), np.zeros_like(q)
    v[1:-1] = (q[2:] - q[:-2]) * RATE / 2
    a[1:-1] = (q[2:] - 2 * q[1:-1] + q[:-2]) * RATE**2
    v[np.abs(v) < 1e-7] = 0.0
    return q, v, a


def _hold(q, seconds):
    return np.tile(q, (int(seconds * RATE), 1))


def _move(robot, here, there, pace, ramp):
    """All joints start and stop together; the slowest one moves at `pace` of its limits. `ramp`: part of the time."""
    way = np.abs(there - here)
    at_speed = way / np.array(robot.speed) / (1 - ramp)
    at_acceleration = np.sqrt(way / np.array(robot.acceleration) / (ramp * (1 - ramp)))
    seconds = max(np.max(np.maximum(at_speed, at_acceleration)) / pace, 0.1)
    s = np.arange(int(seconds * RATE)) / (seconds * RATE)
    top = 1 / (1 - ramp)
    up = top * s**2 / (2 * ramp)
    down = 1 - top * (1 - s) ** 2 / (2 * ramp)
    x = np.where(s < ramp, up, np.where(s > 1 - ramp, down, top * (s - ramp / 2)))
    return here + np.outer(x, there - here)


def _smooth(x, width):
    """Moving average over `width` rows, the ends held."""
    padded = np.concatenate([np.repeat(x[:1], width, 0), x, np.repeat(x[-1:], width, 0)])
    total = np.cumsum(padded, 0)
    mean = (total[width:] - total[:-width]) / width
    first = width // 2
    return mean[first : first + len(x)]


def _slide(rng, v, rest):
    slide = np.sign(v)
    for j in range(v.shape[1]):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], rest[:, j].astype(int), [0]])))
        for start, end in zip(edges[::2], edges[1::2]):
            before = slide[start - 1, j] if start else rng.choice([-1.0, 1.0])
            slide[start:end, j] = before * rng.uniform(-0.3, 1.0)
    return slide
