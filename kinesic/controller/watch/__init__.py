"""The watch of the clearance: motion slows where servos stray, and stops before anything touches."""
