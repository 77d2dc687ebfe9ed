"""The errors of impactdic, with the words of the program: WHAT (WHERE): HINT."""


class Error(Exception):
    """What went wrong, where (a file, a byte, an option), and a hint; one line as text."""

    def __init__(self, what, where="", hint=""):
        self.what, self.where, self.hint = str(what), str(where), str(hint or "")
        super().__init__(self.what, self.where, self.hint)

    def __str__(self):
        text = self.what
        if self.where:
            text += f" ({self.where})"
        if self.hint:
            text += f": {self.hint}"
        return " ".join(text.splitlines())


class InvalidArgument(Error, ValueError):
    """The request was wrong: an unknown option, an impossible value."""


class FileError(Error, OSError):
    """A file could not be read, or written."""


class FormatError(FileError):
    """A file's contents are not what its format promises."""


class OpenClError(Error):
    """An OpenCL call failed, or no device answers."""


class BuildError(Error):
    """A kernel did not compile."""


class ResultError(Error):
    """A folder does not hold the results that were asked for."""


class MissingPackage(Error, ImportError):
    """A Python package that this needs is not installed."""
