"""Chains of gaze shifts, head directions and postures end where the last one of each kind ends alone."""

import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.body.arrays import Floats

from .holding_chain import HOLDING, LOOKS, PASSING, STANCES, Chain, held_alone

TOLERANCE = np.radians(1.0)
MAX_LIMIT_RATIO = 1.0015
PAUSES = st.one_of(st.floats(0.0, 0.6), st.floats(0.0, 4.0))
LOOK_EVENTS = st.tuples(PAUSES, st.sampled_from(LOOKS))
EVENTS = st.tuples(PAUSES, st.sampled_from([*LOOKS, *STANCES, *HOLDING, *PASSING]))


@settings(max_examples=12, deadline=None)
@given(st.lists(LOOK_EVENTS, min_size=2, max_size=9), st.sampled_from([0.0, 0.13]))
def test_chain_of_looks_ends_where_the_last_one_ends_alone(events: list[tuple[float, str]], ahead: float) -> None:
    chain = Chain(ahead=ahead)
    for pause, inside in events:
        chain.wait(pause).send(inside)
    chain.finish()
    assert np.abs(chain.end - chain.expected_end).max() < TOLERANCE
    assert chain.limit_ratio <= MAX_LIMIT_RATIO


@settings(max_examples=20, deadline=None)
@given(st.lists(EVENTS, min_size=2, max_size=9), st.sampled_from([0.0, 0.13]), st.data())
def test_mixed_chain_leaves_only_the_last_look_and_the_last_posture(
    events: list[tuple[float, str]], ahead: float, data: st.DataObject
) -> None:
    chain = Chain(ahead=ahead)
    for pause, inside in events:
        chain.wait(pause).send(inside)
        deed = data.draw(st.sampled_from(["", "", "", "interrupt", "restyle", "leave out"]))
        if deed:
            chain.wait(data.draw(PAUSES)).do(deed, data.draw(st.integers(0, 99)))
    chain.finish()
    assert np.abs(chain.end - chain.expected_end).max() < TOLERANCE
    assert chain.limit_ratio <= MAX_LIMIT_RATIO


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(4))
def test_chain_of_two_hundred_looks_ends_where_the_last_one_ends_alone(seed: int) -> None:
    chance, chain = random.Random(seed), Chain(ahead=0.13 * (seed % 2))
    for _ in range(200):
        chain.wait(chance.choice((chance.uniform(0.0, 0.6), chance.uniform(0.0, 4.0))))
        target = f"1 {chance.uniform(-1.5, 1.5):.3f} {chance.uniform(0.0, 1.2):.3f}"
        chain.send(
            f'<gazeShift id="l" target="{target}"/>' if seed < 2 else chance.choice([*LOOKS, *STANCES, *PASSING])
        )
    chain.finish()
    assert np.abs(chain.end - chain.expected_end).max() < TOLERANCE
    assert chain.limit_ratio <= MAX_LIMIT_RATIO


@pytest.mark.parametrize("inside", [*LOOKS, *STANCES])
def test_what_is_held_is_what_the_plan_holds(inside: str) -> None:
    held: Floats = held_alone(inside)
    chain = Chain(ahead=0.0).send(inside)
    chain.finish()
    np.testing.assert_allclose(chain.end, held, atol=1e-6)
