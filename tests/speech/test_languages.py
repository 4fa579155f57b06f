from pathlib import Path

import pytest

from kinesic.speech.espeak import voice_of, voices
from kinesic.speech.espeak_pool import engine


@pytest.fixture(scope="module")
def data() -> Path:
    place = engine()
    if place is None:
        pytest.skip("espeak-ng is not installed")
    return place.data


@pytest.mark.parametrize(
    ("tag", "voice"),
    [
        ("en", "en-US"),
        ("EN_gb", "en"),
        ("fr", "fr"),
        ("de-AT", "de"),
        ("pt-br", "pt-BR"),
        ("zh-Hans-CN", "cmn"),
        ("no", "nb"),
    ],
)
def test_a_tag_finds_its_voice_in_any_spelling(tag: str, voice: str, data: Path):
    found, remark = voice_of(tag, data)
    assert found.rpartition("/")[2] == voice
    assert remark == ""


@pytest.mark.parametrize("tag", ["tlh", "", "klingon", "-"])
def test_a_language_that_nobody_speaks_is_read_as_english_and_says_so(tag: str, data: Path):
    found, remark = voice_of(tag, data)
    assert found == voices(data)["en-us"]
    assert repr(tag) in remark
