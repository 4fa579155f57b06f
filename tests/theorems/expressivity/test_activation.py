"""Activation is monotone, the identity at 0 and keeps all ranges."""

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from kinesic.expressivity.style.resolve import ACTIVATION_FRACTIONS, fold_activation
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, Expressivity

manners = st.builds(
    Expressivity, **{name: st.floats(least, most) for name, (least, most) in EXPRESSIVITY_RANGES.items()}
)
activations = st.floats(-1.0, 1.0)


@given(manners)
def test_zero_activation_does_not_change_expressivity_parameters(manner):
    still = replace(manner, activation=0.0)
    assert fold_activation(still) == still


@given(manners, activations, activations)
def test_higher_activation_never_lowers_the_parameters_that_it_affects(manner, a, b):
    less, more = (fold_activation(replace(manner, activation=activation)) for activation in sorted((a, b)))
    for name in EXPRESSIVITY_RANGES:
        if name in ACTIVATION_FRACTIONS:
            assert getattr(less, name) <= getattr(more, name) + 1e-12
        elif name != "activation":
            assert getattr(less, name) == getattr(more, name) == getattr(manner, name)


@given(manners)
def test_applying_activation_keeps_expressivity_parameters_in_range(manner):
    folded = fold_activation(manner)
    assert folded.activation == 0.0
    for name, (least, most) in EXPRESSIVITY_RANGES.items():
        assert least <= getattr(folded, name) <= most
