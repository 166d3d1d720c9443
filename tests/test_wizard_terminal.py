"""The wizard on a real terminal of 80 x 24, with the keys that people press."""

from __future__ import annotations

import os
import re
import select
import signal
import struct
import subprocess
import sys
import time
from contextlib import closing, suppress
from pathlib import Path

import pytest

from mtcommission.machine.profile.read import read_profile
from tests.test_wizard import PAPER, SHIPPED, mechanical

fcntl, termios = map(pytest.importorskip, ("fcntl", "termios"))  # terminals of POSIX

ROOT = Path(__file__).parent.parent
ENTER, CTRL_C, CTRL_D = "\r", b"\x03", b"\x04"

LEFT = ((2, CTRL_C, 130), (7, CTRL_D, 2), (12, b"", 0))
"""How many lines of the paper's machine are typed when somebody leaves, by which key, and the exit
code; no key: quit."""


class Terminal:
    """The command line on a terminal of its own: keys in, text out."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self.seen = ""
        self.file, other = os.openpty()
        fcntl.ioctl(other, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        self.process = subprocess.Popen(
            [sys.executable, "-m", "mtcommission", *arguments],
            cwd=folder,
            env=os.environ | {"TERM": "xterm", "PYTHONPATH": str(ROOT)},
            stdin=other, stdout=other, stderr=other, start_new_session=True, preexec_fn=_own_it,
        )  # fmt: skip
        os.close(other)

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        os.close(self.file)

    def answer(self, line: str) -> None:
        """Type a line when it is asked for."""
        self.await_prompt()
        os.write(self.file, f"{line}{ENTER}".encode())
        self.seen += "\n"

    def await_prompt(self) -> None:
        begun = time.monotonic()
        while not self.seen.endswith(": "):
            assert time.monotonic() - begun < 60.0, self.seen[-2000:]
            assert self._read(1.0) or self.process.poll() is None, self.seen[-2000:]

    def end(self, key: bytes = b"") -> int:
        """Wait for the end; the exit code. A key is pressed again where nothing happens: between
        showing a prompt and waiting for keys, Python only notes a Ctrl-C for the next key."""
        begun = time.monotonic()
        while self.process.poll() is None:
            assert time.monotonic() - begun < 60.0, self.seen[-2000:]
            with suppress(OSError):  # it may have ended just now
                os.write(self.file, key)
            while self._read(2.0):
                pass
        return self.process.returncode

    def _read(self, patience: float) -> bool:
        if not select.select([self.file], [], [], patience)[0]:
            return False
        try:
            piece = os.read(self.file, 65536)
        except OSError:  # Linux reports the end of a pseudo-terminal as an error
            return False
        self.seen += re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", piece.decode(errors="replace"))
        return bool(piece)


def _own_it() -> None:
    """Of a process before it begins: its input is its terminal, which sends it Ctrl-C."""
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # a shell's "&" has it ignored


def test_a_session_can_be_left_and_gone_on_from(tmp_path):
    """On 80 columns in processes of their own: each begins where the one before was left, with all
    answers, and the last one writes the paper's machine as if nobody had ever left."""
    path, kept = tmp_path / "p.toml", tmp_path / "p.toml.answers"
    lines, begun = PAPER.splitlines(), 0
    for place, key, code in LEFT:
        with closing(Terminal(tmp_path, "wizard", "-o", "p.toml")) as shell:
            for line in lines[begun:place]:
                shell.answer(line)
            if key:
                shell.await_prompt()
            else:
                shell.answer("quit")
            assert shell.end(key) == code, shell.seen
        assert "answers kept in p.toml.answers" in " ".join(shell.seen.split())
        assert "Traceback" not in shell.seen
        assert list(tmp_path.iterdir()) == [kept]
        begun = place
    with closing(Terminal(tmp_path, "wizard", "-o", "p.toml")) as shell:
        for line in [*lines[begun:], "no"]:
            shell.answer(line)
        assert shell.end() == 0
    assert list(tmp_path.iterdir()) == [path]
    assert mechanical(read_profile(path)) == SHIPPED
