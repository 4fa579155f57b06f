"""What of a speech is heard when."""

from itertools import pairwise

import pytest

from kinesic.controller.performance import Performance
from kinesic.planning.captions import captions


def test_pieces_join_between_the_marks(hurried: Performance, calm: Performance) -> None:
    pieces = [said for said in captions(hurried.plan) if said.text]
    assert [said.text for said in pieces] == ["Hello there,", "welcome"]
    assert [said.mark for said in pieces][1] == "two"
    utterance = hurried.plan.utterances["s"]
    zero = hurried.plan.trajectory.zero
    assert pieces[1].begin == pytest.approx(zero + utterance.marks["two"])
    assert pieces[1].end == pytest.approx(zero + utterance.duration)
    assert all(a.end == b.begin for a, b in pairwise(pieces))
    assert list(captions(calm.plan)) == []
