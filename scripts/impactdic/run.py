"""The measurements: track, batch, correlate."""

import numbers
import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import engine, tables
from .clip import Clip, blocks_of
from .clip import open as open_clip
from .errors import InvalidArgument
from .results import load
from .shot import Batch, Shot


class ResultWarning(UserWarning):
    """What a person should check before using a result."""


@dataclass(frozen=True)
class Ball:
    """The body that hits. diameter_mm gives the scale; inertia_factor is I / (m R^2): 2/3 hollow,
    2/5 solid; mass_g and inertia_factor are what models need."""

    diameter_mm: float = 0.0
    mass_g: float = 0.0
    inertia_factor: float = 0.0

    def body(self):
        """The table [body] of a job of `simulate` or `fit`."""
        for name in ("diameter_mm", "mass_g", "inertia_factor"):
            if not getattr(self, name) > 0:
                raise InvalidArgument("a model needs it", f"ball.{name}")
        radius_m = self.diameter_mm / 2e3
        shapes = {2 / 3: "hollow_sphere", 2 / 5: "solid_sphere"}
        body = {"mass_kg": self.mass_g / 1e3, "diameter_m": self.diameter_mm / 1e3}
        for factor, shape in shapes.items():
            if abs(self.inertia_factor - factor) < 1e-9:
                return {**body, "shape": shape}
        return {**body, "inertia_kg_m2": self.inertia_factor * body["mass_kg"] * radius_m**2}


def _plain_frames(frames):
    """A slice, a range or (first, end[, step]) as the engine takes it."""
    if isinstance(frames, (slice, range)):
        step = 1 if frames.step is None else frames.step
        return (frames.start or 0, frames.stop, step)
    try:
        frames = tuple(frames)
    except TypeError:
        raise InvalidArgument("must be a slice or (first, end, step)", "frames") from None
    return (*frames, 1) if len(frames) == 2 else frames


def _options_for(clip, options):
    if options.get("frames") is not None:
        if "frames" in clip._options():
            raise InvalidArgument("the frames are given twice", "frames", "slice the clip, or name them")
        options["frames"] = _plain_frames(options["frames"])
    return {**clip._options(), **options}


def _clip_of(source, options):
    made = {key: options.pop(key) for key in ("fps", "bits", "raw", "max_megapixels", "gamma", "channel")
            if options.get(key) is not None}
    if isinstance(source, Clip) and not made:
        return source
    return open_clip(source, **made)


def _finish(outcome):
    if outcome["cancelled"]:
        warnings.warn("the run was stopped before its end: the result holds what was measured",
                      ResultWarning, stacklevel=3)


def track(clip, ball=None, *, surface_deg=None, ball_rank=None, out=None, force=False,
          resume=False, progress=False, on_frame=None, on_message=None, device="auto", threads=0,
          **options):
    """Measures a ball in every frame of a clip: centre, motion, displacement field, impact.

    clip: a Clip, or whatever `open` takes. ball: a Ball; its diameter gives the scale.
    surface_deg: inclination of the surface, counter-clockwise from image-right.
    ball_rank: which of several balls is measured, as `impactdic info --candidates` counts them.
    out: a folder for the results, as `impactdic track -o`; without it they lie in a folder that
    goes with the shot. force, resume: as the program's.
    progress: True, or a function of (phase, done, total).
    on_frame: called with (row, picture, field) of each frame as it is measured: a dictionary of
    numbers, an array (height, width), a dictionary of arrays (windows).
    on_message: called with (kind, text). device, threads: as the program's.
    options: those of `impactdic track`, underscores for dashes: frames (a slice), roi (x, y, width,
    height), radius_px (low, high), polygon [(x, y), …], ball_at {frame: (x, y, radius) or None} for
    frames corrected by hand, estimator, body, window, spacing, search, method, mm_per_px,
    gravity_angle_deg, no_field, overlay, compress, fps, bits, …

    Returns a Shot. Numbers are those of the program to the last bit. Ctrl-C ends the run within a
    second; the Shot then holds what was measured. Other threads of Python go on meanwhile.
    Raises InvalidArgument, FileError, FormatError, OpenClError, BuildError.
    """
    clip = _clip_of(clip, options)
    if surface_deg is not None:
        options["surface_angle_deg"] = surface_deg
    if ball_rank is not None:
        options["ball"] = ball_rank
    if ball is not None:
        if ball.diameter_mm and not options.get("mm_per_px"):
            options.setdefault("ball_diameter_mm", ball.diameter_mm)
        if ball.inertia_factor:
            options.setdefault("inertia_factor", ball.inertia_factor)
    holder = None
    if out is None:
        if resume:
            raise InvalidArgument("there is no folder to go on with", "resume", "out=FOLDER")
        holder = tempfile.TemporaryDirectory(prefix="impactdic-")
        out = Path(holder.name) / "shot"
        options.setdefault("no_checksum", True)
    outcome = engine.module().track(
        clip._source, _options_for(clip, options),
        {"folder": str(out), "force": force, "resume": resume}, engine.session(device, threads),
        engine.listener(progress), on_message, on_frame)
    _finish(outcome)
    return Shot(out, ball, holder)


