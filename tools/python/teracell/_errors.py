"""The exceptions of teracell. Their messages are those of the command line."""


class Error(Exception):
    """Anything that went wrong."""


class UsageError(Error, ValueError):
    """An argument, a key of a scene or an index is wrong."""


class IoError(Error, OSError):
    """The operating system reports a failure. `errno` is its number, where that is known."""

    def __str__(self):
        return self.strerror or super().__str__()


class FormatError(Error):
    """A grid or a surface is damaged, or is not what it should be."""
