from collections.abc import Callable

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.axes import Axes, cycle_together
from kinesic.hardware.supervisor.manifest import Manifest

Make = Callable  # of a rig, see conftest
MID_TICKS = 2048  # [ticks] position in the middle of a turn


def test_all_buses_are_queried_before_the_first_reply(rig: Make):
    left, right = rig(7), rig(5, baud=4_000_000)
    buses = {"left": left.bus, "right": right.bus}
    said: list[str] = []
    for name, made in (("left", left), ("right", right)):
        begin, finish = made.bus.begin, made.bus.finish
        made.bus.begin = lambda goals, n=name, f=begin: (said.append(f"ask {n}"), f(goals))[1]
        made.bus.finish = lambda n=name, f=finish: (said.append(f"hear {n}"), f())[1]
    cycles = cycle_together(buses, {"left": np.full(7, MID_TICKS)})
    assert said == ["ask left", "ask right", "hear left", "hear right"]
    assert cycles["left"].fresh.all()
    assert cycles["right"].fresh.all()


def test_bus_with_silent_servos_does_not_affect_another_bus(rig: Make):
    left, right = rig(3), rig(3)
    left.wire.sleep(left.wire.now() + 0.1)
    for servo in left.plant.servos:
        servo.mute = True
    buses = {"left": left.bus, "right": right.bus}
    goals = {"left": np.full(3, MID_TICKS), "right": np.array([MID_TICKS, MID_TICKS + 5, MID_TICKS + 9])}
    for _ in range(10):
        cycles = cycle_together(buses, goals)
        for made in (left, right):
            made.wire.sleep(made.wire.now() + 0.01)
    assert not cycles["left"].fresh.any()
    assert cycles["right"].fresh.all()
    assert right.true(Register.GOAL_POSITION).tolist() == [MID_TICKS, MID_TICKS + 5, MID_TICKS + 9]


def test_closing_the_axes_closes_the_port_of_every_bus(robot: Robot, rig: Make, monkeypatch: pytest.MonkeyPatch):
    left, right = rig(3), rig(3)
    closed: list[str] = []
    for name, made in (("left", left), ("right", right)):
        monkeypatch.setattr(made.wire, "close", lambda n=name: closed.append(n))
    Axes(Manifest.of(robot), {"left": left.bus, "right": right.bus}).close()
    assert closed == ["left", "right"]
