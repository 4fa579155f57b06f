from pathlib import Path

import numpy as np
import pytest

from kinesic.bml.block import Face
from kinesic.body.action_units import ACTION_UNITS, FACE_CHANNELS, unit_channels
from kinesic.body.config import ConfigError
from kinesic.expressivity.face.expressions import (
    EXTENT_GAIN,
    FADE_RATIO,
    MIN_RISE_TIME,
    OVERSHOOT_RATIO,
    Envelope,
    entries,
    find_expression,
)
from kinesic.expressivity.face.tracks import face_outcome
from kinesic.expressivity.keyframes import Outcome
from kinesic.expressivity.style.style import Expressivity

CORE_LEXEMES = {  # BML 1.0 lexemes and the units that each must include
    "OBLIQUE_BROWS": (*unit_channels(1), *unit_channels(4)),
    "RAISE_BROWS": (*unit_channels(1), *unit_channels(2)),
    "RAISE_LEFT_BROW": ("L1", "L2"),
    "RAISE_RIGHT_BROW": ("R1", "R2"),
    "LOWER_BROWS": unit_channels(4),
    "LOWER_LEFT_BROW": ("L4",),
    "LOWER_RIGHT_BROW": ("R4",),
    "LOWER_MOUTH_CORNERS": unit_channels(15),
    "LOWER_LEFT_MOUTH_CORNER": ("L15",),
    "LOWER_RIGHT_MOUTH_CORNER": ("R15",),
    "RAISE_MOUTH_CORNERS": unit_channels(12),
    "RAISE_LEFT_MOUTH_CORNER": ("L12",),
    "RAISE_RIGHT_MOUTH_CORNER": ("R12",),
    "OPEN_MOUTH": ("25", "26"),
    "OPEN_LIPS": ("25",),
    "WIDEN_EYES": unit_channels(5),
    "CLOSE_EYES": unit_channels(43),
}
EMOTION_UNITS = {
    "joy": (6, 12),
    "sadness": (1, 4, 15),
    "anger": (4, 5, 7, 23),
    "fear": (1, 2, 4, 5, 20),
    "surprise": (1, 2, 5, 26),
    "disgust": (9,),
}
SYNC_TIMES = {"start": 1.0, "attackPeak": 1.5, "relax": 2.0, "end": 3.0}


def shown(lexeme: str, amount: float = 1.0) -> dict[str, float]:
    return dict(find_expression(Face((lexeme,), amount=amount)).units)


@pytest.mark.parametrize("lexeme", CORE_LEXEMES)
def test_core_face_lexemes_activate_their_action_units(lexeme: str):
    result = shown(lexeme)
    assert set(CORE_LEXEMES[lexeme]) <= result.keys()
    for side, other in (("LEFT", "R"), ("RIGHT", "L")):
        if side in lexeme:
            assert not [channel for channel in result if channel.startswith(other)]
    assert "26" not in shown("OPEN_LIPS")


@pytest.mark.parametrize("emotion", EMOTION_UNITS)
def test_basic_emotions_activate_action_units_on_both_sides(emotion: str):
    result = shown(emotion)
    for number in EMOTION_UNITS[emotion]:
        assert set(unit_channels(number)) <= result.keys()
    for channel, value in result.items():
        if channel[0] == "L":
            assert result["R" + channel[1:]] == value


@pytest.mark.parametrize(
    ("lexeme", "like"),
    [
        ("Eyebrows_Raise", "RAISE_BROWS"),
        ("eyebrowsFrown", "LOWER_BROWS"),
        ("happy", "joy"),
        ("Surprised", "surprise"),
        ("shut_eyes", "CLOSE_EYES"),
    ],
)
def test_synonyms_and_spellings_of_a_face_lexeme_give_the_standard_expression(lexeme: str, like: str):
    assert shown(lexeme) == shown(like)


def test_words_of_a_face_lexeme_change_intensity_and_side():
    assert shown("small_smile")["L12"] == pytest.approx(shown("smile")["L12"] / 2)
    assert shown("wink").keys() == {"L46", "L12"}
    assert shown("wink_right").keys() == {"R46", "R12"}


