"""How pictures of the robot are made: what the camera frames, the screen of its face, light and shadow."""
