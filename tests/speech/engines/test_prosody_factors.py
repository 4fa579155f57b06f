import pytest

from kinesic.body.utterance import Emphasis
from kinesic.speech.engines.phrase import ProsodySection
from kinesic.speech.engines.prosody_factors import EMPHASIS_FACTORS, convert_sections, read_pitch, read_volume


@pytest.mark.parametrize(
    ("text", "factor"),
    [("high", 1.15), ("+12st", 2.0), ("-12st", 0.5), ("+10%", 1.1), ("-20%", 0.8), ("90%", 0.9), ("120Hz", 1.0),
     ("", 1.0), ("nonsense", 1.0), ("+40st", 2.0), ("x-low", 0.75)],
)  # fmt: skip
def test_ssml_pitch_attribute_is_converted_to_a_factor(text: str, factor: float):
    assert read_pitch(text) == pytest.approx(factor)


@pytest.mark.parametrize(
    ("text", "factor"),
    [("silent", 0.0), ("soft", 0.5), ("loud", 2.0), ("+6dB", 1.995), ("-6dB", 0.501), ("50", 0.5), ("+20%", 1.2),
     ("", 1.0), ("nonsense", 1.0), ("+99dB", 4.0)],
)  # fmt: skip
def test_ssml_volume_attribute_is_converted_to_a_factor(text: str, factor: float):
    assert read_volume(text) == pytest.approx(factor, abs=1e-3)


def test_prosody_and_emphasis_elements_become_prosody_sections_but_voice_elements_do_not():
    emphases = (
        Emphasis(0, 5, "prosody", (("rate", "fast"), ("pitch", "low"), ("volume", "50%"))),
        Emphasis(1, 2, "voice"),
        Emphasis(3, 4, "emphasis", (("level", "strong"),)),
        Emphasis(4, 5, "emphasis", (("level", "unknown"),)),
    )
    assert convert_sections(emphases) == (
        ProsodySection(0, 5, 1.25, 0.87, 0.5),
        ProsodySection(3, 4, *EMPHASIS_FACTORS["strong"]),
        ProsodySection(4, 5, *EMPHASIS_FACTORS["moderate"]),
    )
