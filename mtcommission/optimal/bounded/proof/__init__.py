"""What a control must keep, and how closely its dual bound is evaluated."""
