"""Random configurations, campaigns and command lines: done, or refused in clear lines with status 1 or 2."""

import importlib.util
import shutil
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from asperity.app.campaign import Plan, read_plan
from asperity.app.cli.app import app
from asperity.app.config import RunConfig, read_config
from asperity.app.config.reading import to_toml
from asperity.ask.section import KINDS
from tests.fuzz.fuzzing import Draw, damage_bytes, fuzz, tried
from tests.fuzz.test_fuzz_files import run_command

KEYS: dict[str, list[str]] = {
    section: list(dict.fromkeys(key for one in kinds.values() for key in one.keys))
    for section, kinds in KINDS.items()
}
SWEEP = [*dict.fromkeys(key for keys in KEYS.values() for key in keys), "seeds", "combine", "solid.k1", "x"]

FINE: dict[str, Sequence[str]] = {
    "kind": ['"gaussian"', '"exponential"', '"self_affine"', '"spectral"', '"file"'],
    "shape": ["[8, 8]", "[4, 12]", "[30]", "16", "[1, 1]", "[3, 5]"],
    "size": ["8", "16", "2"],
    "path": ['"rough.npy"', '"none.npy"', '"."', '"table.csv"'],
    "crop": ["[0, 6, 0, 6]", "[0, 4]"],
    "periodic": ['"mirror"', '"reflect"', '"taper"', '"wrap"'],
    "lines": ['"none"', '"median"'],
    "tilt": ['"plane"', '"quadratic"', '"none"'],
    "seed": ["0", "7", "9223372036854775807"],
    "load": ["1.0", "40", "1e5", "1e-9"],
    "hold": ['"load"', '"separation"'],
    "times": ["[1.0, 10.0]", "[0.0]", "[0, 1e3]", "[1e-6, 1.0, 1e12]"],
    "last": ["10.0", "1e4"],
    "per_decade": ["1", "3"],
    "rtol": ["0.1", "0.01"],
    "maps_at": ["[]", "[0.0]", "[1.0, 10.0]"],
    "figures": ["[]"],
    "seeds": ["2", "[1, 5]"],
    "combine": ['"grid"', '"zip"'],
    **dict.fromkeys(("spacing", "pixel_size"), ("1.0", "[0.5, 0.5]", "[0.5, 2.0]")),
    **dict.fromkeys(("unit", "file_unit", "length_unit", "crop_unit"), ('"um"', '"µm"', '"pixel"', '"rms"')),
    **dict.fromkeys(("resample", "despike"), ("true", "false")),
}
NUMBERS = ["1.0", "0.3", "3.0", "12"]
# fmt: off
NASTY = [
    "0", "-0.0", "-1", "1e-320", "1e308", "1e400", "-1e100", "1e100", "1e-100", "1e30", "nan", "-inf", "inf",
    "1.5", "9223372036854775808", "-9223372036854775809", "9" * 400, "1" + "0" * 5000, "0x10", "1_000",
    "10000000000", "true", '""', '"x"', '"1.0"', '"0,5"', '"nan"', '"\\u001b[2J"', '"\\u0000"', '"µ"',
    '"\\uFEFF"', "'\\'", '"' + "a" * 5000 + '"', '"""a\nb"""', "1979-05-27", "07:32:00",
    "1979-05-27T07:32:00Z",
    "[]", "[[]]", '[""]', "[1, 2, 3]", "[1.0, 1.0]", "[2, 1]", "[nan]", "[1e300]", "[-1]", '["png", "png"]',
    "[true]", "{}", "{a = 1}", "[{a = 1}]", "{a = {a = {a = 1}}}", "[10000000000, 10000000000]", "[0, 4]",
    "[" * 60 + "]" * 60,
]
NAMES = [
    "", "x", "Load", "lod", "k_0", '"\\u001b[2J"', '"a b"', '"' + "k" * 3000 + '"', "ünï", "a.b.c", "load.x",
    "sweep",
]
WORDS = [
    *(word.strip('"') for word in NASTY), "1 5", "0,1,2", "8x8", "true", "\x1b[2J", "--", "-", "--load", "-q",
    "=", "--quiet", "--help", "\n", "1\n2", "8", "rough.npy", "table.csv", "run.toml", "campaign.toml",
    "none", ".", "..", "/dev/null", "\udcff", "a\x00b", "~", "*",
]
COMMANDS = [
    "run", "run", "surface", "fit", "sweep", "status", "gather", "reproduce", "", "rnu", "--version",
    "--help",
]
FILES = {
    "surface": "rough.npy", "fit": "table.csv", "sweep": "campaign.toml", "gather": "x", "status": "x",
}
# fmt: on


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with a few files, on a small machine."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("asperity.base.machine.available", lambda: 3_000_000)
    np.save("rough.npy", np.random.default_rng(0).normal(size=(6, 8)))
    Path("table.csv").write_text("t,mu\n1,0.6\n10,0.61\n100,0.625\n1000,0.63\n")


def flags_of(command: str) -> list[str]:
    """Flags of a command, but that which opens a window, and one that there is not."""
    is_ours = command in app and not command.startswith("-")
    arguments = app[command].assemble_argument_collection() if is_ours else []
    flags = {name for one in arguments if one.parse for name in one.names if name.startswith("--")}
    return sorted(flags - {"--open"} | {"--x"})


def value(draw: Draw, key: str, bad: float) -> str:
    if draw.chance(bad):
        return str(draw.one(NASTY))
    if key not in FINE and draw.chance(0.3):
        return repr(draw.decades(-30, 30))
    return str(draw.one(FINE.get(key, NUMBERS)))


