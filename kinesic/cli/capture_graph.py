"""Verb `kinesic capture graph`: summary of the motion graph of a library."""

from collections import Counter
from pathlib import Path

import click
import numpy as np

from kinesic.body.config import ConfigError
from kinesic.capture.motion_graph import build_graph
from kinesic.cli.plain_words import printable
from kinesic.cli.progress import show_stages
from kinesic.expressivity.lexicon.gesture_collection import find_collections
from kinesic.expressivity.lexicon.lexicon import Lexicon

MAX_LISTED = 20  # largest number of separate gestures that are listed


def print_graph(folder: Path) -> int:
    """Print the size of a library's motion graph, and its separate gestures.

    Raises:
        ConfigError: the folder has no captured gestures.
    """
    with show_stages() as stage:
        stage("reading the gestures")
        captures = Lexicon.load(*find_collections(folder)).captured
        if not captures:
            raise ConfigError(f"{folder}: no captured gestures; `kinesic capture import` makes them")
        stage("comparing motions")
        graph = build_graph(captures)
        edges, connected = graph.edges, graph.connected
    phases = Counter(node.phase for node in graph.nodes)
    click.echo(f"{len(captures)} gestures, {', '.join(f'{count} {phase}' for phase, count in phases.items())} phases")
    click.echo(
        f"{len(edges)} transitions between {len(connected)} connected gestures, "
        f"at most {graph.threshold:.2f} arm lengths apart"
    )
    if len(captures) > 1:
        others = graph.transitions[~np.eye(len(captures), dtype=bool)]
        click.echo(f"from the end of a stroke to the start of another: median {np.median(others):.2f} arm lengths")
    separate = [capture.id for k, capture in enumerate(captures) if k not in connected]
    for id in separate[:MAX_LISTED]:
        click.echo(printable(f"separate: {id}"))
    if len(separate) > MAX_LISTED:
        click.echo(f"separate: {len(separate) - MAX_LISTED} more")
    return 0
