from kinesic.expressivity.style.style import Style
from kinesic.intent.behaviour_sets import builtin_sets
from kinesic.intent.reading.passage import Passage
from kinesic.intent.recorded import RecordedAudio, choose_accent_behaviours
from kinesic.intent.writing import write_block

AUDIO = RecordedAudio("my & talk.wav", "", lambda passage: passage)


def test_speech_accents_of_a_recording_get_gesture_head_and_face_behaviours():
    selection = choose_accent_behaviours([0.2, 1.5, 4.0, 7.5], 9.0, Style(), builtin_sets())
    strokes = {behaviour.intent.stroke.reference for behaviour in selection.behaviours}
    assert strokes == {"s:start+1.50", "s:start+4.00", "s:start+7.50"}  # the hand cannot reach a stroke at 0.2 s
    assert {behaviour.channel for behaviour in selection.behaviours} == {"gesture", "head", "face"}
    gestures = [behaviour.lexeme for behaviour in selection.behaviours if behaviour.channel == "gesture"]
    assert all(lexeme.startswith("beat") for lexeme in gestures)


def test_recording_without_text_is_written_as_a_speech_with_an_audio_description():
    bml = write_block(Passage((), ()), (), recorded=AUDIO)
    assert '<description priority="1" type="audio/wav"><audio ref="my &amp; talk.wav"/></description>' in bml
    assert '<speech id="s"' in bml


def test_audio_element_names_the_file_of_word_times():
    audio = RecordedAudio("talk.wav", "talk.json", lambda passage: passage)
    assert '<audio ref="talk.wav" kinesic:words="talk.json"/>' in audio.write()
