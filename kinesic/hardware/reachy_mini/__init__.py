"""Reachy Mini: expressive motion of head, body and antennas through its daemon."""
