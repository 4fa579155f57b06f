"""Declarations of the verbs `kinesic servos`.

The module that implements a verb is imported when the verb runs.
"""

from pathlib import Path

import click

from kinesic.cli.completion import ROBOT_NAME
from kinesic.cli.help_pages import VerbGroup
from kinesic.cli.option_values import ShaftPhysics
from kinesic.cli.options import group_options, implemented_by, robot_and_port_options, robot_option
from kinesic.hardware.protocol.packet import MAX_ID
from kinesic.hardware.virtual.faults import FAULT_KINDS
from kinesic.host import SERVO_DRIVER, VIRTUAL_PORTS

PORT_OPTION = click.option(
    "--port", type=click.Path(path_type=Path, dir_okay=False), required=True, help="Port of the servo."
)
ID_OPTION = click.option(
    "--id", "servo", type=click.IntRange(0, MAX_ID), default=1, show_default=True, help="Id of the servo."
)
BAUD_OPTION = click.option("--baud", type=int, default=57_600, show_default=True, help="Current baud rate.")
ROBOT_HELP = "Robot whose hinges are listed with the ids: name or TOML file."
PHYSICS_HELP = "Physics of the shafts: each servo's motor alone, or the robot's twin."


@click.group("servos", cls=VerbGroup)
def servo_verbs() -> None:
    """Find, calibrate, record, stop, release and simulate servos."""


@servo_verbs.command(
    "accept",
    epilog="SOURCE is the report's folder of a performance with --near and --on servos. A file that this verb has "
    "written is compared with the robot instead: it expires with new limbs, gains, servos or firmware.",
)
@click.argument("source", type=click.Path(path_type=Path))
@robot_and_port_options
@click.option("--person", default="", help="Name of the person who measures (default: ask).")
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    default="acceptance.json",
    show_default=True,
    help="JSON file to write.",
)
@click.option("--force", is_flag=True, help="Replace an existing file.")
@implemented_by("servos.accept:accept_robot", needs=SERVO_DRIVER)
def _accept_robot() -> None:
    """Compare a robot with its model by an acceptance test near people.

    You measure masses, forces and distances. The test is not safety-rated and replaces no risk assessment.
    """


@servo_verbs.command("calibrate")
@robot_and_port_options
@click.option("--yes", is_flag=True, help="Do not ask; the robot is in its zero posture now.")
@click.option("--seconds", type=click.FloatRange(min=0.0), help="Maximum duration in s (default: until Enter).")
@click.option("--lerobot", multiple=True, metavar="NAME=FILE", help="Convert lerobot's JSON file of a bus. Repeatable.")
@click.option(
    "--pypot", type=click.Path(dir_okay=False, path_type=Path), help="Convert the configuration (JSON) of a Poppy."
)
@implemented_by("servos.calibrate:calibrate_robot", needs=SERVO_DRIVER)
def _calibrate_robot() -> None:
    """Write ROBOT.calibration.toml while you move every hinge by hand.

    No servo gets torque. With --lerobot or --pypot, the calibration comes from files, and no servo is needed.
    """


@servo_verbs.command("doctor")
@robot_and_port_options
@implemented_by("doctor:examine_servos", needs=SERVO_DRIVER)
def _examine_servos() -> None:
    """Check ports, permissions, latency, supply and servos, and print remedies."""


@servo_verbs.command("record")
@robot_and_port_options
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), required=True, help="CSV file to write.")
@click.option("--seconds", type=click.FloatRange(min=0.1), help="Duration in s (default: until Enter).")
@click.option("--force", is_flag=True, help="Replace an existing file.")
@implemented_by("servos.record:record_hands", needs=SERVO_DRIVER)
def _record_hands() -> None:
    """Record the joint angles of a robot that you move by hand.

    No servo gets torque. `kinesic certify` and `kinesic perform` read the file.
    """


@servo_verbs.command("release")
@robot_and_port_options
@click.option("--yes", is_flag=True, help="Do not ask whether somebody holds the robot.")
@implemented_by("servos.release:release_robot", needs=SERVO_DRIVER)
def _release_robot() -> None:
    """Switch the torque of every servo off and verify it.

    The robot's arms fall: hold them.
    """


