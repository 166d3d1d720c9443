"""Options of the command line -> quantities and requests; every fault at once.

What solves a request is loaded when it is asked: a sweep reads its options here, too.
"""
