"""Chains of held postures end like the last block alone."""

import random

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kinesic.body.arrays import Floats

from ...examples import examples
from .holding_chain import GAZE_BLOCKS, HOLDING_BLOCKS, PASSING_BLOCKS, STANCE_BLOCKS, Chain, held_alone

WAITING_BLOCK = HOLDING_BLOCKS[-1]  # block that waits 6 s before its gaze
ANGLE_TOLERANCE = np.radians(1.0)  # [rad] largest difference of equal postures
MAX_LIMIT_RATIO = 1.0015  # largest accepted ratio of value / limit
PAUSE_TIMES = st.one_of(st.floats(0.0, 0.6), st.floats(0.0, 4.0))
GAZE_EVENTS = st.tuples(PAUSE_TIMES, st.sampled_from(GAZE_BLOCKS))
CHAIN_EVENTS = st.tuples(PAUSE_TIMES, st.sampled_from([*GAZE_BLOCKS, *STANCE_BLOCKS, *HOLDING_BLOCKS, *PASSING_BLOCKS]))


@examples(40)
@given(st.lists(GAZE_EVENTS, min_size=2, max_size=9), st.sampled_from([0.0, 0.13]))
def test_final_posture_of_a_gaze_chain_equals_that_of_the_last_gaze(
    events: list[tuple[float, str]], ahead: float
) -> None:
    chain = Chain(ahead=ahead)
    for pause, inside in events:
        chain.wait(pause).send(inside)
    chain.finish()
    assert np.abs(chain.end - chain.expected_end).max() < ANGLE_TOLERANCE
    assert chain.limit_ratio <= MAX_LIMIT_RATIO


@examples(40)
@given(st.lists(CHAIN_EVENTS, min_size=2, max_size=9), st.sampled_from([0.0, 0.13]), st.data())
def test_final_posture_of_a_mixed_chain_combines_the_last_gaze_and_posture_shift(
    events: list[tuple[float, str]], ahead: float, data: st.DataObject
) -> None:
    chain = Chain(ahead=ahead)
    for pause, inside in events:
        chain.wait(pause).send(inside)
        deed = data.draw(st.sampled_from(["", "", "", "interrupt", "restyle", "leave out"]))
        if deed:
            chain.wait(data.draw(PAUSE_TIMES)).do(deed, data.draw(st.integers(0, 99)))
    chain.finish()
    assert np.abs(chain.end - chain.expected_end).max() < ANGLE_TOLERANCE
    assert chain.limit_ratio <= MAX_LIMIT_RATIO


@pytest.mark.parametrize(("first", "second"), [GAZE_BLOCKS[:2], GAZE_BLOCKS[1::-1]])
def test_later_of_two_gazes_sent_at_the_same_time_is_held(first: str, second: str) -> None:
    chain = Chain(ahead=0.0).send(first).send(second)
    chain.finish()
    np.testing.assert_allclose(chain.end, held_alone(second), atol=1e-6)


@examples(27)
@given(st.floats(3.0, 6.0), PAUSE_TIMES, st.sampled_from(GAZE_BLOCKS[:2]))
@example(3.616, 1.496, GAZE_BLOCKS[1])  # the times of both gazes differ by rounding
def test_later_of_two_gazes_sent_while_a_gaze_is_held_is_held(first_pause: float, pause: float, last: str) -> None:
    chain = Chain(ahead=0.13).wait(3.0).send(GAZE_BLOCKS[6])
    chain.wait(first_pause).wait(pause).send(GAZE_BLOCKS[0]).wait(6e-8).send(f'<wait id="w" duration="6"/>{last}')
    chain.finish()
    np.testing.assert_allclose(chain.end, held_alone(last), atol=1e-6)


def test_style_change_before_the_first_motion_of_a_block_keeps_its_held_posture() -> None:
    chain = Chain(ahead=0.0).send(WAITING_BLOCK).wait(2.0).do("restyle", 0)
    chain.finish()
    np.testing.assert_allclose(chain.end, held_alone(WAITING_BLOCK), atol=1e-6)


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(4))
def test_final_posture_of_200_chained_blocks_combines_the_last_held_gaze_and_posture(seed: int) -> None:
    chance, chain = random.Random(seed), Chain(ahead=0.13 * (seed % 2))
    for _ in range(200):
        chain.wait(chance.choice((chance.uniform(0.0, 0.6), chance.uniform(0.0, 4.0))))
        target = f"1 {chance.uniform(-1.5, 1.5):.3f} {chance.uniform(0.0, 1.2):.3f}"
        chain.send(
            f'<gazeShift id="l" target="{target}"/>'
            if seed < 2
            else chance.choice([*GAZE_BLOCKS, *STANCE_BLOCKS, *PASSING_BLOCKS])
        )
    chain.finish()
    assert np.abs(chain.end - chain.expected_end).max() < ANGLE_TOLERANCE
    assert chain.limit_ratio <= MAX_LIMIT_RATIO


@pytest.mark.parametrize("inside", [*GAZE_BLOCKS, *STANCE_BLOCKS])
def test_posture_held_by_the_realizer_equals_the_planned_held_posture(inside: str) -> None:
    held: Floats = held_alone(inside)
    chain = Chain(ahead=0.0).send(inside)
    chain.finish()
    np.testing.assert_allclose(chain.end, held, atol=1e-6)
