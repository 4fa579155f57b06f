"""Timing of drawing, by the graphics card's clock or the processor's."""

from collections.abc import Callable
from time import perf_counter

import numpy as np

from kinesic.face.gl.context import GlContext
from kinesic.face.gl.programs import VertexColumn

SOFTWARE_RENDERERS = ("llvmpipe", "softpipe", "swrast")  # names of OpenGL renderers that draw with the processor
BUSY_TIME = 0.015  # [s] filler work of the graphics card while the measured commands are queued
BUSY_SIZE = 512  # [pixels] side of the picture drawn as filler work
MAX_BUSY_STEPS = 1e7  # largest number of filler iterations per pixel

# Shader of the filler work that draws one triangle over the whole picture.
VERTEX_SHADER = """#version 330 core
in vec2 corner;
void main() { gl_Position = vec4(corner, 0.5, 1.0); }"""
# Shader of the filler work that computes `steps` iterations per pixel.
FRAGMENT_SHADER = """#version 330 core
uniform float steps;
out vec4 found;
void main() {
    float x = gl_FragCoord.x;
    for (float k = 0.0; k < steps; k += 1.0) x = sin(x + k);
    found = vec4(x);
}"""


class DrawingClock:
    """A clock of drawing time that excludes the time to submit commands.

    A card that waits for commands would add the submission time. Before each measurement the card is therefore kept
    busy until all commands are in its queue.
    """

    def __init__(self, context: GlContext, *, of_card: bool | None = None) -> None:
        """Choose GPU or CPU clock, and calibrate filler work for a GPU.

        Args:
            context: OpenGL context that draws.
            of_card: whether to use the card's own clock; None: use it unless the processor draws.
        """
        self.context = context
        self.of_card = not any(name in context.renderer for name in SOFTWARE_RENDERERS) if of_card is None else of_card
        self._steps = 0.0
        if self.of_card:
            self._frame = context.frame([context.texture((BUSY_SIZE, BUSY_SIZE), 4)])
            self._program = context.program(VERTEX_SHADER, FRAGMENT_SHADER)
            corners = context.buffer(np.array([-1, -1, 3, -1, -1, 3], dtype="f4").tobytes())
            self._triangle = context.vertices(self._program, [VertexColumn("corner", corners, 2, 0, 2)])
            self._steps = 16.0
            while context.elapsed(self._keep_busy) < BUSY_TIME and self._steps < MAX_BUSY_STEPS:
                self._steps *= 2.0

    def milliseconds(self, draw: Callable[[], object], *, of_card: bool | None = None) -> float:
        """Call a drawing function once and return the drawing time [ms].

        `of_card` overrides the choice of the clock.
        """
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
