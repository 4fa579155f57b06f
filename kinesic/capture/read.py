"""Reading of motion files of all formats, chosen by suffix and content."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote

from kinesic.body.config import ConfigError
from kinesic.capture.body_directions import clip_of_skeleton
from kinesic.capture.clip import BodyClip, Clip
from kinesic.capture.reading.acclaim import read_acclaim_motion, read_acclaim_skeleton
from kinesic.capture.reading.bvh import read_bvh
from kinesic.capture.reading.gltf import read_gltf
from kinesic.capture.reading.joint_tables import read_joint_csv, read_joint_npz, read_npz
from kinesic.capture.reading.lerobot import read_lerobot
from kinesic.capture.reading.reachy_move import read_reachy_move
from kinesic.capture.reading.ros_messages import read_joint_mcap, read_joint_trajectory
from kinesic.capture.reading.smartbody import read_motion, read_skeleton
from kinesic.capture.reading.smpl import is_smpl, read_smpl
from kinesic.capture.reading.text import MAX_FILE_SIZE, CaptureError, read_file
from kinesic.files.input_file import read_inside

SKELETON_FOLDER = "skeletons"  # name of the folders that hold SmartBody skeletons
MAX_FOLDERS_ABOVE = 2  # number of levels above the clip's folder that are searched for skeletons
TRAJECTORY_KEY = b'"joint_names"'  # key of a ROS joint trajectory in JSON
FORMAT_NAMES: Mapping[str, str] = {  # formats of motion files by suffix
    ".bvh": "BVH",
    ".skm": "SmartBody motion, with its skeleton ACTOR.sk",
    ".amc": "Acclaim motion, with its skeleton .asf",
    ".glb": "glTF animation",
    ".gltf": "glTF animation",
    ".mcap": "ROS 2 joint states or joint trajectory",
    ".parquet": "episode of a LeRobot dataset",
    ".csv": "joint angles with a header",
    ".npz": "joint angles with names, or SMPL",
    ".json": "move of Reachy Mini, or ROS joint trajectory",
}


def read_clip(path: Path) -> Clip:
    """Read a motion file of any supported format.

    Args:
        path: of the file, with a suffix in `FORMAT_NAMES`.

    Raises:
        CaptureError: the file is missing or invalid, or its format is unknown.
    """
    suffix = path.suffix.lower()
    if suffix not in FORMAT_NAMES:
        problem = f"cannot read {suffix} files" if suffix else "its name has no suffix, which tells the format"
        raise CaptureError(f"{path}: {problem}; known: {', '.join(FORMAT_NAMES)}")
    if suffix == ".parquet":
        return read_lerobot(path)
    data, source = read_file(path), str(path)
    match suffix:
        case ".bvh":
            return clip_of_skeleton(*read_bvh(data, source), source)
        case ".skm":
            skeleton = find_skeleton(path)
            return clip_of_skeleton(
                read_skeleton(read_file(skeleton), str(skeleton)), read_motion(data, source), source
            )
        case ".amc":
            return _read_acclaim(path, data)
        case ".glb" | ".gltf":
            joints, motion, guesses = read_gltf(data, source, lambda uri: _read_beside(path, uri))
            return _add_guesses(clip_of_skeleton(joints, motion, source), *guesses)
        case ".csv":
            return read_joint_csv(data, source)
        case ".npz":
            return _read_npz(data, source)
        case ".mcap":
            return read_joint_mcap(data, source)
        case _:
            return read_joint_trajectory(data, source) if TRAJECTORY_KEY in data else read_reachy_move(data, source)


def _read_acclaim(path: Path, data: bytes) -> Clip:
    """Read an Acclaim motion with its skeleton."""
    bones = find_acclaim_skeleton(path)
    skeleton = read_acclaim_skeleton(read_file(bones), str(bones))
    motion, guess = read_acclaim_motion(data, str(path), skeleton)
    return _add_guesses(clip_of_skeleton(skeleton.joints, motion, str(path)), guess)


def _read_npz(data: bytes, source: str) -> Clip:
    """Read an SMPL motion or joint angles from an NPZ file."""
    arrays = read_npz(data, source)
    if not is_smpl(arrays):
        return read_joint_npz(arrays, source)
    skeleton, motion, guess = read_smpl(arrays, source)
    return _add_guesses(clip_of_skeleton(skeleton, motion, source), *([guess] if guess else ()))


def _add_guesses(clip: BodyClip, *guesses: str) -> BodyClip:
    return replace(clip, guesses=(*clip.guesses, *guesses))


def _read_beside(path: Path, uri: str) -> bytes:
    """Read a buffer of a glTF file from the same folder.

    Raises:
        CaptureError: the buffer is missing, too large, or outside the folder.
    """
    name = unquote(uri)
    try:
        return read_inside(path.parent, path.parent / name, max_size=MAX_FILE_SIZE)
    except OSError as error:
        problem = error.strerror or str(error)
    except (ConfigError, ValueError) as error:  # a ValueError: the name contains NUL
        problem = str(error)
    raise CaptureError(f"{path}: buffer {name[:40]!r}: {problem}")


def find_acclaim_skeleton(path: Path) -> Path:
    """Return the skeleton file of an Acclaim motion `SUBJECT_NUMBER.amc`.

    It is `SUBJECT.asf` or `SUBJECT_NUMBER.asf` beside the motion, or the only .asf there.

    Raises:
        CaptureError: there is none.
    """
    names = [path.stem, path.stem.partition("_")[0]]
    candidates = [path.with_name(f"{name}.asf") for name in names] + _only(sorted(path.parent.glob("*.asf")))
    found = next((candidate for candidate in candidates if candidate.is_file()), None)
    if found is None:
        raise CaptureError(f"{path}: no skeleton {names[-1]}.asf beside it")
    return found


def _only(paths: list[Path]) -> list[Path]:
    """Return the paths if there is exactly one, otherwise an empty list."""
    return paths if len(paths) == 1 else []


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
