"""Clips: files, arrays, and anything that gives frames."""

import os
import threading
from collections import OrderedDict
from itertools import islice

import numpy as np

from . import engine
from .errors import InvalidArgument

_BLOCK_BYTES = 16 << 20  # read at once from an array that lies elsewhere
_BLOCKS_KEPT = 8


class Clip:
    """A clip that is open for reading; frames are read when they are asked for.

    len(clip): frames. clip[k]: frame k, an array (height, width) of uint8 or uint16, x right, y
    down. clip[a:b:c]: a clip of those frames, nothing is read. numpy.asarray(clip): all of them.
    """

    def __init__(self, source, fps=None, frames=None):
        self._source = source
        self._info = source.info()
        self._fps = float(fps) if fps else None
        self._frames = range(self._info["frames"]) if frames is None else frames

    @property
    def info(self):
        """What the file says of itself: a dictionary (format, camera, bits, exposure_s, …)."""
        return dict(self._info)

    @property
    def fps(self):
        """Rate of the stored frames, 1/s; None where neither the file nor the caller says it."""
        return self._fps or self._info["fps"]

    @property
    def bits(self):
        """Effective bits of a pixel."""
        return self._info["bits"]

    @property
    def dtype(self):
        return np.dtype(np.uint8 if self.bits <= 8 else np.uint16)

    @property
    def shape(self):
        """(frames, height, width)"""
        return (len(self), self._info["height"], self._info["width"])

    @property
    def ndim(self):
        return 3

    @property
    def time_s(self):
        """The camera's own time of each frame in seconds since the file's frame 0; None where the
        file has none."""
        if not self._info["has_timestamps"]:
            return None
        return np.array([self._source.time_s(k) for k in self._frames], dtype=float)

    def __len__(self):
        return len(self._frames)

    def __getitem__(self, index):
        if isinstance(index, slice):
            frames = self._frames[index]
            if frames.step < 0:
                raise InvalidArgument("frames are read forwards", "step", "1 or more")
            return Clip(self._source, self._fps, frames)
        try:
            frame = self._frames[index]
        except TypeError:
            raise InvalidArgument("must be a whole number or a slice", "index") from None
        return self._source.read(frame, 1, 1)[0]

    def __iter__(self):
        return (self[k] for k in range(len(self)))

    def __array__(self, dtype=None, copy=None):
        frames = self._frames
        pixels = self._source.read(frames.start, len(frames), frames.step)
        return pixels if dtype is None else pixels.astype(dtype)

    def __repr__(self):
        count, height, width = self.shape
        rate = f"{self.fps:g} frames/s" if self.fps else "rate not known"
        name = os.path.basename(self._info["path"])
        return f"Clip '{name}': {count} frames, {width}x{height}, {self.bits} bits, {rate}"

    def _options(self):
        """What a run must be told of this clip beside its source."""
        frames = self._frames
        options = {}
        if self._fps:
            options["fps"] = self._fps
        if frames != range(self._info["frames"]):
            options["frames"] = (frames.start, frames.stop, frames.step)
        return options


def open(source, *, fps=None, bits=None, **options):  # noqa: A001
    """Opens a clip.

    source: the path of a clip, a folder or a pattern of pictures; a list of picture files; an array
    (frames, height, width) of uint8 or uint16 with any strides, also memory-mapped; a list of
    pictures (height, width); anything with shape, dtype and slices (dask, zarr, h5py), which is
    read by blocks; or an iterator of pictures that ends (all of them are kept).
    fps: rate of the stored frames, 1/s; overrides the file's.
    bits: effective bits of the pixels of an array (8 for uint8, 16 for uint16).
    options: raw=(width, height, bits) of headerless pixels; gamma of the grey levels (2.2 for most
    film), which are turned back to light; channel ("red", "green", "blue") of pictures in colour,
    instead of their luminance; max_megapixels.

    Arrays whose rows have no gaps are measured where they lie, and must not change meanwhile.
    Raises InvalidArgument, FileError, FormatError.
    """
    if isinstance(source, Clip):
        return Clip(source._source, fps or source._fps, source._frames)
    if fps is not None and not (np.isfinite(fps) and fps > 0):
        raise InvalidArgument(f"the frame rate must be positive, not {fps}", "fps")
    paths = _paths(source)
    if paths is not None:
        if bits is not None:
            raise InvalidArgument("a file says its depth itself", "bits", "raw=(width, height, bits)")
        return Clip(engine.module().clip_from_files(paths, options), fps)
    if options:
        raise InvalidArgument("there is no such option of an array", next(iter(options)))
    return Clip(_array_source(source, bits), fps)


def _paths(source):
    if isinstance(source, (str, os.PathLike)):
        return [os.fspath(source)]
    if isinstance(source, (list, tuple)) and source:
        if all(isinstance(item, (str, os.PathLike)) for item in source):
            return [os.fspath(item) for item in source]
    return None


