"""The program `impactdic` that comes with the package."""

import os
import sys
from pathlib import Path

from . import opencl


def main():
    """Becomes the program; its report uses this Python."""
    program = Path(__file__).resolve().parent / "bin" / "impactdic"
    os.environ.setdefault("IMPACTDIC_PYTHON", sys.executable)
    opencl.offer()
    try:
        os.execv(program, [str(program), *sys.argv[1:]])
    except OSError as error:
        print(f"impactdic: error: cannot run the program ({program}): {error.strerror}",
              file=sys.stderr)
        return 1
