"""Verb `kinesic servos record`: record a robot that is moved by hand."""

import sys
from collections.abc import Callable, Iterator
from math import inf
from pathlib import Path

import click
import numpy as np

from kinesic.body.config import ConfigError
from kinesic.cli.servos.hand_motion import poll_servos, require_torque_off
from kinesic.cli.servos.ports import open_ports, read_all_ports
from kinesic.cli.terminal import pressed_keys
from kinesic.files.output_file import check_file, write_text
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.axes import Axes
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.preflight import prepare_servos
from kinesic.hardware.tools.hand_recording import HandSample, write_recording

RECORDING_PERIOD = 0.02  # [s] interval between two samples
ENTER_KEYS = {"\n", "\r"}  # characters that the Enter key sends


def record_hands(robot: str, ports: tuple[str, ...], out: Path, seconds: float | None, force: bool) -> int:
    """Record the joint angles of a robot moved by hand as CSV.

    No servo gets torque.
    """
    loaded = load_robot(robot)
    manifest = Manifest.of(loaded)
    paths = read_all_ports(ports, manifest.bauds)
    if seconds is None and not sys.stdin.isatty():
        raise ConfigError("standard input is no terminal; give --seconds N")
    check_file(out, force=force)
    with open_ports(manifest, paths) as wires:
        axes = prepare_servos(manifest, wires, period=RECORDING_PERIOD)
        require_torque_off(axes)
        click.echo("Move the robot by hand. Enter ends.", err=True)
        with pressed_keys() as keys:
            samples = tuple(_record(axes, inf if seconds is None else seconds, keys))
    hinges = [hinge.name for hinge in loaded.skeleton.hinges]
    write_text(out, write_recording(hinges, samples), force=force)
    click.echo(f"{len(samples)} samples, {samples[-1].time:.1f} s; check it with `kinesic certify {out}`")
    click.echo(out)
    return 0


def _record(axes: Axes, seconds: float, keys: Callable[[], str]) -> Iterator[HandSample]:
    """Yield the servo positions until Enter or a time limit.

    Raises:
        BusError: a port is gone, or a servo has got torque.
    """
    begin = axes.now()
    for snapshot in poll_servos(axes, seconds, period=RECORDING_PERIOD):
        if snapshot.lost:
            raise BusError("a port is gone; nothing was recorded")
        if snapshot.torque.any():
            raise BusError(f"{axes.label(int(np.argmax(snapshot.torque)))}: has got torque; nothing was recorded")
        yield HandSample(snapshot.time - begin, axes.manifest.angles(snapshot.positions))
        if ENTER_KEYS & set(keys()):
            return
