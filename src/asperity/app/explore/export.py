"""A page of one file, with style, scripts and the messages of a run in it; it needs no server.

The messages are one stream: before each stands its length (uint64, little endian). The stream is compressed
(gzip) and written in base64 in ``<script type="application/octet-stream" id="recording">``.
"""

from __future__ import annotations

import base64
import gzip
import html
import re
from collections.abc import Iterable
from importlib import resources

_LINK = re.compile(r'<link rel="stylesheet" href="([\w.-]+)">')
_SCRIPT = re.compile(r'<script src="([\w.-]+)"( defer)?></script>')
_ALONE = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "img-src data: blob:; media-src data: blob:; connect-src data: blob:"
)
"""Content policy of the exported page, which loads nothing from elsewhere."""


def page_files() -> dict[str, bytes]:
    """Files of the page, by name."""
    page = resources.files("asperity.app.explore").joinpath("page")
    return {file.name: file.read_bytes() for file in page.iterdir() if file.is_file()}


def exported_page(messages: Iterable[bytes], *, title: str) -> str:
    """Write the page with its files, the messages of a server, if any, and a title."""
    stream = b"".join(len(message).to_bytes(8, "little") + message for message in messages)
    packed = base64.b64encode(gzip.compress(stream, mtime=0)).decode("ascii") if stream else ""
    recording = f'<script type="application/octet-stream" id="recording">{packed}</script>'
    files = {name: content.decode() for name, content in page_files().items()}
    page = _LINK.sub(lambda script: f"<style>\n{files[script[1]]}</style>", files["index.html"])
    # Inline scripts run where they stand, so they stand behind what they look for, after the data.
    # No script may end the element in which it stands.
    codes = [files[script[1]].replace("</script", "<\\/script") for script in _SCRIPT.finditer(page)]
    scripts = "\n".join(f"<script>\n{code}</script>" for code in codes)
    page = _SCRIPT.sub("", page)
    page = re.sub(r"<title>.*?</title>", lambda _: f"<title>{html.escape(title)}</title>", page, count=1)
    policy = f'<meta http-equiv="Content-Security-Policy" content="{_ALONE}">'
    page = page.replace("<head>", f"<head>\n{policy}", 1)
    return page.replace("</body>", f"{recording}\n{scripts}\n</body>", 1)
