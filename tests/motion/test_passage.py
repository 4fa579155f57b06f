import pytest

from kinesic.motion.passage import Passage


@pytest.mark.parametrize(
    ("name", "value"), [("tension", 1.2), ("continuity", 0.1), ("continuity", -1.1), ("bias", -2.0), ("steepness", 9.0)]
)
def test_numbers_out_of_range_are_refused_with_the_range(name, value):
    with pytest.raises(ValueError, match=rf"{name} is {value:g}, outside \[.*\]"):
        Passage(**{name: value})
