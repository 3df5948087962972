"""Diagnoses."""

import json
import pickle
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import dynid
from conftest import motion, recorded, written


def spring(q, dq, ddq):
    """4 N.m/rad on the second joint."""
    return np.stack([np.zeros(len(q)), 4.0 * q[:, 1]], axis=1)


@pytest.fixture(scope="module")
def found(planar):
    recordings = [recorded(planar, seed=s, added=spring, duration=10)[0] for s in (1, 2, 3)]
    test, _ = recorded(planar, seed=4, added=spring, duration=10)
    told = []
    d = dynid.diagnose(recordings, test=test, progress=lambda share, what: told.append((share, what)))
    return d, told


def test_a_hidden_spring_is_found_with_its_stiffness(found):
    d, _ = found
    assert [(f.effect, f.joints) for f in d.findings] == [("spring", [2])]
    (finding,) = d.findings
    value, sigma, unit = finding.parameters["k"]
    assert abs(value - 4) < max(5 * sigma, 0.05) and unit == "N.m/rad"
    assert 0.9 < finding.confidence <= 1 and "spring" in finding.sentence.lower()
    assert d.held_out[1] < d.held_out[0]
    assert d.on_test[1] < d.on_test[0]
    assert abs(finding.on_test[0] - 1) < 0.1


