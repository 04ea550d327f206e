"""Build both packages, and try them as their users will: installed in empty environments.

    python .ci/packages.py [STEP ...]

Steps: contents, 3.11, 3.12, 3.13, 3.14, oldest, tool; without arguments all, and before them the build.
Each environment holds the wheel of the library, its dependencies and nothing else; its packages cannot be
written to, and there is no home. In it run the lines of the README and the command line; then, with the
wheel of asperity-research beside it, the commands of that. ``oldest`` takes the oldest release of each
dependency that the stated bounds allow, of the library alone. A step that cannot be done here, as for want of
an interpreter, says why. uv installs, and keeps what it fetched.
"""

from __future__ import annotations

import os
import re
import shutil
import stat
import subprocess
import sys
import tarfile
import tempfile
import time
import tomllib
import zipfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DIST = ROOT / "dist"
PACKAGES = {"asperity": ".", "asperity_research": "research"}
"""What is built, and the folder of each."""

PYTHONS = ("3.11", "3.12", "3.13", "3.14")
UV = [sys.executable, "-m", "uv", "--quiet"]
UNPRIVILEGED = ["setpriv", "--bounding-set=-all", "--inh-caps=-all"]
"""A prefix with which even root cannot write where nobody may."""

IMPORTS = (
    "import sys, time; begin = time.perf_counter(); import asperity; asperity.press; asperity.age; "
    "print(f'{time.perf_counter() - begin:.1f}')"
)


RESEARCH = "comes with asperity-research; try pip install asperity-research"
CHALLENGE = "import asperity\ntry: asperity.challenge\nexcept AttributeError as error: print(error)"
LOAD = "import asperity; asperity.results.load('run/history.zarr')['area'].values"


class SkippedError(Exception):
    """A step cannot be done here."""


def build() -> str:
    """Make the source distributions, the wheels from them, and check what the index will show."""
    shutil.rmtree(DIST, ignore_errors=True)
    for folder in PACKAGES.values():
        run([*UV, "build", "--out-dir", DIST, ROOT / folder])
    run([sys.executable, "-m", "twine", "check", "--strict", *archives()])
    return ", ".join(f"{path.name} {path.stat().st_size / 1e6:.1f} MB" for path in archives())


