"""Options and arguments that several verbs share: document, robot, style, voice, sinks and twins."""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import Literal, get_args

import click

from kinesic.bml.block import BmlError, Dialect
from kinesic.body.config import names_of
from kinesic.controller.perform import set_up
from kinesic.expressivity.context import read_targets
from kinesic.expressivity.gather import Gathering
from kinesic.expressivity.idle import OFF, Idling, Liveliness
from kinesic.expressivity.style.style import RANGES, Style
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.planning.setup import Setup
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, Factors
from kinesic.speech.voice import VoiceName

SINKS = ("twin", "servos", "face")
FAULT = 3  # the exit code when one of them failed
TWINS = {"nominal": (NOMINAL,), "pessimistic": (PESSIMISTIC,), "both": (NOMINAL, PESSIMISTIC)}
TWIN_HELP = "nominal, pessimistic, both (checks of the nominal one, errors of both), or a TOML file of factors."
DIALECTS = ["auto", *get_args(Dialect)]
STYLE_HELP = f"Manner, unless documents say otherwise: {', '.join(names_of('style'))}, or a TOML file."
SET_HELP = (
    "One number of the manner, over documents too, -1 to 1: power=0.8 of all modalities, head.power=0.8 of one; "
    f"of {', '.join(RANGES)} (openness 0 to 1). Repeat for more."
)

VOICE_HELP = "Who speaks: espeak is heard, durations is silent; auto takes espeak where it is installed."
PAUSE_HELP = "Longest pause before a word for which the body would be late, unless documents say otherwise."


def read_input(file: str) -> bytes:
    """The bytes of a file, or of standard input for `-`.

    Raises:
        BmlError: there is no such file, or it cannot be read.
    """
    if file == "-":
        return sys.stdin.buffer.read()
    try:
        return Path(file).read_bytes()
    except OSError as error:
        raise BmlError(f"{file}: {error.strerror}") from None


class SinkNames(click.ParamType[frozenset[str]]):
    """Names of sinks, with commas between them."""

    name = "sinks"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> frozenset[str]:
        """Their set."""
        names = frozenset(str(value).split(","))
        if names - set(SINKS):
            self.fail(f"{value!r} is not one of {', '.join(SINKS)}, or several with commas between them", param, ctx)
        return names


def read_twins(name: str) -> tuple[Factors, ...]:
    """The factors on the servos' and masses' nominal values; the first twin's are checked.

    Raises:
        ConfigError: no such file, or not factors.
    """
    return TWINS[name] if name in TWINS else (Factors.read(Path(name)),)


@dataclass(frozen=True)
class PlanningOptions:
    """What the shared options say; picklable, so that other processes can make the same setup."""

    robot: str
    style: str
    changes: tuple[str, ...]
    lexicon: Path | None
    targets: Path | None
    dialect: Dialect | Literal["auto"]
    gathering: Gathering = "complex"
    idling: Idling = OFF
    voice: VoiceName = "auto"
    pause: float = 0.0

    def setup(self) -> Setup:
        """Reads everything that the options name.

        Raises:
            ConfigError: something is missing or wrong.
        """
        return set_up(
            load_robot(self.robot),
            style=Style.load(self.style).changed(self.changes),
            lexicon=self.lexicon,
            targets=read_targets(self.targets) if self.targets else None,
            dialect=self.dialect,
            gathering=self.gathering,
            idling=self.idling,
            voice=self.voice,
            pause=self.pause,
        )


def planning(verb: Callable[..., int]) -> Callable[..., int]:
    """Adds the options that say how a document is planned, and hands them on as `settings`."""

    @wraps(verb)
    def with_settings(
        *,
        robot: str,
        style: str,
        changes: tuple[str, ...],
        lexicon: Path | None,
        targets: Path | None,
        dialect: Dialect | Literal["auto"],
        gather: Gathering,
        idle: Liveliness,
        seed: int,
        voice: VoiceName,
        pause: float,
        **own: object,
    ) -> int:
        idling = Idling(idle, seed)
        settings = PlanningOptions(robot, style, changes, lexicon, targets, dialect, gather, idling, voice, pause)
        return verb(settings=settings, **own)

    options = (
        click.option("--robot", default="upper22", show_default=True, help="Name, or a robot's TOML file."),
        click.option("--style", default="neutral", show_default=True, help=STYLE_HELP),
        click.option("--set", "changes", multiple=True, metavar="NAME=VALUE", help=SET_HELP),
        click.option("--lexicon", type=click.Path(path_type=Path), help="Gestures: TOML, or Greta's gestuary XML."),
        click.option("--dialect", type=click.Choice(DIALECTS), default="auto", help="How documents are read."),
        click.option("--gather", type=click.Choice(get_args(Gathering)), default="complex", help="How frames fill up."),
        click.option("--idle", type=click.Choice(get_args(Liveliness)), default="off", help="What fills pauses."),
        click.option("--seed", type=int, default=0, show_default=True, help="Of everything random."),
        click.option("--voice", type=click.Choice(get_args(VoiceName)), default="auto", help=VOICE_HELP),
        click.option("--pause", type=click.FloatRange(0.0, 60.0), default=0.0, metavar="SECONDS", help=PAUSE_HELP),
        click.option("--targets", type=click.Path(path_type=Path), help="TOML of named points in the world [m]."),
    )
    decorated: Callable[..., int] = with_settings
    for option in reversed(options):
        decorated = option(decorated)
    return decorated
