"""Verb `kinesic servos calibrate`: calibrate a robot that is moved by hand.

Zero positions, directions and limits are measured.
"""

import sys
from collections.abc import Callable
from math import inf
from pathlib import Path

import click
import numpy as np

from kinesic.body.calibration import Calibration, calibration_path, read_calibration
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.cli.screen.console import Content
from kinesic.cli.screen.live import LiveLines
from kinesic.cli.screen.table import Table
from kinesic.cli.screen.text import Text
from kinesic.cli.servos.hand_motion import poll_servos, require_torque_off
from kinesic.cli.servos.ports import open_ports, read_all_ports, read_bus_paths
from kinesic.cli.terminal import console, pressed_keys, quote_text
from kinesic.files.held_folder import name_failures
from kinesic.files.output_file import check_file, write_text
from kinesic.hardware.protocol.device import RegisterChange
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.servo_map import ServoMap, load_robot
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.supervisor.axes import Axes, Snapshot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.preflight import prepare_servos
from kinesic.hardware.tools.calibration import (
    HingeCalibration,
    Travel,
    calibration,
    calibration_text,
    describe_positive_direction,
    measure_hinges,
)
from kinesic.hardware.tools.lerobot_calibration import convert_lerobot
from kinesic.hardware.tools.pypot_configuration import convert_pypot

PROMPT_LINES = 6  # number of terminal lines of prompt and heading
DISPLAY_RATE = 8.0  # [Hz] redraws of the table
POLL_PERIOD = 0.05  # [s] interval between two snapshots of the servos
ZERO_POSTURE_PROMPT = (
    "Hold the robot in its zero posture, every hinge at 0 degrees (upper22: arms hang, palms to the thighs, head up)."
)
TURN_HINGES_PROMPT = "Turn every hinge by hand: first in the direction of the table, then through its whole range."
WHOLE_TURN_LIMITS = {Register.MIN_POSITION_LIMIT: 0, Register.MAX_POSITION_LIMIT: TICKS_PER_TURN - 1}  # [ticks]
ENTER_KEYS = {"\n", "\r"}  # characters that the Enter key sends


def calibrate_robot(
    robot: str, ports: tuple[str, ...], yes: bool, seconds: float | None, lerobot: tuple[str, ...], pypot: Path | None
) -> int:
    """Write a robot's calibration.

    It is measured while the robot is moved by hand, or converted from files of lerobot or pypot. No servo gets torque.
    """
    uncalibrated = Robot.load(robot, calibrated=False)
    if lerobot and pypot:
        raise ConfigError("--lerobot and --pypot: give one of them")
    if lerobot or pypot:
        return _convert_files(robot, uncalibrated, lerobot, pypot)
    manifest = Manifest.of(uncalibrated)
    paths = read_all_ports(ports, manifest.bauds)
    is_interactive = not yes or seconds is None
    if is_interactive and not sys.stdin.isatty():
        raise ConfigError("standard input is no terminal; give --yes and --seconds N")
    earlier = read_calibration(uncalibrated.path, uncalibrated.name)
    _prepare_folder(calibration_path(uncalibrated.path))
    with open_ports(manifest, paths) as wires:
        axes = prepare_servos(manifest, wires, period=POLL_PERIOD)
        require_torque_off(axes)
        for change in free_servos(axes):
            click.echo(f"servo {change.servo}: {change.register.name} {change.before} -> {change.after}")
        travel = read_zero_posture(axes, ask=not yes)
        with pressed_keys() as keys:
            travel = watch_hands(axes, uncalibrated, travel, seconds=inf if seconds is None else seconds, keys=keys)
        measured = calibration(travel, manifest, uncalibrated, earlier)
    path = _write_calibration(measured, uncalibrated)
    load_robot(robot)
    _print_limits(measured, measure_hinges(travel, manifest, uncalibrated))
    click.echo(f"calibration: {path}")
    return 0


def _convert_files(robot: str, uncalibrated: Robot, texts: tuple[str, ...], pypot: Path | None) -> int:
    """Write the calibration read from files of lerobot or pypot."""
    _prepare_folder(calibration_path(uncalibrated.path))
    earlier = read_calibration(uncalibrated.path, uncalibrated.name)
    if pypot is not None:
        converted = convert_pypot(pypot, uncalibrated, earlier)
    else:
        files = read_bus_paths(texts, [bus.name for bus in ServoMap.of(uncalibrated).buses], option="--lerobot")
        converted = convert_lerobot(files, uncalibrated, earlier)
    path = _write_calibration(converted, uncalibrated)
    load_robot(robot)
    click.echo(f"calibration: {path}")
    return 0


