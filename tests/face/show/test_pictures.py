"""Pictures that are drawn when they are asked for."""

import numpy as np
import pytest

from kinesic.face.show.pictures import LazyPictures


def test_they_are_a_sequence_and_none_is_drawn_before_it_is_asked_for():
    drawn = []

    def draw(index: int):
        drawn.append(index)
        return np.full((1, 1, 3), index, dtype=np.uint8)

    pictures = LazyPictures(4, draw)
    assert len(pictures) == 4
    assert drawn == []
    assert [int(each[0, 0, 0]) for each in pictures] == [0, 1, 2, 3]
    assert int(pictures[-1][0, 0, 0]) == 3
    assert [int(each[0, 0, 0]) for each in pictures[1:3]] == [1, 2]
    with pytest.raises(IndexError):
        pictures[4]
