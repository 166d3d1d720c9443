"""What the profile leaves out of the controller, tuned until the margins hold."""
