"""Speech engines: from one phrase to its sound and times, in Python or in a program of its own."""
