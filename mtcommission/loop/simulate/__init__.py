"""One setpoint, or one disturbance, through the loop."""
