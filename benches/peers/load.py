"""Torques of an exported robot by the tools that read it, friction apart, as JSON: Pinocchio for a URDF, MuJoCo for MJCF.

    peers/bin/pip install pin mujoco numpy
    peers/bin/python benches/peers/load.py FILE STATES.json

STATES.json: {"joints": [names], "states": [[q, dq, ddq], ...]}. A tool that is not installed ends with status 3.
"""

import json
import sys


def by_pinocchio(path, joints, states):
    import numpy as np
    import pinocchio as pin

    model = pin.buildModelFromUrdf(path)
    data = model.createData()
    index = [model.joints[model.getJointId(name)] for name in joints]
    torques = []
    for q, dq, ddq in states:
        full, v, a = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
        for i, joint in enumerate(index):
            if joint.nq == 2:
                full[joint.idx_q:joint.idx_q + 2] = np.cos(q[i]), np.sin(q[i])
            else:
                full[joint.idx_q] = q[i]
            v[joint.idx_v], a[joint.idx_v] = dq[i], ddq[i]
        tau = pin.rnea(model, data, full, v, a)
        torques.append([float(tau[joint.idx_v]) for joint in index])
    return torques


def by_mujoco(path, joints, states):
    import mujoco

    model = mujoco.MjModel.from_xml_path(path)
    model.dof_damping[:] = 0
    model.dof_frictionloss[:] = 0
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data = mujoco.MjData(model)
    index = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in joints]
    torques = []
    for q, dq, ddq in states:
        for i, joint in enumerate(index):
            data.qpos[model.jnt_qposadr[joint]] = q[i]
            data.qvel[model.jnt_dofadr[joint]] = dq[i]
            data.qacc[model.jnt_dofadr[joint]] = ddq[i]
        mujoco.mj_inverse(model, data)
        torques.append([float(data.qfrc_inverse[model.jnt_dofadr[joint]]) for joint in index])
    return torques


def main():
    path, states = sys.argv[1:]
    with open(states) as file:
        states = json.load(file)
    tool = by_pinocchio if path.endswith(".urdf") else by_mujoco
    try:
        torques = tool(path, states["joints"], states["states"])
    except ImportError as error:
        print(error, file=sys.stderr)
        sys.exit(3)
    print(json.dumps(torques))


if __name__ == "__main__":
    main()
