"""TOML -> Machine: every fault at once, with file and line."""

from mtcommission.machine.profile.read import read_profile

__all__ = ["read_profile"]
