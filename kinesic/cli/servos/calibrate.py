"""`kinesic servos calibrate`: zeros, directions and limits, from a robot that is moved by hand."""

import sys
from collections.abc import Callable, Iterator
from math import inf
from pathlib import Path

import click
import numpy as np
from rich.live import Live
from rich.table import Table

from kinesic.body.calibration import Calibration, calibration_path, read_calibration
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.cli.servos.ports import all_ports, open_ports
from kinesic.cli.terminal import console, pressed_keys
from kinesic.files.held_folder import name_failures
from kinesic.files.output_file import check_file, write_text
from kinesic.hardware.protocol.device import Change
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.axes import Axes, Snapshot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.preflight import prepare_servos
from kinesic.hardware.tools.calibration import (
    HingeCalibration,
    Travel,
    calibration,
    calibration_text,
    marks,
    positive_way,
)

POLL = 0.05  # [s] between two looks
FIRST_LOOK = 2.0  # [s] in which all servos must have answered
ZERO = (
    "Hold the robot in its zero posture, every hinge at 0 degrees (upper22: arms hang, palms to the thighs, head up)."
)
TURN_HINGES = "Turn every hinge by hand: first the way the table says, then through all its range."
WHOLE_TURN = {Register.MIN_POSITION_LIMIT: 0, Register.MAX_POSITION_LIMIT: TICKS_PER_TURN - 1}
ENTER = {"\n", "\r"}


def calibrate_robot(robot: str, ports: tuple[str, ...], yes: bool, seconds: float | None) -> int:
    """Writes a robot's calibration, after every hinge was moved by hand; no servo gets torque."""
    raw = Robot.load(robot, calibrated=False)
    manifest = Manifest.of(raw)
    paths = all_ports(ports, manifest.bauds)
    asks = not yes or seconds is None
    if asks and not sys.stdin.isatty():
        raise ConfigError("standard input is no terminal; give --yes and --seconds N")
    before = read_calibration(raw.path, raw.name)
    _prepare_place(calibration_path(raw.path))
    with open_ports(manifest, paths) as wires:
        axes = prepare_servos(manifest, wires, period=POLL)
        limp(axes)
        for change in free_servos(axes):
            click.echo(f"servo {change.servo}: {change.register.name} {change.before} -> {change.after}")
        travel = read_zero_posture(axes, ask=not yes)
        with pressed_keys() as keys:
            travel = watch_hands(axes, raw, travel, seconds=inf if seconds is None else seconds, keys=keys)
        found = calibration(travel, manifest, raw, before)
    path = _written(found, raw)
    load_robot(robot)
    _tell(found, marks(travel, manifest, raw))
    click.echo(f"calibration: {path}")
    return 0


def _prepare_place(path: Path) -> None:
    """Makes the folder of a calibration, and refuses a link, before a hand has moved anything."""
    with name_failures(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    check_file(path, force=True)


def _written(found: Calibration, robot: Robot) -> Path:
    """Writes the calibration, in place of an earlier one."""
    path = calibration_path(robot.path)
    write_text(path, calibration_text(found, robot), force=True, durable=True)
    return path


def limp(axes: Axes) -> Snapshot:
    """Reads all servos until each has answered; refuses to go on if one has torque.

    Raises:
        BusError: a servo has torque, or is silent.
    """
    for snapshot in _looks(axes, FIRST_LOOK):
        energised = [axes.where(k) for k in np.flatnonzero(snapshot.torque).tolist()]
        if energised:
            raise BusError(
                f"{energised[0]}: has torque, like {len(energised) - 1} others; let go with `kinesic servos release`"
            )
        if snapshot.recent.all():
            return snapshot
    raise BusError("not all servos answer at once; `kinesic servos doctor` tells which and why")


def free_servos(axes: Axes) -> list[Change]:
    """Lets servos count their ticks as they will when they are driven, and through a whole turn.

    Position limits were counted from the zeros before; the next start sets them anew.
    """
    return [
        change
        for member in axes.manifest.members
        for change in axes.cold(member.bus).configure(member.id, {**member.lasting, **WHOLE_TURN})
    ]


def read_zero_posture(axes: Axes, *, ask: bool) -> Travel:
    """Reads where the servos stand in the zero posture.

    Raises:
        BusError: a servo has torque, or is silent.
    """
    if ask:
        click.echo(ZERO)
        click.prompt("Then press Enter", default="", show_default=False, prompt_suffix="")
    return Travel.begin(counted_ticks(limp(axes)))


def watch_hands(axes: Axes, robot: Robot, travel: Travel, *, seconds: float, keys: Callable[[], str]) -> Travel:
    """Watches hands move the robot until Enter, until the time is over, or until all has been seen."""
    manifest = axes.manifest
    click.echo(f"{TURN_HINGES} Enter ends.")
    with Live(console=console(), refresh_per_second=8) as live:
        for snapshot in _looks(axes, seconds):
            travel = travel.seen(counted_ticks(snapshot), manifest)
            found = marks(travel, manifest, robot)
            live.update(_table(found, robot))
            if ENTER & set(keys()) or all(mark.whole for mark in found):
                break
    if not sys.stdout.isatty():
        click.echo()  # Live leaves the last line open in a file
    return travel


def counted_ticks(snapshot: Snapshot) -> Ticks:
    """(m,) positions with the turns counted; of a silent servo, the last one."""
    return snapshot.records["position"].astype(np.int64)


def _looks(axes: Axes, seconds: float) -> Iterator[Snapshot]:
    """Yields a look at all servos after another, for some time [s]."""
    end = axes.now() + seconds
    while axes.now() <= end:
        snapshot = axes.cycle(None)
        yield snapshot
        axes.sleep(snapshot.time + POLL)


def _table(found: tuple[HingeCalibration, ...], robot: Robot) -> Table:
    names = ("hinge", "id", "zero", "deg", "first turn it so that", "way", "moved deg", "range deg", "")
    table = Table(*names, box=None, header_style="bold")
    ways = {1: "as its servo", -1: "inverted", 0: "?"}
    for joint, mark in enumerate(found):
        table.add_row(
            mark.hinge,
            ", ".join(str(servo) for servo in mark.ids),
            str(mark.zero_ticks),
            f"{mark.here:.1f}",
            positive_way(robot, joint),
            ways[mark.way],
            f"{mark.least:.0f}..{mark.most:.0f}",
            f"{mark.lower:.0f}..{mark.upper:.0f}",
            "[green]whole[/]" if mark.whole else "",
        )
    return table


def _tell(found: Calibration, seen: tuple[HingeCalibration, ...]) -> None:
    """Names hinges that were not turned, and ranges that are narrower than in the robot's file."""
    still = [mark.hinge for mark in seen if mark.way == 0]
    if still:
        click.echo(f"not turned, so their directions and limits stay as they were: {', '.join(still)}")
    for hinge, (least, most) in found.range_deg.items():
        click.echo(f"{hinge} goes {least:g}..{most:g} deg only")
