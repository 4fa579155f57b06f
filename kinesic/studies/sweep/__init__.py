"""A gesture played over the range of a parameter, and what that changes in the twin."""
