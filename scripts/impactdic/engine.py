"""The compiled part, found and started when it is first needed."""

import importlib
import sys

from . import opencl
from .errors import InvalidArgument, MissingPackage

_session = {}  # the last one that was opened, by its device


def module():
    """The module _impactdic. Reading results does without it."""
    opencl.offer()
    for name in ("impactdic._impactdic", "_impactdic"):
        try:
            return importlib.import_module(name)
        except ModuleNotFoundError as error:
            if error.name not in (name, "impactdic._impactdic"):
                raise
    raise MissingPackage("the compiled part of impactdic is not here", "_impactdic",
                         "pip install impactdic, or build it and put its folder on PYTHONPATH")


def package(name, wanted_for):
    """The module `name`, imported when it is first needed."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise MissingPackage(f"{wanted_for} needs the package {name.split('.')[0]}", name,
                             f"pip install {name.split('.')[0]}") from error


def devices():
    """The OpenCL devices: a list of dictionaries (index, name, platform, driver, is_gpu, …)."""
    return module().list_devices()


def session(device="auto", threads=0):
    """Opened devices and compiled kernels; kept from one run to the next. A limit of threads holds
    for the whole process while its session lives, so such a session is not kept."""
    if threads:
        return module().Session({"device": str(device), "threads": threads})
    key = str(device)
    if key not in _session:
        opened = module().Session({"device": key})
        _session.clear()
        _session[key] = opened
    return _session[key]


def listener(progress):
    """What the engine calls: `progress` may be None, True (a line on stderr) or a function of
    (phase, done, total)."""
    if progress is None or progress is False:
        return None
    if progress is True:
        return _print_progress
    if not callable(progress):
        raise InvalidArgument("must be True, False or a function", "progress")
    return progress


def _print_progress(phase, done, total):
    share = f"{100 * done / total:3.0f} %" if total else ""
    end = "\n" if done == total else ""
    print(f"\r{phase} {done} of {total} frames {share}", end=end, file=sys.stderr, flush=True)
