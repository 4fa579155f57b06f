"""Measures the load of the whole supervisor (wires, player, limits, monitor, status) while it performs in real time."""

import gc
import mmap
import time
from pathlib import Path

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.hardware.bus.bus import Servo
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.models import MODELS
from kinesic.hardware.protocol.servo_map import MID_TICKS
from kinesic.hardware.supervisor.channel import Channel, memory_size
from kinesic.hardware.supervisor.manifest import Manifest, Member
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.supervisor.status import EventLog
from kinesic.hardware.supervisor.supervisor import Supervisor, Surroundings

BUS, RANGE = "bench", 1.5  # [rad] to either side
SWING = 0.2  # [rad] either way from the middle of the motion
PATIENCE = 10.0  # [s] until it performs
SETTLED = 0.5  # [s] of the performance before the measurement


def measure_supervisor(link: Path, *, model: str, count: int, baud: int, period: float, seconds: float) -> float | None:
    """Measures the CPU share of a supervisor that performs on virtual servos.

    Args:
        link: of their port.
        model: of the servos, whose ids are 1..count.
        count: how many.
        baud: [bit/s].
        period: [s].
        seconds: of the measurement.

    Returns:
        Of one core, system calls included; None if it did not come to perform.
    """
    channel, settings = Channel(mmap.mmap(-1, memory_size(count)), count), SupervisorSettings(period=period)
    supervisor = Supervisor(
        manifest(model, count, baud),
        Surroundings(lambda bus: SerialWire(link, baud), channel, planner=lambda: True, journal=EventLog(None)),
        settings,
        watchdog=settings.patient_watchdog,
    )
    supervisor.open()
    for k in range(round((SETTLED + seconds + settings.lead) / period)):
        channel.write(k * period, np.full(count, SWING * (1 - np.cos(2 * k * period))))
    limit = time.monotonic() + PATIENCE
    while supervisor.state.stage is not Stage.ACTIVE and time.monotonic() < limit:
        _run(supervisor, settings, period)
    performs = supervisor.state.stage is Stage.ACTIVE
    _run(supervisor, settings, SETTLED)
    gc.collect()
    gc.freeze()  # as its own process does
    began, cpu = time.monotonic(), time.process_time()
    _run(supervisor, settings, seconds)
    share = (time.process_time() - cpu) / (time.monotonic() - began)
    gc.unfreeze()
    channel.set("release", 1)
    limit = time.monotonic() + PATIENCE
    while not supervisor.done and time.monotonic() < limit:
        _run(supervisor, settings, period)
    return share if performs else None


def _run(supervisor: Supervisor, settings: SupervisorSettings, seconds: float) -> None:
    began = supervisor.now()
    for k in range(round(seconds / settings.period)):
        supervisor.step()
        supervisor.sleep(began + (k + 1) * settings.period)


def manifest(model: str, count: int, baud: int) -> Manifest:
    """Lists so many servos on one wire, a hinge each."""
    members = [
        Member(
            bus=BUS,
            servo=Servo(k + 1, MODELS[model]),
            hinge=f"hinge{k + 1}",
            joint=k,
            zero=MID_TICKS,
            turns=1.0,
            lower=MID_TICKS - 1000,
            upper=MID_TICKS + 1000,
            speed=4.8,
            gains=(800, 0),
            full=141.0,
        )
        for k in range(count)
    ]
    return Manifest(
        robot=BUS,
        bauds={BUS: baud},
        members=tuple(members),
        rest=sealed(np.zeros(count)),
        lower=sealed(np.full(count, -RANGE)),
        upper=sealed(np.full(count, RANGE)),
        chains=tuple(frozenset({k}) for k in range(count)),
    )
