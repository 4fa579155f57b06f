"""Other kinds of files in place of a robot file, with remedies."""

from kinesic.body.config import ConfigError

LFS_POINTER = b"version https://git-lfs.github.com/spec/"  # first bytes of a Git LFS pointer
MOTION_REMEDY = "it is captured motion, not a robot; `kinesic certify FILE` and `kinesic perform FILE` read it"
MESH_REMEDY = "it is a mesh, not a robot; import the URDF or MJCF that refers to it"
CAD_REMEDY = "export it to URDF or MJCF first"
SUFFIX_REMEDIES = {  # suffix of a file -> what to do with it
    ".bvh": MOTION_REMEDY,
    ".amc": MOTION_REMEDY,
    ".skm": MOTION_REMEDY,
    ".stl": MESH_REMEDY,
    ".obj": MESH_REMEDY,
    ".dae": MESH_REMEDY,
    ".glb": MESH_REMEDY,
    ".gltf": MESH_REMEDY,
    ".usd": CAD_REMEDY,
    ".usda": CAD_REMEDY,
    ".usdz": CAD_REMEDY,
    ".step": CAD_REMEDY,
    ".toml": "it is a robot file of kinesic already; use it with --robot",
}
ROOT_TAGS = ("mujoco", "mujocoinclude", "robot")  # tags of the root elements of MJCF and URDF
ROOT_REMEDIES = {  # tag of the root element of another XML format -> what to do with it
    "sdf": "it is SDF; convert it to URDF first, such as by `gz sdf -p` or sdformat_urdf",
    "COLLADA": MESH_REMEDY,
    "package": "it is the manifest of a ROS package; import the URDF in its folder",
}


def refuse_pointer(name: str, data: bytes) -> None:
    """Refuse a Git LFS pointer.

    Raises:
        ConfigError: the data are a pointer to the contents, which Git has not downloaded.
    """
    if data.startswith(LFS_POINTER):
        raise ConfigError(f"{name}: only a Git LFS pointer to the file is here; run `git lfs pull` in its folder")


def refuse_other_kinds(path_text: str, suffix: str, data: bytes) -> None:
    """Refuse a file of another known kind, with a remedy.

    Raises:
        ConfigError: the file is a Git LFS pointer or of another known kind.
    """
    refuse_pointer(path_text, data)
    remedy = MOTION_REMEDY if data.lstrip().startswith(b"HIERARCHY") else SUFFIX_REMEDIES.get(suffix.lower())
    if remedy is not None:
        raise ConfigError(f"{path_text}: {remedy}")


def refuse_other_roots(path_text: str, tag: str) -> None:
    """Refuse an XML file with another root element.

    Raises:
        ConfigError: the root element is that of another format.
    """
    if tag not in ROOT_TAGS:
        remedy = ROOT_REMEDIES.get(tag, "a robot file begins with <robot> (URDF) or <mujoco> (MJCF)")
        raise ConfigError(f"{path_text}: its root element is <{tag[:40]}>: {remedy}")
