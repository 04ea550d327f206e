"""Mistakes: a line for each, beginning with the program's name; an exit status; never a traceback."""

from __future__ import annotations

import itertools
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from asperity import __version__
from asperity.surfaces import gaussian, spectral
from tests.cli.conftest import Asperity, Refused

OF_ARGUMENTS = """
    rnu
    plot
    --vesion
    run --lod 3
    run --r-viscous 3
    run --E 3
    run --half-space
    run --colour 3
    predict --leg 'slide distance=8 velocity=5'
    predict run.toml --creep none --solid-kind
    sweep a --out b --workers 1,5
    fit a.csv --window 0,5 3
    fit a.csv --law log
    run --load
    run --load --out a
    run a.toml b.toml
    run --load 1 --load 2
    surface
"""

OF_RUNS = """
    none.toml
    --load nan
    --load abc
    --load 0,5
    --times 0,5
    --seed 1.5
    --per-decade 2.7
    --surface gausian
    --surface file
    --unit µn --file a.npy
    --k1 -1
    --size 64
    --shape 8,8 --separation 99
    --file none.npy
    --rate-coefficient 0.1
    --branch 0.3 10
    --shape 32x32 --blur 99
    --pixel 2 --maps-at ''
    --pixel 2um
    --threshold 2
    --threshold 0.5
    --file scan.txt --solid half_space --modulus '3.8 GPa'
    --file scan.txt --load '1 mN'
    --file scan.txt --solid half_space --modulus 3.8GPa --file-unit um
    --file scan.txt {scan} --load 1mN --pressure 1MPa
    --file scan.txt {scan} --separation '1 um'
    --file scan.txt {scan} --branch '0.6 1' --branch '0.6 2'
    --file scan.txt {scan} --k0 1
    --file scan.txt {scan} --first '1 m'
    --solid half_space
    --solid half_space --modulus=-1
    --solid layer --modulus 1 --poisson 0.3
    --leg hold
    --leg 'hold -3'
    --leg 'hold 0,5'
    --leg 'stp load=3'
    --leg 'hold 1' --leg step
    --leg 'hold 1' --leg 'step load=0'
    --leg 'ramp 3 lod=3'
    --leg 'repeat 3'
    --leg ''
    --leg 'slide 8'
    --leg 'hold 3 hold=height'
    --leg 'slide distance=2 velocity=inf' --shear-strength 4 --rate-coefficient 0.1 --reference-velocity 1
    --surface sphere --radius 1mm
    --surface sphere --radius 1mm --pixel-size 1um
    --surface sphere --radius 1 --pixel-size 1
    --surface sphere --radius 1mm 2mm --pixel-size 1um {ball}
    --surface sphere --radius 1nm --pixel-size 1um {ball}
    --surface sphere --radius 1mm --pixel-size 1um --shape 64 {ball}
    --surface array --place '20um 3mm' --radii 1mm --pixel-size 1um {ball}
    --surface array --place 20um --radii 1mm --pixel-size 1um {ball}
    --surface punch --radius 1mm --pixel-size '1 s' {ball}
"""
BALL = "--solid half_space --modulus 3GPa"
SCAN = "--solid half_space --modulus '3.8 GPa' --file-unit um --pixel-size 0.4 0.8 --length-unit um"

FILES = {
    "a list": "protocol = 3",
    "a table": '[protocol]\nkind = "hold"',
    "no duration": '[[protocol]]\nkind = "hold"',
    "no kind": "[[protocol]]\nduration = 3.0",
    "a word": '[[protocol]]\nkind = "hold"\nduration = 3.0\nduraton = 3.0',
    "last": '[aging]\nlast = 4.0\n[[protocol]]\nkind = "hold"\nduration = 3.0',
    "hold": '[aging]\nhold = "load"\n[[protocol]]\nkind = "hold"\nduration = 3.0',
    "times": '[aging]\ntimes = [5.0]\n[[protocol]]\nkind = "hold"\nduration = 3.0',
    "maps": '[output]\nmaps_at = [5.0]\n[[protocol]]\nkind = "hold"\nduration = 3.0',
    "a terminal": '["\\u001b[31mred"]',
}


