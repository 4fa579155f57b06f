import json

import pytest

from kinesic.speech.espeak_pool import espeak_fault

HURRIED_BML = b"""<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <speech id="s"><text>See <sync id="a"/>this, <sync id="b"/>this.</text></speech>
  <gesture id="g1" lexeme="offer" mode="RIGHT_HAND" stroke="s:a"/>
  <gesture id="g2" lexeme="large" mode="BOTH_HANDS" stroke="s:b"/>
</bml>
"""


def perform_hurried(kinesic, folder, *options: str) -> dict:
    (folder / "hurried.bml").write_bytes(HURRIED_BML)
    out = str(folder / "out")
    ended = kinesic("perform", str(folder / "hurried.bml"), "--no-film", "--json", "--force", "--out", out, *options)
    assert ended.code in (0, 1), ended.err
    return json.loads(ended.out)


def test_perform_writes_speech_synthesised_by_espeak_to_a_wav_file(kinesic, tmp_path):
    if espeak_fault():
        pytest.skip(espeak_fault())
    assert [speech["heard"] for speech in perform_hurried(kinesic, tmp_path)["speech"]] == [True]
    assert (tmp_path / "out" / "speech.wav").stat().st_size > 10000


def test_option_pause_allows_speech_pauses_that_wait_for_the_body(kinesic, tmp_path):
    def pauses(*options: str) -> list[str]:
        warnings = perform_hurried(kinesic, tmp_path, "--voice", "durations", *options)["warnings"]
        return [warning["text"] for warning in warnings if warning["text"].startswith("a pause of")]

    assert pauses() == []
    assert pauses("--pause", "1")


@pytest.mark.parametrize("option", [("--voice", "nobody"), ("--pause", "-1"), ("--pause", "soon")])
def test_invalid_voice_option_is_refused(option, kinesic, tmp_path):
    (tmp_path / "hurried.bml").write_bytes(HURRIED_BML)
    ended = kinesic("plan", str(tmp_path / "hurried.bml"), "--out", str(tmp_path / "motion.npz"), *option)
    assert ended.code == 2
    assert option[0] in ended.err
