"""MotionLimits + move -> Setpoint: what the control sends to the loop; only door to Ruckig."""
