"""Identification, and recordings."""

import json
import pickle
import subprocess

import numpy as np
import pytest

import dynid
from conftest import motion, recorded, written


def test_the_parameters_of_a_simulated_recording_are_found_within_their_uncertainty(planar):
    rec, (q, dq, ddq) = recorded(planar)
    fit = dynid.identify(rec)
    assert fit.names == planar.names and fit.method == "idim-wls"
    off = (fit.values - planar.chi) / fit.sigma
    assert np.abs(off).max() < 5, dict(zip(fit.names, off))
    assert fit.relative_error < 0.01
    assert fit.covariance.shape == (13, 13)
    np.testing.assert_allclose(np.sqrt(np.diag(fit.covariance)), fit.sigma, rtol=1e-9)
    np.testing.assert_array_equal(fit.predict(q, dq, ddq), planar.torque(fit.values, q, dq, ddq))


@pytest.mark.parametrize("method", ["idim-ols", "pim-wls", "idim-irls"])
def test_every_kind_of_method_comes_to_the_same_parameters(planar, method):
    rec, _ = recorded(planar, noise=0.002)
    found = dynid.identify(rec, method=method)
    assert found.method == method
    np.testing.assert_allclose(found.values, planar.chi, atol=0.1)


def test_several_recordings_are_one(planar):
    parts = [recorded(planar, seed=s, duration=8)[0] for s in (1, 2)]
    both = parts[0] + parts[1]
    assert both.samples == sum(p.samples for p in parts) and len(both.motions) == 2
    np.testing.assert_array_equal(dynid.identify(parts).values, dynid.identify(both).values)


def test_a_recording_of_files_is_that_of_its_arrays(planar, tmp_path):
    rec, _ = recorded(planar)
    opened = dynid.open(written(rec, tmp_path))
    np.testing.assert_array_equal(dynid.identify(opened).values, dynid.identify(rec).values)


def test_the_numbers_are_those_of_the_command_line(planar, program, tmp_path):
    manifest, out = written(recorded(planar)[0], tmp_path), tmp_path / "model.json"
    subprocess.run([program, "identify", str(manifest), "--out", str(out)], check=True, capture_output=True)
    here, there = dynid.identify(dynid.open(manifest)), dynid.load(out)
    np.testing.assert_array_equal(there.values, here.values)
    np.testing.assert_array_equal(there.sigma, here.sigma)


def test_a_saved_model_is_read_back(planar, tmp_path):
    fit = dynid.identify(recorded(planar)[0])
    fit.save(tmp_path / "model.json")
    for again in [dynid.load(tmp_path / "model.json"), pickle.loads(pickle.dumps(fit))]:
        np.testing.assert_array_equal(again.values, fit.values)
        np.testing.assert_array_equal(again.covariance, fit.covariance)
        assert again.json() == fit.json()


