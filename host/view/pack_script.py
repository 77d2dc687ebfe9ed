"""pack_script.py IN.js OUT.js.gz: the script without its white space, gzipped, the same bytes each time."""

import gzip
import re
import sys
from pathlib import Path

script = Path(sys.argv[1]).read_text(encoding="utf-8")
try:
    import rjsmin

    # A number that ends in its point at the end of a line would swallow the next word.
    script = rjsmin.jsmin(re.sub(r"(?<![\w$])(\d+)\.(?=[ \t]*\r?\n)", r"\1", script))
except ImportError:
    pass  # larger, but the same
Path(sys.argv[2]).write_bytes(gzip.compress(script.encode(), 9, mtime=0))
