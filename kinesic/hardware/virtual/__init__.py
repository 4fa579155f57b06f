"""Servos that exist only on a wire: registers, protocol, timing, faults, and a physics to turn their shafts."""
