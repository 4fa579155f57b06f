"""Finishes a lit picture: light spreads under the skin, then depth of field, smooth edges, fewer pixels.

Light spreads (thesis 5.1) where occlusion says that the surface curves (5.2). Wrinkles and the edges of shadows are too
fine for occlusion to tell; what they make uneven is filtered, too.
"""

from collections.abc import Iterator

from kinesic.body.arrays import Floats
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.textures import Rectangle, Size, Texture
from kinesic.face.render.camera import Camera
from kinesic.face.render.geometry import Geometry
from kinesic.face.render.passes import Marks, ScreenPass, Target, Value, Values
from kinesic.face.render.presets import Focus, Preset, Scattering


class ScatterPass:
    """Filters diffuse light along one axis and then along the other, and mends the picture where it did."""

    def __init__(self, context: GlContext, geometry: Geometry, lit: Target, scattering: Scattering) -> None:
        self.scattering, self._geometry = scattering, geometry
        self._pixel = [1.0 / side for side in geometry.size]
        self._marks = Marks(context, ("mark_skin",), geometry.size)
        picture, diffuse, colour = lit.textures
        self._diffuse, self._colour = (Target.of(context, [each], None) for each in (diffuse, colour))
        half = Target(context, geometry.size, ("4f4",), self._marks.depth)
        defines = {"STEPS": scattering.steps, "LEVELS": scattering.levels}
        mended = Target.of(context, [picture], self._marks.depth)
        self._across, self._up = (
            ScreenPass(context, onto, *fragments, where="marked", defines={**defines, "LAST": last})
            for fragments, onto, last in ((("scatter",), half, 0), (("compose", "scatter"), mended, 1))
        )

    def clear(self) -> None:
        """Marks nothing as uneven, before light is drawn."""
        self._colour.frame.clear()

    @property
    def asked(self) -> Values:
        """What the light must know to say where it spreads, and by how many levels."""
        scattering = self.scattering
        deep = {"deep": scattering.deep} if scattering.levels > 1 else {}
        return {"threshold": scattering.threshold} | deep

    def draw(self, bent: Texture, scale: float) -> None:
        """Lets the light spread.

        Args:
            bent: normals, with depth and part.
            scale: [pixels/m] at the middle of the head.
        """
        scattering = self.scattering
        colour = self._colour.textures[0]
        self._marks.draw({"colour": colour}, within=self._geometry.covered)
        values: dict[str, Value] = {"width": scattering.width}
        across, up = (scattering.width / scattering.steps * scale * side for side in self._pixel)
        half = self._across.target
        half.copy(self._diffuse)
        levels = {"colour": colour} if scattering.levels > 1 else {}
        inputs = {"bent": bent, "diffuse": self._diffuse.textures[0]} | levels
        self._across.draw(inputs, values | {"axis": (across, 0.0)})
        inputs = {"bent": bent, "diffuse": half.textures[0], "colour": colour}
        self._up.draw(inputs, values | {"axis": (0.0, up)})

    def levels(self) -> Floats:
        """(height, width) by how much of all samples light spread at each pixel, 0..255; first row on top."""
        return self._colour.read()[..., 3]

    def marked(self) -> float:
        """Tells which share of the picture was filtered last."""
        return self._marks.share()


class FocusPass:
    """Blurs what is nearer or farther than the nearer eye, or than a plane (thesis 12.1)."""

    def __init__(self, context: GlContext, geometry: Geometry, focus: Focus) -> None:
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
            "sharp": float(-eyes[:, 2].max()) if focus.plane is None else focus.plane,
            "within": focus.within,
        }
        found, form = picture.textures[0], self._geometry.target.textures[0]
        found.filter = (gl.LINEAR, gl.LINEAR)
        return self._gather.draw({"form": form, "picture": found}, values)


class SmoothPass:
    """Smooths edges that show stairs."""

    def __init__(self, context: GlContext, size: Size) -> None:
        self._marks = Marks(context, ("mark_edges",), size)
        self._pixel = tuple(1.0 / side for side in size)
        smoothed = Target(context, size, ("4f1",), self._marks.depth)
        self._smooth = ScreenPass(context, smoothed, "smooth", where="marked")

    def draw(self, picture: Target, within: Rectangle | None) -> Target:
        """Draws the picture with smooth edges where there may be any."""
        found = picture.textures[0]
        found.filter = (gl.NEAREST, gl.NEAREST)
        self._marks.draw({"picture": found}, {"pixel": self._pixel}, within=within)
        self._smooth.target.copy(picture)
        return self._smooth.draw({"picture": found}, {"pixel": self._pixel})


class PostProcessing:
    """Does to a picture what its preset asks for."""

    def __init__(self, context: GlContext, geometry: Geometry, preset: Preset, size: Size) -> None:
        self._focus = FocusPass(context, geometry, preset.focus) if preset.focus else None
        self._smooth = SmoothPass(context, geometry.size) if preset.smooth else None
        self._shrink = None
        self._geometry, self._samples = geometry, preset.samples
        if preset.samples > 1:
            self._shrink = ScreenPass(context, Target(context, size, ("4f1",), None), "shrink", where="everywhere")

    def stages(self, picture: Target, camera: Camera) -> Iterator[tuple[str, Target]]:
        """Draws the picture as it is shown; yields the name of each stage, and where it is by then."""
        if self._focus:
            picture = self._focus.draw(picture, camera)
            yield "focus", picture
        if self._smooth:
            picture = self._smooth.draw(picture, None if self._focus else self._geometry.covered)
            yield "smoothing", picture
        if self._shrink:
            picture = self._shrink.draw({"picture": picture.textures[0]}, {"samples": self._samples})
            yield "shrinking", picture
