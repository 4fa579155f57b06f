"""Declarations of the verbs `kinesic styles`."""

import click

from kinesic.cli.completion import STYLE_NAME
from kinesic.cli.help_pages import VerbGroup
from kinesic.cli.options import implemented_by


@click.group("styles", cls=VerbGroup)
def style_verbs() -> None:
    """List the styles, and show the values of one."""


@style_verbs.command("list")
@click.option("--json", "as_json", is_flag=True, help="Print a JSON list of the styles with their values.")
@implemented_by("styles:list_styles")
def _list_styles() -> None:
    """List the built-in styles with their gesture parameters."""


@style_verbs.command("show")
@click.argument("style", type=STYLE_NAME)
@click.option("--set", "settings", multiple=True, metavar="NAME=VALUE", help="Change a parameter first. Repeatable.")
@click.option("--json", "as_json", is_flag=True, help="Print the values as JSON.")
@implemented_by("styles:show_style")
def _show_style() -> None:
    """Show all values of STYLE (name or file) with units and effects.

    Keys are those of the style's file; those before `standing` are also names for --set. A modality (head, torso, face)
    is listed only where it differs from gestures.
    """
