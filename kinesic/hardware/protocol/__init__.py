"""Dynamixel Protocol 2.0: packets, registers, models, ticks and servo map."""
