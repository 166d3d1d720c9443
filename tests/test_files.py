"""Files as users name them: what is written, what is kept, and what is refused."""

from __future__ import annotations

import os
import stat
import threading
from pathlib import Path

import pytest

from mtcommission.base.errors import InputError
from mtcommission.base.files import (
    read_bytes,
    require_folder,
    require_writable,
    write_files,
    write_text,
)
from mtcommission.base.messages.message import Message, printable

FOLDER = Message("file-is-folder")


@pytest.fixture
def mask():
    before = os.umask(0o027)
    yield
    os.umask(before)


def mode_of(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_a_new_file_has_the_umask_and_an_old_one_keeps_its_mode(tmp_path, mask):
    """A sheet that was private must not become readable for all, nor the other way round."""
    old, new = tmp_path / "old", tmp_path / "new"
    old.write_text("before")
    old.chmod(0o604)
    write_text(str(old), "after")
    write_files(tmp_path, {"new": b"new"})
    assert (old.read_text(), mode_of(old), mode_of(new)) == ("after", 0o604, 0o640)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["new", "old"]


def test_a_link_stays_and_its_target_is_written(tmp_path):
    (tmp_path / "below").mkdir()
    target, link = tmp_path / "below" / "target", tmp_path / "link"
    link.symlink_to(target)
    for text in ("new", "again"):
        require_writable(str(link))
        write_text(str(link), text)
        assert link.is_symlink()
        assert target.read_text() == text


def test_a_device_is_written_into():
    """As root, /dev/null once became a file."""
    require_writable("/dev/null", "/dev/null")
    write_text("/dev/null", "gone")
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


def test_a_pipe_is_written_into_and_read(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    found: list[bytes] = []
    reader = threading.Thread(
        target=lambda: found.append(read_bytes(pipe, folder=FOLDER, most=100))
    )
    reader.start()
    write_text(str(pipe), "through")
    reader.join()
    assert found == [b"through"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def test_what_is_read_and_what_is_named_twice_is_refused(tmp_path):
    """sweep --cases DIR/rows.csv -o DIR would overwrite the table of cases."""
    mine, link = tmp_path / "rows.csv", tmp_path / "link"
    mine.write_text("mine")
    link.symlink_to(mine)
    with pytest.raises(InputError, match="read by this command"):
        require_folder(tmp_path, "rows.csv", inputs=[link])
    with pytest.raises(InputError, match="read by this command"):
        require_writable(str(link), inputs=[mine])
    for twice in ((str(mine), str(link)), ("-", "-"), ("new", "./new")):
        with pytest.raises(InputError, match="named for two results"):
            require_writable(*twice)
    require_writable("", "", "-", str(mine))


def test_marks_that_nobody_sees_do_not_reach_the_screen():
    hidden = "\u061c\u200b\u200e\u200f\u202e\u2066\ufeff"
    assert printable(f"a{hidden}b") == f"a{'?' * len(hidden)}b"
    assert printable("é漢👩\u200d🔧") == "é漢👩\u200d🔧"


def test_of_several_files_none_is_replaced_if_one_cannot_be_filled(tmp_path, monkeypatch):
    """A full disk left a new sheet.html beside the old sheet.pdf."""
    write_files(tmp_path, {"a": b"old", "b": b"old"})
    left = 1

    def fsync(_):
        nonlocal left
        left -= 1
        if left < 0:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr("mtcommission.base.files.os.fsync", fsync)
    with pytest.raises(InputError, match="No space left"):
        write_files(tmp_path, {"a": b"new", "b": b"new"})
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {
        "a": b"old",
        "b": b"old",
    }, "and nothing is left of the write that failed"
