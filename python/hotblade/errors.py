"""What goes wrong, by name; exit_code is that of the commands (docs/commands.md)."""
import re


class Error(Exception):
    """Base of all; of itself a mistake of the library."""
    exit_code = 1


class UsageError(Error, ValueError):
    """An argument or a setting."""
    exit_code = 2


class InputError(Error, ValueError):
    """A mesh or a program that cannot be used; `file` and `line` where they are known."""
    exit_code = 3

    def __init__(self, message=""):
        super().__init__(message)
        place = re.match(r"([^\n]*?)(?::(\d+))?: ", message)
        self.file = place[1] if place else None
        self.line = int(place[2]) if place and place[2] else None


class NotCuttable(Error):
    """The plan would be over its tolerance or over a limit."""
    exit_code = 4


class OverTolerance(Error):
    """A cut was measured to be over the tolerance."""
    exit_code = 5


class ControllerError(Error):
    """The controller refused or faulted, or the link was lost."""
    exit_code = 6


class FileError(Error, OSError):
    """A file is missing, unreadable, unwritable or already there."""
    exit_code = 7
