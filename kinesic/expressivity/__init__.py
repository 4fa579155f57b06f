"""Conversion of behaviours to key frames of hands, head, torso and face."""
