"""Regressors, torques and mass matrices."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import dynid

ROBOTS = Path(__file__).parents[2] / "robots"


def states(robot, samples=197, seed=3):
    return np.random.default_rng(seed).uniform(-1.5, 1.5, (3, samples, robot.joints))


@pytest.mark.parametrize("name", dynid.robots())
def test_the_regressor_times_chi_is_the_torque(name):
    r = dynid.Robot(name)
    q, dq, ddq = states(r)
    chi = np.random.default_rng(1).normal(size=len(r.names))
    np.testing.assert_allclose(r.regressor(q, dq, ddq) @ chi, r.torque(chi, q, dq, ddq), rtol=1e-10, atol=1e-9)


@pytest.mark.parametrize("name", ["tx40", "scara4", "branched"])
def test_generated_code_and_the_engine_over_the_yaml_have_the_same_numbers(name, tmp_path):
    text = (ROBOTS / f"{name}.yaml").read_text()
    path = tmp_path / f"{name}.yaml"
    path.write_text(text)
    generated, recursive = dynid.Robot(name), dynid.Robot(path)
    assert generated.generated and not recursive.generated
    assert generated.names == recursive.names
    q, dq, ddq = states(generated)
    for of in ["regressor", "power_regressor"]:
        a, b = (getattr(r, of)(q, dq, ddq) for r in (generated, recursive))
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9)


def test_a_pendulum_has_the_torque_that_is_worked_out_by_hand(planar):
    # One link held straight down, gravity along -y: at q1 = 0 the first joint carries the weight of both links.
    chi = planar.chi
    torque = planar.torque(chi, np.zeros((1, 2)), np.zeros((1, 2)), np.zeros((1, 2)))
    # M1 and MX1 = 1; M2 = 2 at 0.5 m and MX2 = 0.4; offsets 0.2 and -0.1 (robots/planar_2r.yaml).
    np.testing.assert_allclose(torque, [[9.81 * (1 + 2 * 0.5 + 0.4) + 0.2, 9.81 * 0.4 - 0.1]], rtol=1e-12)


def test_the_mass_matrix_is_what_accelerations_add_to_the_torque(tx40):
    q, dq, _ = states(tx40, 5)
    mass = tx40.mass_matrix(tx40.chi, q)
    still = tx40.torque(tx40.chi, q, dq, np.zeros_like(q))
    for j in range(tx40.joints):
        pushed = tx40.torque(tx40.chi, q, dq, np.broadcast_to(np.eye(tx40.joints)[j], q.shape))
        np.testing.assert_allclose(mass[:, :, j], pushed - still, atol=1e-10)
    np.testing.assert_allclose(mass, mass.transpose(0, 2, 1), atol=1e-12)


def test_the_power_regressor_is_the_speeds_times_the_regressor(tx40):
    # Motor power is dqT tau: dh = dqT IDM, and h is what dh accumulates without friction.
    q, dq, ddq = states(tx40)
    power = np.einsum("tj,tjp->tp", dq, tx40.regressor(q, dq, ddq))
    np.testing.assert_allclose(tx40.power_regressor(q, dq, ddq), power, rtol=1e-9, atol=1e-9)


def test_the_energy_regressor_changes_by_the_power(tx40):
    q, dq, ddq = states(tx40, 20)
    step = 1e-6
    after, before = (tx40.energy_regressor(q + s * dq, dq + s * ddq) for s in (step, -step))
    rate = (after - before) / (2 * step)
    friction = [not (n.startswith(("Fv", "Fc", "off"))) for n in tx40.names]
    power = tx40.power_regressor(q, dq, ddq)
    np.testing.assert_allclose(rate[:, friction], power[:, friction], rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("name", ["scara4", "stanford", "tx40"])
def test_the_rate_of_the_energy_is_the_power_without_friction(name):
    r = dynid.Robot(name)
    q, dq, ddq = states(r, 20)
    chi = np.random.default_rng(2).normal(size=len(r.names))
    chi[[n.startswith(("Fv", "Fc")) for n in r.names]] = 0
    step = 1e-6
    after, before = (r.energy(chi, q + s * dq, dq + s * ddq) for s in (step, -step))
    np.testing.assert_allclose((after - before) / (2 * step), r.power_regressor(q, dq, ddq) @ chi, rtol=1e-5, atol=1e-5)
    assert r.energy(chi, q[0], dq[0]) == pytest.approx(r.energy(chi, q, dq)[0], rel=1e-12)


def test_every_layout_of_an_array_has_the_same_numbers(tx40):
    q, dq, ddq = states(tx40)
    expected = tx40.regressor(q, dq, ddq)
    in_columns = [np.asfortranarray(x) for x in (q, dq, ddq)]
    assert (tx40.regressor(*in_columns) == expected).all()
    assert (tx40.regressor(q.tolist(), in_columns[1], ddq) == expected).all()
    backwards = [x[::-1] for x in (q, dq, ddq)]
    np.testing.assert_allclose(tx40.regressor(*backwards), expected[::-1], rtol=1e-12, atol=1e-12)
    room = np.full(expected.shape, np.nan)
    assert tx40.regressor(q, dq, ddq, out=room) is room and (room == expected).all()
    rows, columns = tx40.pattern
    dense = np.zeros_like(expected)
    dense[:, rows, columns] = tx40.regressor_entries(q, dq, ddq)
    np.testing.assert_allclose(dense, expected, rtol=1e-12, atol=1e-12)


# 20 MB of them: more than is written through the cache.
MANY = 7001


@pytest.mark.parametrize("samples", [1, 7, 64, 65, 4097, MANY])
def test_regressors_have_the_same_bytes_for_any_number_of_threads(tx40, samples):
    q, dq, ddq = states(tx40, samples)
    expected = tx40.regressor(q, dq, ddq, threads=1).tobytes()
    for threads in [0, 2, 5]:
        assert tx40.regressor(q, dq, ddq, threads=threads).tobytes() == expected


@pytest.mark.parametrize("name", dynid.robots())
def test_an_array_larger_than_the_cache_has_the_bytes_of_its_pieces(name):
    r = dynid.Robot(name)
    samples = (5 << 19) // (r.joints * len(r.names)) + 3
    q, dq, ddq = states(r, samples)
    whole = r.regressor(q, dq, ddq)
    pieces = [r.regressor(q[at : at + 1000], dq[at : at + 1000], ddq[at : at + 1000]) for at in range(0, samples, 1000)]
    assert whole.tobytes() == np.concatenate(pieces).tobytes()
    # Numbers that begin between two multiples of 16 bytes.
    room = np.full(whole.size + 2, np.nan)[1:-1].reshape(whole.shape)
    assert r.regressor(q, dq, ddq, out=room) is room and room.tobytes() == whole.tobytes()
    assert np.isnan(room.base[[0, -1]]).all()


@pytest.mark.parametrize("samples", [400, MANY])
def test_memory_serves_again_only_after_its_array_and_all_views_of_it_are_gone(tx40, samples):
    q, dq, ddq = states(tx40, samples)
    expected = tx40.regressor(q, dq, ddq)
    copy, view = expected.copy(), expected[5:9]
    other = tx40.regressor(-q, dq, ddq)
    assert (expected == copy).all()
    del expected
    kept = other.copy()
    # More than half as many samples go into the same memory.
    part = samples // 2 + 9
    for _ in range(3):
        assert (tx40.regressor(q, dq, ddq) == copy).all()
        assert (tx40.regressor(q[:part], dq[:part], ddq[:part]) == copy[:part]).all()
    assert (view == copy[5:9]).all() and (other == kept).all()
    assert other.flags.writeable and other.flags.aligned and other.flags.c_contiguous


def test_an_array_that_no_machine_can_hold_is_a_memory_error(tx40):
    q = np.broadcast_to(np.zeros(6), (1 << 44, 6))
    with pytest.raises(MemoryError):
        tx40.regressor(q, q, q)


def test_one_state_is_a_row_without_its_first_axis(tx40):
    q, dq, ddq = states(tx40, 1)
    for of in ["regressor", "power_regressor", "regressor_entries"]:
        all_of, one = getattr(tx40, of)(q, dq, ddq), getattr(tx40, of)(q[0], dq[0], ddq[0])
        assert one.shape == all_of.shape[1:] and (one == all_of[0]).all()
    assert tx40.torque(tx40.chi, q[0], dq[0], ddq[0]).shape == (6,)
    assert tx40.mass_matrix(tx40.chi, q[0]).shape == (6, 6)
    assert tx40.regressor(*np.zeros((3, 0, 6))).shape == (0, 6, 60)


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda r: r.regressor(*np.zeros((3, 5, 4))), "q has the shape (5, 4), expected (N, 6) or (6,)"),
        (lambda r: r.regressor(np.zeros((5, 6)), np.zeros((4, 6)), np.zeros((5, 6))), "dq has the shape (4, 6), and q has (5, 6)"),
        (lambda r: r.regressor("a", 1, 2), "q: an array of <U1 instead of numbers"),
        (lambda r: r.regressor([[{}] * 6], *np.zeros((2, 1, 6))), "q: not an array of numbers"),
        (lambda r: r.regressor(np.zeros((5, 6)) + 0j, *np.zeros((2, 5, 6))), "q: an array of complex128 instead of numbers"),
        (lambda r: r.torque(np.zeros(3), *np.zeros((3, 5, 6))), "chi has the shape (3,), expected (60,)"),
        (lambda r: r.regressor(*np.zeros((3, 5, 6)), out=np.zeros((5, 6, 59))), "out must be an array [5, 6, 60]"),
        (lambda _: dynid.Robot(3), "robot: expected a name, or the path of a robot YAML or of a URDF"),
        (lambda _: dynid.Robot("nothing"), "there is no robot 'nothing'"),
        (lambda _: dynid.Robot("nowhere.yaml"), "nowhere.yaml"),
    ],
)
def test_what_does_not_fit_is_said(tx40, call, words):
    with pytest.raises(dynid.Error) as said:
        call(tx40)
    assert words in str(said.value)
    assert isinstance(said.value, ValueError)


def test_arguments_that_share_memory_with_the_result_are_refused(planar):
    room = np.zeros((2, 2, len(planar.names)))
    q = room.reshape(-1, 2)[:2]
    with pytest.raises(dynid.Error):
        planar.regressor(q, np.zeros((2, 2)), np.zeros((2, 2)), out=room)


ODD = {
    # A linear axis, a fixed frame in mid-chain, a branch that moves with the sum of two joints.
    "tree": """name: tree
