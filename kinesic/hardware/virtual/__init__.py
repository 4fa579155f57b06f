"""Virtual servos: registers, protocol, timing, faults and motor physics."""
