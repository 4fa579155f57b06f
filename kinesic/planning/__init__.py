"""Plans a block with times: postures, detours, a certified motion, pauses and notices."""