def test_amount_scales_facial_intensity_up_to_one():
    assert shown("RAISE_BROWS", 0.3)["L1"] == pytest.approx(0.3)
    assert shown("CLOSE_EYES", 0.5)["L43"] == 1.0
    assert shown("RAISE_BROWS", 7.0)["L1"] == 1.0
    assert shown("RAISE_BROWS", -1.0)["L1"] == 0.0


def test_action_unit_number_of_a_face_behaviour_acts_on_the_given_side_or_else_on_both():
    assert find_expression(Face(action_unit=12, side="left", amount=0.4)).units == {"L12": 0.4}
    assert find_expression(Face(action_unit=12, amount=0.4)).units == {"L12": 0.4, "R12": 0.4}
    assert find_expression(Face(action_unit=26, side="left", amount=0.4)).units == {"26": 0.4}
    assert find_expression(Face(action_unit=99)).unknown == ("99",)


def test_strongest_face_lexeme_is_used_and_unknown_lexemes_are_listed():
    expression = find_expression(Face(("smile", "joy", "Qwrtz"), amount=1.0))
    assert expression.units["L12"] == max(shown("smile")["L12"], shown("joy")["L12"])
    assert expression.unknown == ("Qwrtz",)


def test_every_facial_expression_is_found_by_each_of_its_words():
    for entry in entries():
        assert shown("_".join(entry.words)) is not None
        assert all(find_expression(Face((word,))).unknown == () for word in entry.words)
        assert set(shown(entry.words[0])) <= set(FACE_CHANNELS)


def test_invalid_action_unit_in_user_expressions_is_refused(tmp_path: Path):
    path = tmp_path / "mine.toml"
    path.write_text('[[expression]]\nwords = ["zap"]\nsays = "zap"\nunits = { 12 = 0.5 }\n', encoding="utf-8")
    assert find_expression(Face(("zap",), amount=1.0), path=path).units == {"L12": 0.5, "R12": 0.5}
    assert 3 not in ACTION_UNITS
    for wrong, why in (("3 = 1.0", "no action unit 3; known"), ("12 = -0.5", "must be at least 0")):
        other = tmp_path / f"{wrong[0]}.toml"
        other.write_text(f'[[expression]]\nwords = ["zap"]\nsays = "zap"\nunits = {{ {wrong} }}\n', encoding="utf-8")
        with pytest.raises(ConfigError, match=why):
            find_expression(Face(("zap",)), path=other)


def test_expression_envelope_is_one_from_attack_peak_to_relax_and_zero_outside():
    course = Envelope.of(SYNC_TIMES)
    np.testing.assert_array_equal(course.at(np.array([0.0, 1.0, 3.0, 9.0])), 0.0)
    np.testing.assert_array_equal(course.at(np.array([1.5, 1.7, 2.0])), 1.0)
    np.testing.assert_allclose(course.at(np.array([1.25, 2.5])), 0.5)
    rising = course.at(np.linspace(1.0, 1.5, 50))
    assert np.all(np.diff(rising) > 0.0)


def test_envelope_of_a_permanent_expression_stays_at_one_after_its_end():
    course = Envelope.of({"start": 1.0, "end": 2.0}, stays=True)
    np.testing.assert_allclose(course.at(np.array([1.0, 1.5, 2.0, 1e6])), [0.0, 0.5, 1.0, 1.0])


@pytest.mark.parametrize("stays", [False, True])
def test_facial_expression_with_coinciding_sync_points_has_the_minimum_rise_time(stays: bool):
    times = dict.fromkeys(SYNC_TIMES, 1.0)
    result = Envelope.of(times, stays=stays).at(np.linspace(0.9, 1.2, 301))
    assert np.abs(np.diff(result)).max() < 1e-3 / MIN_RISE_TIME * 2
    assert result.max() == pytest.approx(1.0, abs=1e-2)


FINE_TIMES = np.linspace(0.9, 3.1, 2201)


