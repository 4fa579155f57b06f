"""Setups from names, files and options."""

import pytest

from kinesic.body.config import ConfigError
from kinesic.session.setup import set_up


def test_default_setup_is_neutral_upper22_without_idle_motion_or_variation():
    setup = set_up()
    assert (setup.robot.name, setup.style.name) == ("upper22", "neutral")
    assert (setup.idling.amount, setup.variation.amount) == (0.0, 0.0)


def test_target_without_three_finite_numbers_is_refused():
    for point in ([1.0, 2.0], [1.0, 2.0, float("nan")]):
        with pytest.raises(ConfigError, match=r"target screen is .* it needs three finite numbers"):
            set_up(targets={"screen": point})


def test_style_settings_may_be_a_mapping_or_key_value_strings():
    assert set_up(settings={"power": 0.5}).style == set_up(settings=("power=0.5",)).style
