"""What is said when, in the score of a block."""

from itertools import pairwise

import pytest

from kinesic.controller.performance import Performance
from kinesic.report.plots.score import captions


def test_pieces_join_between_the_marks(hurried: Performance, calm: Performance) -> None:
    pieces = [said for said in captions(hurried.plan) if said.text]
    assert [said.text for said in pieces] == ["Hello there,", "welcome"]
    utterance = hurried.plan.utterances["s"]
    zero = hurried.plan.trajectory.zero
    assert pieces[1].begin == pytest.approx(zero + utterance.marks["two"])
    assert pieces[1].end == pytest.approx(zero + utterance.duration)
    assert all(a.end == b.begin for a, b in pairwise(pieces))
    assert list(captions(calm.plan)) == []
