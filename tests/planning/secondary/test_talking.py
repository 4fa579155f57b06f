import numpy as np
import pytest

from kinesic.expressivity.prosody import NOD_SPACING, Prosody
from kinesic.planning.secondary.talking import (
    DIP_ANGLES,
    DRIFT_PERIODS,
    MAX_HEAD_DRIFT,
    MAX_TRUNK_DRIFT,
    MIN_DRIFT_TIME,
    PEAK_FRACTIONS,
    _straying,
    make_speech_motion,
)
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
SPOKEN_WORDS = "There was a garden, and a man who came to it every morning, and he talked to all of its trees in turn."
SPEECH_ELEMENT = f'<speech id="s" start="1"><text>{SPOKEN_WORDS}</text></speech>'  # speech that starts at 1 s


@pytest.fixture(scope="module")
def known():
    return set_up()


def swells(known, document, amount=1.0, seed=1):
    planned = plan(BML_TEMPLATE.format(document), known)
    chance = np.random.default_rng(seed)
    names = known.robot.skeleton.names
    results = [
        *make_speech_motion(
            planned.timeline, planned.utterances, amount, known.robot, chance, prosody=Prosody(amount, seed)
        )
    ]
    return planned, results, [{names[k] for k in np.flatnonzero(swell.away)} for swell in results]


def test_head_and_trunk_each_move_for_over_90_percent_of_a_speech(known):
    planned, result, moved = swells(known, SPEECH_ELEMENT)
    begin, end = planned.timeline.timed[0].times["start"], planned.timeline.timed[0].times["end"]
    assert min(swell.begin for swell in result) >= begin - 1e-9
    assert max(swell.end for swell in result) <= end + 1e-9
    times = np.arange(begin, end, 0.1)
    for part in ("skullbase", "vl5"):
        own = [s for s, names in zip(result, moved, strict=True) if any(name.startswith(part) for name in names)]
        assert np.mean(np.any([(times > swell.begin) & (times < swell.end) for swell in own], axis=0)) > 0.9


def test_head_dips_on_accents_with_minimum_spacing(known):
    planned, result, moved = swells(known, SPEECH_ELEMENT)
    dips = [swell for swell, names in zip(result, moved, strict=True) if names == {"skullbase_tilt"}]
    vowels = [1.0 + p.start + p.duration / 2 for p in planned.utterances["s"].phonemes if p.symbol in "aeiou"]
    assert all(min(abs(swell.peak - vowel) for vowel in vowels) < 1e-6 for swell in dips)
    peaks = [swell.peak for swell in dips]
    assert len(peaks) >= 3
    assert min(np.diff(peaks)) >= NOD_SPACING[0] - 1e-9
    assert all(DIP_ANGLES[0] <= swell.away.max() <= DIP_ANGLES[1] for swell in dips)


def test_speech_motion_of_the_head_is_omitted_during_a_requested_nod(known):
    nod = '<head id="n" lexeme="NOD" start="s:start+1" end="s:start+3"/>'
    planned, result, _ = swells(known, SPEECH_ELEMENT + nod)
    taken = next(timed.times for timed in planned.timeline.timed if timed.behaviour.id == "n")
    assert result
    assert all(swell.end <= taken["start"] + 1e-9 or swell.begin >= taken["end"] - 1e-9 for swell in result)


def test_head_and_trunk_motion_during_speech_is_proportional_to_its_amount(known):
    most = max(*MAX_HEAD_DRIFT, *MAX_TRUNK_DRIFT, *DIP_ANGLES)
    _, one, _ = swells(known, SPEECH_ELEMENT)
    _, two, _ = swells(known, SPEECH_ELEMENT, 2.0)
    assert max(np.abs(swell.away).max() for swell in one) <= most
    assert all(np.allclose(b.away, 2.0 * a.away) for a, b in zip(one, two, strict=True))


def test_nods_and_head_turns_during_speech_have_separate_amounts(known):
    planned = plan(BML_TEMPLATE.format(SPEECH_ELEMENT), known)
    for amount, prosody, parts in ((0.0, 1.0, {"skullbase_tilt"}), (1.0, 0.0, {"skullbase_torsion", "vl5_torsion"})):
        chance = np.random.default_rng(1)
        result = [
            *make_speech_motion(
                planned.timeline, planned.utterances, amount, known.robot, chance, prosody=Prosody(prosody)
            )
        ]
        moved = {known.robot.skeleton.names[k] for swell in result for k in np.flatnonzero(swell.away)}
        assert parts <= moved
        assert (moved == {"skullbase_tilt"}) == (amount == 0.0)


def test_emphasised_word_gets_a_larger_nod_than_any_word_without_emphasis(known):
    stressed = SPEECH_ELEMENT.replace("every", "<emphasis>every</emphasis>")
    _, result, moved = swells(known, stressed)
    dips = [swell.away.max() for swell, names in zip(result, moved, strict=True) if names == {"skullbase_tilt"}]
    assert max(dips) > 1.5 * DIP_ANGLES[0]
    assert min(dips) >= DIP_ANGLES[0]
    assert max(dips) > max(
        swell.away.max()
        for swell, names in zip(*swells(known, SPEECH_ELEMENT)[1:], strict=True)
        if names == {"skullbase_tilt"}
    )


def test_block_without_speech_has_no_speech_motion(known):
    assert not swells(known, '<wait id="w" duration="8"/>')[1]


@pytest.mark.parametrize("begin", [0.0, 100.0])
@pytest.mark.parametrize("duration", [MIN_DRIFT_TIME, 1.9, DRIFT_PERIODS[0], 7.3, 60.0])
def test_sways_of_head_and_trunk_fill_a_time_span_and_are_smaller_if_short(known, begin, duration):
    sways = [[*_straying((begin, begin + duration), 1.0, known.robot, np.random.default_rng(k))] for k in range(40)]
    largest = max(*MAX_HEAD_DRIFT, *MAX_TRUNK_DRIFT)
    for result in sways:
        neck = result[::2]
        assert neck[0].begin == begin
        assert neck[-1].end == pytest.approx(begin + duration)
        assert [sway.begin for sway in neck[1:]] == [sway.end for sway in neck[:-1]]
        for sway in result:
            lasts = sway.end - sway.begin
            assert MIN_DRIFT_TIME - 1e-9 <= lasts <= DRIFT_PERIODS[1] + MIN_DRIFT_TIME
            assert PEAK_FRACTIONS[0] <= (sway.peak - sway.begin) / lasts <= PEAK_FRACTIONS[1]
            assert np.abs(sway.away).max() <= largest * min(1.0, lasts / DRIFT_PERIODS[0]) + 1e-12
    peaks = [np.abs(sway.away).max() for result in sways for sway in result]
    assert max(peaks) > 0.8 * largest * min(1.0, duration / DRIFT_PERIODS[0])


def test_robot_does_not_sway_in_a_pause_shorter_than_a_sway(known):
    span = (5.0, 5.0 + 0.99 * MIN_DRIFT_TIME)
    assert not [*_straying(span, 1.0, known.robot, np.random.default_rng(1))]
