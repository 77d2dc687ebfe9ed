"""Tables and warnings of a report, as rows of text."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..results import read_table
from . import budget, groups, simulated, sweep
from .models import kind_of, name_of
from .text import rounded, with_sd


@dataclass
class Table:
    title: str
    header: list[str]
    rows: list[list[str]]
    section: str = "Figures of the impact"


def impact_tables(summary):
    impact = summary.get("impact")
    if not impact or not impact.get("found"):
        return []
    si = impact["units"] == "si"
    instants = []
    for name, key in (("contact starts, t0", "t0"), ("most compressed", "t_max_compression"),
                      ("contact ends", "t_end")):
        at = impact.get(key)
        if at is None:
            instants.append([name, "not measured", "not measured"])
            continue
        time = at.get("time_s")
        instants.append([
            name,
            rounded(at["frame"], at["sd_frames"]),
            "no frame rate" if time is None else rounded(1e3 * time, 1e3 * at["sd_s"]) + " ms",
        ])
    speed, spin = ("_m_s", "omega_rad_s") if si else ("_px_per_frame", "omega_rad_per_frame")
    unit = "m/s" if si else "px/frame"
    motion = []
    for name, key, u in (("vx", "vx" + speed, unit), ("vy", "vy" + speed, unit),
                         ("vt", "vt" + speed, unit), ("vn", "vn" + speed, unit),
                         ("angular velocity", spin, "rad/s" if si else "rad/frame")):
        motion.append([f"{name}, {u}"] + [
            with_sd((impact.get(side) or {}).get(key)) for side in ("before", "after")
        ])
    friction, closure = impact["friction"], impact["impulse_closure"]
    figures = [
        ["coefficient of restitution", with_sd(impact["restitution"])],
        ["effective friction, Eq. 3.12", with_sd(friction["eq_3_12"])],
        ["effective friction, gravity-corrected", with_sd(friction["gravity_corrected"])],
        ["rolling cap of the friction", with_sd(friction["rolling_cap"])],
        ["contact time", with_sd(impact["contact_s"], 1e3, "ms")],
        ["largest deflection", with_sd(impact["max_deflection_m"], 1e3, "mm") if si
         else with_sd(impact["max_deflection_px"], 1, "px")],
        ["impulse closure", f"{closure['verdict']}: {closure['explanation']}"],
        ["gravity seen in the flights", with_sd(impact["gravity"]["measured_m_s2"], 1, "m/s²")],
        ["surface seen by path and spin", with_sd(impact.get("surface_angle_found_deg"), 1, "°")],
    ] + space_rows(impact.get("space"), si)
    return [
        Table("Impact", ["figure", "value ± standard deviation"], figures),
        Table("Instants", ["instant", "frame", "time"], instants),
        Table("Motion before and after the contact", ["component", "before", "after"], motion),
    ] + ([Table("What the deviations are made of, shares of the variance",
                ["figure", "± (one deviation)", *budget.SOURCES], budget.rows(impact))]
         if budget.rows(impact) else [])


def space_rows(space, si):
    """What a sphere's impact does out of the picture's plane."""
    if not space:
        return []
    speed, rate = ("m/s", "rad/s") if si else ("px/frame", "rad/frame")
    speed_key, rate_key = ("_m_s", "_rad_s") if si else ("_px_per_frame", "_rad_per_frame")
    rows = []
    for when in ("before", "after"):
        spin = space[f"spin_{when}"]
        for axis in "tnb":
            rows.append([f"spin {when} about {axis}",
                         with_sd(spin[f"omega_{axis}{rate_key}"], 1, rate)])
    return rows + [
        ["slip of the contact point along t", with_sd(space["slip_t" + speed_key], 1, speed)],
        ["slip along b, as the spin makes it", with_sd(space["slip_b" + speed_key], 1, speed)],
        ["friction as a vector, size", with_sd(space["friction"])],
        ["friction's angle off the slip", with_sd(space["friction_off_slip_deg"], 1, "°")],
    ]


def run_table(summary, job):
    ball = summary.get("ball") or {}
    radius, metres = ball.get("radius_px"), ball.get("radius_m")
    scale = summary.get("scale") or {}
    rows = source_rows(summary) + [
        ["analysed frames/s", _or(summary.get("analysed_fps"), "{:g}", "unknown")],
        ["frame times", frame_times(summary.get("frame_times") or {})],
        ["scale", with_sd({"value": scale["m_per_px"], "sd": scale["sd_m_per_px"]}, 1e3, "mm/px")
                  if scale else "unknown: results in px"],
        ["radius of the free ball", _or(radius, "{:.3f} px", "not measured")
                   + (f" = {1e3 * metres:.3f} mm" if metres else "")],
        ["frames", ", ".join(f"{count} {status}" for status, count in
                             (summary.get("frames_by_status") or {}).items())],
    ] + device_rows(summary, job)
    return Table("Run", ["", ""], rows, "Run")


def source_rows(summary):
    """The clip that was measured."""
    source = summary.get("input") or {}
    return [
        ["clip", str(source.get("path", "unknown"))],
        ["SHA-256", str(source.get("sha256") or "not worked out")],
        ["format", f"{source.get('format')}, {source.get('width_px')} × {source.get('height_px')} "
                   f"px, {source.get('bits')} bits, {source.get('frames')} frames"],
        ["camera", str(source.get("camera") or "not stated")],
    ]


def device_rows(summary, job):
    """What measured it."""
    device = summary.get("device") or {}
    return [
        ["speed of the measurement", _or(summary.get("frames_per_s"), "{:.1f} frames/s", "")],
        ["device", f"{device['name']} ({device['platform']}, {device['driver']})" if device
                   else "none"],
        ["impactdic", str(job.get("version", "unknown"))],
    ]


def field_table(summary, job):
    """Of a run of correlate."""
    rows = source_rows(summary) + [["windows", str(summary.get("windows", "unknown"))]]
    return Table("Run", ["", ""], rows + device_rows(summary, job), "Run")


def frame_times(times):
    """What the camera's own clock says."""
    missing = times.get("missing_frames", 0)
    lost = f", {missing} frames missing" if missing else ""
    jitter = times.get("jitter_s")
    if jitter is None:
        return "by the rate" + lost
    return f"by the file's clock, scatter {1e6 * jitter:.3g} µs" + lost


