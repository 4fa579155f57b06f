import pytest

from kinesic.bml.block import Gesture
from kinesic.expressivity.keyframes import NO_SUCCESSION
from kinesic.expressivity.realise import make_keyframes
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.expressivity.variation import HAND_DELAY_RANGE, NO_VARIATION, WRIST_DELAY_RANGE, Variation, deviations


@pytest.fixture
def succession(context, timeline, phases):
    """Return the delays of one gesture for a seed and expressivity."""

    def of(lexeme, seed=3, amount=1.0, **manner):
        built = timeline(("g", Gesture(lexeme), phases(0, 1, 1.4, 2, 2.4, 3, 4)))
        style = Style("asked", gesture=Expressivity(**manner))
        return make_keyframes(built, context(built.block, style=style, variation=Variation(amount, seed))).successions[
            "g"
        ]

    return of


def test_random_delays_of_second_hand_and_wrist_stay_in_their_ranges(succession):
    successions = [succession("large", seed) for seed in range(24)]
    assert all(
        HAND_DELAY_RANGE[0] <= item.behind <= HAND_DELAY_RANGE[1]
        and WRIST_DELAY_RANGE[0] <= item.loose <= WRIST_DELAY_RANGE[1]
        for item in successions
    )
    assert {item.leader for item in successions} == {"l", "r"}
    assert [item.behind_of("l") for item in successions] == [item.behind * (item.leader == "r") for item in successions]


@pytest.mark.parametrize("lexeme", ["applause", "hands_together", "prayer", "beat"])
def test_hands_that_meet_and_single_hands_have_no_random_delay_between_hands(succession, lexeme):
    assert [succession(lexeme, seed).behind for seed in range(4)] == [0.0] * 4
    assert succession(lexeme).loose > 0.0


def test_fluidity_increases_the_wrist_delay_and_power_reduces_wrist_and_hand_delays(succession):
    loose = [succession("large", fluidity=fluidity).loose for fluidity in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    assert loose == sorted(loose)
    assert loose[0] < 0.5 * loose[2] < loose[2] < 0.7 * loose[-1]
    usual, forceful = succession("large"), succession("large", power=1.0)
    assert forceful.loose < 0.5 * usual.loose
    assert forceful.behind < 0.5 * usual.behind


def test_zero_variation_gives_no_hand_or_wrist_delays(succession, timeline, phases, context):
    assert succession("large", amount=0.0) == NO_SUCCESSION
    built = timeline(("g", Gesture("large"), phases(0, 1, 1.4, 2, 2.4, 3, 4)))
    assert deviations(built.block, NO_VARIATION) == {}
