"""Verb `kinesic servos stop`: emergency stop sent directly to supervisor processes.

It depends on no other program, server or network.
"""

import time

import click
import numpy as np

from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.address import find_faults, find_supervisors
from kinesic.hardware.supervisor.channel import Channel
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.host import STOP_FROM_OUTSIDE

STANDSTILL_TIMEOUT = 3.0  # [s] time limit for all setpoints to become constant
POLL_PERIOD = 0.02  # [s] interval between two checks for standstill, several cycles of a supervisor
POWER_OFF_REMEDY = "switch the power off"
STATIONARY_STAGES = frozenset(
    {Stage.STOPPED, Stage.LIMP, Stage.CLOSED, Stage.LOST, Stage.IDENTIFY, Stage.ARM, Stage.ADOPT}
)
"""Supervisor stages without motion, in which an emergency stop can end."""


def stop_robots() -> int:
    """Stop all robots driven by this user's supervisors, and await standstill.

    Raises:
        ConfigError: this system cannot find supervisors.
        BusError: no supervisor of this user runs, or one does not stop.
    """
    STOP_FROM_OUTSIDE.require()
    channels: list[Channel] = []
    for channel in find_supervisors():
        channel.stop("hold")
        channels.append(channel)
    if not channels:
        faults = "".join(f"; {fault}" for fault in find_faults())
        raise BusError(
            f"none of your programs drives servos from this machine{faults}; if a robot still moves, {POWER_OFF_REMEDY}"
        )
    start, waiting = time.monotonic(), list(channels)
    while waiting and time.monotonic() - start < STANDSTILL_TIMEOUT:
        waiting = [channel for channel in waiting if not _is_stationary(channel)]
    if waiting:
        stages = ", ".join(channel.status().stage.value for channel in waiting)
        raise BusError(
            f"{len(waiting)} of {len(channels)} robots have not stopped in {STANDSTILL_TIMEOUT:g} s ({stages}); "
            f"{POWER_OFF_REMEDY}"
        )
    servo_count = sum(channel.status().energised for channel in channels)
    click.echo(f"stopped: {servo_count} servos hold their positions")
    click.echo("to resume: Enter in `perform`, `resume` to `serve`; to fold and end: Ctrl-C there", err=True)
    return 0


def _is_stationary(channel: Channel) -> bool:
    """Return whether a supervisor has stopped and its setpoints are constant."""
    before, cycles = channel.status(), channel.word("cycles")
    time.sleep(POLL_PERIOD)
    after = channel.status()
    is_running = channel.word("cycles") > cycles or after.stage is Stage.CLOSED
    return (
        is_running
        and after.stage in STATIONARY_STAGES
        and np.array_equal(before.setpoints, after.setpoints, equal_nan=True)
    )
