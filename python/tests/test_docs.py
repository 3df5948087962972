"""What the documentation shows is run."""

import ast
import doctest
import inspect
import runpy
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
    if name in ("Robot", "Recording", "identify", "diagnose"):
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


def test_the_story(capsys):
    runpy.run_path(str(PYTHON / "examples" / "story.py"))
    said = capsys.readouterr().out
    assert "worst is joint 2" in said
    assert "stribeck" in said and "the same robot, later: []" in said


def test_the_examples_fit_the_stubs():
    api = pytest.importorskip("mypy.api", reason="mypy is not installed: the examples were not type-checked")
    said, complaint, status = api.run(["--strict-optional", "--check-untyped-defs", str(PYTHON / "examples" / "story.py")])
    assert status == 0, said + complaint


def test_stubs_have_the_arguments_that_are_there():
    """Names, order and defaults of every function and method, as the module tells them."""
    tree = ast.parse((PYTHON / "pysrc/dynid/__init__.pyi").read_text())
    checked = 0
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            checked += has_arguments_of(getattr(dynid, node.name), node)
        elif isinstance(node, ast.ClassDef):
            for member in node.body:
                is_property = any(isinstance(d, ast.Name) and d.id == "property" for d in getattr(member, "decorator_list", []))
                if isinstance(member, ast.FunctionDef) and not member.name.startswith("_") and not is_property:
                    checked += has_arguments_of(getattr(getattr(dynid, node.name), member.name), member)
    assert checked > 20


def has_arguments_of(function, node):
    arguments = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
    stub = [a.arg for a in arguments if a.arg != "self"]
    there = [name for name in inspect.signature(function).parameters if name != "self"]
    assert stub == there, f"{node.name}: {stub} in the stubs, {there} in the module"
    return 1


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
