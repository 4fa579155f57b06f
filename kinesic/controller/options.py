"""The options of planning as keywords: checked, in the words of the command line."""

import difflib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal, TypedDict, get_args

import numpy as np

from kinesic.bml.block import Dialect
from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError, suggestion
from kinesic.body.robot import Robot
from kinesic.controller.perform import set_up
from kinesic.expressivity.context import read_targets
from kinesic.expressivity.gather import Gathering
from kinesic.expressivity.idle import Idling, Liveliness
from kinesic.expressivity.style.style import Style
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.planning.setup import Setup
from kinesic.speech.voice import VoiceName

LONGEST_PAUSE = 60.0  # [s]


class Options(TypedDict, total=False):
    """How documents are planned, in the words of the command line."""

    settings: Mapping[str, float]  # single numbers of the manner, over documents too: {"head.power": 0.8}
    lexicon: str | Path | None  # gestures: TOML, or Greta's gestuary XML
    targets: str | Path | Mapping[str, Sequence[float] | Floats]  # named points in the world [m], or a file of them
    dialect: Dialect | Literal["auto"]  # how documents are read
    gather: Gathering  # how key frames are filled
    idle: Liveliness  # what fills pauses
    seed: int  # of everything random
    voice: VoiceName  # "espeak" is heard, "durations" is silent and the same on every machine
    pause: float  # [s] longest pause before a word for which the body would be late


CHOICES: Mapping[str, tuple[str, ...]] = {
    "dialect": ("auto", *get_args(Dialect)),
    "gather": get_args(Gathering),
    "idle": get_args(Liveliness),
    "voice": get_args(VoiceName),
}


def setup_of(robot: Robot | str | Path, style: Style | str | Path, options: Options) -> Setup:
    """Loads what planning needs.

    Args:
        robot: its name, or its TOML file.
        style: its name, or its TOML file.
        options: everything else.

    Raises:
        ConfigError: something is missing or wrong; says what would have worked.
        TypeError: there is no such option.
    """
    _check(options)
    manner = style if isinstance(style, Style) else Style.load(style)
    lexicon = options.get("lexicon")
    return set_up(
        robot if isinstance(robot, Robot) else load_robot(robot),
        style=manner.changed(f"{name}={float(value)!r}" for name, value in options.get("settings", {}).items()),
        lexicon=None if lexicon is None else Path(lexicon),
        targets=_targets(options.get("targets", {})),
        dialect=options.get("dialect", "auto"),
        gathering=options.get("gather", "complex"),
        idling=Idling(options.get("idle", "off"), options.get("seed", 0)),
        voice=options.get("voice", "durations"),
        pause=options.get("pause", 0.0),
    )


def _check(options: Options) -> None:
    for name, value in options.items():
        if name not in Options.__annotations__:
            near = difflib.get_close_matches(name, Options.__annotations__, n=1)
            known = f"did you mean {near[0]}?" if near else f"known: {', '.join(Options.__annotations__)}"
            raise TypeError(f"a performer has no option {name}; {known}")
        if name in CHOICES and value not in CHOICES[name]:
            raise ConfigError(f"{name} is {value!r}{suggestion(str(value), CHOICES[name])}")
    pause = options.get("pause", 0.0)
    if not (isinstance(pause, int | float) and 0.0 <= pause <= LONGEST_PAUSE):
        raise ConfigError(f"pause is {pause!r}; it must be from 0 to {LONGEST_PAUSE:g} seconds")


def _targets(given: str | Path | Mapping[str, Sequence[float] | Floats]) -> Mapping[str, Floats]:
    if isinstance(given, str | Path):
        return read_targets(Path(given))
    found = {name: sealed(np.array(point, dtype=np.float64)) for name, point in given.items()}
    for name, point in found.items():
        if point.shape != (3,) or not np.isfinite(point).all():
            raise ConfigError(f"target {name} is {point.tolist()}; it needs three finite numbers x, y, z in metres")
    return found
