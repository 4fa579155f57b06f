"""Where there is no browser that is said; with one, tests/studio/test_stage.py times the page."""

from kinesic.bench import studio


def test_without_a_browser_it_is_said_which_one_would_do(monkeypatch):
    monkeypatch.setattr(studio, "find_binary", lambda: None)
    assert [(figure.name, figure.value, figure.why) for figure in studio.bench_page()] == [
        (name, None, "no Chromium: apt-get install chromium") for name in studio.PAGE_GOALS
    ]
