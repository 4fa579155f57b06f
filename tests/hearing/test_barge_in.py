"""Decision whether a person takes the turn."""

from kinesic.hearing.barge_in import BargeInDecision, BargeInDetector, BargeInThresholds

DUCK, END, YIELD = BargeInDecision.DUCK, BargeInDecision.END, BargeInDecision.YIELD
RULE = BargeInThresholds()


def decisions(probabilities, admitted=None):
    """Return (frame number, decision, age) of each reaction to a probability sequence."""
    detector = BargeInDetector()
    flags = admitted or [True] * len(probabilities)
    steps = [detector.step(p, admitted=flag) for p, flag in zip(probabilities, flags, strict=True)]
    return [(number, *change) for number, change in enumerate(steps, 1) if change is not None]


def test_lasting_voice_of_a_person_first_fades_the_robots_speech_and_then_takes_the_turn():
    assert decisions([0.1] * 5 + [0.95] * 30) == [
        (5 + RULE.duck_frames, DUCK, RULE.duck_frames),
        (5 + RULE.turn_frames, YIELD, RULE.turn_frames),
    ]


def test_short_voice_of_a_person_ends_without_taking_the_turn():
    short = [0.95] * (RULE.turn_frames - 1)
    gap = RULE.max_gap + 1
    assert decisions(short + [0.1] * 20) == [(RULE.duck_frames, DUCK, RULE.duck_frames), (len(short) + gap, END, gap)]


def test_gaps_between_words_do_not_end_the_voice_of_a_person():
    words = ([0.95] * 6 + [0.1] * RULE.max_gap) * 3
    assert [change for _, change, _ in decisions(words)] == [DUCK, YIELD]
    longer = ([0.95] * 6 + [0.1] * (RULE.max_gap + 1)) * 3
    assert [change for _, change, _ in decisions(longer)] == [DUCK, END] * 3


def test_interruption_by_a_person_is_reported_once_and_its_end_is_reported():
    changes = [change for _, change, _ in decisions([0.95] * 100 + [0.1] * 10)]
    assert changes == [DUCK, YIELD, END]


def test_voice_with_too_few_clear_frames_does_not_take_the_turn_from_the_robot():
    unclear = (RULE.voice + RULE.clear_voice) / 2
    assert [change for _, change, _ in decisions([unclear] * 60)] == [DUCK]
    few_clear = [0.95] + [unclear] * 20 + [0.95] * (RULE.min_clear_frames - 2)
    assert [change for _, change, _ in decisions(few_clear)] == [DUCK]
    assert [change for _, change, _ in decisions([*few_clear, 0.95])] == [DUCK, YIELD]


def test_sound_frames_with_only_the_robots_voice_do_not_count_as_a_person():
    assert decisions([0.99] * 40, [False] * 40) == []
    assert decisions([0.99] * 3, [True, False, True]) == [(3, DUCK, 3)]


def test_single_voiced_frame_does_not_fade_the_robots_speech():
    assert decisions([0.9] * (RULE.duck_frames - 1) + [0.1] * 20) == []
