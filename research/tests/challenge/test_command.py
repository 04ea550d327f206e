"""``asperity challenge``: the list, the inputs, and scores, also of the command's own run."""

from pathlib import Path

import numpy as np
import pytest
from tests.cli.conftest import Asperity

import asperity_research.challenge as challenge


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_list_names_every_problem(asperity: Asperity) -> None:
    status, text, _ = asperity("challenge")
    assert status == 0
    assert asperity("challenge", "list") == (0, text, "")
    assert all(f"\n{name} " in text for name in challenge.NAMES)


def test_a_run_of_the_written_inputs_agrees(asperity: Asperity) -> None:
    assert asperity("challenge", "write", "inputs", "--problem", "dense")[0] == 0
    assert asperity("run", "inputs/dense/run.toml", "--out", "mine", "--quiet")[0] == 0
    status, text, _ = asperity(
        "challenge", "score", "mine/aging.csv", "--problem", "dense", "--out", "mine.png"
    )
    assert status == 0
    assert "dense     agrees" in text
    assert "2 of 2 quantities agree at 10 of 10 places" in text
    assert Path("mine.png").stat().st_size > 10_000


def test_an_answer_that_is_off_is_no_failure(asperity: Asperity) -> None:
    answer = challenge.problem("dilute").answer
    rows = zip(answer.abscissa, 1.1 * answer.values["area"], strict=True)
    lines = ["# problem: dilute", "time,area", *(f"{t},{a}" for t, a in rows)]
    Path("mine.csv").write_text("\n".join(lines))
    status, text, _ = asperity("challenge", "score", "mine.csv")
    assert status == 0
    assert "off" in text
    assert "approach  not given" in text
    assert "does not agree" in text
    assert "+10" in text


def test_mistakes_are_told(asperity: Asperity) -> None:
    Path("empty.csv").write_text("# problem: dilute\ntime,area\n")
    Path("other.csv").write_text("# problem: dilluted\ntime,area\n0,1\n")
    Path("kept/dense").mkdir(parents=True)
    Path("kept/dense/precious").touch()
    for words, said in {
        ("challenge", "score", "nowhere.csv"): "no such file",
        ("challenge", "score", "empty.csv"): "empty.csv",
        ("challenge", "score", "other.csv"): "--problem dilute",
        ("challenge", "score", "other.csv", "--problem", "dilute", "--out", "x.doc"): ".png",
        ("challenge", "write", "kept"): "kept",
        ("challenge", "write", "kept", "--overwrite"): "kept",
        ("challenge", "write", "new", "--problem", "densely"): "one of dilute",
        ("challenge", "write", "new", "--scan", "empty.csv"): "--scan",
    }.items():
        status, _, error = asperity(*words)
        assert status == 2, words
        assert said in error, words
        assert "Traceback" not in error
    assert Path("kept/dense/precious").exists()
    assert not Path("kept/dilute").exists()
    assert not Path("new").exists()


def test_inputs_are_written_beside_what_a_folder_holds_and_replaced_when_asked(asperity: Asperity) -> None:
    Path("mine").mkdir()
    Path("mine/notes.txt").write_text("kept")
    for problem, flags, expected in (
        ("dense", (), 0),
        ("dilute", (), 0),
        ("dense", (), 2),
        ("dense", ("--overwrite",), 0),
    ):
        assert asperity("challenge", "write", "mine", "--problem", problem, *flags)[0] == expected
    assert sorted(path.name for path in Path("mine").iterdir()) == ["dense", "dilute", "notes.txt"]
    assert np.load("mine/dense/heights.npy").shape == (128, 128)
