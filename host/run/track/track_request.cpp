#include <impactdic/error.h>
#include <impactdic/track.h>

#include <cmath>
#include <string>

#include "host/base/parse.h"
#include "host/clip/ball_by_hand.h"
#include "host/run/open_clip.h"

namespace impactdic {
namespace {

void check(bool good, const std::string& must, double value, const char* setting) {
  if (!good || !std::isfinite(value)) {
    throw InvalidArgument("must be " + must + ", not " + shortest(value), setting);
  }
}

}  // namespace

void TrackRequest::validate() const {
  clip.validate();
  field.validate();
  if (static_cast<unsigned>(estimator) > static_cast<unsigned>(Estimator::kBall)) {
    throw InvalidArgument("this is no estimator", "--estimator", "there are field, ring and ball");
  }
  if (static_cast<unsigned>(body) > static_cast<unsigned>(Body::kDisc)) {
    throw InvalidArgument("this is no body", "--body", "there are auto, sphere and disc");
  }
  if (body == Body::kSphere && estimator != Estimator::kBall) {
    throw InvalidArgument("measures turns in the picture alone", "--estimator",
                          "a sphere needs ball");
  }
  run::check_spacing(spacing_px);
  if (radius_px && !(radius_px->low_px > 0 && radius_px->high_px > radius_px->low_px &&
                     std::isfinite(radius_px->high_px))) {
    throw InvalidArgument("'" + shortest(radius_px->low_px) + ":" + shortest(radius_px->high_px) +
                              "' is not LO:HI with 0 < LO < HI",
                          "--radius-px");
  }
  check_balls_by_hand(ball_at);
  run::check_frames(frames);
  if (roi) run::check_rectangle(*roi);
  run::check_polygon(polygon);
  check(ball >= 0, "1 or more", ball, "--ball");
  check(ball_diameter_mm >= 0, "positive", ball_diameter_mm, "--ball-diameter-mm");
  check(ball_diameter_sd_mm >= 0 &&
            (ball_diameter_sd_mm == 0 || ball_diameter_sd_mm < ball_diameter_mm),
        "positive and less than --ball-diameter-mm", ball_diameter_sd_mm, "--ball-diameter-sd-mm");
  check(mm_per_px >= 0, "positive", mm_per_px, "--mm-per-px");
  check(mm_per_px_sd >= 0 && (mm_per_px_sd == 0 || mm_per_px_sd < mm_per_px),
        "positive and less than --mm-per-px", mm_per_px_sd, "--mm-per-px-sd");
  check(true, "a finite number", surface_angle_deg, "--surface-angle-deg");
  check(surface_angle_sd_deg >= 0 && surface_angle_sd_deg < 90, "between 0 and 90",
        surface_angle_sd_deg, "--surface-angle-sd-deg");
  check(drop_height_mm >= 0, "positive", drop_height_mm, "--drop-height-mm");
  check(distance_mm >= 0, "positive", distance_mm, "--distance-mm");
  check(distance_sd_mm >= 0 && (distance_sd_mm == 0 || distance_sd_mm < distance_mm),
        "positive and less than --distance-mm", distance_sd_mm, "--distance-sd-mm");
  check(true, "a finite number", gravity_angle_deg, "--gravity-angle-deg");
  check(inertia_factor == 0 || (inertia_factor >= 0.01 && inertia_factor <= 1),
        "between 0.01 and 1", inertia_factor, "--inertia-factor");
  if (ball_diameter_mm > 0 && mm_per_px > 0) {
    throw InvalidArgument("give one of --ball-diameter-mm and --mm-per-px", "scale");
  }
  if (!camera.empty() && mm_per_px > 0) {
    throw InvalidArgument("give one of --camera and --mm-per-px", "scale",
                          "a camera knows its scale");
  }
}

}  // namespace impactdic
