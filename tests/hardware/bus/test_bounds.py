import numpy as np
import pytest

from kinesic.hardware.bus.bounds import RecordBounds
from kinesic.hardware.bus.cycle import BLOCK
from kinesic.hardware.protocol.models import MODELS

SPAN = (900, 3100)


@pytest.mark.parametrize("model", MODELS)
def test_each_model_may_say_what_it_can_do(model: str):
    """Its factory limits, a supply that fails, and a joint that hangs a little outside."""
    bounds = RecordBounds.of([MODELS[model]], [SPAN])
    record = np.zeros(1, BLOCK)
    for name, value in (("temperature", 80), ("volts", 31), ("torque", 1), ("watchdog", -1)):
        record[name] = value
    for place in (SPAN[0] - 500, SPAN[1] + 500):
        record["position"] = place
        assert not bounds.outside(record).any()
        assert bounds.reason(0, record[0]) == ""


@pytest.mark.parametrize("name", ["position", "velocity", "current"])
@pytest.mark.parametrize("sign", [-1, 1])
def test_an_outsider_is_named_with_its_bounds(name: str, sign: int):
    bounds = RecordBounds.of([MODELS["xm430_w350"], MODELS["xl430_w250"]], [SPAN, SPAN])
    records = np.zeros(2, BLOCK)
    records["volts"] = 120
    records[name][1] = sign * 32_767
    if name == "position":
        records["torque"] = 1
        records["position"][0] = 2000
    assert bounds.outside(records).tolist() == [False, True]
    assert bounds.reason(0, records[0]) == ""
    assert bounds.reason(1, records[1]).startswith(f"{name} is {sign * 32767}, must be ")
