"""Answers of participants, as the page writes them: one row of CSV per face that was answered."""

import csv
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from kinesic.body.config import ConfigError, suggestion
from kinesic.studies.perception.design import ACTIONS, POINTS, Presentation, Strength

Wrinkles = Literal["with", "without"]

OPINIONS = ("naturalness", "realism")
LABELS = tuple(action.name for action in ACTIONS)
CONDITIONS: Mapping[str, tuple[str, ...]] = {
    "strength": get_args(Strength),
    "wrinkles": get_args(Wrinkles),
    "presentation": get_args(Presentation),
}
COLUMNS = (
    *("participant", "place", "stimulus", "agent", "action", "region", *CONDITIONS),
    *LABELS,
    *OPINIONS,
    "seconds",
)
NEEDED = ("action", *CONDITIONS, *LABELS, *OPINIONS)


@dataclass(frozen=True)
class Rating:
    """What one participant said of one face."""

    action: str
    conditions: Mapping[str, str]  # strength, wrinkles, presentation
    labels: Mapping[str, int]  # action asked for -> 1..5
    opinions: Mapping[str, int]  # naturalness, realism -> 1..5

    @property
    def first_choice(self) -> bool:
        """Whether the true label got more than every other one (thesis 4.5)."""
        others = (points for name, points in self.labels.items() if name != self.action)
        return self.labels[self.action] > max(others, default=0)


def read_answers(paths: Sequence[Path]) -> tuple[Rating, ...]:
    """Reads the answers of all participants; of faces that only confuse none.

    Raises:
        ConfigError: a file or a column is missing, or a value is out of its range.
    """
    found: list[Rating] = []
    for path in paths:
        try:
            with path.open(newline="", encoding="utf-8") as lines:
                found += _read(path, csv.DictReader(lines))
        except OSError as error:
            raise ConfigError(f"{path}: {error.strerror}") from None
        except UnicodeDecodeError:
            raise ConfigError(f"{path} is not text in UTF-8") from None
    if not found:
        raise ConfigError(f"{', '.join(map(str, paths))}: no answer for any of {', '.join(LABELS)}")
    return tuple(found)


def _read(path: Path, rows: "csv.DictReader[str]") -> Iterable[Rating]:
    missing = [name for name in NEEDED if name not in (rows.fieldnames or ())]
    if missing:
        have = list(rows.fieldnames or ())
        raise ConfigError(f"{path}: no column {missing[0]}{suggestion(missing[0], have)}; it has {', '.join(have)}")
    for row in rows:
        if row["action"] in LABELS:
            yield _answer(f"{path}:{rows.line_num}", row)


def _answer(where: str, row: Mapping[str, str]) -> Rating:
    conditions = {name: row[name] for name in CONDITIONS}
    for name, value in conditions.items():
        if value not in CONDITIONS[name]:
            raise ConfigError(f"{where}: {name} is {value!r}, must be one of {', '.join(CONDITIONS[name])}")
    labels = {name: _points(where, name, row[name]) for name in LABELS if row[name]}
    if row["action"] not in labels:
        raise ConfigError(f"{where}: no answer in column {row['action']}, which is what was shown")
    return Rating(row["action"], conditions, labels, {name: _points(where, name, row[name]) for name in OPINIONS})


def _points(where: str, name: str, text: str) -> int:
    if not (text.isdecimal() and 1 <= int(text) <= POINTS):
        raise ConfigError(f"{where}: {name} is {text!r}, must be a whole number from 1 to {POINTS}")
    return int(text)
