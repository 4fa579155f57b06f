import numpy as np
import pytest

from kinesic.controller.feedforward import FeedForward, FeedForwardGoals
from kinesic.controller.observer import Observer
from kinesic.controller.observer_stream import InputStream
from kinesic.controller.play import command_times, commands


@pytest.mark.parametrize("delay", [0.0, 0.012])
def test_tick_by_tick_the_inputs_are_those_of_the_whole_motion(calm, delay):
    known, trajectory = calm.plan.setup, calm.plan.trajectory
    observer = Observer.of(known.robot, known.dynamics, period=0.01, delay=delay)
    times = command_times(calm.plan.duration)
    setpoints = FeedForward(known.robot, known.dynamics, delay=delay).lead(trajectory, times)
    stream = tuple(commands(trajectory, times, setpoints))
    whole, growing = observer.precompute_inputs(stream, setpoints), InputStream(observer)
    for k, command in enumerate(stream):
        rows = (getattr(setpoints, name)[k : k + 1] for name in FeedForwardGoals.__dataclass_fields__)
        single = growing.add(command.angles, FeedForwardGoals(*rows))
        np.testing.assert_allclose(single.rows[0], whole.rows[k], rtol=0, atol=1e-12)
