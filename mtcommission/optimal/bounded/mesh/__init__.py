"""Meshes: where cells lie, what is solved on them, when they are finished."""