def test_the_result_is_told_as_json_text_and_page(found, tmp_path):
    d, _ = found
    assert json.loads(d.json())["findings"][0]["effect"] == "spring"
    assert "spring" in str(d) and d.verdict
    d.report(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert page.startswith("<!") and d.findings[0].sentence.split(",")[0] in page


def test_the_model_that_is_found_predicts_with_its_law(planar, found):
    t, q, dq, ddq = motion(planar, duration=5, seed=8)
    expected = planar.torque(planar.chi, q, dq, ddq) + spring(q, dq, ddq)
    model = found[0].model
    np.testing.assert_allclose(model.predict(q, dq, ddq, t), expected, atol=0.1)
    with pytest.raises(dynid.Error, match="give its times t as well"):
        model.predict(q, dq, ddq)
    with pytest.raises(dynid.Error, match="equally spaced"):
        model.predict(q, dq, ddq, t**2)
    with pytest.raises(dynid.Error, match="a value is not a finite number"):
        model.predict(q * np.nan, dq, ddq, t)


def test_nothing_is_found_where_nothing_is_hidden_or_nothing_changed(planar):
    plain = recorded(planar, seed=5, duration=10)[0]
    assert dynid.diagnose(plain).findings == []
    before, after = ([recorded(planar, seed=s, added=spring, duration=10)[0] for s in seeds] for seeds in ((1, 2), (6, 7)))
    assert dynid.diagnose(after, baseline=before).findings == []


def test_what_a_reference_knows_is_no_news(planar, found, tmp_path):
    d, _ = found
    d.model.save(tmp_path / "normal.json")
    assert json.loads((tmp_path / "normal.json").read_text())["effects"][0]["effect"] == "spring"
    later = [recorded(planar, seed=s, added=spring, duration=10)[0] for s in (11, 12)]
    for reference in [d.model, tmp_path / "normal.json", pickle.loads(pickle.dumps(d.model))]:
        assert dynid.diagnose(later, reference=reference).findings == []
    without = dynid.identify([recorded(planar, seed=s, duration=10)[0] for s in (1, 2, 3)])
    assert [f.effect for f in dynid.diagnose(later, reference=without).findings] == ["spring"]


def test_a_reference_of_the_command_line_brings_its_motions_as_there(planar, program, tmp_path):
    before = written(recorded(planar, seed=1, duration=10)[0], tmp_path / "before")
    later = written(recorded(planar, seed=2, added=spring, duration=10)[0], tmp_path / "later")
    model, told = tmp_path / "model.json", tmp_path / "told.json"
    for words in [["identify", before, "--out", model], ["diagnose", later, "--reference", model, "--json", told]]:
        subprocess.run([program, *map(str, words)], check=True, capture_output=True)
    here, there = json.loads(dynid.diagnose(dynid.open(later), reference=model).json()), json.loads(told.read_text())
    assert [f["effect"] for f in here["findings"]] == ["spring"]
    assert here["findings"] == there["findings"] and here["verdict"] == there["verdict"]
    before.unlink()
    lost = dynid.diagnose(dynid.open(later), reference=model).verdict
    assert "Of the model's motions only what its file holds was used" in lost[-1] and "is not there" in lost[-1]


def test_a_reference_of_another_robot_or_beside_a_baseline_is_refused(planar, tx40):
    rec = recorded(planar, duration=10)[0]
    other = dynid.identify(recorded(tx40, duration=10)[0])
    with pytest.raises(dynid.Error, match="reference: a model of tx40, not of the planar_2r"):
        dynid.diagnose(rec, reference=other)
    with pytest.raises(dynid.Error, match="expected a dynid.Fit or the path"):
        dynid.diagnose(rec, reference=3)
    with pytest.raises(dynid.Error, match="baseline and reference"):
        dynid.diagnose(rec, reference=dynid.identify(rec), baseline=rec)


MAGNET = {"id": "magnet", "joint": 2, "law": "k1*sin(5*q2) + k2*cos(5*q2)"}


def magnet(q, dq, ddq):
    return np.stack([np.zeros(len(q)), 3 * np.sin(5 * q[:, 1]) + 2 * np.cos(5 * q[:, 1])], axis=1)


def test_a_law_of_the_user_is_found_by_its_name(planar, tmp_path):
    recordings = [recorded(planar, seed=s, added=magnet, duration=10)[0] for s in (1, 2, 3)]
    path = tmp_path / "laws.yaml"
    path.write_text('- {id: magnet, joint: 2, law: "k1*sin(5*q2) + k2*cos(5*q2)"}')
    told = [dynid.diagnose(recordings, laws=laws) for laws in ([MAGNET | {"joint": np.int64(2)}], path)]
    assert [f.effect for f in told[0].findings] == ["magnet"]
    assert told[0].json() == told[1].json()
    parameters = told[0].findings[0].parameters
    assert abs(parameters["k1"][0] - 3) < 0.1 and abs(parameters["k2"][0] - 2) < 0.1


def test_what_is_no_law_is_told_with_its_place(planar):
    rec = recorded(planar, duration=10)[0]
    for laws, words in [
        ([MAGNET, MAGNET | {"id": "b", "law": "sin(k*q2)"}], "laws:2:"),
        ([MAGNET | {"joint": 3}], "planar_2r has no joint 3"),
        ([], "the list is empty"),
        (3, "laws: expected a path, or a list of dictionaries"),
    ]:
        with pytest.raises(dynid.Error) as said:
            dynid.diagnose(rec, laws=laws)
        assert words in str(said.value)


def test_progress_goes_from_nothing_to_all(found):
    _, told = found
    shares = [share for share, _ in told]
    assert told and all(0 <= s <= 1 for s in shares)
    assert all(what for _, what in told)


def test_an_error_in_progress_ends_the_diagnosis(planar):
    rec = [recorded(planar, seed=s, added=spring, duration=10)[0] for s in (1, 2, 3)]

    def angry(share, what):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        dynid.diagnose(rec, progress=angry)


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of Unix: Ctrl-C was not tried")
def test_control_c_ends_a_long_diagnosis():
    script = textwrap.dedent(
        """
        import dynid, numpy as np, signal, sys
        # A shell may have started the tests in the background, where Ctrl-C is ignored.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        r = dynid.Robot("tx40")
        t = np.arange(0, 60, 0.002)[:, None]
        w = np.linspace(0.7, 2.9, 6)
        q, dq, ddq = np.sin(w * t), w * np.cos(w * t), -w**2 * np.sin(w * t)
        tau = r.torque(r.chi, q, dq, ddq) + np.random.default_rng(1).normal(0, 0.1, q.shape)
        rec = dynid.Recording(robot=r, t=t[:, 0], q=q, tau=tau)
        print("ready", flush=True)
        try:
            dynid.diagnose([rec], implausible=True)
        except KeyboardInterrupt:
            print("interrupted", flush=True)
            sys.exit(0)
        print("done", flush=True)
        """
    )
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline().strip() == "ready"
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    sent = time.monotonic()
    assert process.stdout.readline().strip() == "interrupted"
    assert time.monotonic() - sent < 5
    assert process.wait(timeout=30) == 0


def test_other_threads_run_meanwhile(planar):
    rec = [recorded(planar, seed=s, added=spring, duration=10)[0] for s in (1, 2, 3)]
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.005)

    thread = threading.Thread(target=count)
    thread.start()
    began = time.monotonic()
    dynid.diagnose(rec)
    took = time.monotonic() - began
    stop.set()
    thread.join()
    assert counted[0] > 20 * min(took, 1), (counted, took)
