"""Telemetry of every servo: correct, frequent and cheap."""

from collections.abc import Callable
from time import process_time

import numpy as np
import pytest

from kinesic.hardware.bus.cycle import RECORD_DTYPE
from kinesic.hardware.bus.telemetry import Telemetry
from kinesic.hardware.protocol.registers import HardwareError
from kinesic.hardware.supervisor.channel import MAX_TELEMETRY_SERVOS
from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS
from kinesic.hardware.supervisor.status import TELEMETRY_INTERVAL
from kinesic.hardware.virtual.faults import PlannedFault


def test_telemetry_contains_the_values_of_each_servo(desk: Callable):
    made = desk()
    assert not made.channel.telemetry().celsius.size
    for k, servo in enumerate(made.plant.servos):
        servo.electronics.celsius, servo.electronics.volts = 30.0 + k, 11.5 + k / 10
    made.open()
    made.run(0.3)
    result = made.channel.telemetry()
    assert result.celsius.tolist() == [30.0, 31.0, 32.0, 33.0, 34.0]
    assert result.volts == pytest.approx([11.5, 11.6, 11.7, 11.8, 11.9], abs=0.051)
    assert not result.torque.any()
    made.expose(PlannedFault("alert", (made.manifest.members[2].id,), value=HardwareError.OVERLOAD.value))
    made.run(0.3)
    assert made.channel.telemetry().errors.tolist() == [0.0, 0.0, HardwareError.OVERLOAD.value, 0.0, 0.0]


def test_servo_loads_are_fractions_of_the_current_limit_in_hinge_direction():
    records = np.zeros(3, dtype=RECORD_DTYPE)
    records["current"] = [455, 455, -910]
    everybody, full = np.ones(3, dtype=np.bool_), np.full(3, 910.0)
    result = Telemetry.of(2.0, records, everybody, full=full, turns=np.array([1.0, -1.2, -1.0]))
    assert result.load.tolist() == [0.5, -0.5, 1.0]


def test_telemetry_of_a_silent_servo_is_nan(desk: Callable):
    made = desk()
    made.open()
    made.run(0.3)
    made.expose(PlannedFault("silent", (made.manifest.members[1].id,), seconds=1.0))
    made.run(0.5)
    result = made.channel.telemetry()
    assert np.isnan(result.figures).sum(axis=0).tolist() == [0, 5, 0, 0, 0]


def test_telemetry_is_updated_twenty_times_a_second_in_less_than_5_percent_of_a_cycle(crowd: Callable):
    made = crowd(37, baud=4_000_000)
    made.open()
    made.run(0.2)
    before = made.channel.word("tellings")
    made.run(1.0)
    assert made.channel.word("tellings") - before == pytest.approx(1.0 / TELEMETRY_INTERVAL, abs=1)
    monitor, channel = made.supervisor._monitor, made.channel
    began = process_time()
    for _ in range(200):
        channel.write_telemetry(monitor.telemetry(1.0))
    assert (process_time() - began) / 200 < 0.05 * DEFAULT_SETTINGS.period  # of a cycle, every fifth cycle


def test_telemetry_beyond_the_maximum_number_of_servos_is_truncated(crowd: Callable):
    made = crowd(2)
    figures = (np.arange(MAX_TELEMETRY_SERVOS + 3.0),) * 5
    made.channel.write_telemetry(Telemetry(1.0, *figures))
    assert made.channel.telemetry().celsius.tolist() == list(range(MAX_TELEMETRY_SERVOS))
