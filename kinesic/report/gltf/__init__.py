"""Export of performances as glTF scenes (Blender, three.js, Unity)."""
