"""Numbers as SINUMERIK's XML files hold them: big-endian doubles in base 85.

Digits, small letters, capitals and 23 marks count from 0 to 84; five of them make 32 bits, a point
stands for a word of zeros. Source: found by decoding, and read in Trace-Tools (E. Rhodén, MIT).
"""

from __future__ import annotations

import numpy as np

from mtcommission.errors import Refused
from mtcommission.identify.measurement import Array
from mtcommission.messages.message import Message

ALPHABET = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ!#$`()*+-/:;=?@[]^_{|}~"
_NO_DIGIT = 255
_POWERS = 85 ** np.arange(4, -1, -1, dtype=np.int64)


def _digits() -> np.ndarray[tuple[int], np.dtype[np.uint8]]:
    table = np.full(256, _NO_DIGIT, dtype=np.uint8)
    table[np.frombuffer(ALPHABET.encode(), dtype=np.uint8)] = np.arange(85)
    return table


_DIGITS = _digits()


def decode_doubles(text: str) -> Array:
    """Return the numbers in a text.

    Raises
    ------
    Refused
        A sign is none of the alphabet, or the text ends inside a number.

    Examples
    --------
    >>> decode_doubles("..")
    array([0.])
    """
    words = []
    for place, piece in enumerate("".join(text.split()).split(".")):
        if place:
            words.append(np.zeros(1, dtype=np.int64))
        if not piece:
            continue
        if not piece.isascii() or len(piece) % 5:
            raise Refused(Message("identify-series-cut"))
        digits = _DIGITS[np.frombuffer(piece.encode(), dtype=np.uint8)]
        if (digits == _NO_DIGIT).any():
            raise Refused(Message("identify-series-sign"))
        words.append(digits.astype(np.int64).reshape(-1, 5) @ _POWERS)
    joined = np.concatenate(words) if words else np.zeros(0, dtype=np.int64)
    if joined.size % 2 or (joined > 0xFFFFFFFF).any():
        raise Refused(Message("identify-series-cut"))
    return np.frombuffer(joined.astype(">u4").tobytes(), dtype=">f8").astype(np.float64)
