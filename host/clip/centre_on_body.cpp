#include "host/clip/centre_on_body.h"

#include <cmath>

namespace impactdic {
namespace {

// Circles that have to tell the centre before any may contradict it.
constexpr int kFewestCircles = 5;
// What a step that was not measured may do to where the centre is on the body.
constexpr double kUnseenStep_px = 0.05;

struct Place {
  double x_px, y_px;
};

// Turned with the body, or back. From x towards y, which points down, is a turn the other way.
Place turned(const Place& at, double angle_rad) {
  if (!std::isfinite(angle_rad)) return at;  // a sphere's
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * at.x_px + s * at.y_px, -s * at.x_px + c * at.y_px};
}

double mean_square(double x, double y) { return (x * x + y * y) / 2; }

double doubt_px(const TrackRow& row) {
  const double px = std::sqrt(mean_square(row.dx_sd_px, row.dy_sd_px));
  return std::isfinite(px) ? px : kUnseenStep_px;
}

double known_px2(const CentreOnBody& centre) {
  return centre.variance_px2 + centre.untold_px * centre.untold_px;
}

CentreOnBody::Beside beside(const TrackRow& row, const Place& off, double variance_px2) {
  constexpr double kChance = 4, kOfRadius = 0.01, kOfEllipse = 0.5;
  const double off_px = std::hypot(off.x_px, off.y_px);
  const double by_chance_px = kChance * std::sqrt(variance_px2);
  if (!(off_px > by_chance_px)) return {};
  const double ellipse_px = std::isfinite(row.e1_px) ? std::hypot(row.e1_px, row.e2_px) : 0;
  const double by_outline_px = kOfRadius * row.r_px + kOfEllipse * ellipse_px;
  return {off.x_px, off.y_px, off_px > by_chance_px + by_outline_px};
}

void tell(CentreOnBody& centre, const Place& at, double variance_px2) {
  const double before_px2 = known_px2(centre);
  const double share = centre.circles == 0 ? 1 : before_px2 / (before_px2 + variance_px2);
  centre.x_px += share * (at.x_px - centre.x_px);
  centre.y_px += share * (at.y_px - centre.y_px);
  centre.variance_px2 = share * variance_px2;
  centre.untold_px = 0;
  ++centre.circles;
}

}  // namespace

CentreOnBody::Beside CentreOnBody::compare(const TrackRow& row) {
  Beside found;
  if (row.circle_ok && row.pose.ok && (circles == 0 || row.pose.origin == origin)) {
    const double px2 = mean_square(row.cx_sd_px, row.cy_sd_px);
    const Place at = {row.cx_px - row.pose.x_px, row.cy_px - row.pose.y_px};
    if (circles >= kFewestCircles && row.by_hand == ByHand::kNo) {
      const Place told = turned({x_px, y_px}, row.pose.angle_rad);
      found = beside(row, {at.x_px - told.x_px, at.y_px - told.y_px}, known_px2(*this) + px2);
    }
    const bool tells = row.status == TrackStatus::kOk && !std::isfinite(row.e1_px) && px2 > 0;
    if (tells && !found.elsewhere) {
      origin = row.pose.origin;
      tell(*this, turned(at, -row.pose.angle_rad), px2);
    }
  }
  untold_px += doubt_px(row);
  return found;
}

}  // namespace impactdic
