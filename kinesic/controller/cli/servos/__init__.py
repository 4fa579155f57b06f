"""`kinesic servos`: servos on wires, one file per verb."""

import click

from kinesic.controller.cli.verbs import Verbs


@click.group(cls=Verbs)
def servos() -> None:
    """Finds, shows, calibrates, releases and simulates servos on wires."""


servos.offer(__name__, "scan", "show", "calibrate", "release", "doctor", "simulate")
