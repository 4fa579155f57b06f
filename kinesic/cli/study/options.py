"""Values of the options of `kinesic study`, grouped by purpose."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class StudyOutput:
    """Folder of a study, and the server that receives its answers."""

    out: Path | None
    force: bool
    post_to: str  # URL; empty: answers are only offered as a file


@dataclass(frozen=True)
class GestureStudyContent:
    """Gestures and documents of a gesture study, and the compared settings."""

    gestures: tuple[str, ...]  # ids; empty: `count` gestures drawn at random
    count: int
    conditions: tuple[str, ...]  # compared settings as NAME=VALUE
    pairs: int  # number of gestures compared for each condition
    documents: tuple[Path, ...]


@dataclass(frozen=True)
class SpeechStudyContent:
    """Texts of a speech study, the compared settings and the planned size."""

    documents: tuple[Path, ...]
    conditions: tuple[str, ...]  # compared settings as NAME=VALUE
    participants: int
