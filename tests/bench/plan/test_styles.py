from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.plan.styles import DOCUMENT_COUNT, StrokeErrors, measure_plans, style_error_metrics, write_documents
from kinesic.session.plan import plan

NOD_BML = '<bml id="b"><head id="h" lexeme="NOD" amount="1" repetition="5" start="0.5" end="{}"/></bml>'


def test_style_benchmark_writes_twenty_different_texts():
    texts = write_documents()
    assert len(texts) == len(set(texts)) == DOCUMENT_COUNT
    assert all(text.endswith(".") and len(text) > 100 for text in texts)


def test_stroke_error_equals_the_planned_shift_if_a_stroke_has_too_little_time(known):
    errors = {time: measure_plans([plan(NOD_BML.format(time), known)]) for time in (5.0, 1.2)}
    assert errors[5.0].shift == 0.0
    assert errors[5.0].errors.max() < 0.05
    assert errors[1.2].shift > 0.05
    assert errors[1.2].errors.max() == pytest.approx(errors[1.2].shift, abs=0.03)
    assert [error.lost for error in errors.values()] == [0, 0]


def test_late_strokes_fail_the_99th_percentile_goal_of_stroke_errors():
    good = StrokeErrors(np.full(20, 0.01), 0, 0.0)
    late = replace(good, errors=np.append(np.full(17, 0.01), [0.1, 0.2, 0.3]), shift=0.3)
    assert [metric.ok for metric in style_error_metrics("part", good)][:2] == [True, True]
    assert [metric.ok for metric in style_error_metrics("part", late)][:2] == [True, False]
    assert [metric.why for metric in style_error_metrics("part", late)][1] == "largest shift in the plan: 300 ms"
