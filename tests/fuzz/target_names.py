"""Names of all targets, which can be listed without importing their readers."""

READERS = (
    *("bml", "document", "text", "control", "framing", "packets", "feedback", "gestures", "gestuary", "card", "style"),
    *("robot", "targets", "faults", "twin", "words", "wav", "bap", "log", "shell", "stl", "obj", "urdf", "mjcf"),
    *("intentions", "baseline", "qualifiers"),
)
CAPTURE_READERS = (
    *("bvh", "skm", "sk", "csv", "npz", "smpl", "reachy", "acclaim", "glb", "gltf", "states", "zstd", "lz4"),
    *("trajectory", "json", "parquet"),
)
TARGET_NAMES = (*READERS, *(f"capture-{name}" for name in CAPTURE_READERS))
