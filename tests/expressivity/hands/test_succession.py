import pytest

from kinesic.bml.block import Gesture
from kinesic.expressivity.keyframes import NO_SUCCESSION
from kinesic.expressivity.realise import keyframes
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.expressivity.variation import BEHIND, EXACT, LOOSE, Variation, deviations


@pytest.fixture
def succession(context, timeline, phases):
    """What moves later in one gesture, in a manner, for a seed."""

    def of(lexeme, seed=3, amount=1.0, **manner):
        built = timeline(("g", Gesture(lexeme), phases(0, 1, 1.4, 2, 2.4, 3, 4)))
        style = Style("asked", gesture=Expressivity(**manner))
        return keyframes(built, context(built.block, style=style, variation=Variation(amount, seed))).successions["g"]

    return of


def test_one_hand_of_two_follows_by_some_hundredths_of_a_second_and_wrists_lag(succession):
    found = [succession("large", seed) for seed in range(24)]
    assert all(BEHIND[0] <= each.behind <= BEHIND[1] and LOOSE[0] <= each.loose <= LOOSE[1] for each in found)
    assert {each.leader for each in found} == {"l", "r"}
    assert [each.behind_of("l") for each in found] == [each.behind * (each.leader == "r") for each in found]


@pytest.mark.parametrize("lexeme", ["applause", "hands_together", "prayer", "beat"])
def test_hands_that_meet_come_together_and_one_hand_follows_none(succession, lexeme):
    assert [succession(lexeme, seed).behind for seed in range(4)] == [0.0] * 4
    assert succession(lexeme).loose > 0.0


def test_fluid_arms_swing_along_and_stiff_or_forceful_ones_move_as_one_piece(succession):
    loose = [succession("large", fluidity=fluidity).loose for fluidity in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    assert loose == sorted(loose)
    assert loose[0] < 0.5 * loose[2] < loose[2] < 0.7 * loose[-1]
    usual, forceful = succession("large"), succession("large", power=1.0)
    assert forceful.loose < 0.5 * usual.loose
    assert forceful.behind < 0.5 * usual.behind


def test_what_does_not_vary_moves_together(succession, timeline, phases, context):
    assert succession("large", amount=0.0) == NO_SUCCESSION
    built = timeline(("g", Gesture("large"), phases(0, 1, 1.4, 2, 2.4, 3, 4)))
    assert deviations(built.block, EXACT) == {}
