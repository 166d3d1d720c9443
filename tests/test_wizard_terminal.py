"""The wizard on a real terminal of 80 x 24, with the keys that people press."""

from __future__ import annotations

import os
import re
import select
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from mtcommission.cli import main
from mtcommission.machine.profile.read import read_profile
from mtcommission.wizard import run_wizard  # noqa: F401
from tests.test_wizard import PAPER, SHIPPED, mechanical

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are POSIX")

ROOT = Path(__file__).parent.parent
ENTER, CTRL_C, CTRL_D = "\r", b"\x03", b"\x04"

LEFT = ((2, CTRL_C, 130), (7, CTRL_D, 2), (12, b"", 0))
"""How many lines of the paper's machine are typed when somebody leaves, by which key, and the exit
code; no key: quit."""


@dataclass(slots=True)
class Terminal:
    """A process on a terminal: keys in, text out."""

    pid: int
    file: int
    seen: str = ""
    status: int | None = None

    def answer(self, line: str) -> None:
        """Type a line when it is asked for."""
        self.await_prompt()
        os.write(self.file, f"{line}{ENTER}".encode())
        self.seen += "\n"

    def await_prompt(self) -> None:
        begun = time.monotonic()
        while not self.seen.endswith(": "):
            assert time.monotonic() - begun < 60.0, self.seen[-2000:]
            assert self._read(1.0) or self.status is None, self.seen[-2000:]

    def end(self, key: bytes = b"") -> int:
        """Wait for the end; the exit code. A key is pressed again where nothing happens: between
        showing a prompt and waiting for keys, Python only notes a Ctrl-C for the next key."""
        begun = time.monotonic()
        while self.status is None:
            assert time.monotonic() - begun < 60.0, self.seen[-2000:]
            os.write(self.file, key)
            while self._read(2.0):
                pass
        return os.waitstatus_to_exitcode(self.status)

    def _read(self, patience: float) -> bool:
        if not select.select([self.file], [], [], patience)[0]:
            return False
        try:
            piece = os.read(self.file, 65536)
        except OSError:  # Linux reports the end of a pseudo-terminal as an error
            piece = b""
        if not piece:
            self.status = os.waitpid(self.pid, 0)[1]
            return False
        self.seen += re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", piece.decode(errors="replace"))
        return True


@contextmanager
def terminal(folder: Path, *arguments: str, fresh: bool = False) -> Iterator[Terminal]:
    """The command line in a process of its own; ``fresh`` begins a new interpreter for it."""
    import fcntl
    import pty
    import struct
    import termios

    pid, file = pty.fork()
    if pid == 0:
        os.environ |= {"TERM": "xterm", "PYTHONPATH": str(ROOT), "COLUMNS": "80", "LINES": "24"}
        os.chdir(folder)
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's "&" has it ignored
        if fresh:
            command = [sys.executable, "-m", "mtcommission", *arguments]
            os.execv(command[0], command)
        sys.stdin, sys.stdout, sys.stderr = (
            os.fdopen(n, mode, encoding="utf-8", closefd=False, buffering=1)
            for n, mode in ((0, "r"), (1, "w"), (2, "w"))
        )
        sys.argv = ["mtcommission", *arguments]
        try:
            main()
        except SystemExit as stopped:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(int(stopped.code or 0))
        os._exit(99)
    fcntl.ioctl(file, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    found = Terminal(pid=pid, file=file)
    try:
        yield found
    finally:
        if found.status is None:
            os.kill(pid, 9)
            os.waitpid(pid, 0)
        os.close(file)


def test_a_session_can_be_left_and_gone_on_from(tmp_path):
    """On 80 columns in processes of their own: each begins where the one before was left, with all
    answers, and the last one writes the paper's machine as if nobody had ever left."""
    path, kept = tmp_path / "p.toml", tmp_path / "p.toml.answers"
    lines, begun = PAPER.splitlines(), 0
    for place, key, code in LEFT:
        with terminal(tmp_path, "wizard", "-o", "p.toml", fresh=not begun) as shell:
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
    with terminal(tmp_path, "wizard", "-o", "p.toml") as shell:
        for line in [*lines[begun:], "no"]:
            shell.answer(line)
        assert shell.end() == 0
    assert list(tmp_path.iterdir()) == [path]
    assert mechanical(read_profile(path)) == SHIPPED
