"""Declaration of the verb `kinesic export`.

The module that implements it is imported when it runs.
"""

from pathlib import Path

import click

from kinesic.cli.completion import DOCUMENT_NAME
from kinesic.cli.help_pages import VerbCommand
from kinesic.cli.options import force_option, implemented_by, planning_options


@click.command("export", cls=VerbCommand)
@click.argument("file", type=DOCUMENT_NAME)
@planning_options
@click.option(
    "--to",
    "kind",
    required=True,
    type=click.Choice(["mcap", "rerun"]),
    help="mcap: for Foxglove (extra mcap); rerun: for the Rerun viewer (extra rerun).",
)
@click.option("--performed", is_flag=True, help="Also perform FILE in the twin, and export its measured joint states.")
@click.option(
    "--out", type=click.Path(path_type=Path), help="X.mcap or X.rrd (default: the name of FILE, in this folder)."
)
@force_option
@implemented_by("export:export_motion")
def export_verb() -> None:
    """Export the motion of FILE for the viewers Foxglove and Rerun.

    FILE is as in `kinesic plan`. The recording has joint states, transforms, surfaces, words and sync points.
    """
