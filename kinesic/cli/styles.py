"""Verbs `kinesic styles`: list the styles and show the values of one."""

import json
from collections.abc import Iterable
from dataclasses import asdict

import click

from kinesic.bml.block import EXPRESSIVITY_RANGES
from kinesic.body.config import names_of
from kinesic.cli.screen.table import Table
from kinesic.cli.terminal import console, quote_text
from kinesic.expressivity.style.style import Style

Json = dict[str, object]


def list_styles(as_json: bool) -> int:
    """Print a table or a JSON list of the built-in styles."""
    styles = [Style.load(name) for name in names_of("style")]
    if as_json:
        click.echo(json.dumps([_as_json(style) for style in styles], indent=1))
        return 0
    table = Table("style", *EXPRESSIVITY_RANGES, "whole_body")
    for style in styles:
        numbers = [*asdict(style.gesture).values(), style.whole_body]
        table.add_row(style.name, *(f"{number:g}" for number in numbers))
    console().print(table)
    return 0


def show_style(style: str, settings: Iterable[str], as_json: bool) -> int:
    """Print all values of a style with units and effects."""
    shown = Style.load(style).changed(settings)
    if as_json:
        click.echo(json.dumps(_as_json(shown), indent=1))
        return 0
    table = Table("key", "value", "unit", "effect")
    for parameter in shown.parameters:
        value = parameter.value if isinstance(parameter.value, str) else f"{parameter.value:g}"
        table.add_row(*map(quote_text, (parameter.key, value, parameter.unit, parameter.effect)))
    console().print(table)
    return 0


def _as_json(style: Style) -> Json:
    return {"name": style.name, "parameters": [asdict(parameter) for parameter in style.parameters]}
