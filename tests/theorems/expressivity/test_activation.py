"""Activation: the identity at 0, monotone, and never out of the ranges, whatever the manner."""

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from kinesic.expressivity.style.resolve import SHARES, fold_activation
from kinesic.expressivity.style.style import RANGES, Expressivity

manners = st.builds(Expressivity, **{name: st.floats(least, most) for name, (least, most) in RANGES.items()})
activations = st.floats(-1.0, 1.0)


@given(manners)
def test_none_changes_nothing(manner):
    still = replace(manner, activation=0.0)
    assert fold_activation(still) == still


@given(manners, activations, activations)
def test_more_raises_what_it_folds_into_and_nothing_else(manner, a, b):
    less, more = (fold_activation(replace(manner, activation=activation)) for activation in sorted((a, b)))
    for name in RANGES:
        if name in SHARES:
            assert getattr(less, name) <= getattr(more, name) + 1e-12
        elif name != "activation":
            assert getattr(less, name) == getattr(more, name) == getattr(manner, name)


@given(manners)
def test_results_are_manners_again_without_activation(manner):
    found = fold_activation(manner)
    assert found.activation == 0.0
    for name, (least, most) in RANGES.items():
        assert least <= getattr(found, name) <= most
