"""Reading of motion files of all formats, chosen by suffix and content."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from kinesic.capture.body_directions import clip_of_skeleton
from kinesic.capture.clip import Clip
from kinesic.capture.reading.bvh import read_bvh
from kinesic.capture.reading.joint_tables import read_joint_csv, read_joint_npz, read_npz
from kinesic.capture.reading.reachy_move import read_reachy_move
from kinesic.capture.reading.smartbody import read_motion, read_skeleton
from kinesic.capture.reading.smpl import is_smpl, read_smpl
from kinesic.capture.reading.text import CaptureError, read_file

SKELETON_FOLDER = "skeletons"  # name of the folders that hold SmartBody skeletons
MAX_FOLDERS_ABOVE = 2  # number of levels above the clip's folder that are searched for skeletons
FORMATS: Mapping[str, str] = {  # formats of motion files by suffix
    ".bvh": "BVH",
    ".skm": "SmartBody motion, with its skeleton ACTOR.sk",
    ".csv": "joint angles with a header",
    ".npz": "joint angles with names, or SMPL",
    ".json": "move of Reachy Mini",
}


def read_clip(path: Path) -> Clip:
    """Read a motion file of any supported format.

    Args:
        path: of the file, with a suffix in `FORMATS`.

    Raises:
        CaptureError: the file is missing or invalid, or its format is unknown.
    """
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise CaptureError(f"{path}: cannot read {suffix or 'no suffix'}; known: {', '.join(FORMATS)}")
    data, source = read_file(path), str(path)
    match suffix:
        case ".bvh":
            return clip_of_skeleton(*read_bvh(data, source), source)
        case ".skm":
            skeleton = find_skeleton(path)
            return clip_of_skeleton(
                read_skeleton(read_file(skeleton), str(skeleton)), read_motion(data, source), source
            )
        case ".csv":
            return read_joint_csv(data, source)
        case ".npz":
            return _read_npz(data, source)
        case _:
            return read_reachy_move(data, source)


def _read_npz(data: bytes, source: str) -> Clip:
    """Read an SMPL motion or joint angles from an NPZ file."""
    arrays = read_npz(data, source)
    if not is_smpl(arrays):
        return read_joint_npz(arrays, source)
    skeleton, motion, guess = read_smpl(arrays, source)
    clip = clip_of_skeleton(skeleton, motion, source)
    return replace(clip, guesses=(*clip.guesses, guess)) if guess else clip


def find_skeleton(path: Path) -> Path:
    """Return the skeleton file of a SmartBody motion `ACTOR@NAME.skm`.

    It lies beside the motion or in a folder `skeletons` beside it or above.

    Raises:
        CaptureError: there is none.
    """
    name = f"{path.stem.partition('@')[0]}.sk"
    folders = [
        path.parent,
        *(folder / SKELETON_FOLDER for folder in [path.parent, *path.parents][: MAX_FOLDERS_ABOVE + 2]),
    ]
    found = next((folder / name for folder in folders if (folder / name).is_file()), None)
    if found is None:
        raise CaptureError(f"{path}: no skeleton {name} beside it or in {SKELETON_FOLDER}/")
    return found
