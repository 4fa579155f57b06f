"""Speech engines, which turn one phrase into sound and times."""
