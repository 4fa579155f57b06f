"""`kinesic servos simulate`: a robot's servos without the robot."""

import signal
import tempfile
from dataclasses import replace
from pathlib import Path
from threading import Event
from types import FrameType

import click

from kinesic.body.config import ConfigError
from kinesic.controller.virtual_robot import TwinPhysics
from kinesic.files.held_folder import name_failures
from kinesic.hardware.bus.host import request_real_time
from kinesic.hardware.protocol.registers import BAUD_RATES
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.virtual.faults import CALM, FaultPlan
from kinesic.hardware.virtual.pty import PtyPort, serve_wires
from kinesic.hardware.virtual.wiring import build_bus, cables
from kinesic.sim.servo_factors import read_twins

PRIORITY = 30  # above a supervisor on the same machine: servos are never late


def simulate_servos(
    robot: str, physics: str, twin: str, faults: Path | None, baud: int | None, folder: Path | None
) -> int:
    """Simulates a robot's servos behind pseudo-terminals until it is stopped."""
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
        with name_failures(home):
            home.mkdir(parents=True, exist_ok=True)
        ports = [PtyPort(bus, home / name) for name, bus in buses.items()]
        for wire, port in zip(wires, ports, strict=True):
            with name_failures(port.link):
                port.exchange(0.0)
            click.echo(f"{wire.name}: {port.link} at {wire.baud} baud, {len(wire.fittings)} servos")
        click.echo("Ctrl-C stops.", err=True)
        serve_wires(ports, lambda: not stopped.is_set())
    return 0


def _stopped_by_signals() -> Event:
    """Makes an event that SIGINT and SIGTERM set."""
    stopped = Event()

    def stop(_number: int, _frame: FrameType | None) -> None:
        stopped.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    return stopped
