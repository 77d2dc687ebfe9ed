"""python3 -m impactdic.report DIR: see `impactdic report --help`."""

import argparse
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from ..errors import MissingPackage, ResultError
from ..results import load, read_table, shots_of
from .first import First, sentence_of_fit, sentence_of_shots, sentence_of_simulated


# Modules, and Debian's packages of them.
NEEDED = {"numpy": "python3-numpy", "h5py": "python3-h5py", "matplotlib": "python3-matplotlib",
          "plotly": "python3-plotly", "rjsmin": "python3-rjsmin"}


def missing_packages():
    from importlib.util import find_spec

    return [package for module, package in NEEDED.items() if find_spec(module) is None]


def versions():
    import matplotlib
    import plotly

    python = ".".join(str(part) for part in sys.version_info[:3])
    return f"Python {python}, matplotlib {matplotlib.__version__}, plotly {plotly.__version__}"


class Report:
    """What stands on the page, gathered from a folder."""

    def __init__(self, folder, program, mass_kg=None):
        self.folder, self.program, self.mass_kg = folder, program, mass_kg
        self.figures, self.tables, self.warnings, self.texts = [], [], [], []
        self.subtitle, self.first, self.kind = "", First(), "Impact"

    def gather(self):
        from . import clip, models, study

        is_shot = (self.folder / "track.csv").exists()
        is_batch = (self.folder / "shots.csv").exists()
        model_folders = models.folders_in(self.folder)
        if is_batch:
            self.add_batch()
        elif is_shot:
            self.add_shot()
        elif (self.folder / "motion.csv").exists() and (self.folder / "fields.h5").exists():
            self.add_field()
        elif study.is_study(self.folder):
            self.add_study()
        elif clip.is_clip(self.folder, load(self.folder).job):
            self.add_clip()
        elif not model_folders and not self.add_tables():
            raise ResultError("there is nothing to report", self.folder,
                              "wanted is a folder of track, batch, correlate, study, fit, "
                              "compare, simulate or info -o")
        for folder in model_folders:
            self.add_models(folder)
        job = load(self.folder).job_text
        if job:
            self.texts.append(("Job", job))
        self.texts.append(("Versions", f"impactdic {_version(load(self.folder))}\n"
                                       f"{versions()}"))

    def add_shot(self):
        from . import frames, mass, shot, tables

        result = load(self.folder)
        summary = result.summary
        self.first = frames.first_screen(result)
        self.figures += shot.figures(result, mass.of_shot(result, self.mass_kg))
        self.tables += tables.impact_tables(summary) + [tables.run_table(summary, result.job)]
        self.warnings += tables.warnings_of(summary)
        impact = summary.get("impact") or {}
        self.subtitle = f"{summary['frames_analysed']} frames; " \
                        f"{impact.get('explanation', 'the impact was not looked for')}."

    def add_field(self):
        from . import correlate, tables

        result = load(self.folder)
        field, self.kind = correlate.Field(result), "Displacement field"
        self.first = correlate.first_screen(field)
        self.figures += correlate.figures(field)
        self.tables.append(tables.field_table(result.summary, result.job))
        self.warnings += result.warnings

    def add_study(self):
        from . import study

        result = load(self.folder)
        self.first, self.kind = study.first_screen(result), "Speckle study"
        self.figures += study.figures(self.folder)
        self.tables += study.tables(result)

    def add_tables(self):
        """Whether there are any."""
        from . import curves

        found = curves.tables_in(self.folder)
        command = load(self.folder).job.get("command", "a table")
        self.kind = f"impactdic {command}"
        self.figures += [made for made in (curves.figure(*table) for table in found) if made]
        self.first.sentence = f"impactdic {command}: " + ", ".join(
            f"{len(next(iter(table.values())))} rows in {name}" for name, table in found)
        return bool(self.figures)

    def add_clip(self):
        from . import clip, tables

        result = load(self.folder)
        self.first, self.kind = clip.first_screen(result), "Clip"
        self.figures += clip.figures(result.summary)
        self.tables.append(tables.Table("Clip", ["", ""], clip.table_rows(result.summary), "Clip"))
        self.warnings += result.warnings

    def add_batch(self):
        from . import groups, shots, tables

        table = read_table(self.folder / "shots.csv")
        results = shots_of(self.folder)
        excluded = groups.left_out(self.folder)
        self.first = First(sentence_of_shots(table, excluded))
        self.figures += shots.figures(table, results, excluded)
        self.tables.append(tables.shots_table(table, excluded))
        failed = len(table["shot"]) - len(results)
        found = sum(result.impact is not None for result in results)
        self.subtitle = f"{len(results)} shots measured, {failed} failed, {found} with an impact."
        if failed:
            self.warnings.append(f"{failed} of {len(table['shot'])} shots failed; the table says "
                                 "why")
        for result in results:
            self.warnings += [f"{result.name}: {w}" for w in tables.warnings_of(result.summary)]

    def add_models(self, folder):
        from . import models, tables

        self.figures += models.figures(folder, self.program, self.warnings)
        result = load(folder)
        self.tables += tables.model_tables(result)
        self.warnings += tables.fit_warnings(result.summary)
        if not self.first.sentence:
            self.first.sentence = (sentence_of_simulated(result.summary)
                                   or sentence_of_fit(result.summary))
        if not self.subtitle:
            self.subtitle = f"Results of impactdic {models.kind_of(folder)}."

    def write_page(self):
        from . import page

        page.write(self.folder / "report.html", f"{self.kind}: {self.folder.resolve().name}",
                   self.first, self.subtitle, self.warnings, self.figures, self.tables, self.texts)

    def write(self, jobs):
        into = self.folder / "figures"
        into.mkdir(exist_ok=True)
        with ProcessPoolExecutor(max_workers=jobs) as pool:
            drawing = [pool.submit(_save, figure, into) for figure in self.figures]
            self.write_page()
            for done in drawing:
                done.result()


