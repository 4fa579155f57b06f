"""Verb `kinesic gestures find`: search for gestures by words.

It imports less than the other verbs of gestures, so that it answers sooner.
"""

import json
from dataclasses import asdict
from pathlib import Path

import click

from kinesic.bml.block import BmlError
from kinesic.body.config import ConfigError, suggestion
from kinesic.cli.screen.table import Table
from kinesic.cli.terminal import console, quote_text
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.names import shorten_name
from kinesic.expressivity.lexicon.search import find_gestures


def search_gestures(words: tuple[str, ...], count: int, category: str, lexicon: Path | None, as_json: bool) -> int:
    """Print the gestures that match some words, the best first."""
    lexicon_data, query = Lexicon.load(lexicon), " ".join(words)
    check_category(category or None, sorted({entry.category for entry in lexicon_data.entries}))
    hits = find_gestures(lexicon_data, query, category=category, count=count)
    if as_json:
        click.echo(json.dumps([asdict(hit) for hit in hits], indent=1))
        return 0
    if not hits:
        where = f" in category {category}" if category else ""
        raise BmlError(
            f"no gesture{where} for {shorten_name(query)!r}; try other words, or list all: kinesic gestures list"
        )
    table = Table("gesture", "category", "match", "score", "description")
    for hit in hits:
        cells = (hit.id, hit.category, hit.kind, f"{hit.score:.2f}", hit.says)
        table.add_row(*map(quote_text, cells))
    console().print(table)
    return 0


def check_category(category: str | None, categories: list[str]) -> None:
    """Refuse an unknown gesture category.

    Raises:
        ConfigError: no gesture has it; the message names all.
    """
    if category is not None and category not in categories:
        raise ConfigError(
            f"no category {category}{suggestion(category, categories)}; there are {', '.join(categories)}"
        )
