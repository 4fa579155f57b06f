"""Conversion of MJCF and URDF robots to robot TOML files."""
