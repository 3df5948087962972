"""Effects of bodies, geometry, transmissions and recording channels, and those that no catalogue has.

Builders as in `laws`. A transmission with compliance or play is integrated for the deflection between motor and link,
with the link's dynamics linearised about the motor's motion (deflections are of the order of a milliradian).
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
from scipy.optimize import brentq

from laws import Effect, Law, _joint, _two, _unit
from motions import RATE
from plant import linearised
from robots import Body


def payload(rng, scene):
    """A body at the flange: mass in parts of the last link's, beside the axis."""
    robot, j = scene.robot, scene.robot.joints
    return _body("payload", j, rng, robot)


def added_mass(rng, scene):
    """A body on an inner link: a dress pack, a valve block."""
    return _body("added_mass", int(rng.integers(1, scene.robot.joints)), rng, scene.robot)


def _body(name, joint, rng, robot):
    own = robot.bodies[joint - 1]
    edge = max(own.edges)
    place = tuple(np.array(own.centre) + rng.uniform(-0.5, 0.5, 3) * edge)

    @dataclass(frozen=True)
    class Attached(Effect):
        def change(self, robot):
            body = Body(self.size * own.mass, place, (0.3 * edge, 0.2 * edge, 0.25 * edge), 0.5)
            return replace(robot, loads=robot.loads + ((joint, body),))

    shape = {"kg_per_size": own.mass, "centre": place}
    return Attached(name, (joint,), 0.3, 4.0 if name == "payload" else 1.0, shape, frozenset({"baseline"}))


def base_tilt(rng, scene):
    """Gravity from another direction: the base turned by an angle, rad, about an axis across gravity."""
    gravity = np.array(scene.robot.gravity)
    axis = np.cross(gravity, rng.normal(size=3))
    axis /= np.linalg.norm(axis)

    @dataclass(frozen=True)
    class Tilt(Effect):
        def change(self, robot):
            return replace(robot, gravity=tuple(pin.exp3(axis * self.size) @ np.array(robot.gravity)))

    return Tilt("base_tilt", (), 0.05, 0.25, {"axis": [float(x) for x in axis]})


def geometry_error(rng, scene):
    """A length of the table that is not the real one; the size is the error in parts of the length."""
    j, key = scene.robot.lengths()[int(rng.integers(len(scene.robot.lengths())))]
    length = getattr(scene.robot.rows[j], key)

    @dataclass(frozen=True)
    class Length(Effect):
        def change(self, robot):
            return robot.with_length(j, key, length * (1 + self.size))

    needs = frozenset({"no_baseline"})
    return Length("geometry_error", (j + 1,), 0.1 * rng.choice([-1, 1]), 0.4, {"length": key}, needs)


def joint_elasticity(rng, scene):
    """A compliant transmission; the encoder is on the motor. Size: compliance, 1 where the link swings at 12 Hz."""
    j = _joint(rng, scene.robot)
    damping = rng.uniform(0.02, 0.08)
    return _transmission("joint_elasticity", j, 0.5, 9.0, damping)


def backlash(rng, scene):
    """Play between motor and link, of the size in rad or m, in a transmission of 30 Hz."""
    j = _joint(rng, scene.robot)
    most = 0.02 if not scene.robot.rows[j].prismatic else 0.002
    return _transmission("backlash", j, 0.2 * most, most, rng.uniform(0.05, 0.15))


def _transmission(name, j, size, most, damping):
    @dataclass(frozen=True)
    class Transmission(Effect):
        def transmit(self, ideal):
            gap, hertz = (self.size, 30.0) if name == "backlash" else (0.0, 12.0 / math.sqrt(self.size))
            mass, slope, stiffness = linearised(ideal.robot, ideal.motion)
            inertia = float(np.mean(mass[:, j, j]))
            k = inertia * (2 * np.pi * hertz) ** 2
            d = 2 * damping * math.sqrt(k * inertia)
            e, de = _deflection(ideal.link[:, j], mass[:, j, j], slope[:, j, j], stiffness[:, j, j], k, d, gap)
            dde = np.gradient(de, 1 / RATE)
            extra = mass[:, :, j] * dde[:, None] + slope[:, :, j] * de[:, None] + stiffness[:, :, j] * e[:, None]
            m = ideal.moved
            moved = replace(m, q=_put(m.q, j, e), v=_put(m.v, j, de), a=_put(m.a, j, dde))
            return replace(ideal, moved=moved, torque=ideal.torque + extra)

    return Transmission(name, (j + 1,), size, most, {"damping_ratio": damping})


