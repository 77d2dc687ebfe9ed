#include "host/pipeline/rows/place_by_path.h"

#include <algorithm>
#include <cmath>

#include "host/pipeline/rows/path.h"

namespace impactdic::pipeline {
namespace {

// Times as exact; deviations.
constexpr double kPlainly = 2, kChance = 5, kSlope = 2.5;

struct Place {
  double x_px = 0, y_px = 0, x_sd_px = 0, y_sd_px = 0;
};

// From a frame to the next: points `about` the circle's centre are carried by a gradient.
class Step {
 public:
  Step(const TrackRow& row, const motion::PairMotion& pair)
      : about_x_px_(row.cx_px),
        about_y_px_(row.cy_px),
        moved_x_px_(pair.motion.dx_px),
        moved_y_px_(pair.motion.dy_px) {
    if (turns_in_space(row)) {
      // Its depth hangs on where the centre is thought to be, which the row's deviations hold.
      x_sd_px_ = row.dx_sd_px + kAboutCentre * std::abs(row.dx_px);
      y_sd_px_ = row.dy_sd_px + kAboutCentre * std::abs(row.dy_px);
      return;
    }
    gradient_ = motion::gradient_of(pair.stretch, pair.motion.rot_rad);
    x_sd_px_ = pair.motion.dx_sd_px;
    y_sd_px_ = pair.motion.dy_sd_px;
  }
  Place on(const Place& from) const {
    const double x = from.x_px - about_x_px_, y = from.y_px - about_y_px_;
    return doubted({about_x_px_ + moved_x_px_ + gradient_.xx * x + gradient_.xy * y,
                    about_y_px_ + moved_y_px_ + gradient_.yx * x + gradient_.yy * y, from.x_sd_px,
                    from.y_sd_px},
                   gradient_);
  }
  Place back(const Place& to) const {
    const double x = to.x_px - about_x_px_ - moved_x_px_, y = to.y_px - about_y_px_ - moved_y_px_;
    const motion::Gradient back = motion::inverse(gradient_);
    return doubted({about_x_px_ + back.xx * x + back.xy * y,
                    about_y_px_ + back.yx * x + back.yy * y, to.x_sd_px, to.y_sd_px},
                   back);
  }
  // What the motion of a point so far beside the circle's centre is more than the centre's.
  void move_centre(double x_px, double y_px, dic::RigidMotion& motion) const {
    motion.dx_px += (gradient_.xx - 1) * x_px + gradient_.xy * y_px;
    motion.dy_px += gradient_.yx * x_px + (gradient_.yy - 1) * y_px;
  }

 private:
  // As if all steps erred alike: a tilt that nobody sees goes on.
  Place doubted(Place place, const motion::Gradient& by) const {
    const double x_sd_px = std::hypot(by.xx * place.x_sd_px, by.xy * place.y_sd_px);
    const double y_sd_px = std::hypot(by.yx * place.x_sd_px, by.yy * place.y_sd_px);
    place.x_sd_px = x_sd_px + x_sd_px_;
    place.y_sd_px = y_sd_px + y_sd_px_;
    return place;
  }

  double about_x_px_, about_y_px_, moved_x_px_, moved_y_px_;
  motion::Gradient gradient_;
  double x_sd_px_, y_sd_px_;
};

// What several places say of one, along one axis, less where its own circle has it.
class Sum {
 public:
  // From `steps` frames away.
  void add(double off_px, double sd_px, double steps) {
    const double known_px = std::max(sd_px, kExact_px), by = 1 / (known_px * known_px);
    weight_ += by;
    off_ += by * off_px;
    squares_ += by * off_px * off_px;
    sd_ += by * known_px;
    steps_ += by * steps;
    steps2_ += by * steps * steps;
    off_by_step_ += by * steps * off_px;
    ++count_;
  }
  // Whether it took the place of what was known; not where that contradicts it.
  bool place(double& px, double& sd_px) const {
    if (count_ < kFewestOthers || leads_elsewhere()) return false;
    const double mean_px = off_ / weight_;
    const double scatter = (squares_ - off_ * mean_px) / static_cast<double>(count_ - 1);
    const double mean_sd_px = std::sqrt(std::max(1.0, scatter)) * sd_ / weight_;
    if (!(kPlainly * mean_sd_px < sd_px && std::abs(mean_px) < kChance * sd_px)) return false;
    px += mean_px;
    sd_px = mean_sd_px;
    return true;
  }

