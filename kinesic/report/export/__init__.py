"""Recordings for robotics viewers: MCAP for Foxglove, and Rerun files."""
