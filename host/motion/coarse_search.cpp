#include "host/motion/coarse_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/motion/field_motion.h"

namespace impactdic::motion {
namespace {

// Side of the windows: at 31 px, half a step of the angle moves a corner by less than half of a
// speckle that can be resolved at all.
constexpr int kWindowPx = 31;
constexpr int kReachPx = 32;
constexpr int kAngles = 60;
constexpr int kAcross = 3;          // windows a side
constexpr double kFarthestPx = 60;  // from the region's centre
// Enough windows to be no coincidence: what chance correlates does not also move as one body.
constexpr int kFewestWindows = 5;
constexpr double kMinCorrelation = 0.35;
constexpr double kLargestResidualPx = 3;
constexpr std::size_t kMostMotions = 3;
constexpr double kApartPx = 8;

std::vector<Window> windows_about(const Roi& region, int window_px) {
  const double reach_x = std::min(kFarthestPx, (region.width - window_px) / 2.0);
  const double reach_y = std::min(kFarthestPx, (region.height - window_px) / 2.0);
  std::vector<Window> windows;
  for (int j = 0; j < kAcross; ++j) {
    for (int i = 0; i < kAcross; ++i) {
      const double x = region.x + (region.width - window_px) / 2.0 + reach_x * (i - 1);
      const double y = region.y + (region.height - window_px) / 2.0 + reach_y * (j - 1);
      Window window{};
      window.x0 = static_cast<idic_int>(std::lround(x));
      window.y0 = static_cast<idic_int>(std::lround(y));
      windows.push_back(window);
    }
  }
  return windows;
}

}  // namespace

bool are_apart(const dic::RigidMotion& a, const dic::RigidMotion& b, double reach_px) {
  const double turn = std::remainder(a.rot_rad - b.rot_rad, 2 * std::numbers::pi);
  return std::hypot(a.dx_px - b.dx_px, a.dy_px - b.dy_px) +
             2 * reach_px * std::sin(std::abs(turn) / 2) >
         kApartPx;
}

CoarseSearch::CoarseSearch(opencl::Engine& engine, const FieldOptions& options)
    : engine_(engine), options_(options) {
  options_.method = FieldMethod::kZncc;
  options_.search_px = std::max(options.search_px, kReachPx);
  options_.min_correlation = kMinCorrelation;
}

std::vector<dic::RigidMotion> CoarseSearch::find(const Frame& first, const Frame& second,
                                                 const Roi& region) {
  const int window_px = std::min({kWindowPx, region.width, region.height});
  if (window_px != window_px_) {
    options_.window_px = window_px_ = window_px;
    correlator_ = dic::make_opencl_correlator(engine_, options_, 2);
  }
  correlator_->set_frame(0, first);
  correlator_->set_frame(1, second);
  const double cx = region.x + (region.width - 1) / 2.0, cy = region.y + (region.height - 1) / 2.0;
  const std::vector<Window> grid = windows_about(region, window_px);
  std::vector<Window> turned;
  for (int k = 0; k < kAngles; ++k) {
    std::vector<Window> windows = grid;
    const double turn = 2 * std::numbers::pi * (k <= kAngles / 2 ? k : k - kAngles) / kAngles;
    aim_windows(windows, window_px, 0, 1, {cx, cy, 0, 0, turn});
    turned.insert(turned.end(), windows.begin(), windows.end());
  }
  const std::vector<WindowMotion> found = correlator_->correlate(turned);

  struct Scored {
    dic::RigidMotion motion;
    double score;
  };
  std::vector<Scored> scored;
  for (int k = 0; k < kAngles; ++k) {
    const auto from = static_cast<std::size_t>(k) * grid.size();
    const auto points = field_points(std::span(turned).subspan(from, grid.size()),
                                     std::span(found).subspan(from, grid.size()), window_px);
    const dic::RigidMotion motion = dic::fit_rigid_motion(points, cx, cy);
    if (!motion.ok || motion.used < kFewestWindows || motion.residual_px > kLargestResidualPx) {
      continue;
    }
    double score = 0;
    for (std::size_t i = from; i < from + grid.size(); ++i) {
      if (found[i].status == static_cast<idic_int>(WindowStatus::kOk))
        score += found[i].correlation;
    }
    scored.push_back({motion, score});
  }
  std::stable_sort(scored.begin(), scored.end(),
                   [](const Scored& a, const Scored& b) { return a.score > b.score; });
  const double reach = std::min(kFarthestPx, std::min(region.width, region.height) / 2.0);
  std::vector<dic::RigidMotion> best;
  for (const Scored& one : scored) {
    const bool is_new = std::all_of(best.begin(), best.end(), [&](const dic::RigidMotion& other) {
      return are_apart(one.motion, other, reach);
    });
    if (is_new && best.size() < kMostMotions) best.push_back(one.motion);
  }
  return best;
}

}  // namespace impactdic::motion
