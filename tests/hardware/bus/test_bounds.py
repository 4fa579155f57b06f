import numpy as np
import pytest

from kinesic.hardware.bus.bounds import RecordBounds
from kinesic.hardware.bus.cycle import BLOCK_DTYPE
from kinesic.hardware.protocol.models import SERVO_MODELS

GOAL_RANGE = (900, 3100)  # [ticks] range of the goals of each servo


@pytest.mark.parametrize("model", SERVO_MODELS)
def test_hot_or_low_voltage_servo_record_slightly_outside_the_goal_range_is_within_record_bounds(model: str):
    """Accept factory limits, a failing supply, and a joint slightly outside its range."""
    bounds = RecordBounds.of([SERVO_MODELS[model]], [GOAL_RANGE])
    record = np.zeros(1, BLOCK_DTYPE)
    for name, value in (("temperature", 80), ("volts", 31), ("torque", 1), ("watchdog", -1)):
        record[name] = value
    for place in (GOAL_RANGE[0] - 500, GOAL_RANGE[1] + 500):
        record["position"] = place
        assert not bounds.outside(record).any()
        assert bounds.reason(0, record[0]) == ""


@pytest.mark.parametrize("name", ["position", "velocity", "current"])
@pytest.mark.parametrize("sign", [-1, 1])
def test_error_for_a_servo_record_names_the_field_and_the_value_outside_its_bounds(name: str, sign: int):
    bounds = RecordBounds.of([SERVO_MODELS["xm430_w350"], SERVO_MODELS["xl430_w250"]], [GOAL_RANGE, GOAL_RANGE])
    records = np.zeros(2, BLOCK_DTYPE)
    records["volts"] = 120
    records[name][1] = sign * 32_767
    if name == "position":
        records["torque"] = 1
        records["position"][0] = 2000
    assert bounds.outside(records).tolist() == [False, True]
    assert bounds.reason(0, records[0]) == ""
    assert bounds.reason(1, records[1]).startswith(f"{name} is {sign * 32767}, must be ")


COMMON_BOUNDS = {
    "volts": (25, 240),
    "torque": (0, 1),
    "watchdog": (-1, 127),
    "temperature": (0, 125),
    "hardware_error": (0, 63),
}
MODEL_BOUNDS = {
    "xm430_w350": COMMON_BOUNDS | {"current": (-2386, 2386), "velocity": (-700, 700)},
    "xl330_m288": COMMON_BOUNDS | {"current": (-3500, 3500), "velocity": (-890, 890), "volts": (25, 105)},
    "xl430_w250": COMMON_BOUNDS
    | {"current": (-2000, 2000), "velocity": (-530, 530), "volts": (25, 210)},  # load in 0.1 %
    "xm540_w270": COMMON_BOUNDS
    | {"current": (-4094, 4094), "velocity": (-525, 525)},  # velocity of a shaft that a hand turns
}
"""Bounds by model: twice the factory limits of current and velocity, and 1.5 times that of the supply voltage."""


@pytest.mark.parametrize(
    ("model", "name", "ends"),
    [(model, name, ends) for model in MODEL_BOUNDS for name, ends in MODEL_BOUNDS[model].items()],
)
def test_servo_record_values_at_their_bounds_are_accepted_and_one_count_beyond_rejected(
    model: str, name: str, ends: tuple[int, int]
):
    """The second servo is at its own model's bounds, which differ from the first's."""
    bounds = RecordBounds.of([SERVO_MODELS["xm430_w350"], SERVO_MODELS[model]], [GOAL_RANGE, (1000, 2000)])
    for value, beyond in ((ends[0], ends[0] - 1), (ends[1], ends[1] + 1)):
        record = np.zeros(2, BLOCK_DTYPE)
        record["volts"], record["position"] = 100, 1500
        record[name][1] = value
        assert not bounds.outside(record).any()
        assert bounds.reason(1, record[1]) == ""
        held = np.iinfo(record[name].dtype)
        if held.min <= beyond <= held.max:
            record[name][1] = beyond
            assert bounds.outside(record).tolist() == [False, True]
            assert bounds.reason(1, record[1]) == f"{name} is {beyond}, must be {ends[0]}..{ends[1]}"


@pytest.mark.parametrize(("torque", "ends"), [(1, (1000 - 512, 2000 + 512)), (0, (-8 * 4096, 8 * 4096))])
def test_servo_position_bounds_are_the_range_plus_a_margin_with_torque_and_eight_turns_without(
    torque: int, ends: tuple[int, int]
):
    bounds = RecordBounds.of([SERVO_MODELS["xm430_w350"]] * 2, [GOAL_RANGE, (1000, 2000)])
    for value, beyond in ((ends[0], ends[0] - 1), (ends[1], ends[1] + 1)):
        record = np.zeros(2, BLOCK_DTYPE)
        record["volts"], record["position"] = 100, 1500
        record["torque"][1], record["position"][1] = torque, value
        assert not bounds.outside(record).any()
        record["position"][1] = beyond
        assert bounds.outside(record).tolist() == [False, True]
        assert bounds.reason(1, record[1]) == f"position is {beyond}, must be {ends[0]}..{ends[1]}"


def test_servo_velocity_bound_is_twice_the_velocity_limit_but_at_least_two_turns_per_second():
    bounds = RecordBounds.of([SERVO_MODELS["xm430_w350"], SERVO_MODELS["xm540_w270"]], [GOAL_RANGE, GOAL_RANGE])
    assert bounds.max_velocity == pytest.approx([2 * 350 * 0.229 / 60 * 4096, 2 * 4096])
