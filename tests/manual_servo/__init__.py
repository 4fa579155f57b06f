"""Independent virtual Dynamixel X servo, written from the manual without kinesic.

`packet` is protocol 2.0, `table` the control table, `device` what a servo does with instructions, `memory` what it
does with registers, `firmware`, `motion` and `physics` how its shaft turns, `line` the wire, `pty` a port; `faults`,
`servo_faults`, `lies` and `strangers` are what may go wrong.
"""
