"""Tests of pictures that are drawn on access."""

import numpy as np
import pytest

from kinesic.face.show.pictures import LazyPictures


def test_pictures_of_a_lazy_sequence_are_drawn_on_access():
    drawn = []

    def draw(index: int):
        drawn.append(index)
        return np.full((1, 1, 3), index, dtype=np.uint8)

    pictures = LazyPictures(4, draw)
    assert len(pictures) == 4
    assert drawn == []
    assert [int(item[0, 0, 0]) for item in pictures] == [0, 1, 2, 3]
    assert int(pictures[-1][0, 0, 0]) == 3
    assert [int(item[0, 0, 0]) for item in pictures[1:3]] == [1, 2]
    with pytest.raises(IndexError):
        pictures[4]