def _or(value, text, otherwise):
    return otherwise if value is None else text.format(value)


def shots_table(table, excluded):
    """The rows of shots.csv in short. `excluded`: why a person has left shots out, by their names."""
    header = ["shot", "status", "ball", "surface", "v before, m/s", "restitution", "friction",
              "contact, ms", "ω after, rad/s", "notes"]
    rows = []
    for i in range(len(table["shot"])):
        def pair(name, deviation, factor=1.0):
            value, sd = (number(table[key][i]) for key in (name, deviation))
            return "" if math.isnan(value) else rounded(factor * value, factor * sd)

        vt, vn = number(table["vt_before_m_s"][i]), number(table["vn_before_m_s"][i])
        angle = number(table["surface_angle_deg"][i])
        status = str(table["status"][i])
        if status == "ok":
            impact = str(table["impact"][i])
            status = "ok" if impact == "found" else f"impact: {impact}"
            if "doubtful" in table and str(table["doubtful"][i]) not in ("", "nan"):
                status = f"doubtful: {table['contradictions'][i]}"
        if str(table["shot"][i]) in excluded:
            status = f"left out: {excluded[str(table['shot'][i])]}"
        rows.append([
            str(table["shot"][i]),
            status if status != "failed" else f"failed: {table['reason'][i]}",
            groups.ball_of(table, i),
            "" if math.isnan(angle) else f"{angle:g}°",
            "" if math.isnan(vn) else f"{math.hypot(vt, vn):.3f}",
            pair("restitution", "restitution_sd"),
            pair("friction", "friction_sd"),
            pair("contact_s", "contact_sd_s", 1e3),
            pair("omega_after_rad_s", "omega_after_sd_rad_s"),
            "" if str(table["notes"][i]) == "nan" else str(table["notes"][i]),
        ])
    return Table("Shots", header, rows, "Shots")


def number(cell):
    try:
        return float(cell)
    except ValueError:
        return math.nan


