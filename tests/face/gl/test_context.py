"""Tests of OpenGL calls through ctypes and their errors."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from kinesic.egl import GraphicsError
from kinesic.face.display import open_offscreen_context
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.functions import FUNCTION_SIGNATURES, Functions
from kinesic.face.gl.programs import VertexColumn

VERTEX_SHADER = """#version 330 core
uniform mat2 turn; in vec2 corner; in float share; out float seen;
void main() { seen = share; gl_Position = vec4(turn * corner, 0.5, 1.0); }"""
FRAGMENT_SHADER = """#version 330 core
uniform vec3 tints[2]; uniform sampler2D picture; in float seen; out vec4 found;
void main() { found = vec4(tints[1] * seen, texelFetch(picture, ivec2(0), 0).g); }"""
FULL_TRIANGLE = np.array([[-1, -1, 0.5], [3, -1, 0.5], [-1, 3, 0.5]])  # corners; covers the whole frame


@pytest.fixture(scope="module")
def context(drawable: None) -> Iterator[GlContext]:
    with open_offscreen_context() as opened:
        yield opened
        assert opened.error == 0


@pytest.mark.parametrize("components", [1, 2, 3, 4])
@pytest.mark.parametrize(("kind", "stored"), [("f1", "u1"), ("f2", "f2"), ("f4", "f4")])
def test_opengl_texture_pixels_are_read_back_unchanged(context: GlContext, components: int, kind: str, stored: str):
    pixels = np.arange(3 * 5 * components).astype(stored).tobytes()
    texture = context.texture((3, 5), components, pixels, kind)
    assert texture.read() == pixels
    assert context.frame([texture]).read() == pixels
    texture.write(pixels[::-1])
    assert context.texture((3, 5), components, texture.read(), kind).read() == pixels[::-1]


def test_written_mipmap_levels_are_read_back_by_a_shader(context: GlContext):
    """Read the last of three levels by a one-pixel frame."""
    texture = context.texture((4, 4), 1, bytes(16), "f1")
    texture.write_smaller([bytes([50] * 4), b"\x64"])
    texture.filter = (gl.GL_LINEAR_MIPMAP_NEAREST, gl.GL_LINEAR)
    source = "#version 330 core\nuniform sampler2D picture; out float found;"
    source += "void main() { found = textureLod(picture, vec2(0.5), LEVEL).r; }"
    vertex = "#version 330 core\nin vec2 corner; void main() { gl_Position = vec4(corner, 0.5, 1.0); }"
    seen = []
    for level in range(3):
        program = context.program(vertex, source.replace("LEVEL", f"{level}.0"))
        frame = context.frame([context.texture((1, 1), 1)])
        texture.use()
        program.sample("picture", 0)
        frame.use()
        context.switch_on()
        corners = context.buffer(FULL_TRIANGLE.astype("f4").tobytes())
        context.vertices(program, [VertexColumn("corner", corners, 2, 0, 3)]).render()
        seen.append(frame.read()[0])
    assert seen == [0, 50, 100]


def drawn(context: GlContext, tints: object, turn: object = ((1, 0), (0, 1))) -> list[float]:
    """Return the last pixel of a frame covered by a program."""
    frame = context.frame([context.texture((4, 4), 4, kind="f4")], context.depth_buffer((4, 4)))
    program = context.program(VERTEX_SHADER, FRAGMENT_SHADER)
    corners = context.buffer(FULL_TRIANGLE.astype("f4").tobytes())
    columns = [VertexColumn("corner", corners, 2, 0, 3), VertexColumn("share", corners, 1, 2, 3)]
    indices = context.buffer(np.array([0, 1, 2], "i4").tobytes())
    program.set("tints", tints)
    program.set("turn", turn)
    context.texture((1, 1), 2, bytes((0, 51))).use(3)
    program.sample("picture", 3)
    frame.clear(0.25, 0.5, 0.75, 1.0)
    frame.use()
    context.switch_on(gl.GL_DEPTH_TEST)
    context.compare_depth("<")
    context.vertices(program, columns, indices).render()
    return np.frombuffer(frame.read(), "f4")[-4:].tolist()


def test_opengl_uniforms_attributes_and_textures_reach_a_drawn_pixel(context: GlContext):
    assert drawn(context, [[9, 9, 9], [0.5, 1.0, 2.0]]) == pytest.approx([0.25, 0.5, 1.0, 0.2])


def test_matrix_rows_become_columns_in_the_opengl_shader(context: GlContext):
    """Rotate a triangle by 180 degrees away from the last pixel."""
    assert drawn(context, np.ones((2, 3)), -np.eye(2)) == pytest.approx([0.5, 0.5, 0.5, 0.2])
    assert drawn(context, np.ones((2, 3)), [[0.1, 0.0], [0.0, 0.1]]) == [0.25, 0.5, 0.75, 1.0]


def test_opengl_scissor_and_depth_mask_protect_pixels(context: GlContext):
    frame = context.frame([context.texture((4, 4), 1)], context.depth_buffer((4, 4)))
    frame.clear(0.0, depth=0.25)
    frame.depth_mask = False
    frame.clear(1.0, depth=0.75)
    assert np.frombuffer(frame.read_depth(), "f4").tolist() == pytest.approx([0.25] * 16)
    context.confine((0, 0, 2, 4))
    frame.clear(0.0)
    context.confine(None)
    assert frame.read() == bytes((0, 0, 255, 255)) * 4


def test_copied_framebuffer_has_the_pixels_of_its_source(context: GlContext):
    one, other = (context.frame([context.texture((2, 2), 1)]) for _ in range(2))
    one.clear(1.0)
    other.copy(one)
    assert other.read() == b"\xff" * 4


def test_leaving_an_opengl_context_restores_the_previous_one(context: GlContext):
    with context:
        previous = context.texture((1, 1), 1, b"a")
        with open_offscreen_context() as inner, inner, context:
            assert previous.read() == b"a"
        with context:
            assert previous.read() == b"a"


def test_opengl_drawing_time_is_measured(context: GlContext):
    with context:
        assert 0.0 <= context.elapsed(lambda: context.frame([context.texture((64, 64), 4)]).clear()) < 60.0
        assert context.renderer


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (
            lambda c: c.program(VERTEX_SHADER, "#version 330 core\nvoid main() { x = 1.0; }"),
            "a shader does not compile: .*x",
        ),
        (
            lambda c: c.program(VERTEX_SHADER, FRAGMENT_SHADER.replace("in float", "in vec3")),
            "shaders cannot be linked|not compile",
        ),
        (lambda c: c.texture((2, 2), 3, b"short"), "5 bytes for 2 x 2 pixels, which need 12"),
        (lambda c: c.buffer(b"1234").write(b"12345"), "5 bytes do not fit into a buffer of 4"),
        (lambda c: c.program(VERTEX_SHADER, FRAGMENT_SHADER).set("tints", [1.0]), "tints needs 6 numbers, not 1"),
        (
            lambda c: c.frame([c.texture((1, 1), 1), c.depth_texture((1, 1))]),
            "cannot draw into textures of these formats",
        ),
        (
            lambda c: c.vertices(
                c.program(VERTEX_SHADER, FRAGMENT_SHADER), [VertexColumn("nose", c.buffer(b"1234"), 1, 0, 1)]
            ),
            "the program has no attribute nose",
        ),
    ],
)
def test_opengl_misuse_raises_an_error(context: GlContext, wrong, says: str):
    with context, pytest.raises(GraphicsError, match=says):
        wrong(context)
    with context:
        context.error  # noqa: B018 - what OpenGL says itself is forgotten


def test_unknown_uniform_or_function_raises_an_error(context: GlContext):
    with context, pytest.raises(KeyError, match="nose"):
        context.program(VERTEX_SHADER, FRAGMENT_SHADER).set("nose", 1.0)
    with pytest.raises(GraphicsError, match="this OpenGL has no glClear"):
        Functions(lambda _: 0).Clear(0)
    with pytest.raises(AttributeError, match="Fly"):
        Functions(lambda _: 0).Fly()


def test_all_listed_opengl_functions_are_available(context: GlContext):
    with context:
        for name in FUNCTION_SIGNATURES:
            assert callable(getattr(context.functions, name)), name


def test_second_thread_can_open_an_opengl_context(context: GlContext):
    """Select OpenGL in the thread, where EGL starts with OpenGL ES."""
    with ThreadPoolExecutor(1) as thread:
        assert thread.submit(red_of_a_frame).result() == 255


def red_of_a_frame() -> int:
    with open_offscreen_context() as opened:
        return int(opened.frame([opened.texture((1, 1), 4, bytes((255, 0, 0, 0)))]).read()[0])
