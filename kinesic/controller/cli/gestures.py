"""`kinesic gestures`: what the lexicon offers."""

import json
from pathlib import Path

import click
from rich.table import Table

from kinesic.bml.block import BmlError
from kinesic.body.config import closest
from kinesic.controller.cli.console import console
from kinesic.expressivity.lexicon import Lexicon

lexicon_option = click.option("--lexicon", type=click.Path(path_type=Path), help="TOML, or Greta's gestuary XML.")


@click.group()
def gestures() -> None:
    """Lists and shows the gestures of the lexicon."""


@gestures.command("list")
@lexicon_option
@click.option("--json", "as_json", is_flag=True, help="Prints JSON.")
def list_gestures(lexicon: Path | None, as_json: bool) -> int:
    """Lists all gestures."""
    forms = sorted(Lexicon.load(lexicon).forms, key=lambda form: (form.category, form.id))
    if as_json:
        entries = [{"id": f.id, "category": f.category, "hands": sorted(f.sides), "keys": len(f.keys)} for f in forms]
        click.echo(json.dumps(entries, indent=1))
        return 0
    table = Table("gesture", "category", "hands", "keys", box=None)
    for form in forms:
        table.add_row(form.id, form.category, " ".join(sorted(form.sides)), str(len(form.keys)))
    console().print(table)
    return 0


@gestures.command()
@click.argument("lexeme")
@lexicon_option
def show(lexeme: str, lexicon: Path | None) -> int:
    """Shows what LEXEME becomes: the gesture or its substitute, key by key."""
    known = Lexicon.load(lexicon)
    match = known.find(lexeme)
    if match is None:
        raise BmlError(f"no gesture {lexeme}{closest(lexeme, [form.id for form in known.forms])}")
    click.echo(f"{match.form.id} ({match.form.category}){', ' + match.substitute if match.substitute else ''}")
    table = Table("key", "hand", "forward", "outward", "up", "palm", "openness", "touches", box=None)
    for number, key in enumerate(match.form.keys, start=1):
        for side, pose in sorted(key.hands.items()):
            position = [f"{value:.2f}" for value in pose.position]
            palm = "" if pose.palm is None else " ".join(f"{value:.1f}" for value in pose.palm)
            table.add_row(str(number), side, *position, palm, f"{pose.openness:.2f}", pose.touch or "")
    console().print(table)
    return 0
