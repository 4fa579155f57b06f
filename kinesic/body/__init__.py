"""The robot as data, and the types that all rooms share."""
