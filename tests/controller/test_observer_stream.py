import numpy as np
import pytest

from kinesic.controller.feedforward import FeedForward, FeedForwardSetpoints
from kinesic.controller.observer import Observer
from kinesic.controller.observer_stream import InputStream
from kinesic.controller.play import commands


@pytest.mark.parametrize("delay", [0.0, 0.012])
def test_streamed_observer_inputs_equal_precomputed_inputs(calm, delay):
    known, trajectory = calm.plan.setup, calm.plan.trajectory
    observer = Observer.of(known.robot, known.dynamics, period=0.01, delay=delay)
    times = calm.plan.command_times
    setpoints = FeedForward(known.robot, known.dynamics, delay=delay).compute_setpoints(trajectory, times)
    stream = tuple(commands(trajectory, times, setpoints))
    whole, growing = observer.precompute_inputs(stream, setpoints), InputStream(observer)
    for k, command in enumerate(stream):
        rows = (getattr(setpoints, name)[k : k + 1] for name in FeedForwardSetpoints.__dataclass_fields__)
        single = growing.add(command.angles, FeedForwardSetpoints(*rows))
        np.testing.assert_allclose(single.rows[0], whole.rows[k], rtol=0, atol=1e-12)
