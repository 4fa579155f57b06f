"""Recordings for the viewers of robotics: MCAP for Foxglove, and Rerun files."""