def _array_source(source, bits):
    if isinstance(source, np.ndarray):
        return _from_array(source, bits)
    if hasattr(source, "shape") and hasattr(source, "dtype") and hasattr(source, "__getitem__"):
        return _from_blocks(source, bits)
    if isinstance(source, (list, tuple)):
        return _from_pictures(list(source), bits)
    if hasattr(source, "__next__") or hasattr(source, "__iter__"):
        # A camera's buffer may be used again for the next frame.
        return _from_pictures([np.array(picture) for picture in source], bits)
    raise InvalidArgument(f"a {type(source).__name__} is no clip", "source",
                          "a path, an array (frames, height, width) or pictures")


def _depth(dtype, bits):
    dtype = np.dtype(dtype)
    if dtype.kind != "u" or dtype.itemsize > 2:
        raise InvalidArgument(f"pictures are arrays of uint8 or uint16, not {dtype}", "array",
                              "convert them, and say which grey levels are meant")
    return int(bits) if bits is not None else 8 * dtype.itemsize


def _from_array(array, bits):
    depth = _depth(array.dtype, bits)
    if array.ndim != 3:
        raise InvalidArgument(f"a clip has the shape (frames, height, width), not {array.shape}",
                              "array")
    if array.size == 0:
        raise InvalidArgument(f"the clip has no frames or no pixels: {array.shape}", "array")
    if not array.dtype.isnative:
        return _from_blocks(array, bits)
    # Pages of a map that nobody has changed in private can be read from the file again.
    mapped = isinstance(array, np.memmap) and array.mode in ("r", "r+")
    return engine.module().clip_from_array(_readable(array), depth, 0.0, mapped)


def _readable(array):
    """A view that DLPack takes, whatever numpy thinks of its writing."""
    plain = np.asarray(array)
    return plain if plain.dtype.isnative else plain.astype(plain.dtype.newbyteorder("="))


def _from_pictures(pictures, bits):
    if not pictures:
        raise InvalidArgument("the clip has no frames", "array")
    pictures = [np.asarray(picture) for picture in pictures]
    first = pictures[0]
    depth = _depth(first.dtype, bits)
    for k, picture in enumerate(pictures):
        if picture.ndim != 2 or picture.shape != first.shape or picture.dtype != first.dtype:
            raise InvalidArgument(
                f"picture {k} is {picture.dtype} of the shape {picture.shape}, the first one "
                f"{first.dtype} of {first.shape}", "array", "one size (height, width), one depth")
    if first.size == 0:
        raise InvalidArgument(f"the pictures have no pixels: {first.shape}", "array")
    if any(p.strides != first.strides or not p.dtype.isnative for p in pictures):
        pictures = [np.ascontiguousarray(_readable(p)) for p in pictures]
    return engine.module().clip_from_pictures([_readable(p) for p in pictures], depth, 0.0)


class _Blocks:
    """Frames of an array that lies elsewhere, read by blocks; the last few are kept."""

    def __init__(self, array, dtype):
        self._array, self._dtype = array, dtype
        _, height, width = array.shape
        self._size = max(1, _BLOCK_BYTES // (height * width * dtype.itemsize))
        self._kept, self._lock = OrderedDict(), threading.Lock()

    def __call__(self, index):
        number, within = divmod(index, self._size)
        with self._lock:
            block = self._kept.pop(number, None)
            if block is None:
                start = number * self._size
                block = np.asarray(self._array[start:start + self._size])
                if block.dtype != self._dtype:
                    block = block.astype(self._dtype)
            self._kept[number] = block
            while len(self._kept) > _BLOCKS_KEPT:
                self._kept.popitem(last=False)
        return block[within]


def _from_blocks(array, bits):
    depth = _depth(array.dtype, bits)
    shape = tuple(int(n) for n in array.shape)
    if len(shape) != 3:
        raise InvalidArgument(f"a clip has the shape (frames, height, width), not {shape}", "array")
    if 0 in shape:
        raise InvalidArgument(f"the clip has no frames or no pixels: {shape}", "array")
    blocks = _Blocks(array, np.dtype(array.dtype).newbyteorder("="))
    return engine.module().clip_from_function(blocks, shape[0], shape[1], shape[2], depth, 0.0)


def blocks_of(pictures, count):
    """Lists of `count` pictures, each beginning with the last one of the list before; the rest at
    the end. (offset, list, whether it is the last)"""
    pictures = (np.array(picture) for picture in pictures)
    block, offset = list(islice(pictures, count)), 0
    while block:
        more = list(islice(pictures, count - 1))
        yield offset, block, not more
        if not more:
            return
        offset += len(block) - 1
        block = [block[-1], *more]
