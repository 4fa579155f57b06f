"""`kinesic servos`: its verbs with their options; a file per verb, imported when it is to be done, does it."""

from pathlib import Path

import click

from kinesic.cli.options import done_by, robot_and_ports, robot_option
from kinesic.hardware.virtual.faults import KINDS

ROBOT_HELP = "Whose hinges the ids are: a name, or a TOML file."
PHYSICS_HELP = "What turns the shafts: each servo's motor for itself, or the robot's twin."


@click.group("servos")
def servo_verbs() -> None:
    """Finds, shows, calibrates, stops, releases and simulates servos on wires."""


@servo_verbs.command("calibrate")
@robot_and_ports
@click.option("--yes", is_flag=True, help="Does not ask: the robot stands at zero now.")
@click.option("--seconds", type=click.FloatRange(min=0.0), help="How long to look at most (default: until Enter).")
@done_by("servos.calibrate:calibrate_robot")
def _calibrate_robot() -> None:
    """Writes ROBOT.calibration.toml, after every hinge was moved by hand. No servo gets torque."""


@servo_verbs.command("doctor")
@robot_and_ports
@done_by("doctor:examine_servos")
def _examine_servos() -> None:
    """Checks ports, permissions, latency, supply and every servo; prints the line that mends what is wrong."""


@servo_verbs.command("release")
@robot_and_ports
@click.option("--yes", is_flag=True, help="Does not ask whether somebody holds the robot.")
@done_by("servos.release:release_robot")
def _release_robot() -> None:
    """Takes the torque of every servo, and looks that it is gone. The robot goes limp: hold its arms."""


@servo_verbs.command("scan")
@click.option("--robot", default="upper22", show_default=True, help=ROBOT_HELP)
@click.option("--port", "ports", multiple=True, metavar="PATH", help="Port; all USB serial ports if not given.")
@click.option("--baud", "bauds", multiple=True, type=int, help="Baud rate to try; all if not given.")
@click.option("--thorough", is_flag=True, help="Asks every id one by one, too: slow, but finds shared ids.")
@click.option("--json", "as_json", is_flag=True, help="Prints what was found as JSON.")
@done_by("servos.scan:scan_ports")
def _scan_ports() -> None:
    """Looks for servos at every baud rate; nothing is changed."""


@servo_verbs.command("show")
@robot_and_ports
@click.option("--json", "as_json", is_flag=True, help="Prints the table as JSON.")
@done_by("servos.show:show_servos")
def _show_servos() -> None:
    """Shows every servo, and what in it differs from what the robot's file wants; nothing is changed."""


@servo_verbs.command(
    "simulate",
    epilog="Each bus of the robot becomes a port that any Dynamixel program can open. FILE is TOML: a [[fault]] for "
    "each thing that goes wrong, with its kind and, where they matter, servos (ids), rate (0..1), start and seconds, "
    f"value, and way (reply or request). Kinds: {', '.join(KINDS)}.",
)
@robot_option
@click.option("--physics", type=click.Choice(("servo", "twin")), default="servo", show_default=True, help=PHYSICS_HELP)
@click.option("--twin", default="nominal", show_default=True, help="nominal, pessimistic, or a TOML of factors.")
@click.option("--faults", type=click.Path(path_type=Path, dir_okay=False), help="TOML of what goes wrong.")
@click.option("--baud", type=int, help="Baud rate of all servos, instead of the robot file's.")
@click.option("--folder", type=click.Path(path_type=Path, file_okay=False), help="Where the ports appear.")
@done_by("servos.simulate:simulate_servos")
def _simulate_servos() -> None:
    """Simulates a robot's servos behind pseudo-terminals, and prints their paths, until it is stopped."""


@servo_verbs.command("stop")
@done_by("servos.stop:stop_robots")
def _stop_robots() -> None:
    """Stops every robot that you drive from this machine, at once: it holds where it is, with torque."""
