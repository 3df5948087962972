"""Effects that add a torque at a joint, written from the mechanics literature: friction, springs, ripple, pushes.

A builder draws joint and shape and leaves one number free, the size, which is chosen later so that the effect can be
seen; torques are in units of the Coulomb friction of the joint. Nothing here is taken from dynid's own laws.
"""

from dataclasses import dataclass, field, replace
from typing import Callable

import numpy as np
import pinocchio as pin

from motions import RATE


@dataclass(frozen=True)
class Effect:
    """A hidden effect: its name (dynid's id where the catalogue has it), joints from 1 on, size and the largest size.

    `accepted`: ids that describe the same physics as well, by the table of equivalents of the judge. `needs` holds
    "baseline" where only a comparison shows it, "no_baseline" where it cannot come, "one_motion" where it goes on in
    time, "stops" where it needs dwells.
    """

    name: str
    joints: tuple
    size: float
    most: float
    shape: dict = field(default_factory=dict)
    needs: frozenset = frozenset()
    window: tuple | None = None

    def change(self, robot):
        """The robot with other bodies or lengths than the table's."""
        return robot

    def torque(self, ideal):
        """Torque at the joints that comes on top, by row and joint."""
        return 0.0

    def transmit(self, ideal):
        """What lies between motor and link."""
        return ideal

    def record(self, ideal):
        """What channels make of it."""
        return ideal


@dataclass(frozen=True)
class Law(Effect):
    """A torque at the last of `joints`: size * law(ideal), times the Coulomb friction of the joint if `of_friction`."""

    law: Callable = None
    of_friction: bool = True

    def torque(self, ideal):
        j = self.joints[-1] - 1
        out = np.zeros_like(ideal.torque)
        out[:, j] = self.law(ideal) * self.size * (ideal.robot.coulomb[j] if self.of_friction else 1.0)
        return out


def _joint(rng, robot):
    return int(rng.integers(robot.joints))


def _two(rng, robot):
    i, j = rng.choice(robot.joints, 2, replace=False)
    return int(i), int(j)


def _unit(robot, q, j):
    """Position from -1 to 1 over the travel that is used."""
    return (q[:, j] - robot.middle[j]) / robot.reach[j]


def stribeck(rng, scene):
    """Friction above the Coulomb level near rest (Armstrong-Helouvry 1994), exponent 1 (Tustin) or 2 (Gauss)."""
    j = _joint(rng, scene.robot)
    speed, power = scene.robot.speed[j] * rng.uniform(0.01, 0.08), int(rng.integers(1, 3))
    law = lambda x: np.exp(-((np.abs(x.motion.v[:, j]) / speed) ** power)) * x.motion.slide[:, j]
    return Law("stribeck", (j + 1,), 0.5, 2.5, {"vs": speed, "power": power}, law=law)


def nonlinear_viscous(rng, scene):
    """Viscous friction that bends: a power of the speed, or shear thinning after Eyring, asinh(v / v1)."""
    j = _joint(rng, scene.robot)
    top, kind = scene.robot.speed[j], rng.choice(["thin", "thick", "eyring"])
    power = rng.uniform(0.35, 0.7) if kind == "thin" else rng.uniform(1.7, 2.5)
    if kind == "eyring":
        law = lambda x: np.arcsinh(x.motion.v[:, j] / (0.05 * top)) / np.arcsinh(20)
    else:
        law = lambda x: np.abs(x.motion.v[:, j] / top) ** power * np.sign(x.motion.v[:, j])
    return Law("nonlinear_viscous", (j + 1,), 1.0, 5.0, {"kind": str(kind), "p": power}, law=law)


def load_dependent_friction(rng, scene):
    """Coulomb friction in proportion to the transmitted torque, that of the links or with the rotor's."""
    j, rotor = _joint(rng, scene.robot), bool(rng.integers(2))
    law = lambda x: np.abs(x.link[:, j] + rotor * x.robot.rotor[j] * x.motion.a[:, j]) * x.motion.slide[:, j]
    return Law("load_dependent_friction", (j + 1,), 0.05, 0.3, {"with_rotor": rotor}, law=law, of_friction=False)


def position_dependent_friction(rng, scene):
    """Coulomb level that varies along the travel: waves, or a worn section."""
    j, robot = _joint(rng, scene.robot), scene.robot
    waves, phase, worn = rng.uniform(0.6, 2.5), rng.uniform(0, 2 * np.pi), rng.random() < 0.3
    centre, width = rng.uniform(-0.6, 0.6), rng.uniform(0.2, 0.4)
    if worn:
        law = lambda x: np.exp(-(((_unit(robot, x.motion.q, j) - centre) / width) ** 2)) * x.motion.slide[:, j]
    else:
        law = lambda x: np.cos(np.pi * waves * _unit(robot, x.motion.q, j) + phase) * x.motion.slide[:, j]
    return Law("position_dependent_friction", (j + 1,), 0.3, 0.9, {"worn": worn, "waves": waves}, law=law)


