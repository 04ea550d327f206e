"""The form of the page: the keys of all sections as the server describes them, which a change keeps."""

import json
import os
from pathlib import Path

from asperity.app.explore.server import Server

FORM = Path(__file__).with_name("form.json")


def test_the_form_stays(tmp_path):
    form = json.loads(json.dumps(Server(None, tmp_path).hello()["form"]))
    if os.environ.get("ASPERITY_MESSAGES") == "write":
        FORM.write_text(json.dumps(form, indent=1, ensure_ascii=False) + "\n", "utf-8")
    assert form == json.loads(FORM.read_text("utf-8"))
