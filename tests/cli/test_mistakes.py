"""Mistakes: a line for each, beginning with the program's name; an exit status; never a traceback."""

import itertools
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from inspect import signature
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

import asperity.app.cli.app as command_line
from asperity import __version__, friction
from asperity.app.cli.command import app
from asperity.app.cli.terminal import complain
from asperity.app.config.mistakes import assigned, flag_in
from asperity.base.files import MARKER, kind_of, mark
from asperity.surfaces import gaussian, spectral
from tests.refusals import matches, refusal

HOLD = ("[[protocol]]", 'kind = "hold"', "duration = 3.0")
BODY = ("[solid]", 'kind = "half_space"', "modulus = 3e7")
SPEEDS = ("[sliding]", "speeds = 1.0")
TABLE = Path(__file__).with_name("mistakes.json")
MISTAKES = json.loads(TABLE.read_text("utf-8"))


@pytest.fixture(scope="module")
def desk(tmp_path_factory, finished):
    """A folder of files that can be used, and of others that have a mistake."""
    folder = tmp_path_factory.mktemp("desk")
    heights = spectral((64, 64), rms_height=0.2, spacing=(0.4, 0.8), cutoff=6.0, seed=1)
    np.savetxt(folder / "scan.txt", heights, fmt="%.6e")
    np.save(folder / "good.npy", np.ones((8, 8)))
    content = (folder / "good.npy").read_bytes()
    time, held = np.geomspace(0.01, 100.0, 17), np.geomspace(1, 1e4, 25)
    modulus = 1000 + 600 * np.exp(-time / 0.3) + 900 * np.exp(-time / 20)
    moduli = [f"{t:.6g},{E:.8g}" for t, E in zip(time, modulus, strict=True)]
    relaxing = ["time_s,E_MPa", *moduli]
    record = friction.synthetic_record(
        friction.slide_hold_slide([10.0, 100.0, 1000.0], velocity=1e-6, distance=50e-6),
        friction.RateAndState(a=0.010, b=0.015, D_c=10e-6, mu_0=0.6, V_0=1e-6),
    )
    columns = np.stack([record.time, 1e6 * record.displacement, record.friction], axis=-1)
    holds = [",".join(map(str, line)) for line in columns.tolist()]
    areas = [f"{t},{1 - 0.3 * np.exp(-t / 50)},0.01,0.01" for t in held]
    pulled = [
        f"{t},{np.interp(t, [0, 10, 20, 55], [0, 100, 100, 450])},{0.6 + 1e-3 * np.sin(t)}" for t in range(56)
    ]
    indented = [f"{t},{0.1 * t - 1},{max(0, 0.1 * t - 1) ** 1.5}" for t in range(30)]
    falls = [f"{t} {2 - n / 25}" for n, t in enumerate(held)]
    for name, lines in {
        **{"empty.npy": [], "words.txt": ["1 2", "three 4"], "noheights.txt": ["no heights"]},
        **{"list.toml": ["protocol = 3"], "table.toml": ["[protocol]", 'kind = "hold"']},
        **{"endless.toml": [*HOLD[:2]], "kindless.toml": [HOLD[0], HOLD[2]]},
        **{"duraton.toml": [*HOLD, "duraton = 3.0"], "last.toml": ["[aging]", "last = 4.0", *HOLD]},
        **{
            "hold.toml": ["[aging]", 'hold = "load"', *HOLD],
            "times.toml": ["[aging]", "times = [5.0]", *HOLD],
        },
        **{"maps.toml": ["[output]", "maps_at = [5.0]", *HOLD], "red.toml": ['["\\u001b[31mred"]']},
        **{"legs.toml": [*BODY, *HOLD], "measured.toml": [*BODY, "[output]", 'measured = "area.csv"']},
        **{"speeds.toml": [*BODY, *SPEEDS], "held.toml": [*BODY, "[contact]", "separation = 1e-6", *SPEEDS]},
        **{"bad.toml": ["[surface]", 'path = "noheights.txt"', "[sweep]", "contact.load = [1.0, 2.0]"]},
        **{"sweep.toml": ["[surface]", "shape = [8, 8]", "[sweep]", "seeds = 2"]},
        **{"run.toml": [], "mine.png": ["mine"], "mine.npy": ["no array: what it is is told later"]},
        "relaxation.csv": relaxing,
        "unitless.csv": ["t,E", *moduli],
        "unsorted.csv": [relaxing[0], relaxing[2], relaxing[1], *relaxing[3:]],
        "rising.csv": [*relaxing[:10], "1.2,9000", *relaxing[10:]],
        "noisy.csv": [*relaxing[:10], "1.2,2500", *relaxing[10:]],
        "short.csv": relaxing[:4],
        "headless.csv": moduli,
        "unnamed.csv": ["a,b", *moduli],  # a modulus in MPa would be taken for one in Pa
        "shear.csv": ["t [s],shear modulus [MPa]", *moduli],
        "half.csv": ["time_s,velocity_um/s,shear_stress_MPa,normal_stress", "0,1,30,50", "1,1,30,50"],
        "mu.csv": ["hold time;mu;error", *(f"{t:g};{0.6 + 0.01 * np.log(t):g};0.002" for t in held)],
        "flat.txt": [f"{t} .6" for t in range(1, 7)],
        "few.txt": ["1 .6", "2 .7"],
        "down.csv": ["hold,friction", "1,.9", "2,.8", "3,.7"],
        "holds.csv": ["time_s,displacement_um,friction", *holds],
        "machine.csv": ["time_s,load_point_um,friction", *pulled],
        "bare.csv": ["time,displacement,friction", *holds],
        "bad.csv": ["time_s,displacement_um,friction", "0,0,0.6", "1,2,0.6", "2,1,0.6"],
        "area.csv": ["time [min],area,stderr,load", *areas],
        "falls.csv": falls,
        "indenter.csv": ["time_s,depth_um,force_nN", *indented],
        "two_errors.csv": ["time_s,area,area_err,load_err", *areas],
        "percent.csv": ["time_s,area,err_percent,load", *areas],
        "furlongs.csv": ["time (furlong),area,a,b", *areas],
        "logarithms.csv": ["log10 time,area,a,b", *areas],
    }.items():
        (folder / name).write_text("\n".join(lines))
    (folder / "cut.npy").write_bytes(content[:-9])
    (folder / "header.npy").write_bytes(content[:20])
    for name in ("empty", "folder", "two results", "my paper/studies/load", "study/one"):
        (folder / name).mkdir(parents=True)
    for name in ("study/one/seed", "folder/thesis.tex"):
        (folder / name).touch()
    (folder / "a run").symlink_to(finished)
    for name in ("one", "two"):
        shutil.copytree(finished, folder / "two results" / name)
    return folder


