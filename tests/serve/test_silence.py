"""Speech that fades out before the planner has answered an interruption."""

import numpy as np

from kinesic.body.utterance import Sound
from kinesic.serve.loop import TICK_PERIOD
from kinesic.serve.sinks.real_time import RealTimeSink
from kinesic.serve.tracks import Track, TrackEffects

from .simulated import Recorder, Simulation, proposal


class Speaker:
    """Stub loudspeaker that records the times at which sounds fade."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation, self.fades = simulation, list[float]()

    def play(self, sound: Sound, at: float) -> None: ...

    def fade_out(self, sound: Sound, at: float) -> None:
        self.fades.append(self.simulation.now)


def test_speech_fades_at_the_next_tick_after_an_interruption_without_the_planner(simulation: Simulation):
    speaker = Speaker(simulation)
    simulation.effects = TrackEffects(speaker)
    loop = simulation.make([RealTimeSink(Recorder())])
    planner = simulation.link()

    def script():
        track = Track(0.0, {}, ((0.2, Sound.of(8000, np.zeros(8000))),))
        planner.send(proposal(tracks={"b": track}))
        yield 1.0
        loop.change_sound(lambda effects: effects.silence("b"))
        yield 1.2

    simulation.run(script())
    assert len(speaker.fades) == 1
    assert 1.0 < speaker.fades[0] <= 1.0 + 1.5 * TICK_PERIOD
