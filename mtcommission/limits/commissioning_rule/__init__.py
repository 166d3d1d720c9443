"""The commissioning rule: limits by hand, from a few numbers of the machine."""
