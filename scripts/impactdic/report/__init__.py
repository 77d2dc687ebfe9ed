"""impactdic report: figures and one page out of a folder of results."""
