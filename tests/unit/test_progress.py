"""Progress: lines in logs, a bar on terminals and in notebooks; results do not depend on it."""

import io
import itertools
import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from asperity import age, press
from asperity.progress import progress_shown
from asperity.solids import spring_lattice
from asperity.surfaces import gaussian

CONTACT = press(gaussian((16, 16)), spring_lattice(k0=1.0, k1=3.0), load=16.0)
TIMES = np.geomspace(0.1, 100.0, 7)


def test_in_a_log_there_is_a_line_for_each_decade(capsys: pytest.CaptureFixture[str]) -> None:
    with_bar = age(CONTACT, TIMES, progress=True)
    out, said = capsys.readouterr()
    assert out == ""
    lines = said.splitlines()
    assert lines[0] == "aging to t = 100"
    assert [line.split()[2] for line in lines[1:]] == ["0", "0.1", "1", "10", "100"]
    assert lines[-1].endswith(
        f"area {with_bar.final.area} sites ({100 * with_bar.final.contact_fraction:.3g} %)"
    )
    without = age(CONTACT, TIMES)
    assert capsys.readouterr() == ("", "")
    assert with_bar.dataset.identical(without.dataset)


def test_in_a_log_there_is_a_line_every_few_seconds_within_a_decade(monkeypatch, capsys):
    seconds = itertools.count(step=6.0)
    monkeypatch.setattr("asperity.progress.clock", SimpleNamespace(monotonic=lambda: next(seconds)))
    age(CONTACT, [1.0, 2.0, 3.0, 4.0], progress=True)
    assert [line.split()[2] for line in capsys.readouterr().err.splitlines()[1:]] == ["0", "1", "3"]


def test_on_a_terminal_there_is_a_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = io.StringIO()
    monkeypatch.setattr(screen, "isatty", lambda: True)
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("TERM", "xterm")
    with progress_shown() as shown:
        shown.stage("pressing")
        shown.remark("a remark")
        age(CONTACT, TIMES, progress=True)
    said = screen.getvalue()
    assert "\x1b[" in said
    assert "remark: a remark" in said
    assert "aging" in said
    assert "of 100, area" in said


def test_in_a_notebook_there_is_a_bar_below_the_cell(monkeypatch, capsys):
    pages: list[str] = []
    cell = SimpleNamespace(update=pages.append)
    display: Any = SimpleNamespace(HTML=str, display=lambda *_, **__: cell)
    ipython: Any = SimpleNamespace(get_ipython=lambda: SimpleNamespace(kernel=1), display=display)
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    history = age(CONTACT, TIMES, progress=True)
    assert capsys.readouterr() == ("", "")
    assert pages[0] == '<div>aging <progress max="7" value="0"></progress> </div>'
    last = f"t = 100 of 100, area {history.final.area} sites"
    assert '<progress max="7" value="7"></progress>' in pages[-1]
    assert last in pages[-1]
    with progress_shown() as shown:
        shown.remark("1 < 2")
    assert "<div>remark: 1 &lt; 2</div>" in pages[-1]


def test_a_call_of_the_users_own_gets_each_frame() -> None:
    times = []
    age(CONTACT, TIMES, progress=lambda frame: times.append(frame.time))
    np.testing.assert_array_equal(times, [0.0, *TIMES])
    assert age(CONTACT, TIMES, progress=False).final.area > 0
