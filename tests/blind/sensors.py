"""What real sensors make of ideal recordings: encoders, torque noise of several kinds, sides and units of drives."""

from dataclasses import dataclass

import numpy as np

from motions import RATE

NOISES = ("white", "ar1", "quantised", "load", "low_pass", "wander")


@dataclass(frozen=True)
class Sensors:
    """The sensors of one robot.

    `rate` in Hz, `noise` one of NOISES ("ar1" decays in 6 ms, "wander" is white with a slow part of 0.3 s), `level` in
    units of the robot's own torque noise, `bits` of the encoders a turn (a metre on prismatic joints), `speeds`
    whether they are recorded, `side` "joint", "motor" or "current". `low_pass`: time constant in s of a filter in the
    whole torque channel, 0 for none.
    """

    rate: int
    noise: str
    level: float
    bits: int
    speeds: bool
    side: str
    stamps: bool
    low_pass: float

    def torque_noise(self, rng, robot, torque):
        """Noise of the torque channel, by recorded row and joint, N.m or N; `torque`: the ideal one."""
        sigma = self.level * np.array(robot.noise)
        white = rng.normal(size=torque.shape)
        if self.noise == "ar1":
            return sigma * _ar1(white, self.rate * 0.006)
        if self.noise == "wander":
            return sigma * (white + 0.15 * _ar1(rng.normal(size=torque.shape), self.rate * 0.3))
        if self.noise == "load":
            most = np.abs(torque).max(0) + 1e-9
            return sigma * (0.5 + 1.5 * np.abs(torque) / most) * white
        if self.noise == "low_pass":
            smooth = np.stack([np.convolve(w, np.ones(3) / 3, "same") for w in white.T], 1)
            return sigma * smooth * np.sqrt(3)
        if self.noise == "quantised":
            step = 1.5 * sigma
            return np.round((torque + 0.75 * sigma * white) / step) * step - torque
        return sigma * white

    def sample(self, rng, robot, ideal):
        """Recorded rows: t, positions, speeds, torques at the joint."""
        every = RATE // self.rate
        torque = ideal.torque
        if self.low_pass:
            late, fade = np.empty_like(torque), np.exp(-1 / RATE / self.low_pass)
            now = torque[0]
            for k, x in enumerate(torque):
                now = fade * now + (1 - fade) * x
                late[k] = now
            torque = late
        m = ideal.motion
        t, q, v, torque = m.t[::every], m.q[::every], m.v[::every], torque[::every]
        torque = torque + self.torque_noise(rng, robot, torque)
        turn = np.array([1.0 if r.prismatic else 2 * np.pi for r in robot.rows])
        step = turn / 2**self.bits
        q = np.round((q + 0.3 * step * rng.normal(size=q.shape)) / step) * step
        v = v + 0.002 * np.array(robot.speed) * rng.normal(size=v.shape)
        return t, q, v, torque


def _ar1(white, rows):
    """First-order autoregression of unit variance that decays over so many rows."""
    rho = np.exp(-1 / rows)
    x, now = np.empty_like(white), white[0]
    for k, w in enumerate(white):
        now = rho * now + np.sqrt(1 - rho**2) * w
        x[k] = now
    return x


def draw(rng):
    return Sensors(
        rate=int(rng.choice([100, 125, 200, 250, 500, 1000], p=[0.08, 0.08, 0.14, 0.2, 0.3, 0.2])),
        noise=str(rng.choice(NOISES)),
        level=float(rng.uniform(0.5, 1.5)),
        bits=int(rng.integers(17, 22)),
        speeds=bool(rng.random() < 0.4),
        side=str(rng.choice(["joint", "motor", "current"], p=[0.6, 0.2, 0.2])),
        stamps=bool(rng.random() < 0.7),
        low_pass=float(rng.choice([0.0, 0.0, 0.0, 0.0015])),
    )
