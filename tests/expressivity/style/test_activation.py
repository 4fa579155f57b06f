import pytest

from kinesic.expressivity.style.activation import SHARES, activated
from kinesic.expressivity.style.style import RANGES, Expressivity


def test_full_activation_of_a_neutral_manner():
    found = activated(Expressivity(activation=1.0))
    assert {name: getattr(found, name) for name in SHARES} == pytest.approx(dict(SHARES))
    assert all(getattr(found, name) == 0.0 for name in RANGES if name not in SHARES)


def test_full_passivity_stops_at_the_lower_ends():
    found = activated(Expressivity(spatial=-0.5, openness=0.5, activation=-1.0))
    assert found.spatial == pytest.approx(-0.5 - 0.5 * SHARES["spatial"])
    assert found.openness == pytest.approx(0.5 * (1 - SHARES["openness"]))


def test_it_is_folded_in_once():
    once = activated(Expressivity(power=0.3, activation=0.7))
    assert once.activation == 0.0
    assert activated(once) == once