@servo_verbs.command("scan")
@click.option("--robot", type=ROBOT_NAME, default="upper22", show_default=True, help=ROBOT_HELP)
@click.option(
    "--port", "ports", multiple=True, metavar="PATH", help="Port to scan (default: all USB serial ports). Repeatable."
)
@click.option("--baud", "bauds", multiple=True, type=int, help="Baud rate to try (default: all). Repeatable.")
@click.option("--thorough", is_flag=True, help="Also ping every id one by one: slow, but finds shared ids.")
@click.option("--json", "as_json", is_flag=True, help="Print the servos as JSON.")
@implemented_by("servos.scan:scan_ports", needs=SERVO_DRIVER)
def _scan_ports() -> None:
    """Search for servos at every baud rate without changing them."""


@servo_verbs.command("set-baud")
@PORT_OPTION
@ID_OPTION
@BAUD_OPTION
@click.option("--to", "new", type=int, required=True, help="New baud rate.")
@implemented_by("servos.setup:change_baud", needs=SERVO_DRIVER)
def _change_baud() -> None:
    """Change and verify the baud rate of one servo of any family."""


@servo_verbs.command("set-id")
@PORT_OPTION
@ID_OPTION
@BAUD_OPTION
@click.option("--to", "new", type=click.IntRange(0, MAX_ID), required=True, help="New id.")
@implemented_by("servos.setup:change_id", needs=SERVO_DRIVER)
def _change_id() -> None:
    """Change the id of one servo of any family, and verify it.

    Connect one servo at a time: two with the same id cannot be told apart.
    """


@servo_verbs.command("reboot")
@PORT_OPTION
@ID_OPTION
@BAUD_OPTION
@implemented_by("servos.setup:restart_servo", needs=SERVO_DRIVER)
def _restart_servo() -> None:
    """Restart one servo without torque, which clears its error."""


@servo_verbs.command("show")
@robot_and_port_options
@click.option("--json", "as_json", is_flag=True, help="Print the table as JSON.")
@implemented_by("servos.show:show_servos", needs=SERVO_DRIVER)
def _show_servos() -> None:
    """Show every servo and its differences from the robot file.

    Nothing is changed.
    """


@servo_verbs.command(
    "simulate",
    epilog="Each bus of the robot becomes a port that any Dynamixel program can open. FILE is TOML with a "
    "[[fault]] for each fault: its kind and, if applicable, servos (ids), rate (0..1), start and seconds, value, "
    f"and way (reply or request). Kinds: {', '.join(FAULT_KINDS)}.",
)
@robot_option
@group_options(
    "shafts",
    ShaftPhysics,
    click.option(
        "--physics", type=click.Choice(("servo", "twin")), default="servo", show_default=True, help=PHYSICS_HELP
    ),
    click.option(
        "--twin",
        default="nominal",
        show_default=True,
        help="Servos of the twin: nominal, pessimistic, or a TOML file of factors.",
    ),
)
@click.option("--faults", type=click.Path(path_type=Path, dir_okay=False), help="TOML file of faults.")
@click.option("--baud", type=int, help="Baud rate of all servos (default: as in the robot file).")
@click.option(
    "--folder",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder of the ports (default: a temporary folder).",
)
@click.option(
    "--by-hand",
    is_flag=True,
    help="Start in the zero posture; Enter turns every hinge through its range, as a person does for calibrate.",
)
@implemented_by("servos.simulate:simulate_servos", needs=VIRTUAL_PORTS)
def _simulate_servos() -> None:
    """Simulate a robot's servos behind pseudo-terminals until stopped.

    The paths of the pseudo-terminals are printed.
    """


@servo_verbs.command("stop")
@implemented_by("servos.stop:stop_robots", needs=SERVO_DRIVER)
def _stop_robots() -> None:
    """Stop all robots that you drive from this machine at once.

    The servos keep their torque and hold their positions.
    """
