"""Options that several verbs share or that belong together, handed on as one value; quick to import."""

import sys
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast, get_args

import click

from kinesic.bml.block import BmlError
from kinesic.body.choices import Terms
from kinesic.body.config import names_of
from kinesic.cli.ending_signals import STOPPED, STOPPED_LINE, ended_on_the_spot
from kinesic.controller.options import CHOICES, Offer, PlanningOptions, offers
from kinesic.importing import import_at_once

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from kinesic.planning.setup import Setup

SINKS = ("twin", "servos", "face")
FAULT = 3  # the exit code when one of them failed
CELL, STRIP = 176, 192  # pixels of each picture of a sheet of faces, and of a strip
SIDE = 512  # pixels of any other

STYLE_HELP = f"Manner, unless documents say otherwise: {', '.join(names_of('style'))}, or a TOML file."
FORCE_HELP = "Replaces a folder that kinesic has made."
TWIN_HELP = "nominal, pessimistic, both (checks of the nominal one, errors of both), or a TOML file of factors."
LEARN_HELP = (
    "FILE of what servos have told (P gain, delay): goals lead by it, and what they tell now is written to it. "
    "'none': goals lead as data sheets say. Default: by the file of --twin."
)
TERMS_HELP = "What of the servos is inverted: everything, what speed needs, or nothing."
CORRECTION_HELP = "Goals corrected by what the twin measures."
PORT_HELP = "Port of a bus, NAME=PATH, or PATH alone if there is one bus. Repeat for more."
AU_HELP = "Action units of FACS and their intensities: 1=0.8,2=0.8; L or R before one moves that side."
EMOTION_HELP = "An emotion or a lexeme of BML: joy, surprise, RAISE_BROWS."

Verb = Callable[..., int]
Decorator = Callable[[Verb], Verb]


