"""What `track` and `batch` give back."""

import html
import shutil
from functools import cached_property
from pathlib import Path

from .errors import InvalidArgument, ResultError
from .results import Result, shots_of
from .report.text import with_sd


class Shot(Result):
    """One measured clip: its tables, fields, figures and files. The results lie in `folder`; of a
    run without `out` that is a folder of its own which goes with the shot (see `save`)."""

    def __init__(self, folder, ball=None, holder=None):
        super().__init__(folder)
        self.ball = ball
        self._holder = holder  # removes a folder that nobody asked for

    @property
    def shots(self):
        return [self]

    @property
    def cancelled(self):
        """True where the run was stopped before its end."""
        return bool(self.summary.get("cancelled"))

    @property
    def figures(self):
        """The impact in figures: a dictionary of {"value", "sd"}; empty where there is none."""
        impact = self.impact
        if impact is None:
            return {}
        chosen = {"restitution": impact["restitution"],
                  "friction": impact["friction"]["gravity_corrected"],
                  "contact_s": impact["contact_s"],
                  "max_deflection_m": impact["max_deflection_m"]}
        for side in ("before", "after"):
            for key, figure in (impact.get(side) or {}).items():
                if isinstance(figure, dict):
                    chosen[f"{key}_{side}"] = figure
        return chosen

    def _lines(self):
        """(name, text) of what a person wants first."""
        lines = [("warning", warning) for warning in self.warnings]
        if self.cancelled:
            lines.insert(0, ("warning", "the run was stopped before its end"))
        counts = self.summary.get("frames_by_status") or {}
        lines.append(("frames", f"{self.summary.get('frames_analysed')} ("
                      + ", ".join(f"{n} {status}" for status, n in counts.items()) + ")"))
        if self.impact is None:
            told = (self.summary.get("impact") or {}).get("explanation", "not looked for")
            return lines + [("impact", told)]
        names = {"restitution": "restitution e", "friction": "friction"}
        for key, figure in self.figures.items():
            lines.append((names.get(key, key), with_sd(figure)))
        return lines

    def __repr__(self):
        return f"Shot '{self.name}'\n" + "\n".join(f"  {name}: {text}"
                                                    for name, text in self._lines())

    def _repr_html_(self):
        rows = "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(text)}</td></tr>"
                       for name, text in self._lines())
        return f"<table><caption>Shot {html.escape(self.name)}</caption>{rows}</table>"

    @cached_property
    def plot(self):
        """Figures by matplotlib: shot.plot.velocity(), .position(), .spin(), …; see dir(shot.plot)."""
        from .plot import Plots

        return Plots(self)

    def save(self, folder, force=False):
        """Copies the results into `folder` and returns them from there."""
        target = Path(folder)
        if target.exists() and any(target.iterdir()) and not force:
            raise InvalidArgument("the folder holds files already", target, "force=True")
        shutil.copytree(self.folder, target, dirs_exist_ok=True)
        return Shot(target, self.ball)

    def report(self, path=None):
        """Writes one page that needs nothing but a browser, that of `impactdic report`: to `path`,
        else to report.html in the folder, with its figures as files in `figures`. Returns the
        path."""
        return _report(self, path)

    def to_vtk(self, folder):
        """Writes the fields as a series for ParaView; see export.to_vtk."""
        from .export import to_vtk

        return to_vtk(self, folder)

    def to_mat(self, path):
        """Writes tables, fields and summary as one MAT file; see export.to_mat."""
        from .export import to_mat

        return to_mat(self, path)


class Batch(Result):
    """What `batch` wrote: `table` of all shots, and the shots that could be measured."""

    @cached_property
    def shots(self):
        return shots_of(self.folder)

    @cached_property
    def overview(self):
        """shots.csv: a pandas.DataFrame, one row a clip."""
        return self.table("shots")

    def __repr__(self):
        from .report.first import sentence_of_shots
        from .report.groups import left_out

        table = self.columns("shots")
        measured = sum(status == "ok" for status in table["status"])
        return (f"Batch {self.name!r}: {measured} of {len(table['status'])} clips measured\n"
                f"  {sentence_of_shots(table, left_out(self.folder))}")

    def __len__(self):
        return len(self.shots)

    def __iter__(self):
        return iter(self.shots)

    def __getitem__(self, index):
        return self.shots[index]

    def report(self, path=None):
        """One page of all shots; see Shot.report."""
        return _report(self, path)


def _report(result, path):
    from .report.__main__ import make

    ball = getattr(result, "ball", None)
    # Figures as files take four times as long as the page.
    make(result.folder, mass_kg=ball.mass_g / 1e3 if ball is not None and ball.mass_g else None,
         page_alone=path is not None)
    page = result.folder / "report.html"
    if path is None:
        return page
    try:
        return Path(shutil.copyfile(page, path))
    except OSError as error:
        raise ResultError("cannot write the page", path, error.strerror) from error
