"""Films and still pictures of the robot, rendered off screen."""

from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import reduce
from pathlib import Path
from typing import TypeVar

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, Picture
from kinesic.body.robot import Robot
from kinesic.files.caption_band import Spoken, caption_box, words_at, write_caption
from kinesic.files.film_file import EncodingError, PixelBox, open_film, picture_durations
from kinesic.files.late_pillow import Image
from kinesic.sim.filming.canvas import Canvas, CanvasError
from kinesic.sim.filming.framing import (
    bounding_box,
    clip_below_floor,
    find_capsule_balls,
    find_motion_view,
    find_robot_boxes,
    find_shadow_boxes,
    project_points,
)
from kinesic.sim.filming.soft_shadow import compute_shadow_outlines, shade
from kinesic.sim.gl import missing_libraries, opengl_fault
from kinesic.sim.model import find_turn_indices
from kinesic.sim.scene_layout import SceneView, find_scene_view
from kinesic.sim.scene_style import styled_model

__all__ = ["FilmError", "film", "moments", "opengl_fault", "write_still"]

ItemT = TypeVar("ItemT")
Faces = Callable[[int, float], Picture]  # picture number and time [s] -> picture of the face
STILL_SIZE = (480, 360)  # [pixels] default width and height of a still picture
FILM_SIZE = (1280, 720)  # [pixels] default width and height of a film
FILM_RATE = 30.0  # [Hz] default picture rate of films
SUPERSAMPLING_FACTOR = 2  # rendered pixels per picture pixel along each side
MAX_FILM_PICTURES = 3600  # largest number of pictures of a film; longer films have a lower rate
DRAWN_MARGIN = 0.08  # [arm lengths] extent of drawn head screen and servos beyond the robot's capsules


class FilmError(RuntimeError):
    """Failure to draw or encode pictures, with the cause and a remedy."""


def moments(begin: float, end: float, rate: float = FILM_RATE) -> Floats:
    """Return the times (m,) [s] of a film's pictures.

    Args:
        begin: [s].
        end: [s].
        rate: [Hz] reduced if the film would exceed `MAX_FILM_PICTURES` pictures.
    """
    period = max(1 / rate, (end - begin) / MAX_FILM_PICTURES)
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
    progress: Callable[[float], None] = lambda fraction: None,
    guarded: bool = True,
) -> None:
    """Render a motion as a film file, with optional captions and sound.

    The camera frames the hands and the head.

    Args:
        robot: Robot that moves.
        times: (m,) [s] increasing.
        angles: (m, n) [rad] at these times.
        path: Output file ending in .webp, or in .mp4 if an encoder is installed.
        size: Width and height of a picture [pixels]; both even.
        rate: [Hz] pictures per second; less if there would be more than `MAX_FILM_PICTURES`.
        faces: Pictures for the screen on the head; None: a plain face without motion.
        spoken: Captions.
        sound: WAV file that starts with the film, for .mp4.
        progress: Callback with the fraction of pictures drawn, called after each picture.
        guarded: Whether to test OpenGL in another process first, as a broken driver may end the process that draws.

    Raises:
        FilmError: OpenGL does not draw on this machine, or there is no encoder.
        ValueError: there is no posture, or times and angles differ in number.
    """
    if len(times) != len(angles) or not len(times):
        raise ValueError(f"a film of {len(angles)} postures at {len(times)} times: both must be the same, at least 1")
    _check_opengl(guarded=guarded)
    picture_times = moments(float(times[0]), float(times[-1]), rate)
    postures = np.column_stack([np.interp(picture_times, times, column) for column in angles.T])
    period = float(picture_times[1] - picture_times[0]) if len(picture_times) > 1 else 1 / rate
    captions = [words_at(spoken, time + period / 2) for time in picture_times.tolist()]
    face_at = (lambda k: None) if faces is None else (lambda k: faces(k, float(picture_times[k])))
    view = find_motion_view(robot, postures, aspect=size[0] / size[1])
    pictures = _draw_ahead(_draw_frames(robot, postures, size, face_at, view=view))
    try:
        with open_film(path, size, rate=1 / period, sound=sound) as writer:
            last_caption = ""
            for k, ((picture, box), duration) in enumerate(
                zip(pictures, picture_durations(len(picture_times), 1 / period), strict=True)
            ):
                write_caption(picture, captions[k])
                bands = [
                    caption_box(text, size) or box
                    for text in {last_caption, captions[k]}
                    if last_caption != captions[k]
                ]
                writer.write(picture, reduce(bounding_box, bands, box), duration)
                last_caption = captions[k]
                progress((k + 1) / len(picture_times))
    except (CanvasError, EncodingError) as error:
        raise FilmError(str(error)) from None


