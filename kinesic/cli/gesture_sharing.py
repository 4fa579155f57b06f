"""Verbs `kinesic gestures install` and `remove`: shared collections of gestures."""

from pathlib import Path

import click

from kinesic.cli.plain_words import printable
from kinesic.expressivity.lexicon.gesture_collection import install_collection, remove_collection


def install_gestures(source: Path, library: Path, force: bool) -> int:
    """Install a collection of gestures, and print its card.

    Raises:
        ConfigError: the collection is hostile or invalid, or exists already.
    """
    folder, card, count = install_collection(source, library, force=force)
    click.echo(printable(f"{card.name}: {count} gestures, licence {card.licence}, from {card.source}"))
    if card.description:
        click.echo(printable(card.description))
    click.echo(f"gestures: {folder}")
    return 0


def remove_gestures(name: str, library: Path) -> int:
    """Remove an installed collection of gestures.

    Raises:
        ConfigError: there is no such collection, or its folder is not kinesic's own.
    """
    click.echo(f"removed: {remove_collection(name, library)}")
    return 0
