"""Times drawing: by the graphics card's own clock, or by ours where the processor draws."""

from collections.abc import Callable
from time import perf_counter

import numpy as np

from kinesic.face.gl.context import GlContext
from kinesic.face.gl.programs import Column

SOFTWARE = ("llvmpipe", "softpipe", "swrast")
BUSY = 0.015  # [s] that a card is kept busy for, in which what is timed next is asked for
SIDE = 512  # pixels of what it draws meanwhile
MOST = 1e7  # steps of each pixel

VERTEX = """#version 330 core
in vec2 corner;
void main() { gl_Position = vec4(corner, 0.5, 1.0); }"""
FRAGMENT = """#version 330 core
uniform float steps;
out vec4 found;
void main() {
    float x = gl_FragCoord.x;
    for (float k = 0.0; k < steps; k += 1.0) x = sin(x + k);
    found = vec4(x);
}"""


class Clock:
    """Measures how long a context draws, without the time that asking for it takes.

    A card that waits for us would count our own slowness: before each measurement it is kept busy, until all of it is
    in its queue.
    """

    def __init__(self, context: GlContext, *, of_card: bool | None = None) -> None:
        """Finds out which clock serves, and how much keeps a card busy.

        Args:
            context: that draws.
            of_card: whether its own clock is asked; None: unless the processor draws.
        """
        self.context = context
        self.of_card = not any(name in context.renderer for name in SOFTWARE) if of_card is None else of_card
        self._steps = 0.0
        if self.of_card:
            self._frame = context.frame([context.texture((SIDE, SIDE), 4)])
            self._program = context.program(VERTEX, FRAGMENT)
            corners = context.buffer(np.array([-1, -1, 3, -1, -1, 3], dtype="f4").tobytes())
            self._triangle = context.vertices(self._program, [Column("corner", corners, 2, 0, 2)])
            self._steps = 16.0
            while context.elapsed(self._keep_busy) < BUSY and self._steps < MOST:
                self._steps *= 2.0

    def milliseconds(self, draw: Callable[[], object], *, of_card: bool | None = None) -> float:
        """Draws and tells how long that took, by the card's clock or not, if that is said."""
        self.context.finish()
        if self.of_card if of_card is None else of_card:
            self._keep_busy()
            return 1e3 * self.context.elapsed(draw)
        began = perf_counter()
        draw()
        self.context.finish()
        return 1e3 * (perf_counter() - began)

    def _keep_busy(self) -> None:
        self._program.set("steps", self._steps)
        self._frame.use()
        self.context.switch_on()
        self._triangle.render()
