"""Robots that are not in dynid's own `robots/`: a modified Denavit-Hartenberg table, solid bodies, drives, friction.

The table is written as dynid's robot YAML and built as a Pinocchio model, both from the same rows, so that the two
programs share the geometry and nothing else. SI units; on a prismatic joint m and N take the places of rad and N.m.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin

H = math.pi / 2


@dataclass(frozen=True)
class Row:
    """A row of the table: Rot(x, alpha) Trans(x, d) Rot(z, theta) Trans(z, r); the joint adds to theta or r."""

    alpha: float
    d: float
    r: float
    theta: float = 0.0
    prismatic: bool = False


@dataclass(frozen=True)
class Body:
    """A solid box: mass, kg, centre and edges in m, in the frame of its link; turned by `turn` rad about (1, 1, 1)."""

    mass: float
    centre: tuple
    edges: tuple
    turn: float = 0.1

    def inertia(self):
        x, y, z = (e * e / 12 * self.mass for e in self.edges)
        turn = pin.exp3(np.full(3, self.turn / math.sqrt(3)))
        about_centre = turn @ np.diag([y + z, x + z, x + y]) @ turn.T
        return pin.Inertia(self.mass, np.array(self.centre), about_centre)


@dataclass(frozen=True)
class Robot:
    """`rotor`, `viscous`, `coulomb`, `offset`, `noise` and the limits are at the joint, one number a joint."""

    name: str
    rows: tuple
    bodies: tuple
    gear: tuple
    rotor: tuple
    viscous: tuple
    coulomb: tuple
    offset: tuple
    noise: tuple  # standard deviation of the torque, N.m or N
    middle: tuple  # middle of the travel that is used
    reach: tuple  # half of it
    speed: tuple
    acceleration: tuple
    gravity: tuple = (0.0, 0.0, -9.81)
    loads: tuple = ()  # (joint, Body): bodies that are attached beside those of the links

    @property
    def joints(self):
        return len(self.rows)

    def model(self):
        """The Pinocchio model: bodies and attached loads, without rotors and friction."""
        model = pin.Model()
        model.gravity.linear = np.array(self.gravity)
        parent = 0
        for j, (row, body) in enumerate(zip(self.rows, self.bodies)):
            about_x = pin.SE3(pin.utils.rotate("x", row.alpha), np.zeros(3))
            along_x = pin.SE3(np.eye(3), np.array([row.d, 0, 0]))
            about_z = pin.SE3(pin.utils.rotate("z", row.theta), np.zeros(3))
            along_z = pin.SE3(np.eye(3), np.array([0, 0, row.r]))
            joint = pin.JointModelPZ() if row.prismatic else pin.JointModelRZ()
            parent = model.addJoint(parent, joint, about_x * along_x * about_z * along_z, f"q{j + 1}")
            model.appendBodyToJoint(parent, body.inertia(), pin.SE3.Identity())
        for joint, body in self.loads:
            model.appendBodyToJoint(joint, body.inertia(), pin.SE3.Identity())
        return model

    def lengths(self):
        """The lengths of the table that are not zero: (row index, "d" or "r")."""
        return [(j, key) for j, row in enumerate(self.rows) for key in ("d", "r") if abs(getattr(row, key)) > 0]

    def with_length(self, j, key, value):
        rows = list(self.rows)
        rows[j] = replace(rows[j], **{key: value})
        return replace(self, rows=tuple(rows))

    def yaml(self):
        """dynid's robot YAML: table, gear and limits; no parameters."""
        lines = [f"name: {self.name}", f"gravity: {list(self.gravity)}", "frames:"]
        for j, row in enumerate(self.rows, 1):
            theta, r = (f"{row.theta:.15g}", f"q{j}") if row.prismatic else (f"q{j}", f"{row.r:.15g}")
            if row.prismatic and row.r:
                r += f" + {row.r:.15g}"
            if not row.prismatic and row.theta:
                theta += f" + {row.theta:.15g}"
            lines.append(
                f"  - {{j: {j}, sigma: {int(row.prismatic)}, alpha: {row.alpha:.15g}, d: {row.d:.15g}, "
                f"theta: {theta}, r: {r}}}"
            )
        travel = [[round(m - 1.2 * h, 6), round(m + 1.2 * h, 6)] for m, h in zip(self.middle, self.reach)]
        lines += [
            f"drive: {{gear: {list(self.gear)}}}",
            "limits:",
            f"  position: {travel}",
            f"  velocity: {list(self.speed)}",
            f"  acceleration: {list(self.acceleration)}",
        ]
        return "\n".join(lines) + "\n"


