"""Properties of a bus under random communication errors."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.bus.cycle import CELL_CONTENTS
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.virtual.faults import WIRE_KINDS, FaultPlan, PlannedFault
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

from ...examples import examples

MID_TICKS, CYCLE_COUNT, CYCLE_PERIOD = 2048, 30, 0.02
SERVO_MODEL = SERVO_MODELS["xm430_w350"]
FAULT_RATES = st.sampled_from([0.0, 0.01, 0.1, 0.5])  # probabilities of a fault on the wire
RATES_BY_KIND = st.fixed_dictionaries(dict.fromkeys(sorted(WIRE_KINDS), FAULT_RATES))
PLANNED_FAULTS = st.lists(
    st.builds(
        PlannedFault,
        st.sampled_from(["silent", "reboot", "alert", "undervoltage", "unplug"]),
        servos=st.sampled_from([(1,), (2, 3), ()]),
        start=st.floats(0.0, 0.6),
        seconds=st.floats(0.05, 0.3),
    ).filter(lambda fault: fault.kind != "undervoltage" or fault.start > 0),
    max_size=2,
)


def opened(count: int, faults: FaultPlan) -> tuple[Bus, MemoryWire, ShaftSimulation]:
    """Return a bus with prepared servos, and the bus's simulated port."""
    plant, buses = build_bus([Cable("body", tuple(ServoFitting(k + 1) for k in range(count)), faults=faults)])
    for servo in plant.servos:
        servo.memory.put(SERVO_MODEL.cells[0].addresses, CELL_CONTENTS)
    wire = MemoryWire(buses["body"])
    return Bus(wire, [Servo(k + 1, SERVO_MODEL) for k in range(count)], period=CYCLE_PERIOD), wire, plant


@examples(80)
@given(RATES_BY_KIND, PLANNED_FAULTS, st.integers(2, 9), st.integers(0, 1000))
def test_bus_raises_no_error_and_accepts_no_false_servo_record(
    rates: dict[str, float], befalls: list[PlannedFault], count: int, seed: int
):
    weather = tuple(PlannedFault(kind, rate=rate) for kind, rate in rates.items() if rate)
    bus, wire, _ = opened(
        count, FaultPlan(tuple(m for m in befalls if m.kind != "unplug" or m.start > 0.01) + weather, seed)
    )
    times = np.full(count, -np.inf)
    for k in range(CYCLE_COUNT):
        cycle = bus.cycle(np.full(count, MID_TICKS))
        heard = np.isfinite(cycle.times)
        assert (np.abs(cycle.positions[heard] - MID_TICKS) <= 2).all()
        assert (cycle.raw_values("volts")[heard] >= 90).all()
        assert (cycle.raw_values("temperature")[heard] < 60).all()
        assert (cycle.records["id"][heard] == np.array(bus.ids)[heard]).all()
        assert (cycle.times[heard] <= cycle.time + cycle.duration).all()
        assert (cycle.times[cycle.fresh & heard] >= cycle.time).all()  # Records of rebooted servos are rejected
        assert (cycle.times[heard] >= times[heard]).all() or any(event.kind == "rebooted" for event in cycle.events)
        times = cycle.times
        wire.sleep(k * CYCLE_PERIOD)


@examples(50)
@given(st.integers(2, 26), st.integers(0, 4095), st.integers(0, 4095))
def test_goals_sent_on_the_bus_arrive_unchanged(count: int, first: int, last: int):
    bus, _, plant = opened(count, FaultPlan())
    goals = np.linspace(first, last, count).astype(np.int64)
    cycle = bus.cycle(goals)
    assert cycle.fresh.all()
    assert cycle.servos == bus.ids
    assert [servo.memory[Register.GOAL_POSITION] for servo in plant.servos] == goals.tolist()
