"""Results of impactdic in Python (numpy, h5py):

    import impactdic
    shot = impactdic.load("shot_01")
    shot.track["time_s"], shot.track["vn_m_s"], shot.summary["impact"], shot.field(frame=120)

Put the folder `scripts` on PYTHONPATH. Axes, units and column names: docs/file-formats.md.
"""

from .results import ResultError, Result, load, read_table, shots_of

__all__ = ["Result", "ResultError", "load", "read_table", "shots_of"]
