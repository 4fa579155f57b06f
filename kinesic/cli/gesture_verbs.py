"""Declarations of the verbs `kinesic gestures`."""

from pathlib import Path

import click

from kinesic.cli.completion import GESTURE_NAME, ROBOT_NAME
from kinesic.cli.help_pages import VerbGroup
from kinesic.cli.option_values import GesturePicture
from kinesic.cli.options import force_option, group_options, implemented_by

lexicon_option = click.option(
    "--lexicon", type=click.Path(path_type=Path), help="Gestures: TOML, a folder of TOML, or Greta's XML."
)
gesture_robot_option = click.option(
    "--robot", type=ROBOT_NAME, default="upper22", show_default=True, help="Robot that performs the gestures."
)


@click.group("gestures", cls=VerbGroup)
def gesture_verbs() -> None:
    """List, find, show and draw the gestures of the lexicon."""


@gesture_verbs.command("list")
@lexicon_option
@gesture_robot_option
@click.option("--category", help="List only this category.")
@click.option("--json", "as_json", is_flag=True, help="Print a JSON vocabulary for a planner or a language model.")
@implemented_by("gestures:list_gestures")
def _list_gestures() -> None:
    """List all gestures."""


@gesture_verbs.command("find")
@click.argument("words", nargs=-1, required=True)
@click.option("--count", type=click.IntRange(1), default=10, show_default=True, help="Largest number of gestures.")
@click.option("--category", default="", help="Find only gestures of this category.")
@lexicon_option
@click.option("--json", "as_json", is_flag=True, help="Print the gestures as JSON.")
@implemented_by("gesture_search:search_gestures")
def _find_gestures() -> None:
    """Find gestures by WORDS for their meaning or movement, the best first.

    Names, synonyms, meanings, descriptions and touched body parts are searched, for example: kinesic gestures find hand
    to the temple.
    """


@gesture_verbs.command("show")
@click.argument("lexeme", type=GESTURE_NAME)
@lexicon_option
@implemented_by("gestures:show_gesture")
def _show_gesture() -> None:
    """Show the key postures of gesture LEXEME or of its substitute."""


@gesture_verbs.command("render")
@click.argument("lexeme", type=GESTURE_NAME, required=False)
@click.option("--all", "all_gestures", is_flag=True, help="Draw a contact sheet of all gestures, as lines.")
@group_options(
    "picture",
    GesturePicture,
    click.option("--turntable", is_flag=True, help="Film the stroke posture from all sides: X.webp or X.mp4."),
    click.option("--drawn", is_flag=True, help="Draw lines, as for X.svg and X.pdf, or without OpenGL."),
    click.option("--out", required=True, type=click.Path(path_type=Path), help="Picture or film, such as X.png."),
    force_option,
)
@lexicon_option
@gesture_robot_option
@implemented_by("gestures:render_gestures")
def _render_gestures() -> None:
    """Draw gesture LEXEME as key postures or turntable, or all gestures."""


library_option = click.option(
    "--library",
    type=click.Path(path_type=Path),
    default="gestures",
    show_default=True,
    help="Folder of installed gestures.",
)


@gesture_verbs.command("install")
@click.argument("source", type=click.Path(path_type=Path))
@library_option
@force_option
@implemented_by("gesture_sharing:install_gestures")
def _install_gestures() -> None:
    """Install a collection of gestures from SOURCE, a folder or .zip.

    The collection needs a card.toml with name, licence and source. All gestures are read before anything is installed.
    """


@gesture_verbs.command("remove")
@click.argument("name")
@library_option
@implemented_by("gesture_sharing:remove_gestures")
def _remove_gestures() -> None:
    """Remove the installed collection NAME."""
