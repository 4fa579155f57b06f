"""Planning of timed blocks: postures, detours, certified motion, pauses and notices."""
