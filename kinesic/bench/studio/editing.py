"""Delay from an edit in the studio until its timeline is drawn."""

import json

from kinesic.bench.studio.browser import Page
from kinesic.bench.studio.dragging import READY_SCRIPT

EDITED_BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="edited"><speech id="s"><text>Well, this one here is '
    'rather <sync id="a"/>small, light as a <sync id="b"/>feather, and the other one over there is <sync id="c"/>large.'
    '</text></speech><gesture id="g" lexeme="BEAT" mode="LEFT_HAND" stroke="s:a+{:.3f}"/>'
    '<gesture id="h" lexeme="GIVE" stroke="s:b"/><gesture id="i" lexeme="BEAT" mode="RIGHT_HAND" stroke="s:c"/>'
    '<head id="n" lexeme="NOD" stroke="s:c"/></bml>'
)  # BML block of about 5 s that the benchmark edits
EDIT_SHIFT = 0.01  # [s] shift of a stroke per edit
EDIT_SCRIPT = """(async (text) => {{
  const frame = () => new Promise(requestAnimationFrame);
  const {{ document, plan }} = kinesicStudio;
  const [before, began] = [plan.count, performance.now()];
  document.edit(text);
  while (plan.count === before) await frame();
  await frame();
  return performance.now() - began;
}})({})"""  # [ms] from an edit until the frame after its plan has arrived


def time_page_edits(page: Page, count: int) -> list[float]:
    """Move a stroke on the studio page and return drawing times [ms].

    The first edit is not counted.
    """
    page.wait(READY_SCRIPT)
    texts = [EDITED_BLOCK.format(EDIT_SHIFT * k) for k in range(count + 1)]
    return [page.read(EDIT_SCRIPT.format(json.dumps(text)), float) for text in texts][1:]
