"""The report's figures, one at a time, for a notebook."""

from . import engine
from .errors import InvalidArgument


class Plots:
    """Each figure is a method that returns a matplotlib.figure.Figure."""

    _NAMES = ("trajectory", "position", "velocity", "spin", "angle", "contact_point", "force_loop",
              "quality")

    def __init__(self, shot):
        self._shot = shot

    def __dir__(self):
        return [*self._NAMES, "frames"]

    def __getattr__(self, name):
        if name not in self._NAMES and name != "frames":
            raise AttributeError(f"there is no figure '{name}'; there are {', '.join(dir(self))}")
        return lambda: self._draw(name)

    def _draw(self, name):
        engine.package("matplotlib", "a figure")
        from .report import draw, frames, path, shot

        places = {"frames": frames.key_frames, "trajectory": path.trajectory}
        figure = places.get(name, getattr(shot, name, None))(shot.Shot(self._shot))
        if figure is None:
            raise InvalidArgument(f"this shot has nothing to show as '{name}'", self._shot.folder)
        return draw.drawn(figure)