def contents() -> str:
    """Compare the archives of both packages with the files of the repository."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if listed.returncode != 0:
        raise SkippedError("this is no git repository")
    every = {name for name in listed.stdout.split("\0") if name and (ROOT / name).exists()}
    return "; ".join(packed(name, folder, every) for name, folder in PACKAGES.items())


def packed(package: str, folder: str, every: set[str]) -> str:
    """Compare the archives of one package with the files in its folder."""
    files = {str(Path(name).relative_to(folder)) for name in every if Path(name).is_relative_to(folder)}
    with zipfile.ZipFile(wheel(package)) as archive:
        inside = {name for name in archive.namelist() if ".dist-info/" not in name}
        metadata = next(name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        page = archive.read(metadata).decode()
    same(
        f"the wheel of {package}",
        inside,
        {name.removeprefix("src/") for name in files if name.startswith(f"src/{package}/")},
    )
    (source,) = DIST.glob(f"{package}-*.tar.gz")
    with tarfile.open(source) as archive:
        unpacked = {member.name.partition("/")[2] for member in archive.getmembers() if member.isfile()}
    tables = tomllib.loads((ROOT / folder / "pyproject.toml").read_text(encoding="utf-8"))
    tops = tables["tool"]["hatch"]["build"]["targets"]["sdist"]["include"]
    wanted = {name for name in files if any(name == top or name.startswith(f"{top}/") for top in tops)}
    same(
        f"the source distribution of {package}",
        unpacked,
        wanted | {"PKG-INFO", "pyproject.toml", ".gitignore"},
    )
    pictures = set(re.findall(r"!\[[^]]*\]\(([^)]+)\)", page))
    if missing := pictures - unpacked:
        raise RuntimeError(f"the source distribution lacks pictures of the README: {sorted(missing)}")
    return f"{package}: {len(inside)} files in the wheel, {len(unpacked)} in the source distribution"


def python(version: str, *, extras: tuple[str, ...] = (), oldest: bool = False) -> str:
    """Install the wheel into an empty environment that cannot be written to, and use it there."""
    interpreter = find(version)
    with tempfile.TemporaryDirectory(prefix="asperity-package-") as name:
        folder = Path(name)
        at, work = folder / "environment", folder / "work"
        work.mkdir()
        run([*UV, "venv", "--python", interpreter, at])
        chosen = next(p for p in (at / "bin/python", at / "Scripts/python.exe") if p.exists())
        pins = pinned(folder, version, extras) if oldest else []
        suffix = f"[{','.join(extras)}]" if extras else ""
        run([*UV, "pip", "install", "--compile-bytecode", "--python", chosen, *pins, f"{wheel()}{suffix}"])
        listed = run([*UV, "pip", "list", "--python", chosen, "--format", "freeze"])
        packages = next(path.parent for path in at.rglob("asperity/__init__.py")).parent
        size = sum(
            path.stat().st_size for path in packages.rglob("*") if path.is_file() and path.suffix != ".pyc"
        )
        lock(packages)
        try:
            seconds = use(chosen, work, campaign="campaign" in extras)
        finally:
            lock(packages, again=True)
        if not oldest:
            run([*UV, "pip", "install", "--python", chosen, wheel(), wheel("asperity_research")])
            use_research(chosen, work)
    return f"{len(listed.split())} packages, {size / 1e6:.0f} MB, {seconds} s to import press and age"


def use(python: Path, work: Path, *, campaign: bool) -> str:
    """Run the README's lines and the command line in an environment; return how long the imports took."""
    prefix = UNPRIVILEGED if hasattr(os, "geteuid") and os.geteuid() == 0 and shutil.which("setpriv") else []
    environment = bare(work)

    def here(*arguments: str | Path) -> str:
        return run([*prefix, python, *arguments], cwd=work, env=environment)

    with_write = "import asperity, pathlib; (pathlib.Path(asperity.__file__).parent / 'x').touch()"
    refused = subprocess.run(
        [*prefix, python, "-c", with_write], env=environment, capture_output=True, check=False
    )
    if refused.returncode == 0:
        raise SkippedError("folders cannot be made read-only for this user")
    lines, printed = readme_lines()
    (work / "readme.py").write_text(lines, encoding="utf-8")
    expect("the lines of the README", here("-W", "ignore", "readme.py").strip(), printed)
    expect("asperity --version", here("-m", "asperity", "--version").strip(), version())
    here("-m", "asperity", "run", "--shape", "64", "64", "--out", "run", "--quiet")
    expect("files of a run", sorted(path.name for path in (work / "run").iterdir()), sorted(RUN))
    here("-W", "ignore", "-c", LOAD)
    absent = subprocess.run(
        [*prefix, python, "-m", "asperity", "reproduce", "--out", "paper"],
        cwd=work, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    lines = absent.stderr.splitlines()
    expect("reproduce without research", (absent.returncode, len(lines), RESEARCH in lines[0]), (2, 1, True))
    expect("asp.challenge without research", RESEARCH in here("-c", CHALLENGE), True)
    if campaign:
        (work / "campaign.toml").write_text("[surface]\nshape = [16, 16]\n[sweep]\nseeds = 2\n")
        here("-m", "asperity", "sweep", "campaign.toml", "--out", "study", "--workers", "1", "--quiet")
        here("-m", "asperity", "gather", "study")
    return here("-W", "ignore", "-c", IMPORTS).strip()


def use_research(python: Path, work: Path) -> None:
    """Run what asperity-research adds, in an environment that has both packages."""
    for words, said in (
        (("challenge", "list"), "dilute"),
        (("study",), "unloading"),
        (("--version",), version()),
    ):
        expect(
            " ".join(words), said in run([python, "-m", "asperity", *words], cwd=work, env=bare(work)), True
        )


def bare(work: Path) -> dict[str, str]:
    """Variables of a process that knows neither a home nor what is installed elsewhere."""
    kept = {name: os.environ[name] for name in ("SYSTEMROOT", "TEMP", "TMP") if name in os.environ}
    own = {"HOME": "/nonexistent", "TMPDIR": str(work), "PYTHONDONTWRITEBYTECODE": "1"}
    return {"PATH": os.defpath, **own, **kept}


def tool() -> str:
    """Run the command from the wheel without installing it, as `uvx` and `pipx run` do."""
    found = run([*UV, "tool", "run", "--isolated", "--from", wheel(), "asperity", "--version"])
    expect("uvx asperity --version", found.strip(), version())
    return "uvx --from WHEEL asperity --version"


RUN = (
    *("aging.csv", "aging.png", "aging_data.csv", "asperity.json", "config.toml", "contacts.csv"),
    *("contacts.png", "history.zarr", "patches.csv", "patches.png", "patches_data.csv", "summary.txt"),
)

STEPS: dict[str, Callable[[], str]] = {
    "contents": contents,
    **{name: (lambda name=name: python(name)) for name in PYTHONS},  # type: ignore[misc]
    "oldest": lambda: python(PYTHONS[0], extras=("campaign", "explore"), oldest=True),
    "tool": tool,
}


def find(version: str) -> str:
    """An interpreter of this version: on the path, under pyenv, or one that uv can get."""
    homes = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    candidates = [shutil.which(f"python{version}"), *homes.glob(f"{version}.*/bin/python"), sys.executable]
    for candidate in map(str, filter(None, candidates)):
        code = "import sys; print('%d.%d' % sys.version_info[:2])"
        asked = subprocess.run([candidate, "-c", code], capture_output=True, text=True, check=False)
        if asked.stdout.strip() == version:
            return candidate
    got = subprocess.run([*UV, "python", "install", "--no-bin", version], capture_output=True, check=False)
    if got.returncode == 0:
        return version
    command = [*UV, "pip", "compile", "--no-header", "--no-annotate", "--python-version", version]
    resolved = run([*command, "--only-binary", ":all:", "-"], input=f"asperity @ {wheel().as_uri()}")
    count = len(resolved.splitlines()) - 1
    raise SkippedError(
        f"no Python {version} here, nor can uv fetch one; all {count} packages have wheels for it"
    )


def pinned(folder: Path, version: str, extras: tuple[str, ...]) -> list[str]:
    """Options of an installation that takes the oldest release of everything that `pyproject.toml` states."""
    pins = folder / "pins.txt"
    command = [*UV, "pip", "compile", "--resolution", "lowest-direct", "--python-version", version]
    wanted = [word for extra in extras for word in ("--extra", extra)]
    pins.write_text(run([*command, *wanted, ROOT / "pyproject.toml"]))
    return ["--constraint", str(pins)]


def readme_lines() -> tuple[str, str]:
    """The README's first block of Python, and what its last comment says that it prints."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    lines = text.partition("```python\n")[2].partition("```")[0]
    return lines, re.findall(r": ([\d.]+)$", lines, flags=re.MULTILINE)[-1]


def lock(folder: Path, *, again: bool = False) -> None:
    """Take the right to write from folders, or give it back. Files may be links into the cache of uv."""
    for path in (folder, *(path for path in folder.rglob("*") if path.is_dir())):
        mode = path.stat().st_mode
        path.chmod(mode | stat.S_IWUSR if again else mode & ~0o222)


def archives() -> list[Path]:
    return sorted([*DIST.glob("*.whl"), *DIST.glob("*.tar.gz")])


def wheel(package: str = "asperity") -> Path:
    (found,) = DIST.glob(f"{package}-*.whl")
    return found


def version() -> str:
    return wheel().name.split("-")[1]


def same(what: str, found: set[str], expected: set[str]) -> None:
    if found != expected:
        lacks, has = sorted(expected - found), sorted(found - expected)
        raise RuntimeError(f"{what} lacks {lacks} and has besides {has}")


def expect(what: str, found: object, expected: object) -> None:
    if found != expected:
        raise RuntimeError(f"{what}: expected {expected}, got {found}")


def run(command: list[object], *, input: str | None = None, **options: object) -> str:  # noqa: A002
    """Run a command that must succeed; return what it printed."""
    words = [str(word) for word in command]
    done = subprocess.run(words, input=input, capture_output=True, text=True, check=False, **options)  # type: ignore[call-overload]
    if done.returncode != 0:
        if "error sending request" in done.stderr:
            raise SkippedError(f"uv cannot reach the package index: {done.stderr.strip().splitlines()[-1]}")
        raise RuntimeError(f"{' '.join(words)}\n{done.stdout}{done.stderr}")
    return str(done.stdout)


def take_settings_of_pip() -> None:
    """Let uv use the index, certificates and folders that pip is told to use; uv reads none of them."""
    command = [sys.executable, "-m", "pip", "config", "list"]
    listed = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    known = dict(re.findall(r"^[^.\n]*\.([\w-]+)='(.*)'$", listed, flags=re.MULTILINE))
    names = {"cert": "SSL_CERT_FILE", "index-url": "UV_DEFAULT_INDEX", "find-links": "UV_FIND_LINKS"}
    for setting, name in names.items():
        value = known.get(setting)
        if value and (setting == "index-url" or Path(value).exists()):
            os.environ.setdefault(name, value)


def step(name: str, what: Callable[[], str]) -> str:
    """Do one step, print how it ended, and return that word."""
    begin = time.perf_counter()
    try:
        state, told = "ok", what()
    except SkippedError as reason:
        state, told = "skipped", str(reason)
    except RuntimeError as error:
        state, told = "FAILED", str(error)
    print(f"{name:9} {state:8} {time.perf_counter() - begin:4.0f} s  {told}", flush=True)
    return state


def main() -> int:
    if unknown := set(sys.argv[1:]) - {"build", *STEPS}:
        print(f"steps: expected some of build, {', '.join(STEPS)}, got {' '.join(unknown)}", file=sys.stderr)
        return 2
    chosen = {name: what for name, what in STEPS.items() if not sys.argv[1:] or name in sys.argv[1:]}
    take_settings_of_pip()
    ends = [step("build", build)]
    if ends == ["ok"]:
        with ThreadPoolExecutor(2) as pool:
            ends += pool.map(step, chosen, chosen.values())
    print(f"{ends.count('ok')} steps passed, {ends.count('skipped')} skipped, {ends.count('FAILED')} failed")
    return int("FAILED" in ends)


if __name__ == "__main__":
    sys.exit(main())