def test_ellipsoids_of_a_table_are_saved_with_the_model(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(
        "name: arm\ngravity: [0, -9.81, 0]\nframes:\n  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n"
        "  - {j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2, r: 0}\n"
        "ellipsoids:\n  - {frame: 2, centre: [0.2, 0, 0], radii: [0.3, 0.1, 0.1]}\n"
    )
    robot = dynid.Robot(path)
    t, q, dq, ddq = motion(robot)
    rec = dynid.Recording(robot, t, q, robot.torque(np.ones(len(robot.names)), q, dq, ddq))
    ((link, saved),) = json.loads(dynid.identify(rec).json())["table"]["ellipsoids"]
    assert link == 1 and saved["centre"] == [0.2, 0, 0]
    np.testing.assert_allclose(saved["shape"], np.diag([0.09, 0.01, 0.01]), rtol=1e-12)


def test_recordings_pickle(planar):
    rec, _ = recorded(planar, duration=8)
    again = pickle.loads(pickle.dumps(rec))
    for a, b in zip(again.arrays()[0], rec.arrays()[0]):
        np.testing.assert_array_equal(a, b)
    np.testing.assert_array_equal(dynid.identify(again).values, dynid.identify(rec).values)


def test_a_frame_has_a_row_for_each_parameter(planar):
    pytest.importorskip("pandas", reason="pandas is not installed: to_frame was not run")
    fit = dynid.identify(recorded(planar)[0])
    frame = fit.to_frame()
    assert list(frame.index) == fit.names and list(frame.columns) == ["value", "sigma", "unit"]


@pytest.mark.parametrize(
    "change, words",
    [
        (dict(t=np.arange(99) / 100.0), "q has 100 rows, and t has 99 values"),
        (dict(q=np.zeros(2), tau=np.zeros(2)), "q has the shape (2,), expected (N, 2)"),
        (dict(t=np.arange(100).astype("datetime64[ms]")), "t: an array of datetime64[ms] instead of numbers"),
        (dict(t=np.zeros(100)), "t[1] is 0, which does not come after t[0], 0"),
        (dict(q=np.zeros((100, 3))), "q has the shape (100, 3), expected (N, 2)"),
        (dict(tau=np.full((100, 2), np.nan)), "tau[0, 0] is NaN, expected a number"),
    ],
)
def test_arrays_that_are_no_recording_are_refused(planar, change, words):
    arrays = dict(t=np.arange(100) / 100.0, q=np.zeros((100, 2)), tau=np.zeros((100, 2))) | change
    with pytest.raises(dynid.Error) as said:
        dynid.Recording(robot=planar, **arrays)
    assert words in str(said.value)


def test_what_identification_refuses_is_an_error_with_its_words(planar, tx40):
    rec, _ = recorded(planar)
    with pytest.raises(dynid.Error, match="no method is called \"magic\": one of idim-ols, idim-wls"):
        dynid.identify(rec, method="magic")
    with pytest.raises(dynid.Error, match="expected a dynid.Recording or a list of them"):
        dynid.identify(3)
    with pytest.raises(dynid.Error, match="a recording of tx40, not of the planar_2r"):
        t, q, *_ = motion(tx40, duration=2)
        dynid.identify([rec, dynid.Recording(robot=tx40, t=t, q=q, tau=q)])
    for options, words in [
        (dict(band=0), "band: it must be a number from 0.01 to 100000"),
        (dict(band=float("nan")), "band: it must be a number"),
        (dict(threads=1025), "threads: it must be a number from 0 to 1024"),
    ]:
        with pytest.raises(dynid.Error, match=words):
            dynid.identify(rec, **options)
    with pytest.raises(dynid.Error, match="there is no such file"):
        dynid.open("nowhere.yaml")


def test_a_recording_with_a_wrong_sign_is_refused_unless_asked_for(planar):
    t, q, dq, ddq = motion(planar)
    tau = planar.torque(planar.chi, q, dq, ddq) * [1, -1]
    rec = dynid.Recording(robot=planar, t=t, q=q, tau=tau)
    with pytest.raises(dynid.Error, match="the opposite sign of the torque of joint 2"):
        dynid.identify(rec)
    assert dynid.identify(rec, implausible=True).relative_error > 0


def followed(robot, seeds=(0, 1)):
    """A recording of a robot that follows its plan, and the plan: what both methods simulate."""
    plan = [motion(robot, duration=12, seed=s) for s in seeds]
    parts = [recorded(robot, seed=s, duration=12)[0] for s in seeds]
    return sum(parts[1:], parts[0]), plan


@pytest.mark.parametrize("method", ["idim-iv", "idim-didim"])
def test_methods_that_simulate_the_plan_find_the_parameters(planar, method):
    rec, plan = followed(planar)
    fit = dynid.identify(rec, method=method, planned=plan)
    assert fit.method == method
    # The plan itself is what was recorded here: the controller that is simulated lags a little behind it.
    np.testing.assert_allclose(fit.values, planar.chi, rtol=0.02, atol=0.02)
    assert json.loads(fit.json())["simulated"]["compared_with"] == "idim-wls"


def test_a_plan_may_be_a_file(planar, tmp_path):
    rec, plan = followed(planar, seeds=(0,))
    path = tmp_path / "motion1.csv"
    np.savetxt(path, np.column_stack(plan[0]), delimiter=",", header="t,q1,q2,dq1,dq2,ddq1,ddq2", comments="", fmt="%.17g")
    from_arrays = dynid.identify(rec, method="idim-iv", planned=plan)
    for place in [path, str(tmp_path)]:
        np.testing.assert_array_equal(dynid.identify(rec, method="idim-iv", planned=place).values, from_arrays.values)


def test_a_plan_that_is_none_of_the_recording_is_refused(planar):
    rec, plan = followed(planar, seeds=(0,))
    t, q, dq, ddq = plan[0]
    uneven = t.copy()
    uneven[3] += 0.002
    cases = [
        (dict(method="idim-iv"), "the method of instrumental variables needs the planned motions"),
        (dict(method="idim-wls", planned=plan), "idim-wls does not simulate"),
        (dict(method="idim-iv", planned=3), "planned: expected a path, or a list with (t, q, dq, ddq)"),
        (dict(method="idim-iv", planned=[plan[0][:3]]), "planned: expected a path, or a list with (t, q, dq, ddq)"),
        (dict(method="idim-iv", planned=[(uneven, q, dq, ddq)]), "planned[0]: the rows must be equally spaced in time"),
        (dict(method="idim-iv", planned=[(t[1:], q, dq, ddq)]), "planned[0]: q has 2400 rows, and t has 2399 values"),
        (dict(method="idim-iv", planned=[(t, q * np.nan, dq, ddq)]), "planned[0]: a value is not a finite number"),
        (dict(method="idim-iv", planned=plan * 2), "planned: "),
        (dict(method="idim-iv", planned="nowhere.csv"), "nowhere.csv"),
    ]
    for options, words in cases:
        with pytest.raises(dynid.Error) as said:
            dynid.identify(rec, **options)
        assert words in str(said.value)


def test_progress_of_an_identification_is_told_and_shown(planar, capsys):
    rec, _ = recorded(planar)
    told = []
    plain = dynid.identify(rec)
    np.testing.assert_array_equal(dynid.identify(rec, progress=lambda *at: told.append(at)).values, plain.values)
    assert all(0 <= share <= 1 and what for share, what in told)
    pytest.importorskip("tqdm", reason="tqdm is not installed: no bar was shown")
    dynid.identify(rec, progress=True)
    shown = capsys.readouterr().err
    assert "identification: 100%" in shown
    dynid.identify(rec, progress=False)
    assert capsys.readouterr().err == ""