def toml(draw: Draw, *, sweep: bool) -> str:
    """A configuration with some mistakes, or none; sometimes a damaged file."""
    bad = draw.one([0.0, 0.0, 0.1, 0.5])
    tables: dict[str, dict[str, str]] = {"surface": {"shape": "[8, 8]"}, "aging": {"rtol": "0.1"}}
    for _ in range(draw.one([0, 1, 2, 5])):
        section = draw.one(list(KEYS))
        key = draw.one(KEYS[section])
        if key == "kind":
            tables["surface"].pop("shape", None)
            tables["surface"].setdefault("size", "8")
        tables.setdefault(section, {})[key] = value(draw, key, bad)
    tables["output"] = {"figures": "[]", "maps_at": "[]"} | tables.get("output", {})
    if draw.chance(bad):
        tables.setdefault(draw.one(NAMES), {})[draw.one(NAMES)] = draw.one(NASTY)
    if draw.chance(bad):
        tables[draw.one(list(tables))][draw.one(NAMES)] = draw.one(NASTY)
    if sweep:
        swept = tables.setdefault("sweep", {})
        for _ in range(draw.between(0, 3)):
            key = draw.one(SWEEP)
            items = [value(draw, key, bad) for _ in range(draw.between(1, 3))]
            swept[key] = items[0] if key in ("seeds", "combine") else f"[{', '.join(items)}]"
            if draw.chance(bad):
                swept[key] = draw.one(NASTY)
    lines = []
    for section, keys in tables.items():
        odd = draw.one(["", f"[[{section}]]", f"{section} = 1"])
        lines += [
            f"[{section}]" if draw.chance(0.99) else odd,
            *(f"{key} = {it}" for key, it in keys.items()),
        ]
    return "\n".join(lines)


def written(draw: Draw, name: str, *, sweep: bool) -> Path:
    path = Path(name)
    content = toml(draw, sweep=sweep).encode()
    path.write_bytes(damage_bytes(draw, content) if draw.chance(0.08) else content)
    draw.say(path.read_text(errors="replace"))
    return path


def is_brief(config: RunConfig) -> bool:
    """Whether a run takes little time: its lattice and its list of times are short."""
    surface = vars(config.surface)
    sites = np.prod([float(n) for n in surface.get("shape", [surface.get("size", 8)] * 2)])
    decades = np.log10(config.span[1] / config.span[0]) if config.aging.times is None else 1.0
    return bool(sites <= 1e4 and decades * config.aging.per_decade <= 300)


@pytest.mark.parametrize("draws", [15, pytest.param(40, marks=pytest.mark.slow)])
def test_configurations(draws: int, capsys: pytest.CaptureFixture[str]) -> None:
    def attempt(draw: Draw) -> None:
        path = written(draw, "run.toml", sweep=draw.chance(0.02))
        config = tried(lambda: read_config(path, {}))
        if isinstance(config, RunConfig):
            Path("again.toml").write_text(to_toml(config), encoding="utf-8")
            assert read_config("again.toml", {}) == config
            if is_brief(config):
                run_command(draw, capsys, ["run", str(path), "--overwrite"])
        else:
            assert run_command(draw, capsys, ["run", str(path)]) == 2

    fuzz("configurations", draws, attempt)


def test_campaign_files(capsys: pytest.CaptureFixture[str]) -> None:
    def attempt(draw: Draw) -> None:
        path = written(draw, "campaign.toml", sweep=True)
        plan = tried(lambda: read_plan(path))
        if isinstance(plan, Plan):
            assert len(plan.runs) >= 1
        elif draw.chance(0.2):
            assert run_command(draw, capsys, ["sweep", str(path), "--out", "new", "--dry-run"]) == 2

    fuzz("campaign files", 60, attempt)


@pytest.mark.parametrize("draws", [15, pytest.param(40, marks=pytest.mark.slow)])
def test_command_lines(
    draws: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # What takes hours is not done.
    monkeypatch.setattr("asperity.app.cli.campaign.sweep", lambda *_, **__: None)
    if importlib.util.find_spec("asperity_research"):
        monkeypatch.setattr("asperity_research.commands.study.answer", lambda *_, **__: None)

    def attempt(draw: Draw) -> None:
        command = draw.one(COMMANDS)
        words = [command, FILES[command]] if command in FILES and draw.chance(0.8) else [command]
        if command == "run":
            words += ["--shape", "8,8", "--times", "1", "--figures", "", "--maps-at", "", "--overwrite"]
        bad = draw.one([0.1, 0.4])
        for _ in range(draw.between(0, 3)):
            flag = draw.one(flags_of(command))
            if flag in words and draw.chance(0.8):
                continue
            fine = [word.strip('[]"') for word in FINE.get(flag.strip("-").replace("-", "_"), NUMBERS)]
            word = str(draw.one(WORDS if draw.chance(bad) else fine))
            words += draw.one([[flag, word], [f"{flag}={word}"], [flag, word], [word]])
        Path("campaign.toml").write_text("[sweep]\nk1 = [1.0, 2.0]\n")
        try:
            run_command(draw, capsys, words)
        finally:
            for path in {*Path().iterdir()} - {Path("rough.npy"), Path("table.csv")}:
                shutil.rmtree(path) if path.is_dir() else path.unlink()

    fuzz("command lines", draws, attempt)