 private:
  // Places from farther away lie farther off: motions go elsewhere than circles, as through a lens.
  bool leads_elsewhere() const {
    const double spread = steps2_ - steps_ * steps_ / weight_;
    const double slope = off_by_step_ - steps_ * off_ / weight_;
    return slope * slope > kSlope * kSlope * spread;
  }

  double weight_ = 0, off_ = 0, squares_ = 0, sd_ = 0;
  double steps_ = 0, steps2_ = 0, off_by_step_ = 0;
  std::size_t count_ = 0;
};

struct Sums {
  Sum x, y;
  void add(const Place& place, const TrackRow& row, double steps) {
    x.add(place.x_px - row.cx_px, place.x_sd_px, steps);
    y.add(place.y_px - row.cy_px, place.y_sd_px, steps);
  }
};

// Whether some circle is so much less exact than another; mostly all are alike.
bool differ(std::span<const TrackRow> rows) {
  double least = rows[0].cx_sd_px, most = least;
  for (const TrackRow& row : rows) {
    least = std::min({least, row.cx_sd_px, row.cy_sd_px});
    most = std::max({most, row.cx_sd_px, row.cy_sd_px});
  }
  return most > kPlainly * least;
}

// Rows that motions lead through from the first to the last.
std::vector<bool> place_run(std::span<TrackRow> rows, std::span<motion::PairMotion> pairs,
                            std::vector<bool>::const_iterator elsewhere) {
  std::vector<Step> steps;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) steps.emplace_back(rows[i], pairs[i]);
  std::vector<Sums> others(rows.size());
  const auto away = [](std::size_t from, std::size_t to) {
    return static_cast<double>(to) - static_cast<double>(from);
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (elsewhere[static_cast<std::ptrdiff_t>(i)]) continue;
    const Place own{rows[i].cx_px, rows[i].cy_px, rows[i].cx_sd_px, rows[i].cy_sd_px};
    Place place = own;
    for (std::size_t to = i; to < steps.size() && to < i + kBeside; ++to) {
      others[to + 1].add(place = steps[to].on(place), rows[to + 1], away(i, to + 1));
    }
    place = own;
    for (std::size_t to = i; to > 0 && to + kBeside > i; --to) {
      others[to - 1].add(place = steps[to - 1].back(place), rows[to - 1], away(i, to - 1));
    }
  }
  std::vector<bool> placed(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackRow& row = rows[i];
    if (row.by_hand != ByHand::kNo) continue;  // somebody has looked at it
    const double x_px = row.cx_px, y_px = row.cy_px;
    const bool x_placed = others[i].x.place(row.cx_px, row.cx_sd_px);
    const bool y_placed = others[i].y.place(row.cy_px, row.cy_sd_px);
    placed[i] = x_placed || y_placed;
    row.rim_off_x_px -= row.cx_px - x_px;  // which stays where it is
    row.rim_off_y_px -= row.cy_px - y_px;
    if (!placed[i] || i == steps.size()) continue;
    steps[i].move_centre(row.cx_px - x_px, row.cy_px - y_px, pairs[i].motion);
  }
  return placed;
}

}  // namespace

std::vector<bool> place_by_path(std::span<TrackRow> rows, std::span<motion::PairMotion> pairs,
                                const std::vector<bool>& elsewhere) {
  std::vector<bool> placed(rows.size());
  for (std::size_t first = 0, end = 0; first < rows.size(); first = end) {
    end = first + 1;
    while (end < rows.size() && is_part_of_path(rows[end - 1]) && rows[end].circle_ok) ++end;
    if (end - first < 2 || !differ(rows.subspan(first, end - first))) continue;
    const auto at = static_cast<std::ptrdiff_t>(first);
    const std::vector<bool> of_run =
        place_run(rows.subspan(first, end - first), pairs.subspan(first, end - first - 1),
                  elsewhere.begin() + at);
    std::copy(of_run.begin(), of_run.end(), placed.begin() + at);
  }
  return placed;
}

}  // namespace impactdic::pipeline
