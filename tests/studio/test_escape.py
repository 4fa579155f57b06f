"""Escape key in a dialog of the studio, with a moving or resting robot."""

from .conftest import Studio

DRAWN = False  # WebGL pictures are tested in test_stage.py
ESCAPE = 27
WAVE = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc">
  <gesture id="g" lexeme="wave" start="1" end="5"/>
</bml>"""


def test_escape_key_in_the_save_dialog_of_the_studio_stops_the_robot_only_while_it_moves(studio: Studio):
    studio.write(WAVE)
    dialog = "document.querySelector('#saving').open"
    studio.until("!s.performs && !s.stopped")
    studio.rest(2.0)  # the state is playing up to a second after the last block
    studio.page.click("#save-as")
    studio.page.until(dialog)
    studio.rest(0.5)  # until the server has said that the robot rests
    studio.page.press("Escape", ESCAPE)
    studio.page.until(f"!{dialog}")
    studio.rest(1.0)
    assert not studio.state("stopped")
    studio.page.click("#perform")
    studio.until("s.performs")
    studio.page.click("#save-as")
    studio.page.until(dialog)
    studio.page.press("Escape", ESCAPE)
    studio.until("s.stopped")
    assert not studio.page.value(dialog)
    studio.page.click("#resume")
    studio.until("!s.stopped && !document.querySelector('#perform').disabled")
