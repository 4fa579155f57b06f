"""Moving and still pictures of the robot, drawn off screen."""

from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import reduce
from pathlib import Path
from typing import TypeVar

import mujoco
import numpy as np
from PIL import Image

from kinesic.body.arrays import Floats, Picture
from kinesic.body.robot import Robot
from kinesic.files.caption_band import Spoken, caption_box, words_at, write_caption
from kinesic.files.film_file import EncodingError, PixelBox, durations, open_film
from kinesic.sim.filming.canvas import Canvas, CanvasError
from kinesic.sim.filming.framing import (
    bounding_box,
    motion_view,
    moving_balls,
    robot_boxes,
    seen_at,
    shadow_boxes,
    sunk_balls,
)
from kinesic.sim.filming.soft_shadow import shade, shadow_outlines
from kinesic.sim.gl import missing_libraries, opengl_fault
from kinesic.sim.model import turn_order
from kinesic.sim.scene_layout import SceneView, view_of
from kinesic.sim.scene_style import styled_model

__all__ = ["FilmError", "film", "moments", "opengl_fault", "write_still"]

T = TypeVar("T")
Faces = Callable[[int, float], Picture]  # the face that is seen in a picture, by its number and time [s]
SIZE = (480, 360)  # [pixels] width and height of a still
FILM_SIZE = (1280, 720)
FILM_RATE = 30.0  # [Hz]
FINER = 2  # pixels that are drawn along a side of one
MOST_PICTURES = 3600  # of one film: two minutes; a longer one has fewer a second
REACH = 0.08  # arm lengths that the screen of the head and servos may be seen beyond a robot's shapes


class FilmError(RuntimeError):
    """Pictures cannot be drawn here: says what is missing and the line that mends it."""


def moments(begin: float, end: float, rate: float = FILM_RATE) -> Floats:
    """[s] of the pictures of a motion at a rate [Hz], or at a lower one where they would be more than MOST_PICTURES."""
    period = max(1 / rate, (end - begin) / MOST_PICTURES)
    return np.arange(begin, end + 1e-9, period)


def film(
    robot: Robot,
    times: Floats,
    angles: Floats,
    path: Path,
    *,
    size: tuple[int, int] = FILM_SIZE,
    rate: float = FILM_RATE,
    faces: Faces | None = None,
    spoken: Sequence[Spoken] = (),
    sound: Path | None = None,
    progress: Callable[[float], None] = lambda share: None,
    guarded: bool = True,
) -> None:
    """Writes a motion as a film, whose camera frames the hands and the head.

    Args:
        robot: who moves.
        times: (m,) [s] increasing.
        angles: (m, n) [rad] at these times.
        path: of the film, ending in .webp, or .mp4 where an encoder is installed.
        size: width and height of a picture, in pixels; both even.
        rate: pictures per second; less when there would be more than MOST_PICTURES.
        faces: what the screen of the head shows; None: a plain face that does nothing.
        spoken: captions.
        sound: a WAV that begins with the film, for .mp4.
        progress: gets the share of the pictures that are drawn, after each of them.
        guarded: whether OpenGL is first tried in another process, as a broken driver may end the one that draws.

    Raises:
        FilmError: OpenGL does not draw on this machine, or there is no encoder.
        ValueError: there is no posture, or times and angles differ in number.
    """
    if len(times) != len(angles) or not len(times):
        raise ValueError(f"a film of {len(angles)} postures at {len(times)} times: both must be the same, at least 1")
    _check_opengl(guarded=guarded)
    shot = moments(float(times[0]), float(times[-1]), rate)
    postures = np.column_stack([np.interp(shot, times, column) for column in angles.T])
    period = float(shot[1] - shot[0]) if len(shot) > 1 else 1 / rate
    said = [words_at(spoken, time + period / 2) for time in shot.tolist()]
    shown = (lambda k: None) if faces is None else (lambda k: faces(k, float(shot[k])))
    view = motion_view(robot, postures, aspect=size[0] / size[1])
    pictures = _one_ahead(_draw_frames(robot, postures, size, shown, view=view))
    try:
        with open_film(path, size, rate=1 / period, sound=sound) as writer:
            before = ""
            for k, ((picture, box), shown_for) in enumerate(
                zip(pictures, durations(len(shot), 1 / period), strict=True)
            ):
                write_caption(picture, said[k])
                bands = [caption_box(text, size) or box for text in {before, said[k]} if before != said[k]]
                writer.write(picture, reduce(bounding_box, bands, box), shown_for)
                before = said[k]
                progress((k + 1) / len(shot))
    except (CanvasError, EncodingError) as error:
        raise FilmError(str(error)) from None


def write_still(robot: Robot, angles: Floats, path: Path, *, size: tuple[int, int] = SIZE) -> None:
    """Writes one posture (n,) [rad] as a PNG.

    Raises:
        FilmError: OpenGL does not draw on this machine.
    """
    _check_opengl(guarded=True)
    try:
        ((picture, _),) = _draw_frames(robot, angles[None], size, lambda k: None, view=view_of(robot))
        Image.fromarray(picture).save(path, format="PNG")
    except CanvasError as error:
        raise FilmError(str(error)) from None


def _one_ahead(pictures: Generator[T, None, None]) -> Iterator[T]:
    """Draws each picture while the one before is written, all in one thread, as OpenGL wants."""
    with ThreadPoolExecutor(1) as thread:
        coming = thread.submit(next, pictures, None)
        try:
            while (found := coming.result()) is not None:
                coming = thread.submit(next, pictures, None)
                yield found
        finally:
            thread.submit(pictures.close).result()


def _draw_frames(
    robot: Robot, postures: Floats, size: tuple[int, int], shown: Callable[[int], Picture | None], *, view: SceneView
) -> Generator[tuple[Picture, PixelBox], None, None]:
    """Draws postures (m, n) [rad]; of all but the first only what changes: yields a picture, and where it did."""
    width, height = (FINER * side for side in size)
    places, radii = moving_balls(robot, postures, [segment.name for segment in robot.skeleton.segments])
    outlines = shadow_outlines(places, radii, view, size=size)
    seen, reach = seen_at(view, places, size=size), radii + REACH * robot.arm_length
    boxes, shadows = robot_boxes(seen, reach, size=size), shadow_boxes(outlines, size=size)
    below, around = sunk_balls(places, reach, view.floor)
    sunk = robot_boxes(seen_at(view, below, size=size), around, size=size) if len(around) else [None] * len(boxes)
    changing = [bounding_box(*both) for both in zip(boxes, shadows, strict=True)]
    model = styled_model(robot, width=width, height=height, view=view)
    data, order = mujoco.MjData(model), turn_order(robot, model)
    with Canvas(model, size, finer=FINER) as canvas:
        mujoco.mj_forward(model, data)
        empty = canvas.draw_empty(data)
        for k, box in enumerate(boxes):
            data.qpos[order] = robot.skeleton.turns(postures[k])
            mujoco.mj_forward(model, data)
            face = shown(k)
            if face is not None:
                canvas.show(face)
            picture = empty.copy()
            shade(picture, shadows[k], outlines[k])
            drawn = canvas.draw(data, box, sunk=sunk[k])
            picture.paste(drawn, box[:2], drawn)
            yield np.array(picture), changing[k] if not k else bounding_box(changing[k - 1], changing[k])


def _check_opengl(*, guarded: bool) -> None:
    if why := opengl_fault() if guarded else missing_libraries():
        raise FilmError(why)
