"""`kinesic servos release`: says what will fall, lets go of every servo, and makes sure of it."""

import time
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path

import click

from kinesic.body.arrays import Floats
from kinesic.cli.servos.ports import all_ports
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.address import find_supervisor
from kinesic.hardware.supervisor.channel import Channel
from kinesic.hardware.supervisor.manifest import Manifest, raised_joints
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.tools.release import held_angles, release_servos

FAULT = 3
FOLD_TIMEOUT = 60.0  # [s] for a supervisor to fold what it can, and to let go
POLL = 0.05  # [s]


def release_robot(robot: str, ports: tuple[str, ...], yes: bool) -> int:
    """Takes the torque of every servo, and looks that it is gone; a supervisor that holds the robot is asked to."""
    manifest = Manifest.of(load_robot(robot))
    paths = all_ports(ports, manifest.bauds)
    holder = _holder(manifest, paths.values())
    if holder is not None:
        _confirm(manifest, holder.status().angles, yes=yes)
        _end(holder)
    wires: dict[str, Wire] = {}
    doubts: list[str] = []
    with ExitStack() as closing:
        for name, path in paths.items():
            try:
                wires[name] = SerialWire(path, manifest.bauds[name])
            except BusError as error:
                if len(paths) == 1:
                    raise
                doubts.append(f"{error}; the servos of bus {name} may still have torque")
                continue
            closing.callback(wires[name].close)
        if holder is None:
            _confirm(manifest, held_angles(manifest, wires), yes=yes)
        doubts += release_servos(wires, _members(manifest, wires))
    for line in doubts:
        click.echo(f"kinesic: {line}", err=True)
    if not doubts:
        click.echo(f"all {len(manifest.members)} servos are limp")
    return FAULT if doubts else 0


def _holder(manifest: Manifest, paths: Iterable[Path]) -> Channel | None:
    """The supervisor that holds the robot, if there is one."""
    found = (find_supervisor(path, len(manifest.rest)) for path in paths)
    return next((channel for channel in found if channel is not None), None)


def _members(manifest: Manifest, wires: Mapping[str, Wire]) -> dict[str, list[int]]:
    return {name: [member.id for member in manifest.members if member.bus == name] for name in wires}


def _confirm(manifest: Manifest, angles: Floats, *, yes: bool) -> None:
    """Says what will fall, and asks whether it may."""
    falls = raised_joints(manifest, angles)
    for line in falls:
        click.echo(f"will fall: {line}", err=True)
    if not falls:
        click.echo("no joint with torque is more than 5 deg from rest", err=True)
    if not yes:
        click.confirm("The robot will go limp. Is somebody holding it?", abort=True)


def _end(holder: Channel) -> None:
    """Lets a supervisor fold what it can, and let go of the rest; returns when it has ended.

    Raises:
        BusError: it does not.
    """
    holder.set("confirm", 1)
    limit, cycles, seen = time.monotonic() + FOLD_TIMEOUT, -1, time.monotonic()
    while time.monotonic() < limit and holder.status().stage is not Stage.CLOSED:
        if holder.word("cycles") != cycles:
            cycles, seen = holder.word("cycles"), time.monotonic()
        elif time.monotonic() - seen > 1.0:  # it writes no more: it has ended, or never will
            return
        time.sleep(POLL)
    stage = holder.status().stage
    if stage is not Stage.CLOSED:
        raise BusError(f"the supervisor has not let go in {FOLD_TIMEOUT:g} s ({stage.value}); switch the power off")
