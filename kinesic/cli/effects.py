"""Options of how the face is looked at, and of what it is drawn with, effect by effect."""

from dataclasses import dataclass
from typing import Annotated, get_args

import click

from kinesic.body.choices import Variant
from kinesic.cli.options import CELL, SIDE, STRIP, together
from kinesic.face.render.effects import Effects, Marching, Shading, Spreading
from kinesic.face.render.presets import LARGEST_SIZE, PRESETS, TILES, Estimator, Falloff, Pattern

YAW_HELP = "Seen from the side: 90 shows the left side, 180 the back."
LIGHT_HELP = "How bright the scene is, 0.01 to 4; of a film at first, and from its middle. Pupils follow."
SIZE_HELP = f"Pixels along a side ({SIDE}; {CELL} each on a sheet, {STRIP} in a strip)."
MARCHING_HELP = "Along all directions, two that turn from pixel to pixel, or one. With any option of it it is drawn."
PATTERN_HELP = "How directions turn from pixel to pixel; noise: by chance over the whole picture."
TILE_HELP = "Pixels along a side of the pattern, and of the blur that takes it out."
SPREADING_HELP = "Light under the skin: where it is uneven, by levels of occlusion, or everywhere."
FOCUS_HELP = "What is sharp: none (all), eyes, or what is so far from the camera, also from M:M."


@dataclass(frozen=True)
class FaceView:
    """How the face is looked at."""

    variant: Annotated[
        Variant, click.option("--variant", type=click.Choice(get_args(Variant)), default="female", show_default=True)
    ]
    preset: Annotated[
        str,
        click.option(
            "--preset", type=click.Choice(list(PRESETS)), default="normal", show_default=True, help="How much is drawn."
        ),
    ]
    yaw: Annotated[float, click.option("--yaw", default=0.0, metavar="DEG", help=YAW_HELP)]  # [deg]
    size: Annotated[int | None, click.option("--size", type=int, help=SIZE_HELP)]  # [pixels] along a side
    gain: Annotated[float, click.option("--gain", default=1.0, show_default=True, help="Of the wrinkles, 0 to 4.")]
    light: Annotated[
        str, click.option("--light", default="1", show_default=True, metavar="SHARE|SHARE:SHARE", help=LIGHT_HELP)
    ]


@dataclass(frozen=True)
class EffectOptions:
    """What differs from the preset."""

    occlusion: Annotated[
        Marching | None, click.option("--occlusion", type=click.Choice(get_args(Marching)), help=MARCHING_HELP)
    ]
    samples: Annotated[
        int | None,
        click.option(
            "--occlusion-size", "samples", type=click.IntRange(2, LARGEST_SIZE), help="Samples of occlusion across."
        ),
    ]
    estimator: Annotated[
        Estimator | None, click.option("--estimator", type=click.Choice(get_args(Estimator)), help="Of occlusion.")
    ]
    falloff: Annotated[
        Falloff | None,
        click.option("--falloff", type=click.Choice(get_args(Falloff)), help="Of occlusion, over the distance."),
    ]
    pattern: Annotated[
        Pattern | None, click.option("--pattern", type=click.Choice(get_args(Pattern)), help=PATTERN_HELP)
    ]
    tile: Annotated[
        int | None, click.option("--pattern-size", "tile", type=click.IntRange(TILES[0], TILES[-1]), help=TILE_HELP)
    ]
    scattering: Annotated[
        Spreading | None, click.option("--scattering", type=click.Choice(get_args(Spreading)), help=SPREADING_HELP)
    ]
    shadow: Annotated[
        Shading | None, click.option("--shadow", type=click.Choice(get_args(Shading)), help="Of the key light.")
    ]
    focus: Annotated[str | None, click.option("--focus", metavar="none|eyes|M|M:M", help=FOCUS_HELP)]
    eyeshade: Annotated[bool, click.option("--eyeshade", is_flag=True, help="The head wears one, translucent.")]

    @property
    def effects(self) -> Effects:
        """What differs, as the renderer wants it."""
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


effects = together("effects", EffectOptions)
face_view = together("view", FaceView)
