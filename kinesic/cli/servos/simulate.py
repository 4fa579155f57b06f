"""Verb `kinesic servos simulate`: virtual servos behind pseudo-terminals."""

import os
import select
import signal
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from threading import Event
from types import FrameType

import click
import numpy as np

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.cli.option_values import ShaftPhysics
from kinesic.files.held_folder import name_failures
from kinesic.hardware.bus.host import request_real_time
from kinesic.hardware.protocol.models import ALL_BAUD_RATES
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.virtual.faults import NO_FAULTS, FaultPlan
from kinesic.hardware.virtual.hand_turning import HandTurnedPhysics
from kinesic.hardware.virtual.physics import Physics
from kinesic.hardware.virtual.pty import PtyPort, serve_wires
from kinesic.hardware.virtual.wiring import Cable, build_bus, describe_cables, independent_motors
from kinesic.sim.servo_factors import read_twins

REAL_TIME_PRIORITY = 30  # Linux real-time priority, above that of supervisors, so that servos answer in time
MAX_INPUT_BYTES = 256  # [bytes] largest standard input per read


def simulate_servos(
    robot: str, shafts: ShaftPhysics, faults: Path | None, baud: int | None, folder: Path | None
) -> int:
    """Simulate a robot's servos behind pseudo-terminals until stopped."""
    if baud is not None and baud not in ALL_BAUD_RATES:
        raise ConfigError(f"--baud is {baud}, must be one of {', '.join(str(rate) for rate in ALL_BAUD_RATES)}")
    if shafts.by_hand and shafts.physics == "twin":
        raise ConfigError("--by-hand turns servos without a body; leave out --physics twin")
    robot_model = load_robot(robot)
    plan = NO_FAULTS if faults is None else FaultPlan.read(faults)
    start = np.zeros(len(robot_model.skeleton.hinges)) if shafts.by_hand else None
    wires = [replace(cable, faults=plan, baud=baud or cable.baud) for cable in describe_cables(robot_model, start)]
    if not wires:
        raise ConfigError(f"{robot_model.path}: no [[bus]], so there are no servos to simulate")
    hands = HandTurnedPhysics(independent_motors(wires), robot_model, wires) if shafts.by_hand else None
    try:
        _, buses = build_bus(wires, hands or _body_physics(shafts, robot_model, wires))
    except ValueError as error:
        raise ConfigError(f"--physics twin: {error}") from None
    stopped = _make_stop_event()
    with tempfile.TemporaryDirectory(prefix="kinesic-servos-") as temporary:
        port_folder = Path(temporary) if folder is None else folder
        with name_failures(port_folder):
            port_folder.mkdir(parents=True, exist_ok=True)
        ports = [PtyPort(bus, port_folder / name) for name, bus in buses.items()]
        for wire, port in zip(wires, ports, strict=True):
            with name_failures(port.link):
                port.exchange(0.0)
            click.echo(f"{wire.name}: {port.link} at {wire.baud} baud, {len(wire.fittings)} servos")
        if hands is not None:
            click.echo("The robot is in its zero posture. Enter turns every hinge by hand for 7 s.", err=True)
        click.echo("Ctrl-C stops.", err=True)
        request_real_time(REAL_TIME_PRIORITY)
        serve_wires(ports, _turned_by_enter(hands, stopped) if hands else lambda: not stopped.is_set())
    return 0


def _body_physics(shafts: ShaftPhysics, robot: Robot, wires: Sequence[Cable]) -> Physics | None:
    """Return the physics of the robot's twin, or None for independent motors."""
    if shafts.physics != "twin":
        return None
    from kinesic.controller.virtual_robot import TwinPhysics  # noqa: PLC0415 - loads MuJoCo

    return TwinPhysics(robot, wires, factors=read_twins(shafts.twin)[0])


def _turned_by_enter(hands: HandTurnedPhysics, stopped: Event) -> Callable[[], bool]:
    """Return a function that turns virtual hinges when Enter is pressed.

    `serve_wires` calls it, and ends once it returns False.
    """
    is_open = True

    def goes_on() -> bool:
        nonlocal is_open
        if is_open and select.select([sys.stdin], [], [], 0)[0]:
            data = os.read(sys.stdin.fileno(), MAX_INPUT_BYTES)
            is_open = bool(data)
            if b"\n" in data and not hands.is_turning:
                click.echo("turning every hinge ...", err=True)
                hands.turn()
        return not stopped.is_set()

    return goes_on


def _make_stop_event() -> Event:
    """Make an event that SIGINT and SIGTERM set."""
    stopped = Event()

    def stop(_number: int, _frame: FrameType | None) -> None:
        stopped.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    return stopped
