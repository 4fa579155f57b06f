"""Names of sync points as dialects spell them: `stroke_start`, `stroke-start` and `StrokeStart` are `strokeStart`."""

import re
from collections.abc import Mapping

SYNC_ATTRIBUTES = ("start", "ready", "strokeStart", "attackPeak", "stroke", "strokeEnd", "relax", "end")

_OTHER_NAMES = {  # of older drafts, which name the beginning and the end of each phase
    "preparationstart": "start",
    "preparationend": "ready",
    "readystart": "ready",
    "strokepeak": "stroke",
    "relaxstart": "relax",
    "retractionstart": "relax",
    "relaxend": "end",
    "retractionend": "end",
}
_SPELLING = re.compile(r"[A-Za-z]+([_-][A-Za-z]+)*")
_MEANT: Mapping[str, str] = {name.lower(): name for name in SYNC_ATTRIBUTES} | _OTHER_NAMES


def sync_name(written: str) -> str | None:
    """Finds the sync point that a name means, whatever its case and its separators; None when it means none."""
    is_name = _SPELLING.fullmatch(written) is not None
    return _MEANT.get(written.lower().replace("_", "").replace("-", "")) if is_name else None