def write_still(robot: Robot, angles: Floats, path: Path, *, size: tuple[int, int] = STILL_SIZE) -> None:
    """Write a picture of one posture (n,) [rad] as a PNG file.

    Raises:
        FilmError: OpenGL does not draw on this machine.
    """
    _check_opengl(guarded=True)
    try:
        ((picture, _),) = _draw_frames(robot, angles[None], size, lambda k: None, view=find_scene_view(robot))
        Image.fromarray(picture).save(path, format="PNG")
    except CanvasError as error:
        raise FilmError(str(error)) from None


def _draw_ahead(pictures: Generator[ItemT, None, None]) -> Iterator[ItemT]:
    """Yield pictures while the next one is drawn in a worker thread.

    All pictures are drawn in that one thread, as OpenGL requires.
    """
    with ThreadPoolExecutor(1) as thread:
        upcoming = thread.submit(next, pictures, None)
        try:
            while (picture := upcoming.result()) is not None:
                upcoming = thread.submit(next, pictures, None)
                yield picture
        finally:
            thread.submit(pictures.close).result()


def _draw_frames(
    robot: Robot, postures: Floats, size: tuple[int, int], face_at: Callable[[int], Picture | None], *, view: SceneView
) -> Generator[tuple[Picture, PixelBox], None, None]:
    """Draw postures and yield each picture with its changed region.

    After the first picture only the changed region is drawn.

    Args:
        robot: Robot that is drawn.
        postures: (m, n) [rad].
        size: Width and height of a picture [pixels].
        face_at: Picture on the screen of the head, by picture number; None: the previous one stays.
        view: Part of the scene that the camera shows.

    Yields:
        The picture, and the region that differs from the previous picture [pixels].
    """
    width, height = (SUPERSAMPLING_FACTOR * side for side in size)
    places, radii = find_capsule_balls(robot, postures, [segment.name for segment in robot.skeleton.segments])
    outlines = compute_shadow_outlines(places, radii, view, size=size)
    seen, reach = project_points(view, places, size=size), radii + DRAWN_MARGIN * robot.arm_length
    boxes, shadows = find_robot_boxes(seen, reach, size=size), find_shadow_boxes(outlines, size=size)
    below, around = clip_below_floor(places, reach, view.floor)
    sunk = (
        find_robot_boxes(project_points(view, below, size=size), around, size=size)
        if len(around)
        else [None] * len(boxes)
    )
    changing = [bounding_box(*both) for both in zip(boxes, shadows, strict=True)]
    model = styled_model(robot, width=width, height=height, view=view)
    data, order = mujoco.MjData(model), find_turn_indices(robot, model)
    with Canvas(model, size, supersampling=SUPERSAMPLING_FACTOR) as canvas:
        mujoco.mj_forward(model, data)
        empty = canvas.draw_empty(data)
        for k, box in enumerate(boxes):
            data.qpos[order] = robot.skeleton.with_couplings(postures[k])
            mujoco.mj_forward(model, data)
            face = face_at(k)
            if face is not None:
                canvas.show(face)
            picture = empty.copy()
            shade(picture, shadows[k], outlines[k])
            drawn = canvas.draw(data, box, sunk=sunk[k])
            picture.paste(drawn, box[:2], drawn)
            yield np.array(picture), changing[k] if not k else bounding_box(changing[k - 1], changing[k])


def _check_opengl(*, guarded: bool) -> None:
    if reason := opengl_fault() if guarded else missing_libraries():
        raise FilmError(reason)
