"""Manual operations on servos: survey, release, calibration and diagnosis."""