def _put(x, j, more):
    x = x.copy()
    x[:, j] += more
    return x


def _deflection(link, mass, slope, stiffness, k, d, gap, substeps=8):
    """Link less motor, and its speed: mass e" + slope e' + stiffness e + link = -(k (e beyond the play) + d e')."""
    h, half = 1 / RATE / substeps, gap / 2
    e, de = -link[0] / k - math.copysign(half, link[0]), 0.0
    out, speed = np.empty(len(link)), np.empty(len(link))
    for i in range(len(link)):
        out[i], speed[i] = e, de
        n = min(i + 1, len(link) - 1)
        for s in range(substeps):
            load = link[i] + (link[n] - link[i]) * s / substeps
            beyond = e - half if e > half else e + half if e < -half else 0.0
            pull = k * beyond + (d * de if beyond else 0.0)
            if beyond and pull * beyond < 0:
                pull = 0.0
            de += h * -(load + pull + slope[i] * de + stiffness[i] * e) / mass[i]
            e += h * de
    return out, speed


@dataclass(frozen=True)
class Channel(Effect):
    """A change of what is recorded: `change_record(ideal, size)` gives the ideal recording with it."""

    change_record: object = None

    def record(self, ideal):
        return self.change_record(ideal, self.size)


def _torque_of(j, factor):
    def changed(ideal, size):
        torque = ideal.torque.copy()
        torque[:, j] = factor(ideal, size)
        return replace(ideal, torque=torque)

    return changed


def torque_constant_error(rng, scene):
    """The torque of a joint recorded by a wrong factor."""
    j = _joint(rng, scene.robot)
    change = _torque_of(j, lambda x, size: x.torque[:, j] * (1 + size))
    return Channel("torque_constant_error", (j + 1,), 0.1 * rng.choice([-1, 1]), 0.4, change_record=change)


def torque_constant_drift(rng, scene):
    """Magnets that warm up: more current for the same torque, exponentially in time."""
    j = _joint(rng, scene.robot)
    tau = scene.motions[0].t[-1] * rng.uniform(0.3, 1.0)
    change = _torque_of(j, lambda x, size: x.torque[:, j] * (1 + size * (1 - np.exp(-x.motion.t / tau))))
    needs = frozenset({"one_motion"})
    return Channel("torque_constant_drift", (j + 1,), 0.2, 0.5, {"tau": tau}, needs, change_record=change)


def torque_crosstalk(rng, scene):
    """A torque channel that hears a neighbour."""
    i, j = _two(rng, scene.robot)
    change = _torque_of(j, lambda x, size: x.torque[:, j] + size * x.torque[:, i])
    return Channel("torque_crosstalk", (i + 1, j + 1), 0.05, 0.3, change_record=change)


def torque_saturation(rng, scene):
    """Iron that saturates: torque = s tanh(current / s), recorded as proportional. Size: what lacks at most, a part."""
    j = _joint(rng, scene.robot)

    def change(x, size):
        most = scene.most_torque[j]
        # The scale with which the recorded torque at the most is most / (1 - size).
        s = brentq(lambda s: s * np.tanh(most / (1 - size) / s) - most, most, 100 * most)
        return s * np.arctanh(np.clip(x.torque[:, j] / s, -0.9999, 0.9999))

    return Channel("torque_saturation", (j + 1,), 0.1, 0.4, change_record=_torque_of(j, change))


def time_delay(rng, scene):
    """All torques recorded later than the positions, by the size in s."""

    def change(x, size):
        late = np.clip(x.motion.t - size, 0, None)
        return replace(x, torque=np.stack([np.interp(late, x.motion.t, c) for c in x.torque.T], 1))

    return Channel("time_delay", (), 0.004, 0.03, change_record=change)


