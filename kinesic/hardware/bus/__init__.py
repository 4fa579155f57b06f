"""Cyclic, fault-tolerant reading and writing of all servos on a bus."""
