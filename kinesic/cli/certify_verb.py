"""Declaration of the verb `kinesic certify`.

The module that implements it is imported when it runs.
"""

from pathlib import Path

import click

from kinesic.cli.completion import ROBOT_NAME
from kinesic.cli.help_pages import VerbCommand
from kinesic.cli.options import force_option, implemented_by


@click.command("certify", cls=VerbCommand)
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--robot", type=ROBOT_NAME, default="upper22", show_default=True, help="Name or TOML file of the robot.")
@click.option("--check", is_flag=True, help="Only judge FILE: exit code 1 if it violates a limit.")
@click.option("--out", type=click.Path(path_type=Path), help="Nearest motion: .npz, .csv, .bvh, .bap, .json, .mcap.")
@force_option
@click.option("--json", "as_json", is_flag=True, help="Print all violations and distances as JSON.")
@implemented_by("certify:certify_file")
def certify_verb() -> None:
    """Certify the motion of FILE for a robot.

    FILE is captured motion (.bvh, .amc, .skm, .glb), joint angles (.csv, .npz, .mcap, .parquet), or a move of Reachy
    Mini or a joint trajectory (.json). Print the limits that it violates on the robot, with joint, time and ratio. Then
    search for the nearest motion that satisfies all limits, and print its distance from FILE.
    """
