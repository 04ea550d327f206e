"""One line about a run of the tests with `--cov`: what it covers of the package, and the lowest files.

Processes that tests start, and compiled loops, are not seen.
"""

import json
import subprocess
import sys

JSON = [sys.executable, "-m", "coverage", "json", "--quiet", "-o", "-"]


def main() -> None:
    report = json.loads(subprocess.run(JSON, check=True, capture_output=True, text=True, timeout=60).stdout)
    covered = {
        file: found["summary"]["percent_covered"]
        for file, found in report["files"].items()
        if found["summary"]["num_statements"]
    }
    least = sorted(covered, key=covered.__getitem__)[:5]
    lowest = ", ".join(f"{file} {covered[file]:.0f} %" for file in least)
    print(f"coverage: {report['totals']['percent_covered']:.1f} % of the lines; lowest: {lowest}")


if __name__ == "__main__":
    main()
