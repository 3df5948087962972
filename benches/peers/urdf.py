"""dynid's table of a URDF beside Pinocchio's model of the same file: torques of the nominal parameters, and the base
regressor. Public robots come with the packages; nothing of them is kept.

    peers/bin/pip install pin numpy example-robot-data
    cargo build --release --bin dynid --example regressor
    peers/bin/python benches/peers/urdf.py [TARGET_DIR]
"""

import json
import os
import subprocess
import sys
import sysconfig
import tempfile

import numpy as np
import pinocchio as pin

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
TARGET = sys.argv[1] if len(sys.argv) > 1 else os.path.join(ROOT, "target")

# File, base, tip. Joints that are not between them are held at 0.
ROBOTS = [
    ("panda_description/urdf/panda.urdf", None, "panda_link8"),
    ("ur_description/urdf/ur3_robot.urdf", None, None),
    ("ur_description/urdf/ur5_robot.urdf", None, None),
    ("ur_description/urdf/ur10_robot.urdf", None, None),
    ("kinova_description/robots/kinova.urdf", None, "j2s6s200_link_6"),
    ("xarm_description/urdf/xarm7.urdf", None, "link_eef"),
    ("z1_description/urdf/z1.urdf", None, None),
    ("tiago_description/robots/tiago_no_hand.urdf", "torso_fixed_link", "arm_7_link"),
    ("centauro_description/urdf/centauro.urdf", "torso_2", "arm1_6"),
    ("laikago_description/urdf/laikago.urdf", None, None),
    ("baxter_description/urdf/baxter.urdf", None, "left_gripper"),
    ("so_arm_description/urdf/so101.urdf", None, None),
    ("double_pendulum_description/urdf/double_pendulum_simple.urdf", None, None),
    ("finger_edu_description/robots/finger_edu.urdf", None, None),
    ("allegro_hand_description/urdf/allegro_right_hand.urdf", None, None),
    ("solo_description/robots/solo12.urdf", None, None),
    ("romeo_description/urdf/romeo_small.urdf", "torso", "l_sole"),
    ("pr2_description/urdf/pr2.urdf", None, "r_wrist_roll_link"),
]


def dynid(*words):
    run = subprocess.run([os.path.join(TARGET, "release", *words[0].split("/")), *words[1:]], capture_output=True, text=True)
    return run.returncode, run.stdout, run.stderr


def moving_joints(yaml):
    """Names in the comments of the moving rows."""
    rows = [line for line in yaml.splitlines() if line.startswith("  - {j:")]
    return [row.split("#")[1].strip() for row in rows if "sigma: 2" not in row]


def check(path, base, tip, snap, random):
    with tempfile.TemporaryDirectory() as folder:
        table, states = os.path.join(folder, "arm.yaml"), os.path.join(folder, "states.json")
        words = ["dynid", "import", path, "--out", table, "--snap", str(snap)]
        words += (["--base", base] if base else []) + (["--tip", tip] if tip else [])
        code, _, error = dynid(*words)
        if code:
            return "refused: " + error.strip().splitlines()[0]
        with open(table) as file:
            names = moving_joints(file.read())
        model = pin.buildModelFromUrdf(path)
        held = [model.getJointId(name) for name in model.names[1:] if name not in names]
        # Base links beyond joints that are held do not turn: gravity stays along -z.
        if held:
            model = pin.buildReducedModel(model, held, pin.neutral(model))
        model.armature[:] = 0
        data = model.createData()
        n, count = len(names), 60
        order = [model.joints[model.getJointId(name)] for name in names]
        q = np.array([random.uniform(-1, 1, n) for _ in range(count)])
        dq, ddq = random.uniform(-2, 2, (count, n)), random.uniform(-5, 5, (count, n))
        with open(states, "w") as file:
            json.dump([[list(a), list(b), list(c)] for a, b, c in zip(q, dq, ddq)], file)
        code, answer, error = dynid("examples/regressor", table, states)
        if code:
            return "refused: " + error.strip().splitlines()[0]
        answer = json.loads(answer)
        damping = np.array([model.damping[j.idx_v] for j in order])
        friction = np.array([model.friction[j.idx_v] for j in order]) if hasattr(model, "friction") else 0
        torques, rows = [], []
        for k in range(count):
            full, v, a = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
            for i, joint in enumerate(order):
                if joint.nq == 2:
                    full[joint.idx_q:joint.idx_q + 2] = np.cos(q[k, i]), np.sin(q[k, i])
                else:
                    full[joint.idx_q] = q[k, i]
                v[joint.idx_v], a[joint.idx_v] = dq[k, i], ddq[k, i]
            index = [joint.idx_v for joint in order]
            torques.append(pin.rnea(model, data, full, v, a)[index] + damping * dq[k] + friction * np.sign(dq[k]))
            rows.append(pin.computeJointTorqueRegressor(model, data, full, v, a)[index])
        torques, ours = np.array(torques), np.array(answer["torques"])
        error = np.abs(torques - ours).max() / np.abs(torques).max()
        W = np.vstack(rows)
        base = np.array(answer["regressor"])
        inertial = [k for k, name in enumerate(answer["base"]) if not name.startswith(("Fv", "Fc", "off"))]
        # Rotor inertias are columns of their own on all but the first axes: not Pinocchio's.
        inertial = [k for k in inertial if not answer["base"][k].startswith("Ia")]
        B = base[:, inertial]
        # Columns of unit length; what is rounding beside the others stays nothing.
        length = np.linalg.norm(W, axis=0)
        W, B = W[:, length > 1e-10 * length.max()], B / np.linalg.norm(B, axis=0)
        W = W / np.linalg.norm(W, axis=0)
        U, S, _ = np.linalg.svd(W, full_matrices=False)
        rank = int((S > 1e-10 * S[0]).sum())
        span = U[:, :rank]
        outside = np.abs(B - span @ (span.T @ B)).max()
        own = int((np.linalg.svd(B, compute_uv=False) > 1e-10).sum())
        return f"{n:2d} joints  torques {error:.1e}  rank {rank:3d}, base {B.shape[1]:3d} of rank {own:3d}, outside {outside:.1e}"


def main():
    random = np.random.default_rng(1)
    folder = os.path.join(sysconfig.get_path("purelib"), "cmeel.prefix/share/example-robot-data/robots")
    for path, base, tip in ROBOTS:
        for snap in (1e-12, 1e-8, 2e-3):
            print(f"{os.path.basename(path):28s} snap {snap:<6g} {check(os.path.join(folder, path), base, tip, snap, random)}", flush=True)


if __name__ == "__main__":
    main()
