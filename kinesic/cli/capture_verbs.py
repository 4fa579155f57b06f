"""Declarations of the verbs `kinesic capture`."""

from pathlib import Path

import click

from kinesic.cli.help_pages import VerbGroup
from kinesic.cli.options import force_option, implemented_by


@click.group("capture", cls=VerbGroup)
def capture_verbs() -> None:
    """Import captured motion as gestures."""


@capture_verbs.command("import")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder of the gestures.")
@click.option("--licence", default="", help="Licence of the clips (default: first line of a licence file).")
@click.option("--source", default="", help="Origin of the clips (default: their path).")
@force_option
@implemented_by("capture:import_clips")
def _import_clips() -> None:
    """Import all clips of FOLDER as gestures of the lexicon.

    Clips are captured motion of a body (.skm, .bvh, .amc, .glb, .npz), with or without markers. `--lexicon` and
    `--library` of all verbs take the new folder.
    """


@capture_verbs.command("graph")
@click.argument("folder", type=click.Path(path_type=Path))
@implemented_by("capture_graph:print_graph")
def _print_graph() -> None:
    """Print how well the captured gestures of FOLDER follow each other.

    FOLDER is a library of imported or installed gestures. Gestures that no other gesture joins smoothly are listed.
    """
