"""Registers that only some servos of a robot have."""

from types import SimpleNamespace

from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.torque import _put_ram_values


def test_registers_that_only_some_servos_have_are_written_to_those_servos():
    gain, pace = Register.POSITION_P_GAIN, Register.PROFILE_VELOCITY
    members = [SimpleNamespace(ram_values=values) for values in ({pace: 1}, {gain: 2, pace: 3}, {gain: 4})]
    puts = {}
    axes = SimpleNamespace(manifest=SimpleNamespace(members=members), put=puts.__setitem__)
    _put_ram_values(axes, [0, 1])
    assert puts == {pace: {0: 1, 1: 3}, gain: {1: 2}}
