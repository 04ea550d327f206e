"""``--open`` and ``--install-completion``."""

from __future__ import annotations

import subprocess
import webbrowser
from pathlib import Path

import pytest

from asperity.app.cli.computing import open_results
from tests.cli.conftest import SMALL, Asperity, Refused


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What the browser was given."""
    given: list[str] = []

    def give(address: str) -> bool:
        given.append(address)
        return True

    monkeypatch.setattr(webbrowser, "open", give)
    return given


def test_a_run_opens_its_picture(asperity: Asperity, opened: list[str], tmp_path: Path) -> None:
    out = tmp_path / "a run"
    assert asperity("run", *SMALL, "--out", out, "--quiet", "--open") == (0, "", "")
    assert opened == [(out / "aging.png").as_uri()]
    assert asperity("run", *SMALL, "--out", out, "--quiet", "--open")[0] == 2  # it is there already
    assert len(opened) == 1


def test_the_page_or_the_picture_is_opened_or_else_the_folder(opened: list[str], tmp_path: Path) -> None:
    for number, (files, shown) in enumerate(
        (
            (("prediction.html", "growth.png", "contacts.png", "history.csv"), "prediction.html"),
            (("history.svg", "contacts.svg", "aging.csv"), "history.svg"),
            (("contacts.pdf", "aging.csv"), "contacts.pdf"),
            (("aging.csv", "summary.txt"), ""),
        )
    ):
        out = tmp_path / str(number)
        (out / "history.zarr").mkdir(parents=True)
        for name in files:
            (out / name).touch()
        open_results(out)
        assert opened[-1] == (out / shown).as_uri()


def test_where_nothing_opens_it_the_place_is_told(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(webbrowser, "open", lambda _: False)
    open_results(tmp_path)
    assert capsys.readouterr().err == f"remark: nothing here opens {tmp_path}\n"


def test_bash_completes_commands_and_flags(
    asperity: Asperity, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("XDG_DATA_HOME", raising=False)
    monkeypatch.delenv("BASH_COMPLETION_USER_DIR", raising=False)
    status, said, error = asperity("--install-completion", "--shell", "bash")
    assert (status, error) == (0, "")
    script = Path(said.removeprefix("written ").split(";")[0])
    assert script.is_relative_to(tmp_path)

    def completed(*words: str) -> set[str]:
        line = " ".join(words)
        ask = f'source "{script}"; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _asperity; '
        ask += 'printf "%s\\n" "${COMPREPLY[@]}"'
        found = subprocess.run(["bash", "-c", ask], capture_output=True, text=True, check=True, timeout=60)
        return set(found.stdout.split())

    assert completed("asperity", "pre") == {"predict"}
    assert completed("asperity", "run", "--hur") == {"--hurst"}
    assert {"--load", "--length-unit"} <= completed("asperity", "run", "--l")
    assert completed("asperity", "predict", "--modulus", "sh") == {"shear"}


def test_a_shell_that_is_not_recognized_is_asked_for(
    refused: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    from cyclopts.completion import detect

    def detection() -> str:
        raise detect.ShellDetectionError

    monkeypatch.setattr(detect, "detect_shell", detection)
    refused("--install-completion")
