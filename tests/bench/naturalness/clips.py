"""A minimal actor and clip in SmartBody's format."""

from pathlib import Path

import numpy as np

LIMB = """joint JtShoulder{side} {{ offset {out} 0.2 0
  prerot axis 0 0 1 ang -90.0
  channel Quat
  joint JtElbow{side} {{ offset 0.3 0 0
    channel Quat
    joint JtWrist{side} {{ offset 0.2 0 0 prerot axis 0 0 0 ang 0 }} }} }}"""
SKELETON = f"""# SK Skeleton Definition
set_name ChrTest
skeleton
root JtRoot
{{ offset 0.0 1.0 0.0
  prerot  axis 0.0 0.0 0.0 ang 0.0
  channel XPos 0 free
  channel Quat
  joint JtSpineC {{ offset 0 0.3 0
    channel Quat
    {LIMB.format(side="Lf", out="0.15")}
    {LIMB.format(side="Rt", out="-0.15")}
  }}
}}
"""
CHANNELS = (
    *("JtRoot XPos", "JtRoot Quat", "JtSpineC Quat"),
    *("JtShoulderLf Quat", "JtElbowLf Quat", "JtShoulderRt Quat", "JtElbowRt Quat"),
)
MARKS = {"ready": 0.5, "strokeStart": 1.0, "emphasis": 1.4, "stroke": 1.5, "relax": 2.0}


def write_skeleton(folder: Path) -> Path:
    """Write ChrTest.sk."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "ChrTest.sk").write_text(SKELETON)
    return folder / "ChrTest.sk"


def write_clip(path: Path, turns, *, rate: float = 30.0, marks=MARKS) -> Path:
    """Write a clip.

    Args:
        path: path of the file.
        turns: channel -> translations (m, 1) [m] or rotation vectors (m, 3) [rad]; missing channels are zero.
        rate: frame rate [Hz].
        marks: times [s] by their names in the file.
    """
    count = len(next(iter(turns.values())))
    columns = [turns.get(name, np.zeros((count, 1 if name.endswith("Pos") else 3))) for name in CHANNELS]
    frames = np.concatenate(columns, axis=1)
    lines = [f"kt {k / rate:.6f} fr {' '.join(f'{value:.9f}' for value in row)}" for k, row in enumerate(frames)]
    times = [f"{name} time: {time:.6f}" for name, time in marks.items()]
    path.parent.mkdir(parents=True, exist_ok=True)
    head = f'SkMotion\n\nname "{path.stem}"\n\nchannels {len(CHANNELS)}\n'
    path.write_text("\n".join([head + "\n".join(CHANNELS), f"\nframes {count}", *lines, "", *times, ""]))
    return path
