"""Control of servos on serial buses."""
