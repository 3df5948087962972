"""Torques by Pinocchio and MuJoCo of the files that dynid wrote: `tests/formats/*.json`.

    peers/bin/pip install pin mujoco numpy
    peers/bin/python benches/peers/written_reference.py

Joints that mimic others move by themselves in both, their constraints switched off, and torques are projected:
tau = GT inverse(G q, G dq, G ddq). MuJoCo's have friction, springs and rotors too; dry friction is a constraint there that
saturates, with a short time constant.
"""

import glob
import json
import os
import xml.etree.ElementTree as xml

import mujoco
import numpy as np
import pinocchio as pin

FOLDER = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "tests/formats")


def urdf(path, states):
    model = pin.buildModelFromUrdf(path)
    model.gravity.linear = np.array([0, 0, -np.linalg.norm(gravity(path))])
    mimics = {}
    for joint in xml.parse(path).getroot().iter("joint"):
        mimic = joint.find("mimic")
        if mimic is not None:
            mimics[joint.get("name")] = (mimic.get("joint"), float(mimic.get("multiplier")))
    names = list(model.names)[1:]
    own = sorted((n for n in names if n not in mimics), key=lambda n: int(n.removeprefix("joint")))
    g = np.zeros((len(names), len(own)))
    for k, name in enumerate(names):
        master, factor = mimics.get(name, (name, 1.0))
        g[k, own.index(master)] = factor
    data = model.createData()

    def position(q):
        parts = [None] * len(names)
        for k, name in enumerate(names):
            joint, angle = model.joints[model.getJointId(name)], (g @ q)[k]
            parts[joint.idx_v] = (joint.idx_q, [angle] if joint.nq == 1 else [np.cos(angle), np.sin(angle)])
        full = np.zeros(model.nq)
        for at, values in parts:
            full[at : at + len(values)] = values
        return full

    order = [model.joints[model.getJointId(name)].idx_v for name in names]
    matrix = np.zeros_like(g)
    matrix[order] = g
    return [list(matrix.T @ pin.rnea(model, data, position(q), matrix @ dq, matrix @ ddq)) for q, dq, ddq in states]


def gravity(path):
    model = mujoco.MjModel.from_xml_path(path.replace(".urdf", ".xml"))
    return model.opt.gravity


def mjcf(path, states):
    model = mujoco.MjModel.from_xml_path(path)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_EQUALITY | mujoco.mjtDisableBit.mjDSBL_LIMIT
    model.dof_solref[:] = model.tendon_solref_fri[:] = [0.0001, 1]
    mimics = {}
    for kind, one, two, values in zip(model.eq_type, model.eq_obj1id, model.eq_obj2id, model.eq_data):
        if kind == mujoco.mjtEq.mjEQ_JOINT:
            mimics[one] = {two: values[1]}
        else:
            # A fixed tendon of length 0: its first joint follows the others.
            first, count = model.tendon_adr[one], model.tendon_num[one]
            joints, factors = model.wrap_objid[first : first + count], model.wrap_prm[first : first + count]
            mimics[joints[0]] = {j: -c / factors[0] for j, c in zip(joints[1:], factors[1:])}
    own = sorted((j for j in range(model.njnt) if j not in mimics), key=lambda j: int(model.joint(j).name.removeprefix("joint")))
    g = np.zeros((model.njnt, len(own)))
    for j in range(model.njnt):
        for master, factor in mimics.get(j, {j: 1.0}).items():
            g[j, own.index(master)] = factor
    data, torques = mujoco.MjData(model), []
    losses = [x for x in [*model.dof_frictionloss, *model.tendon_frictionloss] if x > 0]
    for q, dq, ddq in states:
        data.qpos[:], data.qvel[:], data.qacc[:] = g @ q, g @ dq, g @ ddq
        mujoco.mj_inverse(model, data)
        assert np.allclose(np.sort(np.abs(data.efc_force)), np.sort(losses), rtol=1e-12), (path, data.efc_force, losses)
        torques.append(list(g.T @ data.qfrc_inverse))
    return torques


def main():
    random = np.random.default_rng(4)
    for path in sorted(glob.glob(os.path.join(FOLDER, "*.urdf"))):
        model = mujoco.MjModel.from_xml_path(path.replace(".urdf", ".xml"))
        n = model.njnt - model.neq
        states = []
        for _ in range(6):
            # Fast enough for dry friction to be all there.
            dq = random.uniform(0.5, 2.5, n) * random.choice([-1, 1], n)
            states.append([random.uniform(-1.5, 1.5, n), dq, random.uniform(-4, 4, n)])
        out = {"states": [[list(map(float, x)) for x in s] for s in states]}
        out["pinocchio"] = [list(map(float, t)) for t in urdf(path, states)]
        out["mujoco"] = [list(map(float, t)) for t in mjcf(path.replace(".urdf", ".xml"), states)]
        with open(path.replace(".urdf", ".json"), "w") as file:
            file.write(json.dumps(out) + "\n")
        print(path)


main()
