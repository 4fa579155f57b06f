"""`kinesic servos`: servos on wires, one file per verb."""

import click

from kinesic.cli.lazy_group import Verbs


@click.group(cls=Verbs)
def servos() -> None:
    """Finds, shows, calibrates, releases and simulates servos on wires."""


servos.offer(
    __name__,
    calibrate="Writes ROBOT.calibration.toml, after every hinge was moved by hand.",
    doctor="Checks ports, permissions, latency, supply and every servo; prints the line that mends what is wrong.",
    release="Takes the torque of every servo, and looks that it is gone.",
    scan="Looks for servos at every baud rate; nothing is changed.",
    show="Shows every servo, and what in it differs from what the robot's file wants; nothing is changed.",
    simulate="Simulates a robot's servos behind pseudo-terminals, and prints their paths, until it is stopped.",
)
