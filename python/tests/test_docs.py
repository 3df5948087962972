"""What the documentation shows is run."""

import doctest
import textwrap
from pathlib import Path

import numpy as np
import pytest

import dynid
from conftest import motion, recorded

PYTHON = Path(__file__).parents[1]


@pytest.mark.parametrize("name", dynid.__all__)
def test_examples_of_docstrings(name):
    finder, runner = doctest.DocTestFinder(), doctest.DocTestRunner()
    for example in finder.find(getattr(dynid, name), name, module=False):
        assert runner.run(example).failed == 0, example.name
    if name in ("Robot", "Recording", "identify"):
        assert runner.tries > 0, "its examples were not found"


def test_the_readme():
    result = doctest.testfile(str(PYTHON / "README.md"), module_relative=False)
    assert result.failed == 0 and result.attempted > 5


def test_the_snippet_of_the_readme_of_the_project():
    text = (PYTHON.parent / "README.md").read_text().split("```python\n", 1)[1].split("```", 1)[0]
    r = dynid.Robot("tx40")
    t, q, dq, ddq = motion(r, duration=12)
    other, _ = recorded(r, seed=1, duration=12)
    tau = r.torque(r.chi, q, dq, ddq) + np.random.default_rng(1).normal(0, 0.02, q.shape)
    names = dict(q=q, dq=dq, ddq=ddq, t=t, tau=tau, other=other)
    exec(textwrap.dedent(text), names)
    assert names["W"].shape == (len(t), 6, 60)
    assert names["fit"].relative_error < 0.05
    assert names["d"].findings == []


@pytest.mark.parametrize("name", dynid.__all__)
def test_stubs_name_everything_that_is_there(name):
    stubs = (PYTHON / "pysrc/dynid/__init__.pyi").read_text()
    thing = getattr(dynid, name)
    if not isinstance(thing, type):
        assert f"def {name}(" in stubs
        return
    body = stubs.split(f"class {name}", 1)[1].split("\nclass ")[0]
    if thing is not dynid.Error:
        public = [member for member in vars(thing) if not member.startswith("_")]
        assert public and all(f"def {member}(" in body for member in public)
