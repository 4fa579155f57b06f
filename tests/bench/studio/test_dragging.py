"""Benchmark of the studio's page without a browser.

With a browser, tests/studio/test_stage.py times the page.
"""

from kinesic.bench import studio


def test_missing_browser_gives_null_studio_metrics_with_a_remedy(monkeypatch):
    monkeypatch.setattr(studio, "find_binary", lambda: None)
    assert [(metric.name, metric.value, metric.why) for metric in studio.bench_page()] == [
        (name, None, "no Chromium: apt-get install chromium") for name in studio.PAGE_GOALS
    ]
