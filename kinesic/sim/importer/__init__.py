"""Other people's robots: from an MJCF or URDF file to a robot's TOML."""
