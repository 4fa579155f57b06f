"""Speaks Dynamixel Protocol 2.0: packets, registers, models, ticks, and which servo turns which hinge."""
