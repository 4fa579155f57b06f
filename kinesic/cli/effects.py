"""Command-line options for the view and the rendering effects of the face."""

from dataclasses import dataclass
from typing import Annotated, get_args

import click

from kinesic.body.choices import Variant
from kinesic.cli.options import DEFAULT_PICTURE_SIDE, SHEET_PICTURE_SIDE, STRIP_PICTURE_SIDE, group_options
from kinesic.face.render.effects import Effects, Marching, Shading, Spreading
from kinesic.face.render.presets import MAX_OCCLUSION_SAMPLES, QUALITY_PRESETS, TILE_SIZES, Estimator, Falloff, Pattern

YAW_HELP = "Camera angle: 90 shows the left side, 180 the back."
LIGHT_HELP = (
    "Brightness of the scene relative to the default, 0.01 to 4; a second value is for the second half of a film. "
    "Pupils adapt."
)
SIZE_HELP = (
    f"Side length in pixels (default: {DEFAULT_PICTURE_SIDE}; per picture {SHEET_PICTURE_SIDE} on a sheet, "
    f"{STRIP_PICTURE_SIDE} in a strip)."
)
MARCHING_HELP = (
    "Ambient occlusion along all directions, along two that rotate from pixel to pixel, or along one. "
    "Any occlusion option switches it on."
)
PATTERN_HELP = "Rotation of the occlusion directions from pixel to pixel; noise: random over the whole picture."
TILE_HELP = "Side length in pixels of the rotation pattern, and of the blur that removes it."
SPREADING_HELP = "Light scattering in the skin: where light is uneven, by levels of occlusion, or everywhere."
FOCUS_HELP = "Focus of the camera: none (all sharp), eyes, a distance in m, or a range M:M."


@dataclass(frozen=True)
class FaceView:
    """Variant, quality, camera angle, size and light of the rendered face."""

    variant: Annotated[
        Variant,
        click.option(
            "--variant",
            type=click.Choice(get_args(Variant)),
            default="female",
            show_default=True,
            help="Head to draw.",
        ),
    ]
    preset: Annotated[
        str,
        click.option(
            "--preset",
            type=click.Choice(list(QUALITY_PRESETS)),
            default="normal",
            show_default=True,
            help="Rendering quality.",
        ),
    ]
    yaw: Annotated[float, click.option("--yaw", default=0.0, metavar="DEG", help=YAW_HELP)]  # [deg]
    size: Annotated[int | None, click.option("--size", type=int, help=SIZE_HELP)]  # [pixels] side length
    gain: Annotated[
        float, click.option("--gain", default=1.0, show_default=True, help="Strength of the wrinkles, 0 to 4.")
    ]
    light: Annotated[
        str, click.option("--light", default="1", show_default=True, metavar="FACTOR|FACTOR:FACTOR", help=LIGHT_HELP)
    ]


@dataclass(frozen=True)
class EffectOptions:
    """Rendering effects that override those of the quality preset."""

    occlusion: Annotated[
        Marching | None, click.option("--occlusion", type=click.Choice(get_args(Marching)), help=MARCHING_HELP)
    ]
    samples: Annotated[
        int | None,
        click.option(
            "--occlusion-size",
            "samples",
            type=click.IntRange(2, MAX_OCCLUSION_SAMPLES),
            help="Occlusion samples across the occlusion range.",
        ),
    ]
    estimator: Annotated[
        Estimator | None,
        click.option("--estimator", type=click.Choice(get_args(Estimator)), help="Estimator of occlusion."),
    ]
    falloff: Annotated[
        Falloff | None,
        click.option("--falloff", type=click.Choice(get_args(Falloff)), help="Falloff of occlusion with distance."),
    ]
    pattern: Annotated[
        Pattern | None, click.option("--pattern", type=click.Choice(get_args(Pattern)), help=PATTERN_HELP)
    ]
    tile: Annotated[
        int | None,
        click.option("--pattern-size", "tile", type=click.IntRange(TILE_SIZES[0], TILE_SIZES[-1]), help=TILE_HELP),
    ]
    scattering: Annotated[
        Spreading | None, click.option("--scattering", type=click.Choice(get_args(Spreading)), help=SPREADING_HELP)
    ]
    shadow: Annotated[
        Shading | None, click.option("--shadow", type=click.Choice(get_args(Shading)), help="Shadow of the key light.")
    ]
    focus: Annotated[str | None, click.option("--focus", metavar="none|eyes|M|M:M", help=FOCUS_HELP)]
    eyeshade: Annotated[bool, click.option("--eyeshade", is_flag=True, help="Put a translucent eyeshade on the head.")]

    @property
    def effects(self) -> Effects:
        """Overridden effects, as renderer settings."""
        return Effects(
            self.occlusion,
            self.samples,
            self.estimator,
            self.falloff,
            self.pattern,
            self.tile,
            self.scattering,
            self.shadow,
            self.focus,
            self.eyeshade,
        )


effect_options = group_options("effects", EffectOptions)
view_options = group_options("view", FaceView)
