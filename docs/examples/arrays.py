"""Displacement field and rigid motion of a speckled surface in pictures of one's own.

    python3 docs/examples/arrays.py
"""

import numpy as np

import impactdic as idic


def main() -> None:
    # Two pictures (height, width); here made ones, whose motion is known.
    film, truth = idic.synth(frames=2, radius_px=120, size=(200, 200), velocity_px=(1.3, -0.7),
                             noise=2)
    field = idic.correlate(film[0], film[1], window=21, roi=(40, 40, 120, 120))
    found = field["status"] == 0
    error = field["u_px"].where(found) - truth["dx_px"][0]
    print(f"{int(found.sum())} of {found.size} windows, rms error of u "
          f"{float(np.sqrt((error**2).mean())):.4f} px, stated "
          f"{float(field['u_sd_px'].where(found).median()):.4f} px")
    print(f"motion: {float(field['dx_px']):.4f} ± {float(field['dx_sd_px']):.4f} px")


if __name__ == "__main__":
    main()
