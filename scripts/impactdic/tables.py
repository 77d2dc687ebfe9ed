"""Tables with units."""

from . import engine

# The end of a column's name and its unit, the longest first.
_UNITS = (("_rad_s", "rad/s"), ("_m_s", "m/s"), ("_kg_m2", "kg m^2"), ("_n_s", "N s"),
          ("_rad", "rad"), ("_deg", "deg"), ("_px", "px"), ("_pa", "Pa"), ("_m", "m"), ("_s", "s"),
          ("_n", "N"))


# Columns that count; they are whole numbers where none is missing.
_COUNTS = ("frame", "windows", "origin", "keyframe", "frames", "frames_ok", "by_hand")


def unit_of(name):
    """The unit that a column's name states; "" where it has none."""
    return next((unit for end, unit in _UNITS if name.endswith(end)), "")


def frame(columns, **attributes):
    """A pandas.DataFrame; attrs["units"] has the unit of each column that has one."""
    pandas = engine.package("pandas", "a table")
    table = pandas.DataFrame(dict(columns))
    for name in _COUNTS:
        if name in table and table[name].notna().all():
            table[name] = table[name].astype("int64")
    table.attrs.update(attributes)
    table.attrs["units"] = {name: unit_of(name) for name in table.columns if unit_of(name)}
    return table