COBOT = Robot(
    name="light_arm6",
    rows=(
        Row(0, 0, 0.089),
        Row(H, 0, 0),
        Row(0, -0.425, 0),
        Row(0, -0.392, 0.109),
        Row(H, 0, 0.095),
        Row(-H, 0, 0.082),
    ),
    bodies=(
        Body(3.7, (0.0, -0.02, -0.01), (0.12, 0.14, 0.16)),
        Body(8.4, (-0.21, 0.01, 0.12), (0.5, 0.12, 0.12)),
        Body(2.4, (-0.17, 0.0, 0.02), (0.44, 0.09, 0.09)),
        Body(1.2, (0.0, -0.01, 0.02), (0.09, 0.12, 0.09)),
        Body(1.2, (0.0, 0.012, 0.02), (0.09, 0.12, 0.09)),
        Body(0.5, (0.012, 0.004, -0.02), (0.09, 0.08, 0.05)),
    ),
    gear=(101, 101, 101, 101, 101, 101),
    rotor=(1.9, 1.9, 0.9, 0.22, 0.22, 0.22),
    viscous=(9.0, 9.5, 6.0, 1.6, 1.5, 1.3),
    coulomb=(7.0, 8.5, 5.5, 1.6, 1.4, 1.2),
    offset=(0.4, -0.3, 0.3, 0.05, -0.06, 0.02),
    noise=(0.5, 0.6, 0.35, 0.1, 0.1, 0.08),
    middle=(0.0, -1.4, 0.9, -0.4, 0.0, 0.0),
    reach=(2.0, 1.0, 1.4, 1.8, 1.9, 2.5),
    speed=(2.2, 2.2, 2.6, 3.0, 3.0, 3.0),
    acceleration=(8.0, 8.0, 10.0, 16.0, 16.0, 20.0),
)

REDUNDANT = Robot(
    name="redundant_arm7",
    rows=(
        Row(0, 0, 0.34),
        Row(-H, 0, 0),
        Row(H, 0, 0.4),
        Row(H, 0, 0),
        Row(-H, 0, 0.4),
        Row(-H, 0, 0),
        Row(H, 0, 0.126),
    ),  # fmt: skip
    bodies=(
        Body(4.2, (0.0, -0.03, -0.07), (0.14, 0.14, 0.26)),
        Body(4.0, (0.0, -0.06, 0.04), (0.14, 0.26, 0.14)),
        Body(3.1, (0.0, 0.03, -0.13), (0.12, 0.12, 0.26)),
        Body(2.7, (0.0, 0.067, 0.034), (0.12, 0.26, 0.12)),
        Body(1.7, (0.0, 0.02, -0.15), (0.1, 0.1, 0.22)),
        Body(1.8, (0.0, 0.0, 0.01), (0.1, 0.12, 0.1)),
        Body(0.7, (0.01, -0.012, -0.03), (0.11, 0.08, 0.06)),
    ),
    gear=(160, 160, 160, 160, 100, 160, 160),
    rotor=(1.2, 1.2, 0.8, 0.8, 0.35, 0.25, 0.2),
    viscous=(6.0, 6.0, 4.0, 4.0, 2.0, 1.5, 1.1),
    coulomb=(5.0, 6.0, 4.0, 4.5, 2.0, 1.4, 1.0),
    offset=(0.1, 0.2, -0.1, 0.1, 0.0, 0.03, -0.02),
    noise=(0.3, 0.35, 0.25, 0.25, 0.12, 0.08, 0.06),
    middle=(0.0, 0.5, 0.0, -1.0, 0.0, 0.6, 0.0),
    reach=(1.8, 1.1, 1.8, 0.9, 2.0, 1.2, 2.4),
    speed=(1.6, 1.6, 1.9, 1.9, 2.4, 3.0, 3.0),
    acceleration=(6.0, 6.0, 8.0, 8.0, 12.0, 14.0, 16.0),
)

HEAVY = Robot(
    name="heavy_arm6",
    rows=(
        Row(0, 0, 0.675),
        Row(-H, 0.35, 0),
        Row(0, 1.15, 0),
        Row(-H, -0.041, 1.2),
        Row(H, 0, 0),
        Row(-H, 0, 0.215),
    ),  # fmt: skip
    bodies=(
        Body(380.0, (0.1, 0.05, -0.12), (0.8, 0.7, 0.6)),
        Body(270.0, (0.52, -0.02, 0.05), (1.4, 0.32, 0.35)),
        Body(240.0, (-0.02, 0.1, 0.06), (0.6, 0.7, 0.4)),
        Body(130.0, (0.0, 0.01, -0.45), (0.3, 0.3, 1.0)),
        Body(55.0, (0.0, 0.03, 0.01), (0.25, 0.35, 0.25)),
        Body(120.0, (0.06, 0.03, 0.18), (0.5, 0.4, 0.35)),
    ),
    gear=(185, 200, 190, 150, 145, 110),
    rotor=(240.0, 280.0, 210.0, 30.0, 26.0, 14.0),
    viscous=(400.0, 420.0, 320.0, 75.0, 70.0, 40.0),
    coulomb=(210.0, 260.0, 190.0, 55.0, 50.0, 35.0),
    offset=(12.0, -30.0, 15.0, 2.0, -3.0, 1.0),
    noise=(16.0, 20.0, 14.0, 4.0, 3.5, 2.5),
    middle=(0.0, -1.3, 1.2, 0.0, 0.3, 0.0),
    reach=(2.0, 0.7, 0.9, 2.4, 1.6, 3.0),
    speed=(1.7, 1.5, 1.6, 2.6, 2.4, 3.4),
    acceleration=(3.0, 2.6, 3.2, 8.0, 8.0, 12.0),
)

