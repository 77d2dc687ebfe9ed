"""What `open` takes, and what it refuses."""

import gc
import weakref

import h5py
import numpy as np
import pytest

import impactdic as idic
from conftest import program


def pixels(clip):
    return np.asarray(clip)


def test_a_clip_is_a_lazy_array(film):
    clip = idic.open(film[0], fps=5000)
    assert len(clip) == 12 and clip.shape == (12, 128, 128) and clip.dtype == np.uint8
    assert clip.fps == 5000 and clip.bits == 8 and clip.time_s is None
    assert np.array_equal(clip[-1], film[0][-1])
    part = clip[2:11:3]
    assert isinstance(part, idic.Clip) and len(part) == 3
    assert np.array_equal(part[1:][0], film[0][5])
    assert np.array_equal(pixels(part), film[0][2:11:3])
    assert np.array_equal(np.stack(list(part)), film[0][2:11:3])
    with pytest.raises(IndexError):
        clip[12]
    with pytest.raises(idic.InvalidArgument, match="forwards"):
        clip[::-1]


def strided(film):
    wide = np.zeros((12, 128, 200), np.uint8)
    wide[:, :, 40:168] = film
    return {
        "contiguous": film.copy(),
        "gaps": wide[:, :, 40:168],
        "flipped": np.ascontiguousarray(film[:, ::-1])[:, ::-1],
        "mirrored": np.ascontiguousarray(film[:, :, ::-1])[:, :, ::-1],
        "columns first": np.asfortranarray(film),
        "every second": np.repeat(film, 2, axis=2)[:, :, ::2],
        "last frame first": np.ascontiguousarray(film[::-1])[::-1],
    }


@pytest.mark.parametrize("layout", strided(np.zeros((12, 128, 128), np.uint8)))
def test_any_strides(film, layout):
    array = strided(film[0])[layout]
    assert np.array_equal(array, film[0])
    assert np.array_equal(pixels(idic.open(array)), film[0])


def test_read_only_memory_and_lists(film, tmp_path):
    array = film[0].copy()
    array.flags.writeable = False
    assert np.array_equal(pixels(idic.open(array)), film[0])
    assert np.array_equal(pixels(idic.open(list(array))), film[0])
    assert np.array_equal(pixels(idic.open(picture for picture in array)), film[0])
    mixed = [array[0], np.asfortranarray(array[1])]
    assert np.array_equal(pixels(idic.open(mixed)), film[0][:2])
    np.save(tmp_path / "film.npy", array)
    for mode in ("r", "r+", "c"):
        mapped = np.load(tmp_path / "film.npy", mmap_mode=mode)
        assert np.array_equal(pixels(idic.open(mapped)), film[0])


def test_private_changes_of_a_map_are_measured(film, tmp_path):
    np.save(tmp_path / "film.npy", film[0])
    mapped = np.load(tmp_path / "film.npy", mmap_mode="c")
    mapped[3] = 7
    clip = idic.open(mapped)
    for _ in range(2):  # a page that was given back would come again as the file has it
        assert (clip[3] == 7).all()


def test_deep_pixels(film):
    deep = film[0].astype(np.uint16) << 4
    for bits in (12, 16, None):
        clip = idic.open(deep, bits=bits)
        assert clip.bits == (bits or 16) and np.array_equal(pixels(clip), deep)
    assert np.array_equal(pixels(idic.open(deep.astype(">u2"), bits=12)), deep)
    assert np.array_equal(pixels(idic.open(np.asfortranarray(deep), bits=12)), deep)
    with pytest.raises(idic.InvalidArgument, match="brighter than 10 bits"):
        pixels(idic.open(deep, bits=10))


def test_arrays_that_lie_elsewhere_are_read_by_blocks(film, tmp_path):
    with h5py.File(tmp_path / "film.h5", "w") as file:
        file["film"] = film[0]
        clip = idic.open(file["film"])
        assert np.array_equal(pixels(clip), film[0])

    class Lazy:  # as dask: values come of a slice
        shape, dtype, asked = film[0].shape, film[0].dtype, []

        def __getitem__(self, key):
            self.asked.append(key)
            return film[0][key]

    lazy = Lazy()
    assert np.array_equal(pixels(idic.open(lazy)), film[0])
    assert len(lazy.asked) == 1  # a block, not a frame at a time


