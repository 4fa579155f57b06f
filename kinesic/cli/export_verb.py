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
    type=click.Choice(["mcap", "rerun", "lerobot", "ros", "json", "csv", "npz", "bvh"]),
    help="mcap: for Foxglove (extra mcap); rerun: for the Rerun viewer (extra rerun); lerobot: a dataset folder (extra "
    "store); ros, json: ROS joint trajectory as MCAP or JSON; csv, npz: joint angles; bvh: for animation programs.",
)
@click.option("--performed", is_flag=True, help="Also perform FILE in the twin, and export its measured joint states.")
@click.option(
    "--out", type=click.Path(path_type=Path), help="File to write (default: the name of FILE, in this folder)."
)
@force_option
@implemented_by("export:export_motion")
def export_verb() -> None:
    """Export the motion of FILE for viewers, ROS and animation.

    FILE is as in `kinesic plan`. Recordings (mcap, rerun) have joint states, transforms, surfaces, words and sync
    points. Other files have the angles of all joints; those of an imported robot have the names and zeros of its file.
    """
