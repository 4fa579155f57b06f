"""Draw the packages of kinesic and the direction of imports, from the contract in pyproject.toml.

.venv/bin/python docs/make/layers.py        # writes docs/pictures/layers.svg
"""

import re
import tomllib
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

ROOT_FOLDER = Path(__file__).resolve().parent.parent.parent
PICTURE_FILE = ROOT_FOLDER / "docs" / "pictures" / "layers.svg"
BOX_WIDTH = 1.7
BOX_HEIGHT = 0.62
BOX_GAP = 0.2  # [axis units] horizontal gap between two boxes of a layer
LAYER_PITCH = 1.0  # [axis units] vertical distance between two layers


def read_layers() -> list[list[str]]:
    """Return the packages of each layer, the highest first."""
    tools = tomllib.loads((ROOT_FOLDER / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    contracts = tools["importlinter"]["contracts"]
    layers = next(contract["layers"] for contract in contracts if contract.get("containers") == ["kinesic"])
    return [layer.split(" | ") for layer in layers]


def draw(layers: list[list[str]]) -> Figure:
    """Draw one row of boxes per layer, with an arrow from the highest to the lowest."""
    widest = max(len(layer) for layer in layers) * (BOX_WIDTH + BOX_GAP)
    figure = Figure(figsize=(0.72 * (widest + 1.6), 0.62 * len(layers) * LAYER_PITCH))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(-widest / 2 - 1.4, widest / 2 + 0.2)
    axes.set_ylim(-len(layers) * LAYER_PITCH + 0.3, 0.7)
    for row, layer in enumerate(layers):
        for column, name in enumerate(layer):
            x, y = (column - (len(layer) - 1) / 2) * (BOX_WIDTH + BOX_GAP), -row * LAYER_PITCH
            corner = (x - BOX_WIDTH / 2, y - BOX_HEIGHT / 2)
            axes.add_patch(
                FancyBboxPatch(
                    corner, BOX_WIDTH, BOX_HEIGHT, boxstyle="round,pad=0,rounding_size=0.12", fc="#e8f0f7", ec="#35648f"
                )
            )
            axes.text(x, y, name, ha="center", va="center", fontsize=11, family="DejaVu Sans Mono")
    x = -widest / 2 - 0.5
    axes.add_patch(
        FancyArrowPatch(
            (x, 0.2), (x, -(len(layers) - 1) * LAYER_PITCH - 0.2), arrowstyle="-|>", mutation_scale=18, color="#888"
        )
    )
    axes.text(
        x - 0.35, -(len(layers) - 1) * LAYER_PITCH / 2, "imports", rotation=90, ha="center", va="center", color="#666"
    )
    return figure


def names_in(picture: Path) -> list[str]:
    """Return the package names in a picture, in the order of drawing."""
    return re.findall(r">([a-z_]+)</text>", picture.read_text(encoding="utf-8"))[:-1]  # the last one labels the arrow


def main() -> None:
    """Write the picture, with reproducible bytes for equal layers."""
    with mpl.rc_context({"svg.hashsalt": "kinesic", "svg.fonttype": "none"}):
        draw(read_layers()).savefig(PICTURE_FILE, metadata={"Date": None, "Creator": None})


if __name__ == "__main__":
    main()