@pytest.mark.parametrize("manner", [Expressivity(power=p, fluidity=f, spatial=w) for p, f, w in np.eye(3)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_expressivity_does_not_move_start_peak_and_end_of_a_facial_expression(manner: Expressivity, sign: float):
    manner = Expressivity(**{name: sign * value for name, value in vars(manner).items() if value})
    result = Envelope.of(SYNC_TIMES).at(FINE_TIMES, manner)
    assert np.all(result[(FINE_TIMES <= 1.0) | (FINE_TIMES >= 3.0)] == 0.0)
    assert np.all(result[(FINE_TIMES > 1.01) & (FINE_TIMES < 2.99)] > 0.0)
    peak = result[np.searchsorted(FINE_TIMES, 1.5)]
    assert np.all(np.diff(result[FINE_TIMES <= 1.5]) >= -1e-12)
    assert np.all(result[FINE_TIMES > 1.5] <= peak + 1e-12)


def test_spatial_extent_scales_facial_intensity():
    peaks = [
        Envelope.of(SYNC_TIMES).at(FINE_TIMES, Expressivity(spatial=value)).max() for value in (-1.0, -0.4, 0.0, 1.0)
    ]
    np.testing.assert_allclose(peaks, [1.0 - EXTENT_GAIN, 1.0 - 0.4 * EXTENT_GAIN, 1.0, 1.0 + EXTENT_GAIN])


def test_facial_expression_overshoots_at_high_power_and_rises_late_and_fades_at_low_power():
    strong, plain, weak = (
        Envelope.of(SYNC_TIMES).at(FINE_TIMES, Expressivity(power=value)) for value in (1.0, 0.0, -1.0)
    )
    half = [float(FINE_TIMES[np.argmax(course >= 0.5)]) for course in (strong, plain, weak)]
    assert half == sorted(half)
    assert half[0] < half[1] - 0.03 < half[2] - 0.06
    assert strong.max() == pytest.approx(1.0 + OVERSHOOT_RATIO, abs=0.01)
    before_relax = np.searchsorted(FINE_TIMES, 2.0)
    assert strong[before_relax] == pytest.approx(1.0, abs=0.01)
    assert weak[before_relax] == pytest.approx(1.0 - FADE_RATIO, abs=0.01)


def test_facial_expression_with_low_fluidity_begins_abruptly():
    jerk = [
        np.abs(np.diff(Envelope.of(SYNC_TIMES).at(FINE_TIMES, Expressivity(fluidity=f)), 2)).max()
        for f in (0.0, -0.5, -1.0)
    ]
    assert jerk == sorted(jerk)
    assert jerk[2] > 10 * jerk[0]


@pytest.mark.parametrize("lexeme", ["not_happy", "no_smile", "never_angry", "open_door", "happ", "smile " * 100])
def test_negated_or_similar_words_match_no_facial_expression(lexeme: str):
    assert find_expression(Face((lexeme,))).unknown == (lexeme,)


def test_ignored_word_of_a_face_lexeme_is_reported():
    assert find_expression(Face(("nice_smile",))).left_out == ("nice",)
    assert face_outcome(Face(("nice_smile",))) == Outcome("substituted", '"nice" is left out')
    assert face_outcome(Face(("very_big_smile",))) == Outcome("realised")


def test_facial_expression_with_low_power_fades_during_its_hold():
    course = Envelope.of({"start": 0.0, "attackPeak": 1.0, "relax": 3.0, "end": 4.0})
    held = course.at(np.linspace(1.0, 3.0, 21), Expressivity(power=-0.5))
    assert held[0] == pytest.approx(1.0)
    assert np.all(np.diff(held) < 0.0)
    strong = course.at(np.linspace(1.0, 3.0, 21), Expressivity(power=0.5))
    assert strong[0] > strong[-1] == pytest.approx(1.0)


def test_overshoot_of_a_facial_expression_is_proportional_to_power():
    course = Envelope.of({"start": 0.0, "attackPeak": 1.0, "relax": 3.0, "end": 4.0})
    half, full = (course.at(np.array([1.0]), Expressivity(power=power))[0] - 1.0 for power in (0.5, 1.0))
    assert full == pytest.approx(2 * half)
    assert 0.1 < full < 0.5