def asymmetric_friction(rng, scene):
    """Viscous friction that differs between the directions."""
    j = _joint(rng, scene.robot)
    robot = scene.robot
    most = 0.8 * robot.viscous[j] * robot.speed[j] / robot.coulomb[j]  # friction stays friction both ways
    law = lambda x: np.abs(x.motion.v[:, j]) / robot.speed[j]
    return Law("asymmetric_friction", (j + 1,), 0.4 * rng.choice([-1, 1]), most, law=law)


def _dahl(motion, j, distance, power):
    """State of Dahl's model (1968), dz = |1 - z sign v|^power sign(1 - z sign v) dx / distance: from -1 to 1."""
    z = np.empty(len(motion.t))
    now = motion.slide[0, j]
    steps = motion.v[:, j] / RATE / distance
    for k, step in enumerate(steps):
        for _ in range(4):
            away = 1 - now * np.sign(step)
            now += step / 4 * np.sign(away) * abs(away) ** power
            now = min(max(now, -1.0), 1.0)
        z[k] = now
    return z


def presliding_hysteresis(rng, scene):
    """Dahl friction in the place of a part of the Coulomb friction: it builds up over a distance after a reversal."""
    j = _joint(rng, scene.robot)
    distance, power = scene.robot.reach[j] * np.exp(rng.uniform(np.log(0.004), np.log(0.06))), rng.choice([1.0, 1.5])
    law = lambda x: _dahl(x.motion, j, distance, power) - x.motion.slide[:, j]
    return Law("presliding_hysteresis", (j + 1,), 0.5, 1.0, {"distance": distance, "power": power}, law=law)


def friction_drift(rng, scene):
    """Friction that fades exponentially while the joint warms up."""
    j, viscous = _joint(rng, scene.robot), rng.random() < 0.5
    tau = scene.motions[0].t[-1] * rng.uniform(0.2, 0.6)
    level = lambda x: x.motion.slide[:, j] + viscous * x.motion.v[:, j] / scene.robot.speed[j]
    law = lambda x: level(x) * np.exp(-x.motion.t / tau)
    needs = frozenset({"one_motion"})
    return Law("friction_drift", (j + 1,), 0.5, 2.0, {"tau": tau, "viscous": viscous}, needs, law=law)


def friction_level_change(rng, scene):
    """All friction of a joint larger or smaller by a factor than before."""
    j, sign = _joint(rng, scene.robot), rng.choice([-1, 1])
    law = lambda x: x.robot.viscous[j] * x.motion.v[:, j] + x.robot.coulomb[j] * x.motion.slide[:, j]
    needs = frozenset({"baseline"})
    return Law("friction_level_change", (j + 1,), 0.2 * sign, 0.8, {}, needs, law=law, of_friction=False)


def torque_ripple(rng, scene):
    """Cogging: a torque periodic in the motor's angle, of an order that the sampling rate can carry."""
    j, robot = _joint(rng, scene.robot), scene.robot
    top = max(np.abs(m.v[:, j]).max() for m in scene.motions)
    orders = [k * robot.gear[j] for k in (1, 2, 4, 6)] + [robot.gear[j] / k for k in (2, 5)]
    fit = [o for o in orders if o * top / (2 * np.pi) < 0.3 * scene.rate and o * 2 * robot.reach[j] > 8 * np.pi]
    order, phase = rng.choice(fit or [8 * np.pi / robot.reach[j]]), rng.uniform(0, 2 * np.pi)
    law = lambda x: np.sin(order * x.motion.q[:, j] + phase)
    return Law("torque_ripple", (j + 1,), 0.3, 1.0, {"order": float(order)}, law=law)


def spring(rng, scene):
    """A linear spring at the joint, or a balancer: a spring between a lever on the link and a point of the base."""
    j, robot = _joint(rng, scene.robot), scene.robot
    at = robot.middle[j] + rng.uniform(-0.5, 0.5) * robot.reach[j]
    balancer = not robot.rows[j].prismatic and rng.random() < 0.5
    lever, free = rng.uniform(0.3, 0.6), rng.uniform(0.3, 0.6)

    def pull(x):
        if not balancer:
            return (x.motion.q[:, j] - at) / robot.reach[j]
        angle = x.motion.q[:, j] - at
        length = np.sqrt(1 + lever**2 - 2 * lever * np.cos(angle))
        return (length - free) * lever * np.sin(angle) / length / lever

    return Law("spring", (j + 1,), 1.0, 6.0, {"balancer": balancer, "lever": lever, "rest": at}, law=pull)