def calls(table: str) -> list[list[str]]:
    return [shlex.split(line.format(scan=SCAN, ball=BALL)) for line in table.splitlines() if line.strip()]


def test_words_that_are_none(refused: Refused) -> None:
    for words in calls(OF_ARGUMENTS):
        refused(*words)


def test_runs_that_cannot_be(refused: Refused) -> None:
    heights = spectral((64, 64), rms_height=0.2, spacing=(0.4, 0.8), cutoff=6.0, seed=1)
    np.savetxt("scan.txt", heights, fmt="%.6e")
    for words in calls(OF_RUNS):
        refused("run", *words)


def test_files_that_cannot_be(refused: Refused) -> None:
    for text in FILES.values():
        Path("run.toml").write_text(text)
        refused("run", "run.toml")


def test_several_mistakes_have_a_line_each(asperity: Asperity) -> None:
    Path("run.toml").write_text("[surface]\nshap = 3\n[solid]\nk0 = -1\n[contcat]\n")
    status, out, error = asperity("run", "run.toml", "--rms", "-1")
    lines = error.splitlines()
    assert (status, out, len(lines)) == (2, "", 4)
    assert all(line.startswith("asperity: ") for line in lines)
    assert any(line.startswith("asperity: --rms: ") for line in lines)


@pytest.mark.parametrize("command", [("surface",), ("run", "--file")])
def test_surface_files_that_cannot_be_read(refused: Refused, command: tuple[str, ...]) -> None:
    np.save("good.npy", np.ones((8, 8)))
    content = Path("good.npy").read_bytes()
    Path("empty.npy").write_bytes(b"")
    Path("cut.npy").write_bytes(content[:-9])
    Path("header.npy").write_bytes(content[:20])
    Path("words.txt").write_text("1 2\nthree 4\n")
    for name in ("none.npy", "empty.npy", "cut.npy", "header.npy", "words.txt", "."):
        refused(*command, name)


