"""Reading of inline frames in the HTML of notebooks."""

import json
import re
from base64 import b64decode
from html.parser import HTMLParser

import numpy as np

from kinesic.body.arrays import Floats


class _Frames(HTMLParser):
    """Attributes of all inline frames."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[dict[str, str]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "iframe":
            self.found.append({name: value or "" for name, value in attrs})


def the_frame(html: str) -> dict[str, str]:
    """Return the attributes of the only inline frame."""
    reader = _Frames()
    reader.feed(html)
    (frame,) = reader.found
    return frame


def replay_of(html: str) -> dict:
    """Return the player's data in the only inline frame."""
    (text,) = re.findall(r'<script type="application/json" id="replay">(.*?)</script>', the_frame(html)["srcdoc"])
    return json.loads(text)


def angles_of(replay: dict, motion: str) -> Floats:
    """Return the angles of a motion, (frames, hinges) [rad]."""
    rows = np.frombuffer(b64decode(replay["motions"][motion]), "<i2").reshape(replay["frames"], -1)
    return rows * replay["step"]
