"""`kinesic servos stop`: an emergency stop for the supervisors themselves, past programs, servers and networks."""

import time

import click
import numpy as np

from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.address import find_faults, find_supervisors
from kinesic.hardware.supervisor.channel import Channel
from kinesic.hardware.supervisor.state_machine import Stage

STANDSTILL_TIMEOUT = 3.0  # [s] until all goals must stand still
POLL = 0.02  # [s] between two looks, in which a supervisor has several cycles
POWER_OFF = "switch the power off"
STANDING = frozenset({Stage.STOPPED, Stage.LIMP, Stage.CLOSED, Stage.LOST, Stage.IDENTIFY, Stage.ARM, Stage.ADOPT})
"""Stages that move nothing, in which an emergency stop can end."""


def stop_robots() -> int:
    """Stops all robots that supervisors of this user drive, and waits until their goals stand still.

    Raises:
        BusError: no supervisor of this user runs, or one does not stop.
    """
    channels: list[Channel] = []
    for channel in find_supervisors():
        channel.stop("hold")
        channels.append(channel)
    if not channels:
        faults = "".join(f"; {fault}" for fault in find_faults())
        raise BusError(
            f"no program of yours drives servos from here{faults}; if a robot moves all the same, {POWER_OFF}"
        )
    began, waiting = time.monotonic(), list(channels)
    while waiting and time.monotonic() - began < STANDSTILL_TIMEOUT:
        waiting = [channel for channel in waiting if not _stands(channel)]
    if waiting:
        stages = ", ".join(channel.status().stage.value for channel in waiting)
        raise BusError(
            f"{len(waiting)} of {len(channels)} have not stopped in {STANDSTILL_TIMEOUT:g} s ({stages}); {POWER_OFF}"
        )
    held = sum(channel.status().energised for channel in channels)
    click.echo(f"stopped: {held} servos hold where they are")
    click.echo("to go on: Enter at `perform`, `resume` to `serve`; to let go: Ctrl-C there", err=True)
    return 0


def _stands(channel: Channel) -> bool:
    """Whether a supervisor has heard the stop, and its goals stay."""
    before, cycles = channel.status(), channel.word("cycles")
    time.sleep(POLL)
    now = channel.status()
    lives = channel.word("cycles") > cycles or now.stage is Stage.CLOSED
    return lives and now.stage in STANDING and np.array_equal(before.goals, now.goals, equal_nan=True)
