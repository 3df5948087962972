"""The robot in motion: torques by Pinocchio, and how much of a hidden effect can be seen at all.

`simulate` gives what ideal sensors would record. `visible` fits the standard model (Pinocchio's numeric regressor, with
columns for rotors, friction and offsets) and measures what of an effect no parameter can take over.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import pinocchio as pin
import scipy.linalg

from motions import RATE, Motion


@dataclass(frozen=True)
class Ideal:
    """What ideal sensors record: the motion that they see, the torque in N.m or N; and the torque of the links alone.

    `robot` is the robot as it really is, `motion` that of the sensors, `moved` that of the links.
    """

    robot: object
    motion: Motion
    moved: Motion
    link: np.ndarray
    torque: np.ndarray


def simulate(robot, motion, effects=()):
    """A robot that moves as planned, with the effects: changed bodies, added torques, transmissions, channels."""
    for effect in effects:
        robot = effect.change(robot)
    link = link_torque(robot, motion)
    standard = (
        link
        + np.array(robot.rotor) * motion.a
        + np.array(robot.viscous) * motion.v
        + np.array(robot.coulomb) * motion.slide
        + np.array(robot.offset)
    )
    ideal = Ideal(robot, motion, motion, link, standard)
    torque = standard + sum((e.torque(ideal) for e in effects), np.zeros_like(standard))
    ideal = replace(ideal, torque=torque)
    for effect in effects:
        ideal = effect.transmit(ideal)
    for effect in effects:
        ideal = effect.record(ideal)
    return ideal


@lru_cache(maxsize=32)
def link_torque(robot, motion):
    """Torque of inertia and gravity of the bodies, without rotors, by row and joint."""
    model = robot.model()
    data = model.createData()
    rows = zip(motion.q, motion.v, motion.a)
    return np.array([pin.rnea(model, data, q, v, a) for q, v, a in rows])


@lru_cache(maxsize=4)
def linearised(robot, motion):
    """By row: mass matrix, damping and stiffness: how the link torques change with accelerations, speeds, positions."""
    model = robot.model()
    data = model.createData()
    n = robot.joints
    mass, damping, stiffness = (np.empty((len(motion.t), n, n)) for _ in range(3))
    for k, (q, v, a) in enumerate(zip(motion.q, motion.v, motion.a)):
        stiffness[k], damping[k], m = pin.computeRNEADerivatives(model, data, q, v, a)
        mass[k] = np.triu(m) + np.triu(m, 1).T
    return mass, damping, stiffness


class Standard:
    """The standard model on recordings: base parameters fitted to all of them, residuals in blocks of `block` s."""

    def __init__(self, robot, ideals, noise, block):
        self.size = max(int(round(block * RATE)), 1)
        self.noise = noise
        self.used = [self._moving(i.motion) for i in ideals]
        rows = [self._rows(robot, i.motion, used) for i, used in zip(ideals, self.used)]
        w = np.concatenate(rows)
        w /= np.maximum(np.linalg.norm(w, axis=0), 1e-12)
        q, r, _ = scipy.linalg.qr(w, mode="economic", pivoting=True)
        diagonal = np.abs(np.diag(r))
        self.basis = q[:, : np.count_nonzero(diagonal > 1e-8 * diagonal[0])]
        self.bounds = np.cumsum([0] + [len(x) for x in rows])

    def residuals(self, torques):
        """Of each recording what the standard model leaves, in units of the noise: blocks by joint, nan at rest."""
        y = np.concatenate([self._mean(t / self.noise).T[u.T] for t, u in zip(torques, self.used)])
        rest = y - self.basis @ (self.basis.T @ y)
        out = []
        for k, used in enumerate(self.used):
            x = np.full(used.shape, np.nan).T
            x[used.T] = rest[self.bounds[k] : self.bounds[k + 1]]
            out.append(x.T)
        return out

    def _mean(self, x):
        n = len(x) // self.size
        return x[: n * self.size].reshape(n, self.size, *x.shape[1:]).mean(1)

    def _moving(self, motion):
        return self._mean((~motion.rest).astype(float)) > 0.999

    def _rows(self, robot, motion, used):
        """Regressor of the blocks, joint after joint, in units of the noise."""
        model = robot.model()
        data = model.createData()
        n = robot.joints
        w = np.zeros((len(used), n, 14 * n))
        for k in range(len(used)):
            i = k * self.size + self.size // 2
            w[k, :, : 10 * n] = pin.computeJointTorqueRegressor(model, data, motion.q[i], motion.v[i], motion.a[i])
        own = [self._mean(x) for x in (motion.a, motion.v, np.sign(motion.v), np.ones_like(motion.v))]
        for j in range(n):
            w[:, j, 10 * n + 4 * j : 10 * n + 4 * j + 4] = np.stack([x[:, j] for x in own], 1)
        w /= np.array(self.noise)[None, :, None]
        return np.concatenate([w[used[:, j], j] for j in range(n)])


class Sight:
    """What is seen of effects in recordings: `before` without them, `target` the places of those that can hold them.

    `bands`: (block in s, standard deviation of the torque noise of each joint in such blocks).
    """

    def __init__(self, robot, before, target, bands):
        self.robot, self.before, self.target, self.bands = robot, before, target, bands
        self.standard = [Standard(robot, before, np.array(noise), block) for block, noise in bands]

    def visible(self, after, window=None):
        """By joint: the torque that no refit takes over, root mean square in units of the noise, in the best band.

        `after`: the recordings with the effect. `window`: (number of the motion, start, end) in s, of an effect that
        lasts for a while and counts while it does.
        """
        moved = any(a.motion is not b.motion for a, b in zip(after, self.before))
        seen = []
        for (block, noise), standard in zip(self.bands, self.standard):
            other = Standard(self.robot, after, np.array(noise), block) if moved else standard
            squares = [self._square(s, x, block, window) for s, x in ((other, after), (standard, self.before))]
            seen.append(np.sqrt(np.maximum(squares[0] - squares[1], 0)))
        return np.max(seen, 0)

    def _square(self, standard, ideals, block, window):
        left = standard.residuals([i.torque for i in ideals])
        parts = []
        for k in self.target:
            t = (np.arange(len(left[k])) + 0.5) * block
            here = np.ones(len(t), bool)
            if window:
                here = (t > window[1]) & (t < window[2]) & (ideals[k].motion.number == window[0])
            parts.append(left[k][here])
        parts = np.concatenate(parts)
        known = np.isfinite(parts)
        return np.where(known, parts**2, 0).sum(0) / np.maximum(known.sum(0), 10)
