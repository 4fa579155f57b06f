"""Post-processing: subsurface scattering, depth of field, anti-aliasing, downsampling.

Light scatters (thesis 5.1) where occlusion indicates a curved surface (5.2). Wrinkles and shadow edges are too fine for
occlusion; the unevenness they cause is filtered, too.
"""

from collections.abc import Iterator

from kinesic.body.arrays import Floats
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.textures import Rectangle, Size, Texture
from kinesic.face.render.camera import Camera
from kinesic.face.render.geometry import Geometry
from kinesic.face.render.passes import MarkPass, ScreenPass, Target, Value, Values
from kinesic.face.render.presets import Focus, Preset, Scattering


class ScatterPass:
    """Pass that simulates subsurface scattering by blurring diffuse light."""

    def __init__(self, context: GlContext, geometry: Geometry, lit: Target, scattering: Scattering) -> None:
        self.scattering, self._geometry = scattering, geometry
        self._pixel = [1.0 / side for side in geometry.size]
        self._marks = MarkPass(context, ("mark_skin",), geometry.size)
        picture, diffuse, colour = lit.textures
        self._diffuse, self._colour = (Target.of(context, [source], None) for source in (diffuse, colour))
        half = Target(context, geometry.size, ("4f4",), self._marks.depth)
        defines = {"STEPS": scattering.steps, "LEVELS": scattering.levels}
        mended = Target.of(context, [picture], self._marks.depth)
        self._across, self._up = (
            ScreenPass(context, onto, *fragments, where="marked", defines={**defines, "LAST": last})
            for fragments, onto, last in ((("scatter",), half, 0), (("compose", "scatter"), mended, 1))
        )

    def clear(self) -> None:
        """Clear the scattering colours and levels before the light pass."""
        self._colour.frame.clear()

    @property
    def light_uniforms(self) -> Values:
        """Light pass uniforms that select the pixels with scattering."""
        scattering = self.scattering
        deep = {"deep": scattering.deep} if scattering.levels > 1 else {}
        return {"threshold": scattering.threshold} | deep

    def draw(self, bent: Texture, scale: float) -> None:
        """Blur the diffuse light of skin, to simulate scattering.

        Args:
            bent: normals, with depth and part.
            scale: [pixels/m] at the centre of the head.
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
        """Return the (height, width) scattering level of each pixel, 0..255.

        The first row is the top row.
        """
        return self._colour.read()[..., 3]

    def measure_filtered_fraction(self) -> float:
        """Return the fraction of the picture that the last `draw` blurred."""
        return self._marks.measure_marked_fraction()


class FocusPass:
    """Pass that blurs pixels outside the focus distance (thesis 12.1).

    The focus is on the nearer eye or on a plane.
    """

    def __init__(self, context: GlContext, geometry: Geometry, focus: Focus) -> None:
        self.focus, self._geometry = focus, geometry
        blurred = Target(context, geometry.size, ("4f1",), None)
        defines = {"TAPS": focus.taps}
        self._gather = ScreenPass(context, blurred, "form", "focus", where="everywhere", defines=defines)

    def draw(self, picture: Target, camera: Camera) -> Target:
        """Draw the picture with blur outside the focus distance."""
        focus, (width, height) = self.focus, self._geometry.size
        view = camera.view()
        eyes = self._geometry.mesh.eyes @ view[:3, :3].T + view[:3, 3]
        values: dict[str, Value] = {
            "lens": (focus.circle * height / width, focus.circle),
            "sharp": float(-eyes[:, 2].max()) if focus.plane is None else focus.plane,
            "within": focus.within,
        }
        source, form = picture.textures[0], self._geometry.target.textures[0]
        source.filter = (gl.GL_LINEAR, gl.GL_LINEAR)
        return self._gather.draw({"form": form, "picture": source}, values)


class SmoothPass:
    """Pass that smooths jagged edges."""

    def __init__(self, context: GlContext, size: Size) -> None:
        self._marks = MarkPass(context, ("mark_edges",), size)
        self._pixel = tuple(1.0 / side for side in size)
        smoothed = Target(context, size, ("4f1",), self._marks.depth)
        self._smooth = ScreenPass(context, smoothed, "smooth", where="marked")

    def draw(self, picture: Target, within: Rectangle | None) -> Target:
        """Draw the picture with smoothed edges."""
        source = picture.textures[0]
        source.filter = (gl.GL_NEAREST, gl.GL_NEAREST)
        self._marks.draw({"picture": source}, {"pixel": self._pixel}, within=within)
        self._smooth.target.copy(picture)
        return self._smooth.draw({"picture": source}, {"pixel": self._pixel})


class PostProcessing:
    """Post-processing passes selected by a preset."""

    def __init__(self, context: GlContext, geometry: Geometry, preset: Preset, size: Size) -> None:
        self._focus = FocusPass(context, geometry, preset.focus) if preset.focus else None
        self._smooth = SmoothPass(context, geometry.size) if preset.smooth else None
        self._shrink = None
        self._geometry, self._samples = geometry, preset.samples
        if preset.samples > 1:
            self._shrink = ScreenPass(context, Target(context, size, ("4f1",), None), "shrink", where="everywhere")

    def stages(self, picture: Target, camera: Camera) -> Iterator[tuple[str, Target]]:
        """Draw the final picture stage by stage.

        Yields:
            The name of each completed stage, and the target with the picture.
        """
        if self._focus:
            picture = self._focus.draw(picture, camera)
            yield "focus", picture
        if self._smooth:
            picture = self._smooth.draw(picture, None if self._focus else self._geometry.covered)
            yield "smoothing", picture
        if self._shrink:
            picture = self._shrink.draw({"picture": picture.textures[0]}, {"samples": self._samples})
            yield "shrinking", picture
