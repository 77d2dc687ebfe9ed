#include "host/clip/centre_on_body.h"

#include <cmath>

namespace impactdic {
namespace {

// No circle is known better than this.
constexpr double kExact_px = 1e-6;
// Circles that have to tell the centre before any may contradict it.
constexpr int kFewestCircles = 5;
// What a step that was not measured may do to where the centre is on the body.
constexpr double kUnseenStep_px = 0.05;

struct Place {
  double x_px, y_px;
};

Place on_body(const TrackRow& row) {
  const double x = row.cx_px - row.pose.x_px, y = row.cy_px - row.pose.y_px;
  if (!std::isfinite(row.pose.angle_rad)) return {x, y};  // a sphere's
  // From x towards y, which points down, is a turn the other way.
  const double c = std::cos(row.pose.angle_rad), s = std::sin(row.pose.angle_rad);
  return {c * x - s * y, s * x + c * y};
}

double mean_square(double x, double y) { return (x * x + y * y) / 2; }

double doubt_px2(const TrackRow& row) {
  const double px2 = mean_square(row.dx_sd_px, row.dy_sd_px);
  return std::isfinite(px2) ? px2 : kUnseenStep_px * kUnseenStep_px;
}

bool contradicts(const TrackRow& row, const Place& at, double variance_px2,
                 const CentreOnBody& centre) {
  constexpr double kChance = 4, kOfRadius = 0.01, kOfEllipse = 0.5;
  const double ellipse_px = std::isfinite(row.e1_px) ? std::hypot(row.e1_px, row.e2_px) : 0;
  const double by_chance_px = kChance * std::sqrt(centre.variance_px2 + variance_px2);
  return std::hypot(at.x_px - centre.x_px, at.y_px - centre.y_px) >
         by_chance_px + kOfRadius * row.r_px + kOfEllipse * ellipse_px;
}

void tell(CentreOnBody& centre, const Place& at, double variance_px2) {
  const double known = centre.variance_px2 + kExact_px * kExact_px;
  const double share = centre.circles == 0 ? 1 : known / (known + variance_px2);
  centre.x_px += share * (at.x_px - centre.x_px);
  centre.y_px += share * (at.y_px - centre.y_px);
  centre.variance_px2 = share * variance_px2;
  ++centre.circles;
}

}  // namespace

bool CentreOnBody::is_elsewhere(const TrackRow& row) {
  bool elsewhere = false;
  if (row.circle_ok && row.pose.ok && (circles == 0 || row.pose.origin == origin)) {
    const Place at = on_body(row);
    const double px2 = mean_square(row.cx_sd_px, row.cy_sd_px);
    const bool tells = row.status == TrackStatus::kOk && !std::isfinite(row.e1_px) && px2 > 0;
    elsewhere = circles >= kFewestCircles && contradicts(row, at, px2, *this);
    if (tells && !elsewhere) {
      origin = row.pose.origin;
      tell(*this, at, px2);
    }
  }
  variance_px2 += doubt_px2(row);
  return elsewhere;
}

}  // namespace impactdic
