"""Reader of participants' answers in a gesture study."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from kinesic.body.config import ConfigError, suggestion
from kinesic.studies.gesture_perception.design import (
    OPTION_COUNT,
    OPTION_SEPARATOR,
    STANDARD_SYSTEM,
    STIMULUS_VERSIONS,
    STUDY_TASKS,
)
from kinesic.studies.questionnaire.answers import read_columns, read_rows

REQUIRED_COLUMNS = ("participant", "place", "task", "stimulus", "condition", "options", "chosen")
ANSWER_COLUMNS = (*REQUIRED_COLUMNS, "seconds")  # columns of the answer file that the page writes
MAX_NAME_LENGTH = 200  # [characters] longest accepted name in an answer file


@dataclass(frozen=True)
class ParticipantAnswer:
    """One answer of a participant in a gesture study."""

    participant: str
    stimulus: str  # shown gesture, or text with gestures
    options: tuple[str, ...]  # in the order of presentation
    chosen: str

    @property
    def place(self) -> int:
        """Position of the chosen option, from 0."""
        return self.options.index(self.chosen)


@dataclass(frozen=True)
class Recognition(ParticipantAnswer):
    """Choice of one of six meanings for a gesture.

    Options are gestures.
    """

    @property
    def right(self) -> bool:
        """Whether the participant chose the correct meaning."""
        return self.chosen == self.stimulus


@dataclass(frozen=True)
class Preference(ParticipantAnswer):
    """Choice of the more natural of two performances.

    Options are standard and changed.
    """

    condition: str  # the changed setting


@dataclass(frozen=True)
class SpeechMatch(ParticipantAnswer):
    """Choice of the speech that belongs to a motion.

    Options are texts.
    """

    system: str  # system that made the motion

    @property
    def right(self) -> bool:
        """Whether the participant chose the speech of the motion."""
        return self.chosen == self.stimulus


@dataclass(frozen=True)
class Realism(ParticipantAnswer):
    """Choice of the more natural of two systems' motions for a text.

    Options are systems.
    """


AnyAnswer = Recognition | Preference | SpeechMatch | Realism


@dataclass(frozen=True)
class PairChoice:
    """Preferred and rejected system of one answer."""

    participant: str
    preferred: str
    rejected: str


@dataclass(frozen=True)
class Answers:
    """Answers of all participants in a gesture study."""

    recognitions: tuple[Recognition, ...]
    preferences: tuple[Preference, ...]
    matches: tuple[SpeechMatch, ...] = ()
    realisms: tuple[Realism, ...] = ()

    @property
    def pair_choices(self) -> tuple[PairChoice, ...]:
        """Choices between two systems, where a changed setting counts as a system."""
        choices = []
        for answer in (*self.preferences, *self.realisms):
            options = answer.options
            rejected = next(option for option in options if option != answer.chosen)
            names: dict[str, str] = {STIMULUS_VERSIONS[0]: STANDARD_SYSTEM}
            if isinstance(answer, Preference):
                names[STIMULUS_VERSIONS[1]] = answer.condition
            choices.append(
                PairChoice(answer.participant, *(names.get(name, name) for name in (answer.chosen, rejected)))
            )
        return tuple(choices)


def are_of_gestures(path: Path) -> bool:
    """Return whether a file contains answers of a gesture study.

    Raises:
        ConfigError: the file is missing or not CSV.
    """
    return {"task", "chosen"} <= set(read_columns(path))


def read_gesture_answers(paths: Sequence[Path]) -> Answers:
    """Read the answers of all participants in a gesture study.

    Raises:
        ConfigError: a file or column is missing, a value is invalid, or an answer is duplicated.
    """
    seen: dict[tuple[str, str], str] = {}
    answers: list[AnyAnswer] = []
    for location, row in read_rows(paths, REQUIRED_COLUMNS):
        before = seen.setdefault((row["participant"], row["place"]), location)
        if before != location:
            person, place = row["participant"][:MAX_NAME_LENGTH], row["place"][:MAX_NAME_LENGTH]
            raise ConfigError(
                f"{location}: participant {person!r} already answered at place {place!r}, in {before}; "
                "give each file once"
            )
        answers.append(_answer(location, row))
    if not answers:
        raise ConfigError(f"{', '.join(map(str, paths))}: no answers")
    return Answers(
        tuple(answer for answer in answers if isinstance(answer, Recognition)),
        tuple(answer for answer in answers if isinstance(answer, Preference)),
        tuple(answer for answer in answers if isinstance(answer, SpeechMatch)),
        tuple(answer for answer in answers if isinstance(answer, Realism)),
    )


def _answer(location: str, row: Mapping[str, str]) -> AnyAnswer:
    for name in REQUIRED_COLUMNS:
        if len(row[name]) > MAX_NAME_LENGTH * (OPTION_COUNT if name == "options" else 1):
            raise ConfigError(f"{location}: {name} has {len(row[name])} characters, more than a page can write")
    options, task = tuple(row["options"].split(OPTION_SEPARATOR)), row["task"]
    if task not in STUDY_TASKS:
        raise ConfigError(
            f"{location}: task is {task!r}{suggestion(task, STUDY_TASKS)}, must be one of {', '.join(STUDY_TASKS)}"
        )
    if task == "comparison":
        if sorted(options) != sorted(STIMULUS_VERSIONS):
            raise ConfigError(
                f"{location}: options are {row['options']!r}, "
                f"must be {OPTION_SEPARATOR.join(STIMULUS_VERSIONS)} in any order"
            )
        if not row["condition"]:
            raise ConfigError(f"{location}: no condition, which is the setting that was changed")
    elif task in ("mismatching", "realism"):
        _check_pair(location, row, options)
    elif len(options) != OPTION_COUNT or len(set(options)) != OPTION_COUNT or row["stimulus"] not in options:
        raise ConfigError(
            f"{location}: options are {row['options']!r}, must be {OPTION_COUNT} gestures, {row['stimulus']} among them"
        )
    if row["chosen"] not in options:
        raise ConfigError(f"{location}: chosen is {row['chosen']!r}, must be one of {', '.join(options)}")
    common = row["participant"], row["stimulus"], options, row["chosen"]
    match task:
        case "comparison":
            return Preference(*common, row["condition"])
        case "mismatching":
            return SpeechMatch(*common, row["condition"])
        case "realism":
            return Realism(*common)
    return Recognition(*common)


def _check_pair(location: str, row: Mapping[str, str], options: tuple[str, ...]) -> None:
    """Check the answer options of a comparison of two systems or texts.

    Raises:
        ConfigError: they are invalid, or the system is missing.
    """
    is_match = row["task"] == "mismatching"
    if len(options) != 2 or options[0] == options[1] or (is_match and row["stimulus"] not in options):
        what = f"two texts, {row['stimulus']} among them" if is_match else "two systems"
        raise ConfigError(f"{location}: options are {row['options']!r}, must be {what}")
    if is_match and not row["condition"]:
        raise ConfigError(f"{location}: no condition, which is the system that made the motion")