def track_blocks(pictures, ball=None, *, block=256, **options):
    """Measures a clip that has no end: an iterator of pictures, a block of frames at a time.

    Yields a Shot for each block. Frame numbers and times go on from block to block, in the columns
    `frame` and `time_s` of its track; a block begins with the last picture of the block before, so
    that no motion is lost. Scale and impact are worked out from each block alone.
    options: as `track`; block: pictures at a time, 2 or more.
    """
    if not isinstance(block, numbers.Integral) or block < 2:
        raise InvalidArgument("a motion needs two pictures", "block", "a whole number, 2 or more")
    if not hasattr(pictures, "__iter__"):
        raise InvalidArgument(f"a {type(pictures).__name__} gives no pictures", "pictures",
                              "an iterator of arrays (height, width)")
    for offset, some, last in blocks_of(pictures, block):
        shot = track(list(some), ball, **options)
        table = shot.track
        if not last:
            table = table.iloc[:-1]
        fps = shot.summary.get("analysed_fps")
        shot.track = table.assign(frame=table["frame"] + offset,
                                  time_s=table["time_s"] + offset / (fps or 1))
        yield shot
        if shot.cancelled:
            return


def batch(folder, out, ball=None, *, table=None, surface_deg=None, force=False, resume=False,
          progress=False, on_message=None, device="auto", threads=0, **options):
    """`track` for every clip of a folder, as `impactdic batch`; returns a Batch.

    table: a CSV file with the column file and any of surface_angle_deg, ball_diameter_mm,
    inertia_factor, drop_height_mm, camera, ball, mass_g, notes.
    options: those of `impactdic batch`, underscores for dashes.
    """
    if surface_deg is not None:
        options["surface_angle_deg"] = surface_deg
    if ball is not None:
        options.setdefault("ball_diameter_mm", ball.diameter_mm or None)
        options.setdefault("inertia_factor", ball.inertia_factor or None)
    if table is not None:
        options["table"] = str(table)
    if options.get("frames") is not None:
        options["frames"] = _plain_frames(options["frames"])
    outcome = engine.module().batch(
        str(folder), options, {"folder": str(out), "force": force, "resume": resume},
        engine.session(device, threads), engine.listener(progress), on_message)
    _finish(outcome)
    done = Batch(out)
    for shot in done.shots:
        shot.ball = ball
    return done


def correlate(reference, picture=None, *, mask=None, out=None, force=False, resume=False,
              progress=False, on_message=None, device="auto", threads=0, **options):
    """The displacement field of any speckled surface.

    reference, picture: two pictures (height, width); or a clip alone, as `open` takes it.
    mask: the file of a picture, or an array (height, width): only its non-zero pixels count.
    options: those of `impactdic correlate`: roi, polygon [(x, y), …], window, spacing, search,
    method, reference="first" or "previous" of a clip as `against`, motion, frames, fps, …
    out: a folder for the results, as `impactdic correlate -o`.

    Returns an xarray.Dataset: u_px, v_px and more of each window, with their deviations; NaN where
    `status` is not 0. Of two pictures its dimension is (window), of a clip (time, window). The
    rigid motion of the region stands in dx_px, dy_px, rot_deg; with camera= also in its plane of
    motion: dx_m, dy_m, plane_rot_deg. Raises as `track`.
    """
    clip = _clip_of(reference if picture is None else [reference, picture], options)
    against = options.pop("against", None)
    if against is not None:
        options["reference"] = against
    if isinstance(mask, np.ndarray):
        mask = np.ascontiguousarray(mask != 0, dtype=np.uint8)
    elif mask is not None:
        options["mask"], mask = str(mask), None
    outcome = engine.module().correlate(
        clip._source, _options_for(clip, options),
        {"folder": "" if out is None else str(out), "force": force, "resume": resume}, mask,
        engine.session(device, threads), engine.listener(progress), on_message)
    _finish(outcome)
    for warning in outcome["warnings"]:
        warnings.warn(warning, ResultWarning, stacklevel=2)
    if out is not None:
        return load(out).fields
    return _dataset(outcome, picture is not None)


def _dataset(outcome, pair):
    from .fields import dataset

    motion = outcome["motion"]
    attributes = {"warnings": outcome["warnings"], "axes": "x right, y down, px"}
    field = dataset(outcome["field"], outcome["field_frames"], outcome["fps"], attributes)
    rows = np.searchsorted(motion["frame"], outcome["field_frames"])
    names = ["dx_px", "dy_px", "rot_deg", "dx_sd_px", "dy_sd_px", "rot_sd_deg"]
    if np.isfinite(motion["dx_m"]).any():
        names += ["dx_m", "dy_m", "plane_rot_deg", "dx_sd_m", "dy_sd_m", "plane_rot_sd_deg"]
    for name in names:
        field[name] = ("time", motion[name][rows], {"units": tables.unit_of(name)})
    field["time"] = ("time", motion["time_s"][rows], field["time"].attrs)
    return field.isel(time=0, drop=True) if pair and field.sizes["time"] == 1 else field