def cured(words, error):
    """Where the first mistake of an error is, and a command with its cure; no command without a cure."""
    first = next(iter(getattr(error, "mistakes", ())), error)
    where = getattr(first, "path", ()) or (getattr(first, "name", ""),)
    for key, value in getattr(first, "cure", {}).items():
        flag = flag_in(str(where[0]), key)
        if flag in words and flag != "--units":  # what the cure replaces
            after = words.index(flag) + 1
            end = next((n for n in range(after, len(words)) if words[n].startswith("--")), len(words))
            words = words[: after - 1] + words[end:]
        words = [*words, *shlex.split(assigned(flag, value))]
    return where, words


@pytest.mark.parametrize("command", MISTAKES)
def test_mistakes_are_one_clear_line_whose_advice_is_not_refused_for_the_same(
    command, mistaken, asperity, desk, monkeypatch
):
    # Exit code 2 and one line, which `mistaken` expects; class, path and value of each mistake, where "..."
    # stands for any words. To add one, write "ending": []; ASPERITY_MESSAGES=write writes what is refused.
    monkeypatch.chdir(desk)
    for late in ("simulate.follow", "app.campaign.sweeping.compile_loops", "inference.inferring.conclude"):
        monkeypatch.setattr(f"asperity.{late}", Mock(side_effect=KeyboardInterrupt))  # too late to be told
    errors: list[Any] = []
    say = complain

    def heard(*of):
        errors.append(sys.exception())
        return say(*of)

    monkeypatch.setattr(command_line, "complain", heard)
    called: Any = app[command.split()[0]].default_command if command else None
    own = [*signature(called).parameters] if command else []
    lines = [shlex.split(f"{command} {ending}") for ending in MISTAKES[command]]
    for words in lines:
        mistaken(*words)
    of_lines, known = errors[:], [*MISTAKES[command].values()]
    for words, error in zip(lines, of_lines, strict=True):
        for _ in range(2 if command else 0):  # two columns may lack a unit
            (where, better), count = cured(words, error), len(errors)
            if better == words:
                break
            asperity(*better)
            if len(errors) == count:
                break
            same = cured(better, errors[-1])[0] == where and str(errors[-1]) == str(error)
            assert not same, shlex.join(better)
            words, error = better, errors[-1]
    found = [refusal(error, own) for error in of_lines]
    alike = [
        len(old) == len(new) and all(map(matches, old, new)) for old, new in zip(known, found, strict=True)
    ]
    if os.environ.get("ASPERITY_MESSAGES") == "write":
        renewed = (old if same else new for same, old, new in zip(alike, known, found, strict=True))
        MISTAKES[command] = dict(zip(MISTAKES[command], renewed, strict=True))
        TABLE.write_text(re.sub(r"\n   +|\n  (?=\])", " ", json.dumps(MISTAKES, indent=1)) + "\n", "utf-8")
    else:
        assert all(alike), [pair for same, *pair in zip(alike, known, found, strict=True) if not same]