def model_tables(result):
    """Of a folder of fit, compare or simulate."""
    summary = result.summary
    if kind_of(result.folder) == "simulate":
        return simulated.tables(result, Table)
    if kind_of(result.folder) == "sweep":
        return sweep.tables(result, Table)
    tables = []
    parameters = summary.get("parameters") or (summary.get("calibration") or {}).get("parameters")
    if parameters:
        rows = []
        between = any("between" in p for p in parameters.values())  # of several shots
        for key, p in parameters.items():
            low, high = p["ci95"]
            row = [
                key,
                with_sd(p),
                " to ".join("open" if end is None else f"{end:.6g}" for end in (low, high)),
                "yes" if p["determined"] else "no: " + p.get("verdict", ""),
            ]
            if between:
                row.append(with_sd({"value": p["between"]["sd"]}) if "between" in p else "")
            rows.append(row)
        tables.append(Table(f"Calibrated parameters ({result.name})",
                            ["parameter", "value ± standard deviation", "95 %", "determined"]
                            + ["deviation between the shots"] * between,
                            rows, "Models"))
    if kind_of(result.folder) == "compare":
        table = read_table(result.folder / "comparison.csv")
        tables.append(_rods(result, table) if "blow" in table else _balls(result, table))
    return tables


def _balls(result, table):
    columns = {"vt": "vt_m_s", "vn": "vn_m_s", "omega": "omega_rad_s"}
    rows = []
    for i, model in enumerate(table["model"]):
        row = [name_of(str(table["track"][i])), f"{table['surface_angle_deg'][i]:g}°", str(model)]
        for name, column in columns.items():
            error = table[name + "_error"][i]
            row.append(f"{table[column][i]:.4f}"
                       + ("" if math.isnan(error) else f" ({100 * error:+.1f} %)"))
        rms, aic = 1e3 * table["rms_m"][i], table["final_aic"][i]
        rows.append(row + ["" if math.isnan(rms) else f"{rms:.4f}",
                           "" if math.isnan(aic) else f"{aic:.1f}"])
    header = ["shot", "surface", "model", "vt after, m/s", "vn after, m/s", "ω after, rad/s",
              "rms of the path, mm", "AIC of the velocities"]
    return Table(f"Models after the impact ({result.name}), relative error in brackets", header,
                 rows, "Models")


def _rods(result, table):
    columns = ["rod_angle_deg", "restitution_measured", "restitution", "omega_measured_rad_s",
               "omega_rad_s"]
    rows = []
    for i, model in enumerate(table["model"]):
        numbers = [number(table[column][i]) for column in columns]
        rows.append([str(table["blow"][i]), str(model)]
                    + ["" if math.isnan(n) else f"{n:.4g}" for n in numbers])
    header = ["blow", "model", "angle of the rod, °", "restitution measured", "restitution",
              "ω measured, rad/s", "ω, rad/s"]
    return Table(f"Models of the rod ({result.name})", header, rows, "Models")


def fit_warnings(summary):
    """Of a fit, or of the calibration of a comparison; of a simulation its own."""
    if "phases" in summary or "axes" in summary:
        return [str(warning) for warning in summary.get("warnings", [])]
    of = summary.get("calibration") or summary
    fits = of.get("shots", [])
    common = [warning for p in (of.get("parameters") or {}).values()
              for warning in p.get("warnings", [])]
    return common + [f"{name_of(fit['shot']['track'])}: {warning}"
            for fit in fits for warning in fit.get("warnings", [])]


def warnings_of(summary):
    """What a reader must know before trusting the figures."""
    found = [str(w) for w in summary.get("warnings") or []]
    statuses = summary.get("frames_by_status") or {}
    total = sum(statuses.values())
    good = statuses.get("ok", 0) + statuses.get("last_frame", 0)
    if good < total:
        found.append(f"{total - good} of {total} frames could not be measured in full")
    if summary.get("scale_m_per_px") is None:
        found.append("no scale: lengths are in px (--ball-diameter-mm or --mm-per-px)")
    if summary.get("analysed_fps") is None:
        found.append("no frame rate: times are in frames (--fps)")
    impact = summary.get("impact")
    if not impact:
        return found
    if not impact.get("found"):
        return found + [impact["explanation"]]
    for name, key in (("start", "t0"), ("end", "t_end")):
        edge = impact.get(key)
        if edge is None:
            found.append(f"the {name} of the contact could not be measured")
        elif not edge.get("onset_law_holds", True):
            found.append(f"no contact law describes the {name} of the contact; "
                         "its deviation is widened")
    if impact.get("contradictions"):  # they stand among the warnings, with the likely slip
        return found
    closure = impact["impulse_closure"]
    if closure["verdict"] in ("signs", "lever_arm", "scale"):
        found.append(f"impulse closure: {closure['explanation']}")
    if impact["gravity"].get("agrees_with_9_81") is False:
        found.append("the flights do not fall with 9.81 m/s²: are scale and frame rate right?")
    return found
