"""From a machine to everything that is known about it: what is asked, the chain, a glance."""
