"""Robots that lack a part: the default one without the hinges and the chain of its neck, trunk or collar bones."""

import re
from pathlib import Path

from kinesic.body.config import CONFIGS

BODIES = {"neck": "skullbase", "torso": "vl5", "clavicles": "l_sternoclavicular"}


def write_robot(folder: Path, *missing: str) -> Path:
    """Writes a robot that lacks parts.

    Args:
        folder: where its TOML goes.
        missing: of `BODIES`.
    """
    text = (CONFIGS / "robots" / "upper22.toml").read_text("utf-8")
    for part in missing:
        body = BODIES[part]
        text = re.sub(rf'\[\[hinge\]\]\nname = "{body}_(?:.+\n)+\n', "", text)
        names = f"[lr]{body[1:]}" if body.startswith("l_") else body
        text = re.sub(rf"^{names}_\w+ = .*\n", "", text, flags=re.M)
        text = text.replace(f'{part} = ["{body}"]\n', "").replace(f'l_arm = ["{body}", ', "l_arm = [")
    path = folder / f"without_{'_'.join(missing) or 'nothing'}.toml"
    path.write_text(text.replace('name = "upper22"', f'name = "{path.stem}"', 1), "utf-8")
    return path