def position_dependent_torque(rng, scene):
    """A cable that is bent over, tanh, or a magnet that is passed, a bell."""
    j, robot = _joint(rng, scene.robot), scene.robot
    cable, centre, width = rng.random() < 0.5, rng.uniform(-0.4, 0.4), rng.uniform(0.15, 0.4)
    bell = lambda s: np.tanh(s) if cable else np.exp(-(s**2))
    law = lambda x: bell((_unit(robot, x.motion.q, j) - centre) / width)
    return Law("position_dependent_torque", (j + 1,), 1.0, 5.0, {"cable": cable, "width": width}, law=law)


def drive_efficiency(rng, scene):
    """Losses of a gear in proportion to the power that it transmits, other ones when it is driven by the load."""
    j, ratio = _joint(rng, scene.robot), rng.choice([0.3, 0.6, 1.6])

    @dataclass(frozen=True)
    class Efficiency(Effect):
        def torque(self, ideal):
            link, forward = ideal.link[:, j], ideal.link[:, j] * ideal.motion.v[:, j] > 0
            backward = ideal.link[:, j] * ideal.motion.v[:, j] < 0
            out = np.zeros_like(ideal.torque)
            out[:, j] = link * (forward * (1 / (1 - self.size) - 1) - backward * min(self.size * ratio, 0.8))
            return out

    return Efficiency("drive_efficiency", (j + 1,), 0.1, 0.5, {"ratio_of_losses": float(ratio)})


def coupled_transmission(rng, scene):
    """A rotor that two joints turn at once, with Coulomb, viscous friction and inertia of its own."""
    i, j = sorted(_two(rng, scene.robot))
    i = j - 1 if rng.random() < 0.7 else i
    ratio = float(rng.choice([-1.0, -0.5, 0.5, 1.0])) * scene.robot.speed[j] / scene.robot.speed[i]

    @dataclass(frozen=True)
    class Coupled(Effect):
        def torque(self, ideal):
            m, robot = ideal.motion, ideal.robot
            speed, acceleration = m.v[:, j] + ratio * m.v[:, i], m.a[:, j] + ratio * m.a[:, i]
            dry = np.where(np.abs(speed) > 1e-7, np.sign(speed), m.slide[:, j])
            own = robot.coulomb[j] * dry + robot.viscous[j] * speed + 0.3 * robot.rotor[j] * acceleration
            out = np.zeros_like(ideal.torque)
            out[:, j], out[:, i] = self.size * own, self.size * ratio * own
            return out

    return Coupled("coupled_transmission", (i + 1, j + 1), 0.5, 1.5, {"ratio": ratio})


def contact(rng, scene):
    """A push of 0.15 to 3 s: on one joint, or a force at the flange; a half sine or a plateau with soft edges."""
    robot, m = scene.robot, scene.motions[int(rng.integers(len(scene.motions)))]
    lasts = min(np.exp(rng.uniform(np.log(0.15), np.log(3.0))), 0.3 * m.t[-1])
    start = rng.uniform(0.1, 0.85) * (m.t[-1] - lasts)
    edge = rng.uniform(0.02, 0.06)
    j, flange, plateau = _joint(rng, robot), rng.random() < 0.5, rng.random() < 0.5
    force = rng.normal(size=3)
    force /= np.linalg.norm(force)

    @dataclass(frozen=True)
    class Push(Effect):
        def torque(self, ideal):
            x, out = ideal.motion, np.zeros_like(ideal.torque)
            s = x.t - start
            rise = np.minimum(np.clip(s / edge, 0, 1), np.clip((lasts - s) / edge, 0, 1))
            height = rise if plateau else np.sin(np.pi * np.clip(s / lasts, 0, 1))
            if x.number != m.number:
                return out
            if not flange:
                out[:, j] = self.size * robot.coulomb[j] * height
                return out
            model = robot.model()
            data = model.createData()
            arm = robot.coulomb[j] / max(0.2, sum(abs(r.d) + abs(r.r) for r in robot.rows) / 2)
            for k in np.flatnonzero(height):
                pin.computeJointJacobians(model, data, x.q[k])
                jacobian = pin.getJointJacobian(model, data, robot.joints, pin.LOCAL_WORLD_ALIGNED)
                out[k] = -self.size * arm * height[k] * (jacobian[:3].T @ force)
            return out

    joints = tuple(range(1, robot.joints + 1)) if flange else (j + 1,)
    window = (m.number, start, start + lasts)
    return Push("contact", joints, 1.0, 20.0, {"flange": flange, "lasts": lasts}, window=window)


CATALOGUE = {
    f.__name__: f
    for f in (
        stribeck, nonlinear_viscous, load_dependent_friction, position_dependent_friction, asymmetric_friction,
        presliding_hysteresis, friction_drift, friction_level_change, torque_ripple, spring, position_dependent_torque,
        drive_efficiency, coupled_transmission, contact,
    )
}  # fmt: skip


def resized(effect, size):
    return replace(effect, size=float(np.sign(effect.size) * min(abs(size), effect.most)))
