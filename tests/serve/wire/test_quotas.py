import re
from pathlib import Path
from xml.etree.ElementTree import fromstring

import pytest

from kinesic.serve.wire import quotas
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS, Quotas, TokenBucket, quota_feedback


@pytest.mark.parametrize(
    "name", ["message", "rate", "burst", "waiting", "clients", "fragments", "unread", "patience", "planning"]
)
def test_non_positive_quotas_are_refused(name):
    with pytest.raises(ValueError, match=f"{name} is 0, must be above 0"):
        Quotas(**{name: 0})


def test_default_quotas_match_the_documentation():
    page = (Path(__file__).parents[3] / "docs" / "reference" / "wire-protocol.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `(\w+)`(?:, `burst`)? \| ([\d ]*\d)", page, re.MULTILINE))
    results = {name: float(figure.replace(" ", "")) for name, figure in rows.items() if hasattr(DEFAULT_QUOTAS, name)}
    assert results.keys() >= {"message", "depth", "duration", "rate", "waiting", "clients", "unread"}
    assert results == {name: getattr(DEFAULT_QUOTAS, name) for name in results}


def test_token_bucket_allows_a_burst_then_the_rate(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(quotas, "monotonic", lambda: now[0])
    bucket = TokenBucket(10.0, 3)
    assert [bucket.take() for _ in range(5)] == [True, True, True, False, False]
    now[0] = 0.25
    assert [bucket.take() for _ in range(3)] == [True, True, False]
    now[0] = 1000.0
    assert [bucket.take() for _ in range(4)] == [True, True, True, False]
    now[0] = 2000.0
    bucket.empty()
    now[0] = 2000.15
    assert [bucket.take() for _ in range(2)] == [True, False]
    for _ in range(2):
        bucket.widen(5)
    bucket.widen(1)
    assert [bucket.take() for _ in range(3)] == [True, True, False]
    now[0] = 3000.0
    assert sum(bucket.take() for _ in range(8)) == 5


def test_quota_refusal_names_the_exceeded_rule():
    result = fromstring(quota_feedback("rate", "too many"))
    assert result.tag.endswith("warningFeedback")
    assert result.text == "rule rate: too many"
