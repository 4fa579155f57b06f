"""Messages about learned servo factors and lost servo events."""

from collections.abc import Iterable
from pathlib import Path

import click

from kinesic.controller.learned_gains import Identification
from kinesic.hardware.supervisor.notes import Note


def print_learned_factors(identification: Identification, path: Path | None, *, to_stderr: bool) -> None:
    """Print learned servo factors and the option that reloads these factors."""
    click.echo(f"servos: {identification}", err=to_stderr)
    if path is not None:
        click.echo(f"to use it in the next performance: --learn {path}", err=to_stderr)


def warn_of_lost_events(notes: Iterable[Note]) -> None:
    """Print to standard error why servo events could not be logged."""
    for note in notes:
        if note.kind == "journal":
            click.echo(note.text, err=True)
