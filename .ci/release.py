"""Set the version, and say how to publish it.

python .ci/release.py set 0.4.0     # the number and today's date, wherever they stand
python .ci/release.py ready         # whether this commit can be released
python .ci/release.py upload        # the commands that publish what `make packages` built
"""

from __future__ import annotations

import hashlib
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VERSION, DATE = r"\d+\.\d+\.\d+", r"\d{4}-\d\d-\d\d"
PLACES = [
    ("src/asperity/base/version.py", rf'(?<=__version__ = "){VERSION}'),
    ("CITATION.cff", rf"(?<=\nversion: ){VERSION}"),
    ("CITATION.cff", rf"(?<=\ndate-released: ){DATE}"),
    ("research/pyproject.toml", rf'(?<=\nversion = "){VERSION}'),
    ("research/pyproject.toml", rf"(?<=asperity\[campaign\]==){VERSION}"),
    ("recipe.yaml", rf"(?<=\n  version: ){VERSION}"),
    ("README.md", rf"(?<=\nVersion ){VERSION}(?=:)"),
    ("CHANGELOG.md", rf"(?<=\n## )(?:{VERSION}, {DATE}|Unreleased)(?=\n)"),
]
"""Where the version or its date stands, as expressions of which the first match counts."""


def stated() -> list[str]:
    """What stands at each place."""
    found = [re.search(pattern, (ROOT / name).read_text(encoding="utf-8")) for name, pattern in PLACES]
    return [match[0] if match else "" for match in found]


def set_version(version: str, date: str) -> None:
    """Write a version and its date at every place. A new version takes over the heading `Unreleased`."""
    heading = stated()[-1]
    if heading not in ("Unreleased", f"{version}, {date}") and not heading.startswith(f"{version}, "):
        raise SystemExit(
            f"CHANGELOG.md: expected the heading '## Unreleased' or '## {version}, ...', got {heading}"
        )
    for name, pattern in PLACES:
        text = (ROOT / name).read_text(encoding="utf-8")
        new = f"{version}, {date}" if name == "CHANGELOG.md" else date if DATE in pattern else version
        (ROOT / name).write_text(re.sub(pattern, new, text, count=1), encoding="utf-8")


def ready() -> list[str]:
    """What keeps this commit from being released."""
    version, cited, date, *others, heading = stated()
    reasons = []
    if {version, cited, *others} != {version} or heading != f"{version}, {date}":
        reasons.append(f"the versions differ: {stated()}; try python .ci/release.py set {version}")
    if git("status", "--porcelain"):
        reasons.append("there are changes that are not committed")
    if git("tag", "--list", f"v{version}"):
        reasons.append(f"the tag v{version} exists; try python .ci/release.py set with the next version")
    return reasons


def upload() -> str:
    """The commands that publish the archives in dist, and their checksums."""
    version = stated()[0]
    archives = sorted((ROOT / "dist").glob(f"asperity*-{version}*"))
    if len(archives) != 4:
        expected = f"wheels and source distributions of asperity and asperity-research {version}"
        raise SystemExit(f"dist: expected {expected}, got {len(archives)} files")
    sums = "\n".join(f"  {hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}" for path in archives)
    names = " ".join(f"dist/{path.name}" for path in archives)
    return (
        f"sha256\n{sums}\n\nAsperity {version} is ready. To publish it:\n"
        f"  git tag --annotate v{version} --message 'Asperity {version}' && git push origin v{version}\n"
        f"  .venv/bin/python -m twine upload {names}"
    )


def git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True).stdout


def main() -> None:
    match sys.argv[1:]:
        case ["set", version] if re.fullmatch(VERSION, version):
            set_version(version, time.strftime("%Y-%m-%d"))
        case ["ready"]:
            if reasons := ready():
                raise SystemExit("\n".join(reasons))
        case ["upload"]:
            print(upload())
        case _:
            raise SystemExit(__doc__)


if __name__ == "__main__":
    main()