def test_several_mistakes_have_a_line_each(asperity):
    Path("run.toml").write_text("[surface]\nshap = 3\n[solid]\nk0 = -1\n[contcat]\n")
    status, out, error = asperity("run", "run.toml", "--rms", "-1")
    lines = error.splitlines()
    assert (status, out, len(lines)) == (2, "", 4)
    assert all(line.startswith("asperity: ") for line in lines)
    assert any(line.startswith("asperity: --rms: ") for line in lines)


def test_more_than_memory_holds(refused, monkeypatch):
    monkeypatch.setattr("asperity.base.machine.available", lambda: 20_000_000_000)
    for words in ("--shape 10000000,100000000", "--surface self_affine --size 1048576", "--shape 2000000000"):
        refused("run", *words.split(), status=1)


def test_what_a_terminal_would_obey_is_written_as_it_is_spelled(asperity):
    np.save("\x1b[2Jrough.npy", gaussian((8, 8)))
    words = ("--maps-at", "", "--figures", "", "--times", "1")
    status, out, error = asperity("run", "--file", "\x1b[2Jrough.npy", *words)
    assert status == 0
    assert "\\x1b[2Jrough.npy" in out
    assert "\x1b" not in out + error


def test_folders_that_are_kept(refused, finished, monkeypatch):
    Path("thesis").mkdir()
    Path("thesis/text").write_text("years of work")
    shutil.copytree(finished, "run")
    Path("run/notes.txt").touch()
    Path("sweep").mkdir()
    mark(Path("sweep", MARKER), "campaign", ["plan.json"])
    assert [kind_of(Path(name)) for name in ("thesis", "run", "sweep")] == ["", "run", "campaign"]
    for folder in ("thesis/text", ".", "..", "thesis", "run", "sweep"):
        refused("run", "--out", folder, "--overwrite")
    refused("run", "--out", "run")
    # Found before anything is computed.
    monkeypatch.setattr("asperity.app.runs.pipeline.pressed", lambda *_, **__: pytest.fail("pressed"))
    refused("run", "--out", "thesis/text/out", status=1)


def test_version_and_help_that_fills_its_lines(asperity, says):
    alone = says()
    assert asperity("--help") == (0, alone, "")
    assert asperity("--version") == asperity("-V") == (0, f"{__version__}\n", "")
    text = " ".join(asperity("run", "--help")[1].replace("│", " ").split())
    for shown in (
        *("200 200]", "--rms FLOAT Rms height. For gaussian, exponential. [default: 1]", "--pressure FLOAT"),
        "10 times the longest relaxation time, else 1e+06.",
    ):
        assert shown in text
    assert "--pressure QUANTITY" in asperity("predict", "--help")[1]
    for command in ("run", "surface", "fit", "sweep", "status", "gather"):
        lines = [line.strip("│ ") for line in asperity(command, "--help")[1].splitlines()]
        for line, after in itertools.pairwise(lines):
            if line and after and line[-1].isalpha() and after[0].islower() and "--" not in after[:3]:
                assert len(line) + 1 + len(after.split()[0]) > 45, f"{line!r} ends early"


def test_the_command_is_a_module():
    words = [sys.executable, "-m", "asperity", "rnu"]
    done = subprocess.run(words, check=False, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith('asperity: Unknown command "rnu"')


def test_a_scheduler_that_is_none_is_a_failure(asperity, monkeypatch):
    # Nobody there is no mistake in what was typed.
    pytest.importorskip("distributed", reason="needs asperity[campaign]")
    monkeypatch.setattr("asperity.app.campaign.cluster._ANSWER", 0.5)
    Path("plan.toml").write_text("[surface]\nshape = [8, 8]\n[aging]\nlast = 0.1\n[sweep]\nseeds = 2\n")
    words = ("--out", "out", "--scheduler", "tcp://127.0.0.1:9", "--quiet")
    status, _, error = asperity("sweep", "plan.toml", *words)
    assert status == 1
    assert error.splitlines()[-1].startswith("asperity: scheduler: expected ")
    status, _, error = asperity("sweep", "plan.toml", *words[:3], "nonsense")
    assert (status, "address of a Dask scheduler" in error) == (2, True)


def test_all_that_is_known_to_be_said_belongs_to_a_test():
    for line in (Path(__file__).parent / "said.txt").read_text(encoding="utf-8").splitlines():
        if not line.startswith(" "):
            file, name = line.split("::")
            assert f"def {name}(" in (Path(__file__).parents[1] / file).read_text(encoding="utf-8")
