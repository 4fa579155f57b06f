from kinesic.bench.face.prosody import measure_prosody
from kinesic.speech.durations import DurationModel


def test_story_has_motion_on_accents_and_blinks_in_every_minute():
    values = measure_prosody(DurationModel())
    assert 20.0 <= values["face.prosody.accents_moved"] <= 100.0
    assert 10.0 <= values["face.prosody.brows"] <= 40.0
    assert 10.0 <= values["face.prosody.blinks_fewest"] <= values["face.prosody.blinks_most"] <= 25.0
