from dataclasses import replace
from time import perf_counter
from types import SimpleNamespace

import pytest

from kinesic.capture import certified_plan
from kinesic.capture.certified_plan import list_notices, plan_captured
from kinesic.capture.reading.text import CaptureError

from .clips import reach
from .test_retarget import clip_of


def test_captured_motion_without_enough_clearance_after_certification_is_refused(known, monkeypatch):
    certify = certified_plan.certify_clip
    monkeypatch.setattr(certified_plan, "certify_clip", lambda *inputs: replace(certify(*inputs), clearance=-0.003))
    with pytest.raises(CaptureError, match=r"a.bvh: no motion within all limits found: clearance -3 mm of 10 mm"):
        plan_captured(clip_of(reach(20)), known, source="a.bvh")


def test_notice_of_a_captured_motion_reports_a_time_stretch_above_half_a_percent(known):
    certification = certified_plan.certify_clip(clip_of(reach(60)), known, "a.bvh")
    for total, is_told in ((1.0, False), (1.004, False), (1.006, True), (2.0, True)):
        nearest = SimpleNamespace(**vars(certification.nearest) | {"total_stretch": total})
        texts = [notice.text for notice in list_notices(replace(certification, nearest=nearest))]
        assert any(f"{total:.2f}" in text for text in texts) == is_told, texts


def test_planning_time_of_a_captured_motion_is_its_duration(known):
    began = perf_counter()
    planned = plan_captured(clip_of(reach(20)), known, source="a.bvh")
    assert 0.0 < planned.seconds <= perf_counter() - began
