"""Plant + controller + Setpoint -> response: what of a setpoint reaches the tool."""
