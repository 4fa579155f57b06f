"""Finishes a lit picture: depth of field, smooth edges, fewer pixels."""

import moderngl

from kinesic.face.render.camera import Camera
from kinesic.face.render.geometry import Geometry
from kinesic.face.render.passes import Marks, Rectangle, ScreenPass, Size, Target, Value
from kinesic.face.render.presets import Focus, Preset


class FocusPass:
    """Blurs what is nearer or farther than the nearer eye (thesis 12.1)."""

    def __init__(self, context: moderngl.Context, geometry: Geometry, focus: Focus) -> None:
        self.focus, self._geometry = focus, geometry
        blurred = Target(context, geometry.size, ("4f1",), None)
        defines = {"TAPS": focus.taps}
        self._gather = ScreenPass(context, blurred, "form", "focus", where="everywhere", defines=defines)

    def draw(self, picture: Target, camera: Camera) -> Target:
        """Draws the picture out of focus where it is too near or too far."""
        focus, (width, height) = self.focus, self._geometry.size
        view = camera.view()
        eyes = self._geometry.mesh.eyes @ view[:3, :3].T + view[:3, 3]
        values: dict[str, Value] = {
            "lens": (focus.circle * height / width, focus.circle),
            "sharp": float(-eyes[:, 2].max()),
            "within": focus.within,
        }
        found, form = picture.textures[0], self._geometry.target.textures[0]
        found.filter = (moderngl.LINEAR, moderngl.LINEAR)
        return self._gather.draw({"form": form, "picture": found}, values)


class SmoothPass:
    """Smooths edges that show stairs."""

    def __init__(self, context: moderngl.Context, size: Size) -> None:
        self._marks = Marks(context, ("mark_edges",), size)
        self._pixel = tuple(1.0 / side for side in size)
        smoothed = Target(context, size, ("4f1",), self._marks.depth)
        self._smooth = ScreenPass(context, smoothed, "smooth", where="marked")

    def draw(self, picture: Target, within: Rectangle | None) -> Target:
        """Draws the picture with smooth edges where there may be any."""
        found = picture.textures[0]
        found.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._marks.draw({"picture": found}, {"pixel": self._pixel}, within=within)
        found.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self._smooth.target.copy(picture)
        return self._smooth.draw({"picture": found}, {"pixel": self._pixel})


class PostProcessing:
    """Does to a picture what its preset asks for."""

    def __init__(self, context: moderngl.Context, geometry: Geometry, preset: Preset, size: Size) -> None:
        self._focus = FocusPass(context, geometry, preset.focus) if preset.focus else None
        self._smooth = SmoothPass(context, geometry.size) if preset.smooth else None
        self._shrink = None
        self._geometry, self._samples = geometry, preset.samples
        if preset.samples > 1:
            self._shrink = ScreenPass(context, Target(context, size, ("4f1",), None), "shrink", where="everywhere")

    def draw(self, picture: Target, camera: Camera) -> Target:
        """Draws the picture as it is shown."""
        if self._focus:
            picture = self._focus.draw(picture, camera)
        if self._smooth:
            picture = self._smooth.draw(picture, None if self._focus else self._geometry.covered)
        if self._shrink:
            picture = self._shrink.draw({"picture": picture.textures[0]}, {"samples": self._samples})
        return picture
