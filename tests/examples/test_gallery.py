"""Every script of the gallery answers its question: it runs, its checks hold, it draws, and leaves nothing.

A script is executed as a user would do it, in an empty folder, and warnings are errors. What it checks its
answer against stands in it, behind the words "Origin:".
"""

import ast
import re
import runpy
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

GALLERY = Path(__file__).parents[2] / "docs" / "gallery"
SCRIPTS = sorted(GALLERY.glob("*/*.py"))


@pytest.fixture
def empty_folder(tmp_path, monkeypatch):
    """Work in an empty folder, with a folder for temporary files that must be empty again at the end."""
    here, temporary = tmp_path / "here", tmp_path / "temporary"
    for folder in (here, temporary):
        folder.mkdir()
    monkeypatch.chdir(here)
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    yield
    left = [path.name for path in (*here.iterdir(), *temporary.iterdir())]
    assert set(left) <= {"dask-scratch-space"}  # which dask keeps for all that runs on the machine


@pytest.mark.parametrize(
    "script",
    [pytest.param(script, marks=[pytest.mark.slow] * (script.stem != "own_array")) for script in SCRIPTS],
    ids=lambda script: str(script.relative_to(GALLERY)),
)
@pytest.mark.usefixtures("empty_folder", "no_display")
def test_the_script_runs_draws_and_its_checks_hold(script, capsys):
    runpy.run_path(str(script), run_name="__main__")
    assert capsys.readouterr().out  # the verdict
    figures = [plt.figure(number) for number in plt.get_fignums()]
    assert figures
    for figure in figures:
        figure.canvas.draw()
        assert figure.axes
        for axes in figure.axes:
            assert axes.has_data()
            named = axes.get_xlabel() or axes.get_ylabel() or axes.get_title()
            assert named or not axes.axison or axes.get_label() == "<colorbar>"


def test_each_script_asks_a_question_and_says_where_its_checked_value_comes_from():
    for script in SCRIPTS:
        text = script.read_text(encoding="utf-8")
        title, line = (ast.get_docstring(ast.parse(text)) or "").splitlines()[:2]
        assert title.endswith("?"), script
        assert line == "=" * len(title), script
        # The check stands below the words on where its value comes from.
        assert re.search(r"# Origin[ :](.*\n)+? *(assert |np\.testing\.assert_)", text), script
        assert len(text.splitlines()) <= 90, script
    folders = {script.parent for script in SCRIPTS} | {GALLERY}
    assert all((folder / "GALLERY_HEADER.rst").is_file() for folder in folders)
    assert len(SCRIPTS) >= 14
