"""The exceptions of teracell. Their messages are those of the command line."""
from __future__ import annotations

import errno
from typing import Any


class Error(Exception):
    """Anything that went wrong."""


class UsageError(Error, ValueError):
    """An argument, a key of a scene or an index is wrong, or the grid is closed."""


class TooLargeError(Error, MemoryError):
    """An array would be larger than the machine's memory."""


class IoError(Error, OSError):
    """The operating system reports a failure. `errno` is its number, where that is known; as with OSError, the number chooses the class."""

    def __new__(cls, *args: Any) -> IoError:
        kind = _BY_NUMBER.get(args[0], cls) if cls is IoError and args else cls
        return super().__new__(kind, *args)

    def __str__(self) -> str:
        return self.strerror or super().__str__()


class NotFoundError(IoError, FileNotFoundError):
    """There is no such file."""


class NotPermittedError(IoError, PermissionError):
    """The file may not be read or written."""


class FolderError(IoError, IsADirectoryError):
    """There is a folder where a file was expected."""


class FormatError(Error):
    """A grid or a surface is damaged, or is not what it should be."""


_BY_NUMBER: dict[int, type[IoError]] = {errno.ENOENT: NotFoundError, errno.EACCES: NotPermittedError, errno.EPERM: NotPermittedError, errno.EISDIR: FolderError}
