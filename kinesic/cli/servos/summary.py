"""What servos have told of themselves, and what their journal could not keep, in words."""

from collections.abc import Iterable
from pathlib import Path

import click

from kinesic.controller.learned_gains import Lesson
from kinesic.hardware.supervisor.channel import Note


def print_lesson(lesson: Lesson, path: Path | None, *, on_error: bool) -> None:
    """Prints what servos have told of themselves, and where it stands for the next performance."""
    click.echo(f"servos: {lesson}", err=on_error)
    if path is not None:
        click.echo(f"the next performance leads by it: --learn {path}", err=on_error)


def warn_of_lost_events(notes: Iterable[Note]) -> None:
    """Prints to standard error why events of the servos are not kept, where that is so."""
    for note in notes:
        if note.kind == "journal":
            click.echo(note.text, err=True)