frames:
  - {j: 1, sigma: 1, alpha: -pi/2, d: 0.1, theta: 0.3, r: q1}
  - {j: 2, sigma: 2, alpha: 0.4, d: 0.2, theta: 0.5, r: 0.1}
  - {j: 3, sigma: 0, alpha: pi/2, d: 0.3, theta: q3, r: 0.2}
  - {j: 4, sigma: 0, alpha: 0, d: 0.2, theta: q4, r: 0}
  - {j: 5, parent: 3, sigma: 0, alpha: 0, d: 0.1, theta: q4 - q3, r: 0}
""",
    # What is known, springs, and friction between joints.
    "held": """name: held
frames:
  - {j: 1, sigma: 0, alpha: pi/2, d: 0, theta: q1, r: 0}
  - {j: 2, sigma: 0, alpha: -pi/3, d: 0.5, theta: q2, r: 0.1}
known: {M2: 0.2, Fc1: 0.4}
springs: [{joint: 2}]
friction: [{joints: {q1: 1, q2: -1}, name: belt}]
ellipsoids: [{frame: 2, centre: [0.2, 0, 0], radii: [0.3, 0.1, 0.1]}]
""",
}


@pytest.mark.parametrize("name", ODD)
def test_robots_that_are_no_chains_of_turning_links_are_consistent(name, tmp_path):
    path = tmp_path / f"{name}.yaml"
    path.write_text(ODD[name])
    r = dynid.Robot(path)
    q, dq, ddq = states(r, 20)
    chi = np.random.default_rng(5).normal(size=len(r.names))
    torque = r.torque(chi, q, dq, ddq)
    np.testing.assert_allclose(r.regressor(q, dq, ddq) @ chi, torque, rtol=1e-10, atol=1e-10)
    power = r.power_regressor(q, dq, ddq) @ chi
    np.testing.assert_allclose((dq * torque).sum(1), power, rtol=1e-10, atol=1e-10)
    lossless = chi * [not n.startswith(("Fv", "Fc")) for n in r.names]
    step = 1e-6
    after, before = (r.energy(lossless, q + s * dq, dq + s * ddq) for s in (step, -step))
    rate = (dq * r.torque(lossless, q, dq, ddq)).sum(1)
    np.testing.assert_allclose((after - before) / (2 * step), rate, rtol=1e-4, atol=1e-4)
    pushed = r.torque(chi, q, dq, ddq) - r.torque(chi, q, dq, np.zeros_like(q))
    np.testing.assert_allclose(np.einsum("tij,tj->ti", r.mass_matrix(chi, q), ddq), pushed, rtol=1e-9, atol=1e-9)
    again = pickle.loads(pickle.dumps(r))
    path.unlink()
    assert (again.torque(chi, q, dq, ddq) == torque).all() and again.relations == r.relations


def test_robots_pickle(tx40, tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text((ROBOTS / "planar_2r.yaml").read_text())
    for robot in [tx40, dynid.Robot(str(path))]:
        again = pickle.loads(pickle.dumps(robot))
        assert again.names == robot.names and again.generated == robot.generated
        q, dq, ddq = states(robot, 3)
        assert (again.regressor(q, dq, ddq) == robot.regressor(q, dq, ddq)).all()


def test_torques_are_those_of_pinocchio(tmp_path):
    pinocchio = pytest.importorskip("pinocchio", reason="Pinocchio (pip install pin) is not installed: nothing compared")
    urdf = tmp_path / "arm.urdf"
    urdf.write_text(
        """<robot name="arm"><link name="base"/>
        <joint name="a" type="continuous"><parent link="base"/><child link="one"/><origin xyz="0 0 .3" rpy=".2 0 0"/><axis xyz="0 0 1"/></joint>
        <link name="one"><inertial><origin xyz=".1 .02 .05" rpy=".1 .2 .3"/><mass value="3"/>
          <inertia ixx=".05" ixy="0" ixz="0" iyy=".06" iyz="0" izz=".03"/></inertial></link>
        <joint name="b" type="continuous"><parent link="one"/><child link="two"/><origin xyz=".2 0 .1" rpy="0 1.1 0"/><axis xyz="0 1 0"/></joint>
        <link name="two"><inertial><origin xyz="0 .1 .2"/><mass value="2"/>
          <inertia ixx=".02" ixy=".001" ixz="0" iyy=".02" iyz="0" izz=".01"/></inertial></link></robot>"""
    )
    r = dynid.Robot(str(urdf))
    model = pinocchio.buildModelFromUrdf(str(urdf))
    data = model.createData()
    q, dq, ddq = states(r, 20)
    expected = []
    for a, b, c in zip(q, dq, ddq):
        position = np.array([x for angle in a for x in (np.cos(angle), np.sin(angle))])
        expected.append(pinocchio.rnea(model, data, position, b, c))
    np.testing.assert_allclose(r.torque(r.chi, q, dq, ddq), expected, rtol=1e-9, atol=1e-9)
