"""Poles, margins and frequency responses of a loop."""
