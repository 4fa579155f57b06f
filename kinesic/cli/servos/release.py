"""Verb `kinesic servos release`: switch all torque off after a confirmation."""

import time
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path

import click

from kinesic.body.arrays import Floats
from kinesic.cli.servos.ports import read_all_ports
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.address import find_supervisor
from kinesic.hardware.supervisor.channel import Channel
from kinesic.hardware.supervisor.manifest import Manifest, describe_raised_joints
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.tools.release import holding_angles, release_servos

FAULT_EXIT_CODE = 3  # exit code if a servo may still have torque
FOLD_TIMEOUT = 60.0  # [s] time limit for a supervisor to fold the arms and switch torque off
POLL_PERIOD = 0.05  # [s] interval between two checks of the supervisor


def release_robot(robot: str, ports: tuple[str, ...], yes: bool) -> int:
    """Switch the torque of every servo off, and verify it.

    A supervisor that holds the robot folds it first and ends.
    """
    manifest = Manifest.of(load_robot(robot))
    paths = read_all_ports(ports, manifest.bauds)
    supervisor = _find_supervisor(manifest, paths.values())
    if supervisor is not None:
        _confirm_release(manifest, supervisor.status().angles, yes=yes)
        _end_supervisor(supervisor)
    wires: dict[str, Wire] = {}
    problems: list[str] = []
    with ExitStack() as stack:
        for name, path in paths.items():
            try:
                wires[name] = SerialWire(path, manifest.bauds[name])
            except BusError as error:
                if len(paths) == 1:
                    raise
                problems.append(f"{error}; the servos of bus {name} may still have torque")
                continue
            stack.callback(wires[name].close)
        if supervisor is None:
            _confirm_release(manifest, holding_angles(manifest, wires), yes=yes)
        problems += release_servos(wires, _group_ids(manifest, wires), manifest.tables)
    for line in problems:
        click.echo(f"kinesic: {line}", err=True)
    if not problems:
        click.echo(f"all {len(manifest.members)} servos have no torque")
    return FAULT_EXIT_CODE if problems else 0


def _find_supervisor(manifest: Manifest, paths: Iterable[Path]) -> Channel | None:
    """Return the channel of the supervisor that drives the robot, or None."""
    channels = (find_supervisor(path, len(manifest.rest)) for path in paths)
    return next((channel for channel in channels if channel is not None), None)


def _group_ids(manifest: Manifest, wires: Mapping[str, Wire]) -> dict[str, list[int]]:
    return {name: [member.id for member in manifest.members if member.bus == name] for name in wires}


def _confirm_release(manifest: Manifest, angles: Floats, *, yes: bool) -> None:
    """Print the joints that will fall, and ask for confirmation unless `yes`."""
    falling = describe_raised_joints(manifest, angles)
    for line in falling:
        click.echo(f"will fall: {line}", err=True)
    if not falling:
        click.echo("no joint with torque is more than 5 deg from rest", err=True)
    if not yes:
        click.confirm("All torque will be switched off. Is somebody holding the robot?", abort=True)


def _end_supervisor(supervisor: Channel) -> None:
    """Make a supervisor fold the arms, switch torque off and exit.

    Returns when the supervisor has ended.

    Raises:
        BusError: the supervisor does not end in time.
    """
    supervisor.set("confirm", 1)
    deadline, cycles, last_change = time.monotonic() + FOLD_TIMEOUT, -1, time.monotonic()
    while time.monotonic() < deadline and supervisor.status().stage is not Stage.CLOSED:
        if supervisor.word("cycles") != cycles:
            cycles, last_change = supervisor.word("cycles"), time.monotonic()
        elif time.monotonic() - last_change > 1.0:  # The supervisor has ended.
            return
        time.sleep(POLL_PERIOD)
    stage = supervisor.status().stage
    if stage is not Stage.CLOSED:
        raise BusError(f"the supervisor has not ended in {FOLD_TIMEOUT:g} s ({stage.value}); switch the power off")