def _prepare_folder(path: Path) -> None:
    """Create the calibration file's folder, and refuse a link as file."""
    with name_failures(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    check_file(path, force=True)


def _write_calibration(measured: Calibration, robot: Robot) -> Path:
    """Write the calibration, replacing an earlier one, and return its path."""
    path = calibration_path(robot.path)
    write_text(path, calibration_text(measured, robot), force=True, durable=True)
    return path


def free_servos(axes: Axes) -> list[RegisterChange]:
    """Configure the servos for driving, with position limits of a whole turn.

    Old position limits refer to the previous zeros; the next start sets new ones.
    """
    return [
        change
        for member in axes.manifest.members
        for change in axes.access(member.bus).configure(member.id, {**member.eeprom_values, **WHOLE_TURN_LIMITS})
    ]


def read_zero_posture(axes: Axes, *, ask: bool) -> Travel:
    """Read the servo positions in the zero posture.

    Raises:
        BusError: a servo has torque, or does not answer.
    """
    if ask:
        click.echo(ZERO_POSTURE_PROMPT)
        click.prompt("Then press Enter", default="", show_default=False, prompt_suffix="")
    return Travel.begin(count_ticks(require_torque_off(axes)))


def watch_hands(axes: Axes, robot: Robot, travel: Travel, *, seconds: float, keys: Callable[[], str]) -> Travel:
    """Record manual hinge motion until Enter, a time limit or complete ranges."""
    manifest = axes.manifest
    output = console()
    if not output.is_terminal:
        click.echo(f"{TURN_HINGES_PROMPT} Enter ends.")
    contents: tuple[Content, ...] = ()
    with LiveLines(output, lambda: contents, rate=DISPLAY_RATE).shown():
        for snapshot in poll_servos(axes, seconds, period=POLL_PERIOD):
            travel = travel.with_positions(count_ticks(snapshot), manifest)
            hinges = measure_hinges(travel, manifest, robot)
            contents = show_progress(hinges, robot, height=output.height)
            if ENTER_KEYS & set(keys()) or all(hinge.is_whole for hinge in hinges):
                break
    output.print(_tabulate(hinges, robot))
    return travel


def count_ticks(snapshot: Snapshot) -> Ticks:
    """Return each servo's multi-turn position [ticks], (m,).

    A silent servo has its last known position.
    """
    return snapshot.records["position"].astype(np.int64)


def show_progress(hinges: tuple[HingeCalibration, ...], robot: Robot, *, height: int) -> tuple[Table, Text]:
    """Return hinge table and prompt, shortened on terminals with few lines."""
    finished_count = sum(hinge.is_whole for hinge in hinges)
    whole = f" {finished_count} of {len(hinges)} hinges are whole." if finished_count else ""
    prompt = Text(f"{TURN_HINGES_PROMPT} Enter ends.{whole}", "bold")
    is_low = len(hinges) + PROMPT_LINES > height
    return _tabulate_pending(hinges, robot, height - PROMPT_LINES) if is_low else _tabulate(hinges, robot), prompt


def _tabulate_pending(hinges: tuple[HingeCalibration, ...], robot: Robot, count: int) -> Table:
    """Tabulate the first `count` hinges whose whole range is not covered yet."""
    titles = ("hinge", "first turn it so that", "moved/range deg")
    table = Table(is_compact=True)
    for title in titles:
        table.add_column(title, no_wrap=True)
    pending = [(joint, mark) for joint, mark in enumerate(hinges) if not mark.is_whole]
    for joint, mark in pending[: max(count, 1)]:
        moved = f"{mark.lowest:.0f}..{mark.highest:.0f}/{mark.lower:.0f}..{mark.upper:.0f}"
        table.add_row(mark.hinge, describe_positive_direction(robot, joint), moved)
    return table


def _tabulate(hinges: tuple[HingeCalibration, ...], robot: Robot) -> Table:
    names = ("hinge", "id", "zero", "deg", "first turn it so that", "direction", "moved deg", "range deg", "")
    table = Table(*names)
    direction_labels = {1: "as its servo", -1: "inverted", 0: "?"}
    for joint, mark in enumerate(hinges):
        table.add_row(
            mark.hinge,
            ", ".join(str(servo) for servo in mark.ids),
            str(mark.zero_ticks),
            f"{mark.present:.1f}",
            describe_positive_direction(robot, joint),
            direction_labels[mark.direction],
            f"{mark.lowest:.0f}..{mark.highest:.0f}",
            f"{mark.lower:.0f}..{mark.upper:.0f}",
            quote_text("whole" if mark.is_whole else "", style="green"),
        )
    return table


def _print_limits(measured: Calibration, hinges: tuple[HingeCalibration, ...]) -> None:
    """Print unturned hinges, and measured ranges narrower than the robot file's."""
    unturned = [mark.hinge for mark in hinges if mark.direction == 0]
    if unturned:
        click.echo(f"not turned, so their directions and limits are unchanged: {', '.join(unturned)}")
    for hinge, (lower, upper) in measured.range_deg.items():
        click.echo(f"{hinge} moves only {lower:g}..{upper:g} deg")