def _version(result):
    """Jobs of models, which people write, name none; what came of them does."""
    found = result.job.get("version")
    if not found and (result.folder / "summary.json").exists():
        found = result.summary.get("version")
    return found or "of an unknown version"


def _save(figure, into):
    from . import draw

    draw.save(figure, into)


def make(folder, program=None, threads=0, mass_kg=None, page_alone=False):
    """Writes report.html into `folder`, and the figures of the results as files unless `page_alone`;
    returns what stands on the page. `program`: the impactdic that integrates models; none: they are left out.
    `mass_kg`: the ball's; none: what a table of shots or a job of fit and compare says of it.
    Raises ResultError, MissingPackage."""
    folder = Path(folder)
    missing = missing_packages()
    if missing:
        raise MissingPackage(f"Python packages are missing ({', '.join(missing)})", "",
                             f"on Debian: apt-get install {' '.join(missing)}")
    if not folder.is_dir():
        raise ResultError("there is no such folder", folder)
    report = Report(folder, program, mass_kg)
    report.gather()
    if page_alone:
        report.write_page()
    else:
        report.write(threads or os.cpu_count() or 1)
    return report


def main():
    parser = argparse.ArgumentParser(prog="impactdic report")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--program", help="the impactdic that integrates models")
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--mass-g", type=float, help="the ball's mass")
    parser.add_argument("--quiet", action="store_true")
    options = parser.parse_args()
    try:
        report = make(options.folder, options.program, options.threads,
                      options.mass_g / 1e3 if options.mass_g else None)
    except MissingPackage as error:
        print(f"impactdic: error: {error}", file=sys.stderr)
        return 1
    except ResultError as error:
        print(f"impactdic: error: {error}", file=sys.stderr)
        return 1
    except KeyError as error:
        print(f"impactdic: error: the results have no {error} ({options.folder}): were they written "
              "by another version?", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"impactdic: error: {error.strerror} ({error.filename})", file=sys.stderr)
        return 1
    if not options.quiet:
        print(f"{len(report.figures)} figures in {options.folder / 'figures'}; "
              f"page {options.folder / 'report.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
