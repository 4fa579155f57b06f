"""Properties of every face track."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bml.block import FACE_SYNCS, Behaviour, Block, Face, Place, Speech, TimedBehaviour, Timeline
from kinesic.body.action_units import FACE_CHANNELS
from kinesic.body.arrays import Floats
from kinesic.body.utterance import Phoneme, Script, Utterance
from kinesic.expressivity.face.eyes import Eyes, GazeDirection, Habits
from kinesic.expressivity.face.tracks import Channels, face_track
from kinesic.expressivity.face.visemes import MIN_PRESS_TIME, RELEASE_ADVANCE
from kinesic.expressivity.style.resolve import resolve_styles
from kinesic.expressivity.style.style import Style

from ...examples import examples

SAMPLE_TIMES = np.arange(0.0, 6.0, 0.02)  # [s] times at which the face is evaluated
# names of expressions, the last one unknown
FACE_LEXEMES = ("joy", "anger", "surprise", "RAISE_LEFT_BROW", "CLOSE_EYES", "REPEATED_BLINK", "Qwrtz")
seconds = st.floats(0.0, 5.0)
faces = st.builds(
    Face,
    st.lists(st.sampled_from(FACE_LEXEMES), max_size=2).map(tuple),
    st.none(),
    amount=st.floats(-1, 3),
    shift=st.booleans(),
)
numbered = st.builds(
    Face,
    st.just(()),
    st.integers(0, 100),
    side=st.sampled_from(["left", "right", "both"]),
    amount=st.floats(0, 1),
    shift=st.booleans(),
)
gazes = st.lists(st.builds(GazeDirection, seconds, st.floats(-1, 1), st.floats(-1, 1), seconds), max_size=3)


@st.composite
def timelines(draw: st.DrawFn) -> Timeline:
    timed = []
    for number, action in enumerate(draw(st.lists(faces | numbered, max_size=4))):
        start, peak, relax, end = sorted(draw(st.tuples(seconds, seconds, seconds, seconds)))
        times = (
            {"start": start, "end": end}
            if action.shift
            else dict(zip(FACE_SYNCS, (start, peak, relax, end), strict=True))
        )
        timed.append(TimedBehaviour(Behaviour(f"f{number}", "face", action, Place(1, 1)), times))
    speech = Behaviour("s", "speech", Speech(Script("x")), Place(1, 1))
    timed.append(TimedBehaviour(speech, {"start": draw(seconds), "end": 6.0}))
    return Timeline(Block("b", tuple(item.behaviour for item in timed)), tuple(timed))


@st.composite
def utterances(draw: st.DrawFn) -> Utterance:
    now, results = 0.0, []
    for symbol in draw(st.text("pbmaiuoftsʃw \u02c8\u02d0☃", max_size=12)):
        duration = draw(st.floats(0.0, 0.3))
        results.append(Phoneme(symbol, now, duration))
        now += duration
    return Utterance(now, {}, tuple(results))


def show(timeline: Timeline, said: Utterance, times: Floats = SAMPLE_TIMES, **eyes) -> Channels:
    return face_track(timeline, {"s": said}, times, styles=resolve_styles(Style(), timeline.block), eyes=Eyes(**eyes))


@examples(80)
@given(timelines(), utterances(), gazes, st.integers(0, 9))
def test_face_track_intensities_are_finite_and_between_0_and_1(
    timeline: Timeline, said: Utterance, looks: list[GazeDirection], seed: int
):
    result = show(timeline, said, SAMPLE_TIMES, habits=Habits(seed), looks=looks)
    assert result.keys() <= set(FACE_CHANNELS)
    for values in result.values():
        assert values.shape == SAMPLE_TIMES.shape
        assert np.all(np.isfinite(values))
        assert values.min() >= 0.0
        assert values.max() <= 1.0
        assert not values.flags.writeable


@examples(40)
@given(timelines(), utterances(), st.integers(0, 9))
def test_face_intensities_at_a_time_do_not_depend_on_other_sample_times(timeline: Timeline, said: Utterance, seed: int):
    whole = show(timeline, said, SAMPLE_TIMES, habits=Habits(seed))
    again = show(timeline, said, SAMPLE_TIMES, habits=Habits(seed))
    assert whole.keys() == again.keys()
    assert all(np.array_equal(whole[channel], again[channel]) for channel in whole)
    half = show(timeline, said, SAMPLE_TIMES[::2])
    every = show(timeline, said, SAMPLE_TIMES)
    for channel, values in half.items():
        np.testing.assert_allclose(values, every[channel][::2], atol=1e-12)


@examples(60)
@given(timelines(), utterances())
def test_lips_close_on_bilabials_in_every_expression(timeline: Timeline, said: Utterance):
    begin = timeline.timed[-1].times["start"]
    result = show(timeline, said, SAMPLE_TIMES)
    for sound in said.phonemes:
        since, last = SAMPLE_TIMES - begin - sound.start, sound.duration - RELEASE_ADVANCE  # Start of the opening
        during = (since >= min(0.0, last - MIN_PRESS_TIME)) & (since <= last)
        if sound.symbol in ("p", "b", "m") and during.any():
            np.testing.assert_allclose(result["24"][during], 1.0, atol=0.06)
