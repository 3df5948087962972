"""Recordings that are made here: motions by formula, torques by inverse dynamics."""

import os

import numpy as np
import pytest

import dynid


def motion(robot, duration=20.0, rate=200.0, seed=0):
    """t (N,), q, dq, ddq (N, n): three sines a joint, with derivatives in closed form."""
    rng = np.random.default_rng(seed)
    t = np.arange(0, duration, 1 / rate)
    n = robot.joints
    amplitude = rng.uniform(0.2, 0.6, (3, n)) * np.array([1.0, 0.5, 0.25])[:, None]
    speed = rng.uniform(0.6, 1.4, (3, n)) * np.array([1.0, 2.3, 5.1])[:, None]
    phase = rng.uniform(0, 2 * np.pi, (3, n))
    at = t[:, None, None] * speed + phase
    q = (amplitude * np.sin(at)).sum(1)
    dq = (amplitude * speed * np.cos(at)).sum(1)
    ddq = (-amplitude * speed**2 * np.sin(at)).sum(1)
    return t, q, dq, ddq


def recorded(robot, seed=0, added=None, noise=0.02, **options):
    """A recording of a robot with its nominal parameters, with `added(q, dq, ddq)` on its torques, and the motion."""
    t, q, dq, ddq = motion(robot, seed=seed, **options)
    tau = robot.torque(robot.chi, q, dq, ddq)
    if added is not None:
        tau = tau + added(q, dq, ddq)
    tau = tau + np.random.default_rng(100 + seed).normal(0, noise, tau.shape)
    return dynid.Recording(robot=robot, t=t, q=q, tau=tau), (q, dq, ddq)


def written(recording, folder):
    """The YAML of a recording of one motion of planar_2r that is written to files there."""
    folder.mkdir(exist_ok=True)
    ((t, q, tau),) = recording.arrays()
    rows = np.column_stack([t, q, tau])
    np.savetxt(folder / "run.csv", rows, delimiter=",", header="t,q1,q2,tau1,tau2", comments="", fmt="%.17g")
    manifest = folder / "recording.yaml"
    manifest.write_text(
        "robot: planar_2r\ntime: {column: t, unit: s}\nposition: {columns: [q1, q2], unit: rad}\n"
        "torque: {columns: [tau1, tau2], unit: N.m}\ntrajectories:\n  - {file: run.csv}\n"
    )
    return manifest


@pytest.fixture(scope="session")
def program():
    """The path of the program, where the variable DYNID has it."""
    if not os.environ.get("DYNID"):
        pytest.skip("DYNID does not name the program: Python was not compared with the command line")
    return os.environ["DYNID"]


@pytest.fixture(scope="session")
def planar():
    return dynid.Robot("planar_2r")


@pytest.fixture(scope="session")
def tx40():
    return dynid.Robot("tx40")
