"""Simulated participants and the answer files that they would write."""

import csv
from collections.abc import Callable, Sequence
from pathlib import Path
from random import Random

from kinesic.studies.gesture_perception.answers import ANSWER_COLUMNS

GESTURES = tuple(f"gesture_{k}" for k in range(24))
CONDITIONS = ("fluidity=-1", "whole_body=0")
PAIRS = 6

Choice = Callable[[Random, str, Sequence[str]], str]  # random source, shown gesture, options -> answer


def always_right(chance: Random, shown: str, options: Sequence[str]) -> str:
    """Recognize every gesture and prefer the standard."""
    return shown if shown in options else "standard"


def guess(chance: Random, shown: str, options: Sequence[str]) -> str:
    """Guess at random."""
    return chance.choice(options)


def first_place(chance: Random, shown: str, options: Sequence[str]) -> str:
    """Always choose the first option."""
    return options[0]


def rows_of(person: str, choice: Choice, seed: int) -> list[dict[str, str]]:
    """Return one participant's answers, with answer positions as on the page."""
    chance, rows = Random(seed), []
    for k, gesture in enumerate(chance.sample(GESTURES, len(GESTURES))):
        others = chance.sample([name for name in GESTURES if name != gesture], 5)
        options = [*others[: k % 6], gesture, *others[k % 6 :]]
        rows.append(("recognition", gesture, "", options))
    for condition in CONDITIONS:
        for k in range(PAIRS):
            rows.append(("comparison", GESTURES[k], condition, ["standard", "changed"][:: 1 - 2 * (k % 2)]))
    return [
        {
            "participant": person,
            "place": str(k + 1),
            "task": task,
            "stimulus": shown,
            "condition": condition,
            "options": "|".join(options),
            "chosen": choice(chance, shown, options),
            "seconds": "1.0",
        }
        for k, (task, shown, condition, options) in enumerate(rows)
    ]


def write_answers(path: Path, people: Sequence[Choice], seed: int = 0) -> Path:
    """Write the answers of simulated participants."""
    with path.open("w", newline="") as lines:
        rows = csv.DictWriter(lines, ANSWER_COLUMNS)
        rows.writeheader()
        for k, choice in enumerate(people):
            rows.writerows(rows_of(f"{choice.__name__}-{k}", choice, 1000 * seed + k))
    return path