def read_input(file: str) -> bytes:
    """Reads a file, or standard input for `-`.

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
        """Reads names of sinks."""
        names = frozenset(str(value).split(","))
        if names - set(SINKS):
            self.fail(f"{value!r} is not one of {', '.join(SINKS)}, or several with commas between them", param, ctx)
        return names


@dataclass(frozen=True)
class Planning:
    """A robot, and how documents are planned for it; picklable, so that other processes can load the same."""

    robot: str
    style: str
    options: PlanningOptions

    def set_up(self) -> "Setup":
        """Loads everything that the options name.

        Raises:
            ConfigError: something is missing or wrong.
        """
        from kinesic.controller.perform import set_up  # noqa: PLC0415 - slow to import, and help needs it not

        return set_up(self.robot, style=self.style, **self.options)


@dataclass(frozen=True)
class Performers:
    """Who performs, and at which ports servos are."""

    sinks: frozenset[str]
    ports: tuple[str, ...]


@dataclass(frozen=True)
class ServoOptions:
    """How the twin's servos are, and what is known of the robot's."""

    twin: Annotated[str | None, click.option("--twin", metavar="NAME|FILE", help=TWIN_HELP)]
    learn: Annotated[str | None, click.option("--learn", metavar="FILE", help=LEARN_HELP)]


@dataclass(frozen=True)
class TwinOptions(ServoOptions):
    """How the twin performs."""

    feedforward: Annotated[
        Terms,
        click.option(
            "--feedforward", type=click.Choice(get_args(Terms)), default="full", show_default=True, help=TERMS_HELP
        ),
    ]
    correction: Annotated[
        bool,
        click.option("--correction/--no-correction", default=True, help="Goals corrected by what the twin measures."),
    ]


@dataclass(frozen=True)
class Output:
    """Where results go, and whether as JSON to standard output."""

    out: Path | None
    force: bool
    as_json: bool


force_option = click.option("--force", is_flag=True, help="Replaces an existing file.")


@dataclass(frozen=True)
class PictureFile:
    """Where a picture or a film goes, if it is not shown in a window."""

    out: Annotated[
        Path | None,
        click.option(
            "--out",
            type=click.Path(path_type=Path),
            help="X.png, or X.webp or X.mp4 to move; a window without it.",
        ),
    ]
    force: Annotated[bool, force_option]


@dataclass(frozen=True)
class ExpressionOptions:
    """A face by its action units, an emotion, or both."""

    units: Annotated[str, click.option("--au", "units", default="", metavar="N=X,...", help=AU_HELP)]
    emotion: Annotated[str | None, click.option("--emotion", metavar="NAME", help=EMOTION_HELP)]
    amount: Annotated[
        float,
        click.option(
            "--amount", type=click.FloatRange(0.0, 1.0), default=1.0, show_default=True, help="Of the emotion."
        ),
    ]


def done_by(place: str) -> Callable[[Callable[[], None]], Verb]:
    """Has a verb done by a function MODULE:NAME of this package, which is imported when the verb is called.

    Where the function leaves Ctrl-C to us, it is one line and an exit code.
    """
    module, name = place.split(":")

    def decorate(verb: Callable[[], None]) -> Verb:
        @wraps(verb)
        def begin(**given: object) -> int:
            with ended_on_the_spot():
                function: Verb = getattr(import_at_once(f"{__package__}.{module}"), name)
            try:
                return function(**given)
            except KeyboardInterrupt:
                click.echo(STOPPED_LINE, err=True)
                return STOPPED

        return begin

    return decorate


robot_option = click.option("--robot", default="upper22", show_default=True, help="Name, or a robot's TOML file.")
port_option = click.option("--port", "ports", multiple=True, metavar="NAME=PATH", help=PORT_HELP)


def planning(verb: Verb) -> Verb:
    """Adds the options that say how a document is planned."""

    @wraps(verb)
    def begin(*, robot: str, style: str, **given: object) -> int:
        options = {name: given.pop(name) for name in PlanningOptions.__annotations__}
        return verb(planning=Planning(robot, style, cast(PlanningOptions, options)), **given)

    return _decorated(
        begin,
        robot_option,
        click.option("--style", default="neutral", show_default=True, help=STYLE_HELP),
        *(_planning_option(name, offer) for name, offer in offers().items()),
    )


def _planning_option(name: str, offer: Offer) -> Decorator:
    kinds = {Path: click.Path(path_type=Path), float: click.FloatRange(0.0, offer.most), int: click.IntRange(0)}
    return click.option(
        offer.flag or f"--{name}",
        name,
        type=click.Choice(CHOICES[name]) if name in CHOICES else kinds.get(offer.kind, offer.kind),
        default=offer.default,
        multiple=offer.many,
        metavar=offer.metavar,
        show_default=offer.show_default,
        help=offer.help,
    )


def together(name: str, kind: "type[DataclassInstance]", *options: Decorator) -> Decorator:
    """Adds options to a verb, which gets their values as one; without any, those that stand beside its fields."""
    options = options or tuple(get_args(field.type)[-1] for field in fields(kind))

    def decorate(verb: Verb) -> Verb:
        @wraps(verb)
        def begin(**given: object) -> int:
            own = {field.name: given.pop(field.name) for field in fields(kind)}
            return verb(**given, **{name: kind(**own)})

        return _decorated(begin, *options)

    return decorate


def _decorated(verb: Verb, *options: Decorator) -> Verb:
    """Adds options in the order in which help lists them."""
    for option in reversed(options):
        verb = option(verb)
    return verb


def performers(on_help: str) -> Decorator:
    """Adds --on and --port."""
    return together(
        "performers",
        Performers,
        click.option("--on", "sinks", type=SinkNames(), default="twin", show_default=True, help=on_help),
        port_option,
    )


def robot_and_ports(verb: Verb) -> Verb:
    """Adds --robot and --port."""
    return robot_option(port_option(verb))


def output(out_help: str, force_help: str, json_help: str, *between: Decorator) -> Decorator:
    """Adds --out, --force and --json, and other options before the last."""
    return together(
        "output",
        Output,
        click.option("--out", type=click.Path(path_type=Path), help=out_help),
        click.option("--force", is_flag=True, help=force_help),
        *between,
        click.option("--json", "as_json", is_flag=True, help=json_help),
    )


twin_options = together("way", TwinOptions)
servo_options = together("servos", ServoOptions)
expression = together("expression", ExpressionOptions)
picture_file = together("picture", PictureFile)
