"""Tests of captions: the spoken text with its times."""

from itertools import pairwise

import pytest

from kinesic.metrics.dry_run import DryRun
from kinesic.planning.captions import make_captions


def test_captions_cover_the_spoken_text_between_speech_marks(hurried: DryRun, calm: DryRun) -> None:
    pieces = [said for said in make_captions(hurried.plan) if said.text]
    assert [said.text for said in pieces] == ["Hello there,", "welcome"]
    assert [said.mark for said in pieces][1] == "two"
    utterance = hurried.plan.utterances["s"]
    zero = hurried.plan.trajectory.zero
    assert pieces[1].begin == pytest.approx(zero + utterance.marks["two"])
    assert pieces[1].end == pytest.approx(zero + utterance.duration)
    assert all(a.end == b.begin for a, b in pairwise(pieces))
    assert list(make_captions(calm.plan)) == []
