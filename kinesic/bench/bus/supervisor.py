"""CPU load of a whole supervisor that performs in real time.

The load includes wires, player, limits, monitor and status.
"""

import gc
import mmap
import time
from pathlib import Path

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.servo_map import MID_TICKS
from kinesic.hardware.supervisor.channel import Channel, memory_size
from kinesic.hardware.supervisor.context import SupervisorContext
from kinesic.hardware.supervisor.manifest import Manifest, Member
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.supervisor.status import EventLog
from kinesic.hardware.supervisor.supervisor import Supervisor

BUS_NAME = "bench"  # name of the only bus in the manifest
JOINT_RANGE = 1.5  # [rad] range of each virtual servo's joint to either side
MOTION_AMPLITUDE = 0.2  # [rad] amplitude of the joints' sinusoidal motion
START_TIMEOUT = 10.0  # [s] time limit for the supervisor to begin the performance
SETTLING_TIME = 0.5  # [s] wait between the start of the performance and the measurement


def measure_supervisor(link: Path, *, model: str, count: int, baud: int, period: float, seconds: float) -> float | None:
    """Measure the CPU load of a supervisor that performs on virtual servos.

    Args:
        link: link to the port of the virtual servos.
        model: servo model; the servo ids are 1..count.
        count: number of servos.
        baud: baud rate [bit/s].
        period: control period [s].
        seconds: duration of the measurement [s].

    Returns:
        CPU time / wall time, system calls included; None if the supervisor did not start to perform.
    """
    channel, settings = Channel(mmap.mmap(-1, memory_size(count)), count), SupervisorSettings(period=period)
    supervisor = Supervisor(
        build_manifest(model, count, baud),
        SupervisorContext(lambda bus: SerialWire(link, baud), channel, planner=lambda: True, journal=EventLog(None)),
        settings,
        watchdog=settings.patient_watchdog,
    )
    supervisor.open()
    for k in range(round((SETTLING_TIME + seconds + settings.lead) / period)):
        channel.write(k * period, np.full(count, MOTION_AMPLITUDE * (1 - np.cos(2 * k * period))))
    limit = time.monotonic() + START_TIMEOUT
    while supervisor.state.stage is not Stage.ACTIVE and time.monotonic() < limit:
        _run(supervisor, settings, period)
    has_started = supervisor.state.stage is Stage.ACTIVE
    _run(supervisor, settings, SETTLING_TIME)
    gc.collect()
    gc.freeze()  # as in the supervisor's own process
    began, cpu = time.monotonic(), time.process_time()
    _run(supervisor, settings, seconds)
    load = (time.process_time() - cpu) / (time.monotonic() - began)
    gc.unfreeze()
    channel.set("release", 1)
    limit = time.monotonic() + START_TIMEOUT
    while not supervisor.done and time.monotonic() < limit:
        _run(supervisor, settings, period)
    return load if has_started else None


def _run(supervisor: Supervisor, settings: SupervisorSettings, seconds: float) -> None:
    began = supervisor.now()
    for k in range(round(seconds / settings.period)):
        supervisor.step()
        supervisor.sleep(began + (k + 1) * settings.period)


def build_manifest(model: str, count: int, baud: int) -> Manifest:
    """Build a manifest of `count` servos on one bus."""
    members = [
        Member(
            bus=BUS_NAME,
            servo=Servo(k + 1, SERVO_MODELS[model]),
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
        robot=BUS_NAME,
        bauds={BUS_NAME: baud},
        members=tuple(members),
        rest=sealed(np.zeros(count)),
        lower=sealed(np.full(count, -JOINT_RANGE)),
        upper=sealed(np.full(count, JOINT_RANGE)),
        chains=tuple(frozenset({k}) for k in range(count)),
    )
