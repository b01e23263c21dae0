# SPDX-License-Identifier: Apache-2.0
"""The exceptions and warnings of the package."""


class Error(Exception):
    """What the library refuses or cannot do: one sentence that says what is wrong, where, and what would be right.

    where:   the file and line, or the argument, that is wrong; may be empty
    allowed: what would be right; may be empty
    code:    "InvalidInput", "FileError", "MissingCapability" or "Cancelled"
    """

    def __init__(self, message: str = "", where: str = "", allowed: str = "") -> None:
        super().__init__(message, where, allowed)
        self.where = where
        self.allowed = allowed

    @property
    def code(self) -> str:
        return type(self).__name__

    def __str__(self) -> str:
        message = str(self.args[0])
        return f"{message} ({self.allowed})" if self.allowed and self.allowed not in message else message


class InvalidInput(Error, ValueError):
    """Bad input: a malformed file, a wrong array, an option out of range."""


class FileError(Error, OSError):
    """A file cannot be read or written."""

    def __str__(self) -> str:  # OSError has its own
        return Error.__str__(self)


class MissingCapability(Error):
    """This machine or this build lacks something: OpenGL, NanoVDB, memory."""


class Cancelled(Error):
    """The work was cancelled."""


class SubvolWarning(UserWarning):
    """What was left out, converted or chosen. `warnings.filterwarnings` hides it or makes it an error."""
