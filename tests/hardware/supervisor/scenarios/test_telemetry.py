"""What is told of every servo: as it is, one by one, often enough, and cheap."""

from collections.abc import Callable
from time import process_time

import numpy as np
import pytest

from kinesic.hardware.bus.cycle import HEALTH
from kinesic.hardware.bus.telemetry import Telemetry
from kinesic.hardware.protocol.registers import HardwareError
from kinesic.hardware.supervisor.channel import TOLD
from kinesic.hardware.supervisor.settings import USUAL
from kinesic.hardware.supervisor.status import SLOWLY
from kinesic.hardware.virtual.faults import PlannedFault


def test_each_servo_is_told_by_itself(desk: Callable):
    made = desk()
    assert not made.channel.telemetry().celsius.size
    for k, servo in enumerate(made.plant.servos):
        servo.electronics.celsius, servo.electronics.volts = 30.0 + k, 11.5 + k / 10
    made.open()
    made.run(0.3)
    told = made.channel.telemetry()
    assert told.celsius.tolist() == [30.0, 31.0, 32.0, 33.0, 34.0]
    assert told.volts == pytest.approx([11.5, 11.6, 11.7, 11.8, 11.9], abs=0.051)
    assert not told.torque.any()
    made.expose(PlannedFault("alert", (made.manifest.members[2].id,), value=HardwareError.OVERLOAD.value))
    made.run(0.3)
    assert made.channel.telemetry().errors.tolist() == [0.0, 0.0, HardwareError.OVERLOAD.value, 0.0, 0.0]


def test_loads_are_shares_of_the_limit_in_the_direction_of_the_hinge():
    records = np.zeros(3, dtype=HEALTH)
    records["current"] = [455, 455, -910]
    everybody, full = np.ones(3, dtype=np.bool_), np.full(3, 910.0)
    told = Telemetry.of(2.0, records, everybody, full=full, turns=np.array([1.0, -1.2, -1.0]))
    assert told.load.tolist() == [0.5, -0.5, 1.0]


def test_a_servo_that_does_not_answer_is_not_made_up(desk: Callable):
    made = desk()
    made.open()
    made.run(0.3)
    made.expose(PlannedFault("silent", (made.manifest.members[1].id,), seconds=1.0))
    made.run(0.5)
    told = made.channel.telemetry()
    assert np.isnan(told.figures).sum(axis=0).tolist() == [0, 5, 0, 0, 0]


def test_it_is_told_twenty_times_a_second_and_costs_next_to_nothing(crowd: Callable):
    made = crowd(37, baud=4_000_000)
    made.open()
    made.run(0.2)
    before = made.channel.word("tellings")
    made.run(1.0)
    assert made.channel.word("tellings") - before == pytest.approx(1.0 / SLOWLY, abs=1)
    monitor, channel = made.supervisor._monitor, made.channel
    began = process_time()
    for _ in range(200):
        channel.write_telemetry(monitor.telemetry(1.0))
    assert (process_time() - began) / 200 < 0.05 * USUAL.period  # of a cycle, every fifth cycle


def test_of_too_many_servos_the_first_are_told(crowd: Callable):
    made = crowd(2)
    figures = (np.arange(TOLD + 3.0),) * 5
    made.channel.write_telemetry(Telemetry(1.0, *figures))
    assert made.channel.telemetry().celsius.tolist() == list(range(TOLD))