def test_more_than_memory_holds(refused: Refused, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("asperity.base.machine.available", lambda: 20_000_000_000)
    for words in (
        ("--shape", "10000000,100000000"),
        ("--surface", "self_affine", "--size", "1048576"),
        ("--shape", "2000000000"),
    ):
        refused("run", *words, status=1)


def test_a_load_below_the_resolution_of_the_numbers_is_a_failure(refused: Refused) -> None:
    refused("run", "--shape", "8,8", "--load", "1e-30", status=1)


def test_what_a_terminal_would_obey_is_written_as_it_is_spelled(asperity: Asperity) -> None:
    np.save("\x1b[2Jrough.npy", gaussian((8, 8)))
    words = ("--maps-at", "", "--figures", "", "--times", "1")
    status, out, error = asperity("run", "--file", "\x1b[2Jrough.npy", *words)
    assert status == 0
    assert "\\x1b[2Jrough.npy" in out
    assert "\x1b" not in out + error


def test_folders_that_are_no_campaign_say_what_they_are(refused: Refused, finished: Path) -> None:
    Path("my paper/studies/load").mkdir(parents=True)
    Path("study/one").mkdir(parents=True)
    Path("study/one/seed").touch()
    Path("run").symlink_to(finished)
    for command in ("status", "gather"):
        for folder in ("my paper", "study", "run"):
            refused(command, folder)


def test_folders_that_are_kept(refused: Refused, finished: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("thesis").mkdir()
    Path("thesis/text").write_text("years of work")
    Path("run").mkdir()
    for name in (*(path.name for path in finished.iterdir()), "notes.txt"):
        Path("run", name).touch()
    for words in (
        ("thesis/text", "--overwrite"),
        (".", "--overwrite"),
        ("..", "--overwrite"),
        ("thesis", "--overwrite"),
        ("run",),
        ("run", "--overwrite"),
    ):
        refused("run", "--out", *words)
    # Found before anything is computed.
    monkeypatch.setattr("asperity.app.runs.pipeline.press", lambda *_, **__: pytest.fail("pressed"))
    refused("run", "--out", "thesis/text/out", status=1)


def test_help_and_version(asperity: Asperity) -> None:
    status, alone, _ = asperity()
    assert status == 0
    assert asperity("--help") == (0, alone, "")
    assert asperity("--version") == asperity("-V") == (0, f"{__version__}\n", "")
    text = " ".join(asperity("run", "--help")[1].replace("│", " ").split())
    for shown in (
        "200 200]",
        "--rms FLOAT Rms height. For gaussian, exponential. [default: 1]",
        "ten times the longest relaxation time, else 1e+06.",
        "--pressure FLOAT",
    ):
        assert shown in text
    assert "--pressure QUANTITY" in asperity("predict", "--help")[1]


@pytest.mark.parametrize("command", ["run", "surface", "fit", "sweep", "status", "gather"])
def test_help_fills_its_lines(asperity: Asperity, command: str) -> None:
    _, text, _ = asperity(command, "--help")
    lines = [line.strip("│ ") for line in text.splitlines()]
    for line, after in itertools.pairwise(lines):
        if line and after and line[-1].isalpha() and after[0].islower() and "--" not in after[:3]:
            assert len(line) + 1 + len(after.split()[0]) > 45, f"{line!r} ends early"


def python(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *words]
    return subprocess.run(command, check=False, capture_output=True, text=True, timeout=120)


def test_help_does_not_wait_for_the_engine() -> None:
    code = (
        "import sys\nfrom asperity.app.cli import main\nmain(['run', '--help'])\n"
        "sys.exit(any(m in sys.modules for m in ('scipy', 'xarray', 'matplotlib')))"
    )
    assert python("-c", code).returncode == 0
    bare = code.replace("'run', ", "").replace("'scipy'", "'numpy', 'pydantic'")
    assert python("-c", bare).returncode == 0


def test_as_a_module() -> None:
    done = python("-m", "asperity", "rnu")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("asperity: unknown command rnu")


@pytest.mark.parametrize("command", ["run", "fit", "friction", "sweep"])
def test_bad_input_is_refused_before_loops_are_compiled(
    command: str, refused: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    def compiled(*_: object, **__: object) -> None:
        pytest.fail("compiled")

    for place in ("asperity.app.campaign.sweeping.compile_loops", "asperity.app.runs.pipeline.press"):
        monkeypatch.setattr(place, compiled)
    Path("bad.txt").write_text("no numbers")
    Path("bad.toml").write_text('[surface]\npath = "bad.txt"\n[sweep]\ncontact.load = [1.0, 2.0]\n')
    words = {"run": ("--file", "bad.txt"), "sweep": ("bad.toml", "--out", "out", "--dry-run")}
    refused(command, *words.get(command, ("bad.txt",)))


def test_a_scheduler_that_is_none_is_a_failure(asperity: Asperity, monkeypatch: pytest.MonkeyPatch) -> None:
    # Nobody there is no mistake in what was typed.
    pytest.importorskip("distributed", reason="needs asperity[campaign]")
    monkeypatch.setattr("asperity.app.campaign.cluster._ANSWER", 0.5)
    Path("plan.toml").write_text("[surface]\nshape = [8, 8]\n[aging]\nlast = 0.1\n[sweep]\nseeds = 2\n")
    words = ("--out", "out", "--scheduler", "tcp://127.0.0.1:9", "--quiet")
    status, _, error = asperity("sweep", "plan.toml", *words)
    assert status == 1
    assert error.splitlines()[-1].startswith("asperity: scheduler: expected ")


def test_all_that_is_known_to_be_said_belongs_to_a_test() -> None:
    for line in (Path(__file__).parent / "said.txt").read_text(encoding="utf-8").splitlines():
        if not line.startswith(" "):
            file, name = line.split("::")
            assert f"def {name}(" in (Path(__file__).parents[1] / file).read_text(encoding="utf-8")
