from kinesic.bench.face.prosody import measure_prosody
from kinesic.speech.durations import DurationModel


def test_face_moves_on_at_least_20_percent_of_story_accents_and_blinks_every_minute():
    values = measure_prosody(DurationModel())
    assert 20.0 <= values["face.prosody.accents_moved"] <= 100.0
    assert 10.0 <= values["face.prosody.brows"] <= 40.0
    assert 10.0 <= values["face.prosody.blinks_fewest"] <= values["face.prosody.blinks_most"] <= 25.0
