"""`kinesic servos`: servos on wires, one file per verb."""

import click

from kinesic.controller.cli.servos.calibrate import calibrate
from kinesic.controller.cli.servos.doctor import doctor
from kinesic.controller.cli.servos.release import release
from kinesic.controller.cli.servos.scan import scan
from kinesic.controller.cli.servos.show import show
from kinesic.controller.cli.servos.simulate import simulate


@click.group()
def servos() -> None:
    """Finds, shows, calibrates, releases and simulates servos on wires."""


for verb in (scan, show, calibrate, release, doctor, simulate):
    servos.add_command(verb)
