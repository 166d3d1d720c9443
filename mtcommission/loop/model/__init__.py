"""The sampled loop: its blocks, one position cycle as arithmetic and as matrices."""