def wrong_sample_rate(rng, scene):
    """Stamps that run too fast or too slow: the declared time is the real one times 1 + size."""

    def change(x, size):
        m, c = x.motion, 1 + size
        return replace(x, motion=replace(m, t=m.t * c, v=m.v / c, a=m.a / c**2))

    return Channel("wrong_sample_rate", (), 0.08 * rng.choice([-1, 1]), 0.2, change_record=change)


def position_offset(rng, scene):
    """An encoder whose zero is off."""
    j = _joint(rng, scene.robot)
    change = lambda x, size: replace(x, motion=replace(x.motion, q=_put(x.motion.q, j, size)))
    return Channel("position_offset", (j + 1,), 0.08 * rng.choice([-1, 1]), 0.3, change_record=change)


CATALOGUE = {
    f.__name__: f
    for f in (
        payload, added_mass, base_tilt, geometry_error, joint_elasticity, backlash, torque_constant_error,
        torque_constant_drift, torque_crosstalk, torque_saturation, time_delay, wrong_sample_rate, position_offset,
    )
}  # fmt: skip


def product_of_positions(rng, scene):
    """A hose between two links: a torque of the product of two positions."""
    i, j = _two(rng, scene.robot)
    law = lambda x: _unit(scene.robot, x.motion.q, i) * _unit(scene.robot, x.motion.q, j)
    return Law("product_of_positions", (i + 1, j + 1), 1.0, 5.0, law=law)


def friction_of_another_angle(rng, scene):
    """A bearing that is pressed harder where another joint stands."""
    i, j = _two(rng, scene.robot)
    waves, phase = rng.uniform(0.4, 1.2), rng.uniform(0, 2 * np.pi)
    law = lambda x: np.cos(np.pi * waves * _unit(scene.robot, x.motion.q, i) + phase) * x.motion.slide[:, j]
    return Law("friction_of_another_angle", (i + 1, j + 1), 0.4, 0.9, law=law)


def swirl(rng, scene):
    """A fluid that is thrown outward: a torque of the square of another joint's speed."""
    i, j = _two(rng, scene.robot)
    law = lambda x: (x.motion.v[:, i] / scene.robot.speed[i]) ** 2
    return Law("swirl", (i + 1, j + 1), 1.0, 4.0, law=law)


def heating(rng, scene):
    """Friction that falls with a temperature which friction power raises: a state, not a law of time."""
    j = _joint(rng, scene.robot)
    tau = scene.motions[0].t[-1] * rng.uniform(0.1, 0.4)

    def law(x):
        power, warm, out = np.abs(x.motion.v[:, j]) / scene.robot.speed[j], 0.0, np.empty(len(x.motion.t))
        for k, p in enumerate(power):
            warm += (3 * p - warm) / tau / RATE
            out[k] = -warm
        return out * x.motion.slide[:, j]

    return Law("heating", (j + 1,), 0.4, 0.9, {"tau": tau}, frozenset({"one_motion"}), law=law)


def friction_after_rest(rng, scene):
    """Friction that has grown while the joint stood, and is worn off along a distance."""
    j = _joint(rng, scene.robot)
    tau, distance = rng.uniform(0.2, 0.8), scene.robot.reach[j] * rng.uniform(0.05, 0.2)

    def law(x):
        held, out = 0.0, np.empty(len(x.motion.t))
        for k, (rest, v) in enumerate(zip(x.motion.rest[:, j], np.abs(x.motion.v[:, j]))):
            held += (1 - held) / tau / RATE if rest else -held * v / distance / RATE
            out[k] = held
        return out * x.motion.slide[:, j]

    return Law("friction_after_rest", (j + 1,), 0.8, 2.5, {"tau": tau}, frozenset({"stops"}), law=law)


OUTSIDE = {
    f.__name__: f for f in (product_of_positions, friction_of_another_angle, swirl, heating, friction_after_rest)
}
