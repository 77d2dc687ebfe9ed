"""OpenCL drivers that are Python packages, for machines that have none of their own."""

import os
import sys
from pathlib import Path

_VENDORS = Path("/etc/OpenCL/vendors")


def offer():
    """Has the OpenCL loader take Intel's driver for processors (the packages of impactdic[cpu])
    where the system has no driver and the caller names none."""
    if any(name in os.environ for name in ("OCL_ICD_VENDORS", "OCL_ICD_FILENAMES")):
        return
    if _VENDORS.is_dir() and any(_VENDORS.glob("*.icd")):
        return
    driver = Path(sys.prefix) / "lib" / "libintelocl.so"
    if driver.exists():
        os.environ["OCL_ICD_VENDORS"] = str(driver)
