"""BML block of about five seconds that moves both hands, head and torso."""

PASSAGE_BML = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="passage">
  <gesture id="g1" lexeme="offer" mode="BOTH_HANDS" start="{0:.3f}" stroke="{1:.3f}" end="{2:.3f}"/>
  <gesture id="g2" lexeme="beat" mode="RIGHT_HAND" stroke="{3:.3f}"/>
  <gesture id="g3" lexeme="large" mode="BOTH_HANDS" stroke="{4:.3f}" end="{5:.3f}"/>
  <head id="h1" lexeme="NOD" amount="0.6" start="{6:.3f}"/>
  <head id="h2" lexeme="NOD" amount="0.4" repetition="2" start="{7:.3f}"/>
  <gaze id="z1" target="left" start="{8:.3f}" end="{9:.3f}"/>
</bml>
"""
STROKE_TIMES = (0.2, 1.0, 2.2, 2.7, 3.9, 5.0, 0.4, 2.0, 3.4, 4.7)  # [s] times of the strokes


def passage_text(repetition: int) -> str:
    """Return the block with stroke times that depend slightly on the repetition."""
    return PASSAGE_BML.format(*(time + 0.003 * (repetition % 17) for time in STROKE_TIMES))
