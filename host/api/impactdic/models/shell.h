// A ball that is a shell.
#pragma once

#include <impactdic/export.h>

namespace IMPACTDIC_PUBLIC impactdic {

// Two masses and a spring between them: the part of the ball that lies on the surface, and the
// rest. The part in contact stops at once while the rest flattens the ball; the surface (a string
// bed, a plate) is the normal law, which lies in series with the shell. What swings on after the
// separation is lost to the rebound.
struct BallShell {
  double stiffness_n_per_m = 0;
  double damping_n_s_per_m = 0;  // beside the spring, at all times
  double flat_fraction = 0.1;    // of the mass: the part that lies on the surface

  // Of the ball's own mode, undamped, out of contact: omega^2 = k/(f (1 - f) m).
  double own_frequency_hz(double mass_kg) const;
};

}  // namespace impactdic
