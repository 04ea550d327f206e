"""Set the version and the address, and say how to publish.

python .ci/release.py set 0.4.0     # the number and today's date, wherever they stand
python .ci/release.py address URL   # where the repository is, such as https://github.com/OWNER/asperity
python .ci/release.py ready [TAG]   # whether this commit can be released, or has been tagged for it
python .ci/release.py upload        # the recipe for conda, and the tag that publishes on PyPI
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

NO_ADDRESS = "https://example.org/owner/asperity"
"""Stands for the address until there is one; `ready` refuses it."""

ADDRESSED = ("pyproject.toml", "research/pyproject.toml", "CITATION.cff", "recipe.yaml")
"""Files with the address, which the first states as the homepage."""


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


def address() -> str:
    """Where the repository is."""
    found = re.search(r'(?<=\nHomepage = ")[^"]+', (ROOT / ADDRESSED[0]).read_text(encoding="utf-8"))
    return found[0] if found else ""


def set_address(new: str) -> None:
    """Write the address at every place, and its owner as who keeps the recipe."""
    old, owner = address(), new.rstrip("/").split("/")[-2]
    for name in ADDRESSED:
        text = (ROOT / name).read_text(encoding="utf-8").replace(old, new.rstrip("/"))
        text = re.sub(r"(recipe-maintainers:\n +- ).*", rf"\g<1>{owner}", text)
        (ROOT / name).write_text(text, encoding="utf-8")


def ready(tag: str = "") -> list[str]:
    """What keeps this commit from being released, before it has a tag or with this one."""
    version, cited, date, *others, heading = stated()
    reasons = []
    if address() == NO_ADDRESS:
        reasons.append("there is no address yet; try python .ci/release.py address https://...")
    if tag and tag != f"v{version}":
        reasons.append(f"the tag is {tag}, the version {version}; try git tag v{version}")
    if {version, cited, *others} != {version} or heading != f"{version}, {date}":
        reasons.append(f"the versions differ: {stated()}; try python .ci/release.py set {version}")
    if git("status", "--porcelain"):
        reasons.append("there are changes that are not committed")
    if not tag and git("tag", "--list", f"v{version}"):
        reasons.append(f"the tag v{version} exists; try python .ci/release.py set with the next version")
    return reasons


def upload() -> str:
    """Write the recipe of what is in dist beside it; return checksums, and the commands that publish."""
    version = stated()[0]
    archives = sorted((ROOT / "dist").glob(f"asperity*-{version}*"))
    if len(archives) != 4:
        expected = f"wheels and source distributions of asperity and asperity-research {version}"
        raise SystemExit(f"dist: expected {expected}, got {len(archives)} files")
    sums = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in archives}
    recipe = (ROOT / "recipe.yaml").read_text(encoding="utf-8")
    written = re.sub(r"(?<=sha256: )\w+", sums[f"asperity-{version}.tar.gz"], recipe)
    (ROOT / "dist" / "recipe.yaml").write_text(written, encoding="utf-8")
    lines = "\n".join(f"  {one}  {name}" for name, one in sums.items())
    return (
        f"sha256\n{lines}\n\nAsperity {version} is ready. The workflow publish takes this tag:\n"
        f"  git tag --annotate v{version} --message 'Asperity {version}' && git push origin v{version}\n"
        "For conda-forge: dist/recipe.yaml, once PyPI has the source distribution."
    )


def git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True).stdout


def main() -> None:
    match sys.argv[1:]:
        case ["set", version] if re.fullmatch(VERSION, version):
            set_version(version, time.strftime("%Y-%m-%d"))
        case ["address", new] if re.fullmatch(r"https://[\w.-]+(/[\w.-]+){2,}/?", new):
            set_address(new)
        case ["ready", *tag] if len(tag) < 2:
            if reasons := ready(*tag):
                raise SystemExit("\n".join(reasons))
        case ["upload"]:
            print(upload())
        case _:
            raise SystemExit(__doc__)


if __name__ == "__main__":
    main()
