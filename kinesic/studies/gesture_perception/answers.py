"""Answers of participants, one row of CSV each: what was offered, in which order, and what was chosen."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from kinesic.body.config import ConfigError, suggestion
from kinesic.studies.gesture_perception.design import OPTIONS, SEPARATOR, SIDES, TASKS
from kinesic.studies.questionnaire.answers import read_columns, read_rows

NEEDED_COLUMNS = ("participant", "place", "task", "stimulus", "condition", "options", "chosen")
COLUMNS = (*NEEDED_COLUMNS, "seconds")
LONGEST_NAME = 200  # characters of a name that is believed


@dataclass(frozen=True)
class ParticipantAnswer:
    """What one participant chose, once."""

    participant: str
    stimulus: str  # gesture, or text with gestures, that was shown
    options: tuple[str, ...]  # in the order in which they were offered
    chosen: str

    @property
    def place(self) -> int:
        """Of what was chosen, from 0."""
        return self.options.index(self.chosen)


@dataclass(frozen=True)
class Recognition(ParticipantAnswer):
    """Which of six meanings a participant saw in a gesture; options are gestures."""

    @property
    def right(self) -> bool:
        """Whether it is the gesture's own."""
        return self.chosen == self.stimulus


@dataclass(frozen=True)
class Preference(ParticipantAnswer):
    """Which of two performances of a gesture looked more natural; options are standard and changed."""

    condition: str  # the setting that was changed


@dataclass(frozen=True)
class Answers:
    """Of all participants."""

    recognitions: tuple[Recognition, ...]
    preferences: tuple[Preference, ...]


def are_of_gestures(path: Path) -> bool:
    """Whether a file of answers is of a study of gestures.

    Raises:
        ConfigError: it is missing, or no CSV.
    """
    return {"task", "chosen"} <= set(read_columns(path))


def read_gesture_answers(paths: Sequence[Path]) -> Answers:
    """Reads the answers of all participants.

    Raises:
        ConfigError: a file or a column is missing, a value is none that a page writes, or an answer is there twice.
    """
    seen: dict[tuple[str, str], str] = {}
    found: list[Recognition | Preference] = []
    for where, row in read_rows(paths, NEEDED_COLUMNS):
        before = seen.setdefault((row["participant"], row["place"]), where)
        if before != where:
            who, place = row["participant"][:LONGEST_NAME], row["place"][:LONGEST_NAME]
            raise ConfigError(
                f"{where}: participant {who!r} has answered at place {place!r} before, in {before}; give each file once"
            )
        found.append(_answer(where, row))
    if not found:
        raise ConfigError(f"{', '.join(map(str, paths))}: no answers")
    return Answers(
        tuple(answer for answer in found if isinstance(answer, Recognition)),
        tuple(answer for answer in found if isinstance(answer, Preference)),
    )


def _answer(where: str, row: Mapping[str, str]) -> Recognition | Preference:
    for name in NEEDED_COLUMNS:
        if len(row[name]) > LONGEST_NAME * (OPTIONS if name == "options" else 1):
            raise ConfigError(f"{where}: {name} has {len(row[name])} characters, more than a page writes")
    options, task = tuple(row["options"].split(SEPARATOR)), row["task"]
    if task not in TASKS:
        raise ConfigError(f"{where}: task is {task!r}{suggestion(task, TASKS)}, must be one of {', '.join(TASKS)}")
    if task == "comparison":
        if sorted(options) != sorted(SIDES):
            raise ConfigError(f"{where}: options are {row['options']!r}, must be {SEPARATOR.join(SIDES)} in any order")
        if not row["condition"]:
            raise ConfigError(f"{where}: no condition, which is the setting that was changed")
    elif len(options) != OPTIONS or len(set(options)) != OPTIONS or row["stimulus"] not in options:
        raise ConfigError(
            f"{where}: options are {row['options']!r}, must be {OPTIONS} gestures, {row['stimulus']} among them"
        )
    if row["chosen"] not in options:
        raise ConfigError(f"{where}: chosen is {row['chosen']!r}, must be one of {', '.join(options)}")
    common = row["participant"], row["stimulus"], options, row["chosen"]
    return Preference(*common, row["condition"]) if task == "comparison" else Recognition(*common)
