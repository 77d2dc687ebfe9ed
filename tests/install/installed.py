"""Where the installed tree lies, and how the tests of it run things."""

import os
import shutil
import subprocess
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ["IMPACTDIC_BUILD"])
CMAKE = os.environ.get("IMPACTDIC_CMAKE", "cmake")
SCRATCH = BUILD / "tests" / "install" / "scratch"
PREFIX = SCRATCH / "moved" / "prefix"
# What the library itself is compiled with (-march among it).
OPTIONS = os.environ.get("IMPACTDIC_OPTIONS", "").split()
COMPILERS = {"GCC": os.environ.get("IMPACTDIC_GCC", "g++"),
             "Clang": os.environ.get("IMPACTDIC_CLANG", "")}


# What a compiler made of the same files before is taken again, wherever the checkout lies.
CCACHE = shutil.which("ccache")
CACHED = {**os.environ, "CCACHE_BASEDIR": str(SCRATCH), "CCACHE_NOHASHDIR": "1"}
if CCACHE:
    CACHED["CMAKE_CXX_COMPILER_LAUNCHER"] = CCACHE


def run(*command, status=0, **keywords):
    """What the command prints; another exit status than `status` is a failure with its output."""
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, **keywords)
    if done.returncode != status:
        raise AssertionError(f"{' '.join(words)}\n{done.returncode}: "
                             f"{done.stdout}{done.stderr}")
    return done.stdout


def compiled(compiler, *arguments):
    """Compiles one source, through ccache where it is."""
    run(*([CCACHE] if CCACHE else []), compiler, "-c", *arguments, env=CACHED, cwd=SCRATCH)


def compilers(test):
    """The compilers that are here, by name; says which are not."""
    for name, path in COMPILERS.items():
        if path and shutil.which(path):
            yield name, path
        else:
            print(f"{name} is not installed: {test} leaves it out")


def find(pattern):
    """The one path below the prefix of this name."""
    found = sorted(PREFIX.glob(f"**/{pattern}"))
    if len(found) != 1:
        raise AssertionError(f"{pattern}: {found}")
    return found[0]


def headers():
    return sorted((PREFIX / "include" / "impactdic").rglob("*.h"))


def empty(name):
    folder = SCRATCH / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder
