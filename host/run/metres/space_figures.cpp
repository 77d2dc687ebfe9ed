#include "host/run/metres/space_figures.h"

#include <cmath>

namespace impactdic::run {

std::optional<SpaceImpact> to_si(const std::optional<SpaceImpact>& space, const SiScale& scale) {
  if (!space || !(scale.metre_per_px > 0 && scale.fps > 0)) return space;
  SpaceImpact si = *space;
  // Scale and rate are known so well.
  const double metre = scale.metre_per_px_sd / scale.metre_per_px, rate = scale.fps_sd / scale.fps;
  const auto spin = [&](Measured& m) {
    m = {m.value * scale.fps, std::hypot(m.sd, m.value * rate) * scale.fps};
  };
  for (MeasuredVector* vector : {&si.spin_before, &si.spin_after}) {
    spin(vector->t), spin(vector->n), spin(vector->b);
  }
  spin(si.spin_change_n);
  const double speed = scale.metre_per_px * scale.fps;
  for (Measured* slip : {&si.slip_t, &si.slip_b}) {
    *slip = {slip->value * speed,
             std::hypot(slip->sd, slip->value * metre, slip->value * rate) * speed};
  }
  return si;
}

}  // namespace impactdic::run
