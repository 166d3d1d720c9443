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

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.cli import main
from mtcommission.machine.profile.read import read_profile
from mtcommission.wizard import run_wizard  # noqa: F401
from mtcommission.wizard.answers import TOWER
from mtcommission.wizard.question import Question
from mtcommission.wizard.script import list_questions
from tests.test_wizard import mechanical

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are POSIX")

ROOT = Path(__file__).parent.parent
PAPER = mechanical(read_profile(ROOT / "profiles" / "milling-manipulator.toml"))

TYPED = {
    "machine.name": "Milling machine workpiece manipulator",
    "machine.axis": "",
    "machine.motion": "",
    "drive.max_force": "2 kN",
    "wizard.way": TOWER,
    "plant.base_mass": "450",
    "plant.slider_mass": "750",
    "plant.rotary_inertia": "40",
    "plant.lever_arm": "0,25",
    "plant.tcp_height": "0,21",
    "plant.base_stiffness": "44,41 N/um",
    "plant.base_damping": "8500",
    "plant.rotary_stiffness": "8.2e6",
    "plant.rotary_damping": "1800",
    "moves.0.distance": "0.1 m/s",
    "requirements.tcp_deviation": "5 um",
    "control.kind": "state-space",
}
"""What is typed for the paper's machine; Enter for all else."""

CHANGED = {
    "machine.source": "Christiansen, Maurer, Zirn, Table 1; max_force: sec. 5.1",
    "drive.force_lag": "2,5 ms",
    "control.state_feedback": "auto",
}
"""What is changed below what has a default."""

KNOWN = list_questions({**TYPED, "moves.0.velocity_step": "0.1 m/s"})
"""The questions as they are asked again."""

FIRST_MOVE = next(one for one in list_questions({}) if one.key == "moves.0.distance")
QUESTIONS = [FIRST_MOVE if one.key == "moves.0.velocity_step" else one for one in KNOWN]
"""The questions as they are asked first."""

ENGLISH = Catalogue("en")

ENTER, CTRL_C, CTRL_D = b"\r", b"\x03", b"\x04"


@dataclass(slots=True)
class Terminal:
    """A process on a terminal: keys in, text out."""

    pid: int
    file: int
    seen: str = ""
    everything: str = ""
    status: int | None = None

    def press(self, *keys: bytes) -> None:
        for key in keys:
            os.write(self.file, key)

    def type(self, text: str) -> None:
        os.write(self.file, text.encode())

    def until(self, words: str) -> None:
        """Wait until the words have been shown since the last wait."""
        begun = time.monotonic()
        while words not in self.seen:
            assert time.monotonic() - begun < 60.0, self.everything[-2000:]
            assert self._read(1.0) or self.status is None, self.everything[-2000:]
        self.seen = self.seen[self.seen.index(words) + len(words) :]

    def end(self, key: bytes = b"") -> int:
        """Wait for the end; the exit code. A key is pressed again where nothing happens: between
        showing a prompt and waiting for keys, Python only notes a Ctrl-C for the next key."""
        begun = time.monotonic()
        while self.status is None:
            assert time.monotonic() - begun < 60.0, self.everything[-2000:]
            self.press(*[key] * bool(key))
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
        text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", piece.decode(errors="replace"))
        self.seen += text
        self.everything += text
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


def enter(shell: Terminal, typed: str = "") -> None:
    shell.type(typed)
    shell.press(ENTER)


def answer(shell: Terminal, question: Question) -> None:
    enter(shell, TYPED.get(question.key, ""))


def await_prompt(shell: Terminal, question: Question) -> None:
    """Wait for a question that is asked anew: the line above it is not drawn again by typing."""
    shell.until(question.where(ENGLISH)[:20])
    shell.until(question.say(ENGLISH).partition(" (empty")[0])


def settle(shell: Terminal) -> None:
    """Change what has a default, then go on."""
    for key, typed in CHANGED.items():
        shell.until("Number or key")
        enter(shell, key)
        shell.until("):" if key == "drive.force_lag" else "]:" if "source" in key else ":")
        enter(shell, typed)
    shell.until("Number or key")
    enter(shell)
    shell.until("Compute the limits now")


LEFT = ((2, CTRL_C, 130), (7, CTRL_D, 2), (12, b"", 0))
"""Number of the question at which somebody leaves, the key, and the exit code; no key: quit."""


def test_a_session_can_be_left_and_gone_on_from(tmp_path: Path) -> None:
    """On 80 columns in processes of their own: each begins where the one before was left, with all
    answers, and the last one writes the paper's machine as if nobody had ever left."""
    path, kept, begun = tmp_path / "p.toml", tmp_path / "p.toml.answers", 0
    for place, key, code in LEFT:
        with terminal(tmp_path, "wizard", "-o", "p.toml", fresh=not begun) as shell:
            for question in QUESTIONS[begun:place]:
                await_prompt(shell, question)
                answer(shell, question)
            await_prompt(shell, QUESTIONS[place])
            if not key:
                enter(shell, "quit")
            assert shell.end(key) == code, shell.everything
        said = " ".join(shell.everything.split())
        assert f"at {QUESTIONS[place].key}; answers kept in p.toml.answers" in said
        assert "Traceback" not in said
        assert list(tmp_path.iterdir()) == [kept]
        begun = place
    with terminal(tmp_path, "wizard", "-o", "p.toml") as shell:
        for question in QUESTIONS[begun:]:
            await_prompt(shell, question)
            answer(shell, question)
        settle(shell)
        enter(shell, "no")
        assert shell.end() == 0
    assert list(tmp_path.iterdir()) == [path]
    assert mechanical(read_profile(path)) == PAPER