def test_what_an_array_raises_comes_out(film):
    class Broken:
        shape, dtype = film[0].shape, film[0].dtype

        def __getitem__(self, key):
            raise KeyError("the disk is gone")

    with pytest.raises(KeyError, match="the disk is gone"):
        idic.track(Broken(), no_field=True)


@pytest.mark.parametrize("array, words", [
    (np.zeros((3, 64, 64)), "uint8 or uint16, not float64"),
    (np.full((3, 64, 64), np.nan, np.float32), "uint8 or uint16, not float32"),
    (np.zeros((3, 64, 64), bool), "not bool"),
    (np.zeros((3, 64, 64), np.int16), "not int16"),
    (np.zeros((3, 64, 64), np.uint32), "not uint32"),
    (np.zeros((64, 64), np.uint8), "shape"),
    (np.zeros((3, 64, 64, 3), np.uint8), "shape"),
    (np.zeros((0, 64, 64), np.uint8), "no frames"),
    (np.zeros((3, 0, 64), np.uint8), "no pixels"),
    ([], "no frames"),
    ([np.zeros((8, 8), np.uint8), np.zeros((8, 9), np.uint8)], "picture 1"),
    ([np.zeros((8, 8), np.uint8), np.zeros((8, 8), np.uint16)], "picture 1"),
    ([np.zeros(8, np.uint8)], "picture 0"),
    (iter([]), "no frames"),
    (None, "no clip"),
    (7, "no clip"),
])
def test_what_is_no_clip_is_refused(array, words):
    with pytest.raises(idic.InvalidArgument, match=words):
        idic.open(array)


def test_wrong_depths_are_refused(film):
    for bits in (0, 9, 17, -1):
        with pytest.raises(idic.InvalidArgument):
            idic.open(film[0], bits=bits)
    for fps in (0, -1, float("nan"), float("inf")):
        with pytest.raises(idic.InvalidArgument, match="frame rate"):
            idic.open(film[0], fps=fps)


def test_files(film, tmp_path):
    program("synth", "-q", "-o", tmp_path / "clip", "--frames", 5, "--size", "64x48", "--radius-px",
            20, "--format", "cine", "--fps", 4000)
    clip = idic.open(tmp_path / "clip" / "video.cine")
    assert clip.shape == (5, 48, 64) and clip.fps == 4000
    assert clip.info["format"] == "Phantom cine"
    assert np.allclose(clip[1:].time_s, np.arange(1, 5) / 4000, atol=1e-6)
    assert pixels(clip)[2:3].sum() == clip[2].sum() > 0
    with pytest.raises(idic.FileError, match="nowhere"):
        idic.open("/nowhere/clip.cine")
    (tmp_path / "bad.cine").write_bytes(b"CI" + b"\0" * 20)
    with pytest.raises(idic.FormatError):
        idic.open(str(tmp_path / "bad.cine"))
    raw = tmp_path / "pixels.raw"
    raw.write_bytes(film[0].tobytes())
    assert np.array_equal(pixels(idic.open(raw, raw=(128, 128, 8))), film[0])
    light = pixels(idic.open(raw, raw=(128, 128, 8), gamma=2.2))
    assert light.dtype == np.uint16
    assert np.abs(light - 65535.0 * (film[0] / 255.0) ** 2.2).max() <= 0.51
    with pytest.raises(idic.InvalidArgument, match="red, green and blue"):
        idic.open(raw, raw=(128, 128, 8), channel="purple")


def test_the_array_lives_as_long_as_the_clip(film):
    array = film[0].copy()
    alive = weakref.ref(array)
    clip = idic.open(array)
    del array
    gc.collect()
    assert np.array_equal(pixels(clip), film[0])
    del clip
    gc.collect()
    assert alive() is None
