"""Default robot without neck, trunk or clavicles."""

import re
from pathlib import Path

from kinesic.body.config import CONFIGS

REMOVABLE_BODIES = {"neck": "skullbase", "torso": "vl5", "clavicles": "l_sternoclavicular"}


def write_robot(folder: Path, *missing: str) -> Path:
    """Write a robot file without some parts.

    Args:
        folder: folder of the TOML file.
        missing: parts to remove, from `BODIES`.
    """
    text = (CONFIGS / "robots" / "upper22.toml").read_text("utf-8")
    for part in missing:
        body = REMOVABLE_BODIES[part]
        text = re.sub(rf'\[\[hinge\]\]\nname = "{body}_(?:.+\n)+\n', "", text)
        names = f"[lr]{body[1:]}" if body.startswith("l_") else body
        text = re.sub(rf"^{names}_\w+ = .*\n", "", text, flags=re.M)
        text = text.replace(f'{part} = ["{body}"]\n', "").replace(f'l_arm = ["{body}", ', "l_arm = [")
    path = folder / f"without_{'_'.join(missing) or 'nothing'}.toml"
    path.write_text(text.replace('name = "upper22"', f'name = "{path.stem}"', 1), "utf-8")
    return path
