"""Stubs, examples, memory, and the package without its heavier parts."""

import ast
import gc
import importlib.util
import inspect
import json
import os
import runpy
import subprocess
import sys

import numpy as np
import pytest

import impactdic as idic
from conftest import SOURCE

STUB = SOURCE / "scripts" / "impactdic" / "__init__.pyi"
LEAK_RUNS = int(os.environ.get("IMPACTDIC_LEAK_RUNS", 10))


def environment():
    folders = [str(SOURCE / "scripts"), os.environ["IMPACTDIC_MODULE"]]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(folders), "MPLBACKEND": "Agg"}


def stubs():
    return {node.name: node for node in ast.parse(STUB.read_text()).body
            if isinstance(node, (ast.FunctionDef, ast.ClassDef))}


def test_the_stubs_name_what_there_is():
    assert set(stubs()) - {"Plots"} == set(idic.__all__)
    for name in idic.__all__:
        assert getattr(idic, name).__doc__, name
        assert name in dir(idic)
    with pytest.raises(AttributeError, match="nothing"):
        idic.nothing


def parameters(node):
    given = node.args
    return [one.arg for one in given.args + given.kwonlyargs] + (
        [given.kwarg.arg] if given.kwarg else [])


def test_the_stubs_have_the_parameters_of_the_functions():
    checked = 0
    for name, node in stubs().items():
        members = [(getattr(idic, name, None), node)]
        if isinstance(node, ast.ClassDef):
            if name == "Plots":
                continue
            members = [(inspect.getattr_static(getattr(idic, name), one.name, None), one)
                       for one in node.body if isinstance(one, ast.FunctionDef)]
            assert all(real is not None for real, _ in members), name
        for real, one in members:
            if inspect.isfunction(real):
                assert list(inspect.signature(real).parameters) == parameters(one), one.name
                checked += 1
    assert checked > 25


def test_mypy_strict():
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("mypy is not installed")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", os.devnull, "--config-file",
         str(SOURCE / "pyproject.toml"), *map(str, (SOURCE / "docs" / "examples").glob("*.py"))],
        capture_output=True, text=True,
        env={**os.environ, "MYPYPATH": str(SOURCE / "scripts"), "PYTHONPATH": ""})
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_examples_run(tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib").use("Agg")
    # In this process: a new one would import numpy, pandas and the rest again.
    for name, words in (("arrays", "windows, rms error"), ("shot", "restitution e")):
        monkeypatch.setattr(sys, "argv", [name, str(tmp_path)])
        runpy.run_path(str(SOURCE / "docs" / "examples" / f"{name}.py"), run_name="__main__")
        assert words in capsys.readouterr().out
    assert (tmp_path / "shot" / "track.csv").exists() and (tmp_path / "velocity.png").exists()


def test_results_are_read_without_the_engine(impact_shot, tmp_path):
    kept = impact_shot.save(tmp_path / "shot")
    code = ("import sys, impactdic as idic\n"
            "shot = idic.load(sys.argv[1])\n"
            "assert not {'pandas', 'xarray', 'matplotlib', '_impactdic'} & set(sys.modules)\n"
            "print(shot.columns('track')['frame'][-1], len(shot.track))\n"
            "try:\n    idic.devices()\nexcept idic.MissingPackage as error:\n    print(error)\n")
    done = subprocess.run([sys.executable, "-c", code, str(kept.folder)], capture_output=True,
                          text=True, env={**environment(), "PYTHONPATH": str(SOURCE / "scripts")})
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[:2] == [f"{len(impact_shot.track) - 1}.0", str(len(impact_shot.track))]
    assert "pip install impactdic" in done.stdout


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_runs_leak_nothing():
    """IMPACTDIC_LEAK_RUNS=1000 for the long form."""
    pictures, _ = idic.synth(frames=3, radius_px=20, size=(60, 60), velocity_px=(0.7, -0.4))

    def measure():
        idic.track(pictures, no_field=True)
        idic.correlate(pictures[0], pictures[1], window=15, spacing=10)
        with pytest.raises(idic.InvalidArgument):
            idic.track(pictures, window=4)

    for _ in range(5):
        measure()
    gc.collect()
    before, references = resident_bytes(), sys.getrefcount(pictures)
    for _ in range(LEAK_RUNS):
        measure()
    gc.collect()
    grown = resident_bytes() - before
    assert sys.getrefcount(pictures) == references
    # A picture of 16 KB or a field of 2 KB a run would show; an allocator's own growth does not.
    assert grown < 8e6 + 4000 * LEAK_RUNS, grown


def test_a_map_larger_than_memory_is_given_back(film, tmp_path):
    """A sparse file of 600 MB: what was read of it does not stay in this process."""
    path, count = tmp_path / "film.raw", 600_000_000 // (128 * 128)
    with open(path, "wb") as file:
        file.truncate(count * 128 * 128)
    mapped = np.memmap(path, np.uint8, "r", shape=(count, 128, 128))
    clip = idic.open(mapped)
    clip[0]
    before = resident_bytes()
    for first in range(0, count, 64):
        clip._source.read(first, min(64, count - first), 1)
    assert resident_bytes() - before < 50e6
    assert not np.asarray(clip[:2]).any()


# What a notebook's cell `parameters` says, smaller: a figure of each, not the best of it.
SMALL = {
    "shot": {"radius_px": 36},
    "calibrate": {"shot_count": 2, "radius_px": 30},
    "chapter2": {"patterns": ["e1", "b2"], "radius_px": 30, "frames": 4},
}


@pytest.mark.parametrize("name", SMALL)
def test_the_notebooks_run(name, monkeypatch):
    """Every cell, as a notebook runs it."""
    matplotlib = pytest.importorskip("matplotlib")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    matplotlib.use("Agg")
    cells = json.loads((SOURCE / "docs" / "examples" / f"{name}.ipynb").read_text())["cells"]
    space = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), f"{name}.ipynb", "exec"), space)  # noqa: S102
        if "parameters" in cell["metadata"].get("tags", []):
            assert set(SMALL[name]) <= set(space)
            space.update(SMALL[name])
    matplotlib.pyplot.close("all")
    if name == "shot":
        law, measured = space["law"], space["shot"].figures["restitution"]
        assert abs(measured["value"] - law["restitution"]) < 0.05  # of a ball of 36 px
    elif name == "calibrate":
        stiffness = space["fit"].parameters["value"][0]
        assert len(space["shots"]) == 2 and abs(stiffness / 13385 - 1) < 0.05
    else:
        assert all(max(values) < 0.02 for values in space["errors"].values())  # px
        assert space["found"].sum() > 20
