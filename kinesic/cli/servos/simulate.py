"""`kinesic servos simulate`: a robot's servos without the robot."""

import signal
import tempfile
from dataclasses import replace
from pathlib import Path
from threading import Event
from types import FrameType

import click

from kinesic.body.config import ConfigError
from kinesic.cli.options import read_twins
from kinesic.controller.virtual_robot import TwinPhysics
from kinesic.hardware.bus.real_time import request_real_time
from kinesic.hardware.protocol.registers import BAUD_RATES
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.virtual.faults import CALM, KINDS, FaultPlan
from kinesic.hardware.virtual.pty import PtyPort, serve_wires
from kinesic.hardware.virtual.wiring import build_bus, cables

PHYSICS = ("servo", "twin")
PRIORITY = 30  # above a supervisor on the same machine: servos are never late


@click.command(
    epilog="Each bus of the robot becomes a port that any Dynamixel program can open. FILE is TOML: a [[fault]] for "
    "each thing that goes wrong, with its kind and, where they matter, servos (ids), rate (0..1), start and seconds, "
    f"value, and way (reply or request). Kinds: {', '.join(KINDS)}."
)
@click.option("--robot", default="upper22", show_default=True, help="Name, or a robot's TOML file.")
@click.option(
    "--physics",
    type=click.Choice(PHYSICS),
    default="servo",
    show_default=True,
    help="What turns the shafts: each servo's motor for itself, or the robot's twin.",
)
@click.option("--twin", default="nominal", show_default=True, help="nominal, pessimistic, or a TOML of factors.")
@click.option("--faults", type=click.Path(path_type=Path, dir_okay=False), help="TOML of what goes wrong.")
@click.option("--baud", type=int, help="Baud rate of all servos, instead of the robot file's.")
@click.option("--folder", type=click.Path(path_type=Path, file_okay=False), help="Where the ports appear.")
def simulate(robot: str, physics: str, twin: str, faults: Path | None, baud: int | None, folder: Path | None) -> int:
    """Simulates a robot's servos behind pseudo-terminals, and prints their paths, until it is stopped."""
    if baud is not None and baud not in BAUD_RATES:
        raise ConfigError(f"--baud is {baud}, must be one of {', '.join(str(rate) for rate in BAUD_RATES)}")
    body = load_robot(robot)
    plan = CALM if faults is None else FaultPlan.read(faults)
    wires = [replace(cable, faults=plan, baud=baud or cable.baud) for cable in cables(body)]
    if not wires:
        raise ConfigError(f"{body.path}: no [[bus]], so there are no servos to simulate")
    try:
        _, buses = build_bus(
            wires, TwinPhysics(body, wires, factors=read_twins(twin)[0]) if physics == "twin" else None
        )
    except ValueError as error:
        raise ConfigError(f"--physics twin: {error}") from None
    request_real_time(PRIORITY)
    stopped = _stopped_by_signals()
    with tempfile.TemporaryDirectory(prefix="kinesic-servos-") as place:
        home = Path(place) if folder is None else folder
        home.mkdir(parents=True, exist_ok=True)
        ports = [PtyPort(bus, home / name) for name, bus in buses.items()]
        for wire, port in zip(wires, ports, strict=True):
            port.exchange(0.0)
            click.echo(f"{wire.name}: {port.link} at {wire.baud} baud, {len(wire.fittings)} servos")
        click.echo("Ctrl-C stops.", err=True)
        serve_wires(ports, lambda: not stopped.is_set())
    return 0


def _stopped_by_signals() -> Event:
    """Set when somebody wants this process to end."""
    stopped = Event()

    def stop(_number: int, _frame: FrameType | None) -> None:
        stopped.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    return stopped
