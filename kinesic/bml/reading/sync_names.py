"""Names of sync points in BML and its dialects.

`stroke_start`, `stroke-start` and `StrokeStart` are `strokeStart`.
"""

import re
from collections.abc import Mapping

# BML attributes that give the time of a sync point
SYNC_ATTRIBUTES = ("start", "ready", "strokeStart", "attackPeak", "stroke", "strokeEnd", "relax", "end")

_DRAFT_SYNC_NAMES = {  # sync point of older drafts, which mark start and end of each phase -> sync point of BML
    "preparationstart": "start",
    "preparationend": "ready",
    "readystart": "ready",
    "strokepeak": "stroke",
    "relaxstart": "relax",
    "retractionstart": "relax",
    "relaxend": "end",
    "retractionend": "end",
}
_SYNC_NAME_PATTERN = re.compile(r"[A-Za-z]+([_-][A-Za-z]+)*")  # words joined by underscores or hyphens
# lower-case name -> sync point
_SYNCS_BY_SPELLING: Mapping[str, str] = {name.lower(): name for name in SYNC_ATTRIBUTES} | _DRAFT_SYNC_NAMES


def find_sync_name(text: str) -> str | None:
    """Return BML's name of a sync point, or None if unknown."""
    is_name = _SYNC_NAME_PATTERN.fullmatch(text) is not None
    return _SYNCS_BY_SPELLING.get(text.lower().replace("_", "").replace("-", "")) if is_name else None
