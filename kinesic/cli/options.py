"""Command-line options used by several verbs.

Options that belong together are passed to a verb as one dataclass. The module is quick to import.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast, get_args

import click

from kinesic.bml.block import BmlError
from kinesic.body.choices import InvertedTerms
from kinesic.body.config import names_of
from kinesic.cli.completion import ROBOT_NAME, STYLE_NAME
from kinesic.cli.ending_signals import INTERRUPTED_EXIT_CODE, INTERRUPTED_MESSAGE, exit_at_once_on_interrupt
from kinesic.cli.help_pages import SharedOption
from kinesic.host import HostFeature
from kinesic.importing import import_at_once
from kinesic.session.builtin_documents import locate_document, suggest_document
from kinesic.session.options import OPTION_CHOICES, CliOption, PlanningOptions, list_cli_options

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from kinesic.planning.setup import Setup

SINK_NAMES = ("twin", "servos", "face")
FAULT_EXIT_CODE = 3  # exit code after a robot or servo fault
SHEET_PICTURE_SIDE = 176  # [pixels] side of each picture on a contact sheet of faces
STRIP_PICTURE_SIDE = 192  # [pixels] side of each picture in a film strip
DEFAULT_PICTURE_SIDE = 512  # [pixels] default side of single pictures of the face

STYLE_HELP = f"Style, unless a document sets another: {', '.join(names_of('style'))}, or a TOML file."
FORCE_HELP = "Replace a folder made by kinesic."
TWIN_HELP = (
    "Servos of the twin: nominal, pessimistic, both (checks of the nominal twin, errors of both), "
    "or a TOML file of factors."
)
LEARN_HELP = (
    "FILE of learned servo factors (P gain, delay): the feed-forward uses it, and newly learned factors are written "
    "to it. 'none': the feed-forward uses the data sheets, and nothing is learned. Default: the file of --twin."
)
TERMS_HELP = "Inverted terms of the servo model in the feed-forward: all, the velocity lag, or none."
CORRECTION_HELP = "Correct the setpoints by the positions that the twin measures."
PORT_HELP = "Port of a bus: NAME=PATH, or PATH if the robot has one bus. Repeatable."
AU_HELP = "FACS action units with intensities: 1=0.8,2=0.8; L or R before a unit moves only that side."
EMOTION_HELP = "Emotion or BML lexeme, such as joy, surprise or RAISE_BROWS."

Verb = Callable[..., int]
Decorator = Callable[[Verb], Verb]


def read_input(file: str) -> bytes:
    """Read a file, built-in document, or standard input for `-`.

    Raises:
        BmlError: the file does not exist or cannot be read.
    """
    if file == "-":
        return sys.stdin.buffer.read()
    try:
        return locate_document(file).read_bytes()
    except FileNotFoundError as error:
        raise BmlError(f"{file}: {error.strerror}{suggest_document(file)}") from None
    except OSError as error:
        raise BmlError(f"{file}: {error.strerror}") from None


class SinkNames(click.ParamType[frozenset[str]]):
    """Parameter type for comma-separated outputs, such as `servos,face`."""

    name = "sinks"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> frozenset[str]:
        """Parse and check the names of the outputs."""
        names = frozenset(str(value).split(","))
        if names - set(SINK_NAMES):
            self.fail(
                f"{value!r} is not one of {', '.join(SINK_NAMES)}, nor several of them separated by commas", param, ctx
            )
        return names


@dataclass(frozen=True)
class Planning:
    """Robot, style and options of planning, picklable for worker processes."""

    robot: str
    style: str
    options: PlanningOptions

    def set_up(self) -> "Setup":
        """Load robot, style and files that the planning options name.

        Raises:
            ConfigError: a file is missing or an option is invalid.
        """
        from kinesic.session.mapping_check import describe_mapping_doubt  # noqa: PLC0415 - after help
        from kinesic.session.setup import set_up  # noqa: PLC0415 - slow to import, and unused by help

        setup = set_up(self.robot, style=self.style, **self.options)
        if (doubt := describe_mapping_doubt(setup.robot)) is not None:
            click.echo(f"kinesic: robot {setup.robot.name}: {doubt}", err=True)
        return setup


@dataclass(frozen=True)
class Performers:
    """Outputs of a performance (twin, servos, face), and servo ports."""

    sinks: frozenset[str]
    ports: tuple[str, ...]


@dataclass(frozen=True)
class ServoOptions:
    """Servo model of the twin, and file of learned servo parameters."""

    twin: Annotated[str | None, click.option("--twin", metavar="NAME|FILE", help=TWIN_HELP)]
    learn: Annotated[str | None, click.option("--learn", metavar="FILE", help=LEARN_HELP)]


@dataclass(frozen=True)
class TwinOptions(ServoOptions):
    """Options for performing in the twin."""

    feedforward: Annotated[
        InvertedTerms,
        click.option(
            "--feedforward",
            type=click.Choice(get_args(InvertedTerms)),
            default="full",
            show_default=True,
            help=TERMS_HELP,
        ),
    ]
    correction: Annotated[
        bool,
        click.option("--correction/--no-correction", default=True, help=CORRECTION_HELP),
    ]


@dataclass(frozen=True)
class Output:
    """Output folder, and whether results go to standard output as JSON."""

    out: Path | None
    force: bool
    as_json: bool


force_option = click.option("--force", is_flag=True, help="Replace an existing file.")


@dataclass(frozen=True)
class PictureFile:
    """Output file of a picture or film, or None for a window."""

    out: Annotated[
        Path | None,
        click.option(
            "--out",
            type=click.Path(path_type=Path),
            help="X.png for a picture, X.webp or X.mp4 for a film (default: a window).",
        ),
    ]
    force: Annotated[bool, force_option]


@dataclass(frozen=True)
class ExpressionOptions:
    """Facial expression as action units, an emotion, or both."""

    units: Annotated[str, click.option("--au", "units", default="", metavar="N=X,...", help=AU_HELP)]
    emotion: Annotated[str | None, click.option("--emotion", metavar="NAME", help=EMOTION_HELP)]
    amount: Annotated[
        float,
        click.option(
            "--amount",
            type=click.FloatRange(0.0, 1.0),
            default=1.0,
            show_default=True,
            help="Intensity of the emotion.",
        ),
    ]


def implemented_by(place: str, *, needs: HostFeature | None = None) -> Callable[[Callable[[], None]], Verb]:
    """Make a verb that imports its function MODULE:NAME only when called.

    The module belongs to this package. If the function does not handle Ctrl-C itself, an interrupt ends in one line and
    an exit code.

    Args:
        place: MODULE:NAME.
        needs: feature of the operating system without which the verb is refused.
    """
    module, name = place.split(":")

    def decorate(verb: Callable[[], None]) -> Verb:
        @wraps(verb)
        def run(**arguments: object) -> int:
            if needs is not None:
                needs.require()
            with exit_at_once_on_interrupt():
                function: Verb = getattr(import_at_once(f"{__package__}.{module}"), name)
            try:
                return function(**arguments)
            except KeyboardInterrupt:
                click.echo(INTERRUPTED_MESSAGE, err=True)
                return INTERRUPTED_EXIT_CODE

        return run

    return decorate


robot_option = click.option(
    "--robot", type=ROBOT_NAME, default="upper22", show_default=True, help="Name or TOML file of the robot."
)
port_option = click.option("--port", "ports", multiple=True, metavar="NAME=PATH", help=PORT_HELP)


def planning_options(verb: Verb) -> Verb:
    """Add the planning options, passed to the verb as `planning`."""

    @wraps(verb)
    def run(*, robot: str, style: str, **arguments: object) -> int:
        options = {name: arguments.pop(name) for name in PlanningOptions.__annotations__}
        return verb(planning=Planning(robot, style, cast(PlanningOptions, options)), **arguments)

    return _add_options(
        run,
        robot_option,
        click.option("--style", type=STYLE_NAME, default="neutral", show_default=True, help=STYLE_HELP),
        *(_make_planning_option(name, option) for name, option in list_cli_options().items()),
    )


def _make_planning_option(name: str, option: CliOption) -> Decorator:
    click_types = {Path: click.Path(path_type=Path), float: click.FloatRange(0.0, option.most), int: click.IntRange(0)}
    return click.option(
        option.flag or f"--{name}",
        name,
        cls=SharedOption,
        type=click.Choice(OPTION_CHOICES[name])
        if name in OPTION_CHOICES
        else click_types.get(option.kind, option.kind),
        default=option.default,
        multiple=option.many,
        metavar=option.metavar,
        show_default=option.show_default,
        help=option.help,
    )


def group_options(name: str, kind: "type[DataclassInstance]", *options: Decorator) -> Decorator:
    """Add options to a verb, which receives their values as one dataclass.

    Without explicit options, those in the annotations of the dataclass fields are added.
    """
    options = options or tuple(get_args(field.type)[-1] for field in fields(kind))

    def decorate(verb: Verb) -> Verb:
        @wraps(verb)
        def run(**arguments: object) -> int:
            values = {field.name: arguments.pop(field.name) for field in fields(kind)}
            return verb(**arguments, **{name: kind(**values)})

        return _add_options(run, *options)

    return decorate


def _add_options(verb: Verb, *options: Decorator) -> Verb:
    """Add options to a verb in the order of its help page."""
    for option in reversed(options):
        verb = option(verb)
    return verb


def performer_options(on_help: str) -> Decorator:
    """Add --on and --port, passed to the verb as `performers`."""
    return group_options(
        "performers",
        Performers,
        click.option("--on", "sinks", type=SinkNames(), default="twin", show_default=True, help=on_help),
        port_option,
    )


def robot_and_port_options(verb: Verb) -> Verb:
    """Add --robot and --port."""
    return robot_option(port_option(verb))


def output_options(out_help: str, force_help: str, json_help: str, *more_options: Decorator) -> Decorator:
    """Add --out, --force, further options and --json to a verb."""
    return group_options(
        "output",
        Output,
        click.option("--out", type=click.Path(path_type=Path), help=out_help),
        click.option("--force", is_flag=True, help=force_help),
        *more_options,
        click.option("--json", "as_json", is_flag=True, help=json_help),
    )


twin_options = group_options("twin_options", TwinOptions)
servo_options = group_options("servos", ServoOptions)
expression_options = group_options("expression", ExpressionOptions)
picture_options = group_options("picture", PictureFile)
