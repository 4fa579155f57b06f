from dataclasses import replace

import pytest

from kinesic.capture import certified_plan
from kinesic.capture.certified_plan import plan_captured
from kinesic.capture.reading.text import CaptureError

from .clips import reach
from .test_retarget import clip_of


def test_captured_motion_without_enough_clearance_after_certification_is_refused(known, monkeypatch):
    certify = certified_plan.certify_clip
    monkeypatch.setattr(certified_plan, "certify_clip", lambda *inputs: replace(certify(*inputs), clearance=-0.003))
    with pytest.raises(CaptureError, match=r"a.bvh: no motion within all limits found: clearance -3 mm of 10 mm"):
        plan_captured(clip_of(reach(20)), known, source="a.bvh")
