"""Words for directions, and the file's order of axes."""

import numpy as np
import pytest

from kinesic.expressivity.lexicon.directions import FILE_ORDER, format_direction, read_direction
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.space import position


def test_position_converted_to_the_axis_order_of_lexicon_files_has_the_written_components():
    assert position(0.1, 0.2, 0.3)[list(FILE_ORDER)].tolist() == [0.1, 0.2, 0.3]


@pytest.mark.parametrize(
    "words", ["out", "in", "up", "down", "forward", "back", "in up", "out down back", "down down back"]
)
def test_direction_is_printed_as_the_words_from_which_it_was_read(words: str):
    assert format_direction(read_direction(words)) == words


def test_direction_without_matching_words_is_printed_as_outward_up_and_forward_numbers():
    assert format_direction(np.array([0.1, 0.9, -0.43])) == "0.9 -0.4 0.1"


def test_printed_directions_of_the_lexicon_read_as_the_same_directions():
    poses = [pose for form in Lexicon.load().forms for key in form.keys for pose in key.hands.values()]
    directions = [vector for pose in poses for vector in (pose.palm, pose.pointing) if vector is not None]
    assert len(directions) > 1000
    assert max(np.abs(read_direction(format_direction(vector)) - vector).max() for vector in directions) < 1e-9