PALLETISER = Robot(
    name="stacker4",
    rows=(Row(0, 0, 0.8), Row(-H, 0.3, 0), Row(0, 1.0, 0), Row(-H, 1.1, 0.2)),
    bodies=(
        Body(210.0, (0.05, 0.0, -0.15), (0.6, 0.5, 0.6)),
        Body(120.0, (0.45, 0.0, 0.04), (1.1, 0.25, 0.25)),
        Body(95.0, (0.4, 0.02, 0.0), (1.2, 0.22, 0.22)),
        Body(38.0, (0.03, 0.01, 0.1), (0.4, 0.3, 0.2)),
    ),
    gear=(140, 160, 150, 80),
    rotor=(80.0, 95.0, 70.0, 3.5),
    viscous=(160.0, 170.0, 130.0, 9.0),
    coulomb=(90.0, 110.0, 85.0, 8.0),
    offset=(3.0, -8.0, 5.0, 0.2),
    noise=(7.0, 8.5, 6.5, 0.6),
    middle=(0.0, -1.1, 0.9, 0.0),
    reach=(2.2, 0.7, 0.8, 3.0),
    speed=(2.2, 1.9, 2.0, 5.0),
    acceleration=(6.0, 5.0, 5.0, 20.0),
)

SCARA = Robot(
    name="scara_quill",
    rows=(Row(0, 0, 0.38), Row(0, 0.4, 0), Row(0, 0.3, 0), Row(0, 0, 0, 0.0, True)),
    bodies=(
        Body(11.0, (0.19, 0.0, 0.0), (0.5, 0.16, 0.14)),
        Body(8.0, (0.14, 0.01, 0.05), (0.42, 0.15, 0.2)),
        Body(0.9, (0.004, 0.0, -0.02), (0.06, 0.06, 0.12)),
        Body(1.9, (0.015, 0.004, -0.06), (0.09, 0.07, 0.3)),
    ),
    gear=(80, 60, 18, 620),  # axis 4: rad/m
    rotor=(0.5, 0.22, 0.012, 9.0),
    viscous=(8.0, 3.6, 0.12, 60.0),
    coulomb=(6.5, 3.4, 0.3, 18.0),
    offset=(0.2, -0.1, 0.01, 1.0),
    noise=(0.45, 0.22, 0.02, 0.8),
    middle=(0.0, 0.0, 0.0, -0.1),
    reach=(1.9, 2.0, 3.0, 0.09),
    speed=(4.5, 6.0, 12.0, 0.8),
    acceleration=(30.0, 40.0, 120.0, 9.0),
)

TABLETOP = Robot(
    name="tabletop3",
    rows=(Row(0, 0, 0.08), Row(H, 0.0, 0), Row(0, 0.16, 0)),
    bodies=(
        Body(0.28, (0.0, 0.004, -0.01), (0.06, 0.05, 0.05)),
        Body(0.16, (0.09, 0.0, 0.003), (0.18, 0.03, 0.03)),
        Body(0.12, (0.07, 0.006, 0.0), (0.15, 0.03, 0.025)),
    ),
    gear=(12, 12, 12),
    rotor=(0.0016, 0.0016, 0.0011),
    viscous=(0.012, 0.012, 0.008),
    coulomb=(0.03, 0.034, 0.022),
    offset=(0.001, -0.002, 0.001),
    noise=(0.0035, 0.004, 0.0025),
    middle=(0.0, 0.7, -0.6),
    reach=(1.8, 0.9, 1.3),
    speed=(4.0, 4.0, 5.0),
    acceleration=(30.0, 30.0, 40.0),
)

GANTRY = Robot(
    name="gantry_wrist",
    rows=(Row(0, 0, 0, 0.0, True), Row(-H, 0.12, 0.4, 0.0, True), Row(H, 0.1, 0.2)),
    bodies=(
        Body(60.0, (0.05, 0.1, 0.0), (0.5, 0.4, 0.3)),
        Body(28.0, (0.02, 0.01, -0.2), (0.2, 0.2, 0.9)),
        Body(7.0, (0.11, 0.02, 0.06), (0.3, 0.12, 0.14)),
    ),
    gear=(210, 310, 60),  # axes 1 and 2: rad/m
    rotor=(26.0, 30.0, 0.3),
    viscous=(140.0, 170.0, 1.1),
    coulomb=(70.0, 80.0, 1.5),
    offset=(1.0, -5.0, 0.05),
    noise=(4.0, 4.5, 0.1),
    middle=(0.6, 0.4, 0.0),
    reach=(0.6, 0.35, 2.6),
    speed=(1.3, 1.0, 4.5),
    acceleration=(6.0, 5.0, 25.0),
    gravity=(0.0, -9.81, 0.0),
)

ROBOTS = (COBOT, REDUNDANT, HEAVY, PALLETISER, SCARA, TABLETOP, GANTRY)
