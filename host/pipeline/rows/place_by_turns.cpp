#include "host/pipeline/rows/place_by_turns.h"

#include <algorithm>
#include <cmath>

#include "host/sphere/source_response.h"

namespace impactdic::pipeline {
namespace {

// Steps err by chance, and by this share of what they state all alike.
constexpr double kStepsAlike = 0.5;
// Tilted farther, two pictures share too little to tell what a centre does to a motion.
constexpr double kMostTilt_rad = 1;
// What is told of frames a few apart shares their pictures.
constexpr double kLeastShare = 0.7;
// What is told by more is told by few pixels, or by pixels of something else; what scatters by so
// much more than it states is not told at all.
constexpr double kMostSd_px = 0.1, kMostScatter = 3;
// Deviations, and px, by which a circle may lie off what is told.
constexpr double kContradicts = 5, kLeastOff_px = 0.1;
// No centre is told to be better known than this.
constexpr double kLeastSd_px = 0.004;

struct Centre {
  double x_px = 0, y_px = 0;
};

// What motions make of a centre that was taken to lie elsewhere.
class Steps {
 public:
  Steps(std::span<const TrackRow> rows, std::span<const motion::PairMotion> pairs,
        const motion::EstimatorOptions& options)
      : rows_(rows), pairs_(pairs) {
    std::size_t like = pairs.size();  // the pair that the last response is of
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (!is_linked(i)) {
        by_.emplace_back();
      } else if (like < pairs.size() && is_alike(pairs[i].motion, pairs[like].motion)) {
        by_.push_back(by_[like]);
      } else {
        by_.push_back(response(i, options));
        like = i;
      }
    }
  }
  bool leads_on(std::size_t i) const {
    return i < pairs_.size() && is_linked(i) && std::isfinite(by_[i].rot_z[sphere::kToRadius]);
  }
  // From the centre in row i to that in the next one, and back.
  Centre on(std::size_t i, const Centre& at) const {
    return {at.x_px + dx(i, at), at.y_px + dy(i, at)};
  }
  Centre back(std::size_t i, const Centre& next) const {
    Centre at{next.x_px - pairs_[i].motion.dx_px, next.y_px - pairs_[i].motion.dy_px};
    for (int pass = 0; pass < 3; ++pass) at = {next.x_px - dx(i, at), next.y_px - dy(i, at)};
    return at;
  }
  // The motion of a ball whose centre is there.
  void correct(std::size_t i, const Centre& at, dic::RigidMotion& motion) const {
    const double x = rows_[i].cx_px - at.x_px, y = rows_[i].cy_px - at.y_px;
    const auto off = [&](const auto& by) { return by[0] * x + by[1] * y; };
    motion.dx_px -= off(by_[i].dx);
    motion.dy_px -= off(by_[i].dy);
    motion.rot_x_rad -= off(by_[i].rot_x);
    motion.rot_y_rad -= off(by_[i].rot_y);
    motion.rot_rad -= off(by_[i].rot_z);
  }
  double sd_px(std::size_t i) const {
    return std::max(pairs_[i].motion.dx_sd_px, pairs_[i].motion.dy_sd_px);
  }

 private:
  // A response is slow to find, and the same turn has the same one.
  static bool is_alike(const dic::RigidMotion& a, const dic::RigidMotion& b) {
    constexpr double kAlikeTurns = 0.03;
    const double x = a.rot_x_rad - b.rot_x_rad, y = a.rot_y_rad - b.rot_y_rad;
    return std::hypot(x, y, a.rot_rad - b.rot_rad) <
           kAlikeTurns * std::hypot(b.rot_x_rad, b.rot_y_rad, b.rot_rad);
  }
  sphere::SourceResponse response(std::size_t i, const motion::EstimatorOptions& options) const {
    const dic::RigidMotion& motion = pairs_[i].motion;
    return sphere::source_response({{motion.rot_x_rad, motion.rot_y_rad, motion.rot_rad},
                                    options.sphere_radius(rows_[i].r_px),
                                    {},
                                    {},
                                    options.sphere_light});
  }
  bool is_linked(std::size_t i) const {
    return is_round(rows_[i]) && is_round(rows_[i + 1]) && pairs_[i].motion.ok &&
           pairs_[i].motion.rot_x_sd_rad > 0 &&
           std::hypot(pairs_[i].motion.rot_x_rad, pairs_[i].motion.rot_y_rad) < kMostTilt_rad;
  }
  // A compressed sphere has no model.
  static bool is_round(const TrackRow& row) { return row.circle_ok && !std::isfinite(row.e1_px); }
  double dx(std::size_t i, const Centre& at) const {
    return pairs_[i].motion.dx_px - by_[i].dx[0] * (rows_[i].cx_px - at.x_px) -
           by_[i].dx[1] * (rows_[i].cy_px - at.y_px);
  }
  double dy(std::size_t i, const Centre& at) const {
    return pairs_[i].motion.dy_px - by_[i].dy[0] * (rows_[i].cx_px - at.x_px) -
           by_[i].dy[1] * (rows_[i].cy_px - at.y_px);
  }

  std::span<const TrackRow> rows_;
  std::span<const motion::PairMotion> pairs_;
  std::vector<sphere::SourceResponse> by_;
};

// What is told of one row's centre along one axis.
class Told {
 public:
  void add(double at_px, double sd_px) {
    const double weight = 1 / (sd_px * sd_px);
    if (count_ == 0) first_px_ = at_px;
    const double off_px = at_px - first_px_;
    weight_ += weight;
    off_ += weight * off_px;
    squares_ += weight * off_px * off_px;
    best_px_ = count_++ == 0 ? sd_px : std::min(best_px_, sd_px);
  }
  // By several frames that agree.
  bool is_told() const { return count_ > 1 && times_stated() < kMostScatter; }
  double at_px() const { return first_px_ + off_ / weight_; }
  double sd_px() const {
    const double by_chance = std::max(std::sqrt(1 / weight_), kLeastShare * best_px_);
    return std::max(std::max(1.0, times_stated()) * by_chance, kLeastSd_px);
  }
  bool contradicts(double px, double sd) const {
    const double off = std::abs(px - at_px());
    return off > kLeastOff_px && off > kContradicts * std::hypot(sd, sd_px());
  }
  // With the row's own circle.
  void place(double& px, double& sd) const {
    const double told = 1 / (sd_px() * sd_px()), own = 1 / (sd * sd);
    px = (told * at_px() + own * px) / (told + own);
    sd = std::sqrt(1 / (told + own));
  }

 private:
  // By how much they scatter, over what they state.
  double times_stated() const {
    const double scatter = std::max(0.0, squares_ - off_ * off_ / weight_);
    return std::sqrt(scatter / static_cast<double>(count_ - 1));
  }

  double weight_ = 0, first_px_ = 0, off_ = 0, squares_ = 0, best_px_ = 0;
  int count_ = 0;
};

struct ToldOfRow {
  Told x, y;
};

// Adds what is told of one row to all rows that motions lead to.
void spread(const motion::TurnedCentre& told, std::span<const TrackRow> rows, const Steps& steps,
            std::vector<ToldOfRow>& sums) {
  const Centre from{rows[told.frame].cx_px - told.off_x_px, rows[told.frame].cy_px - told.off_y_px};
  double alike_px = 0, chance_px2 = 0;
  const auto add = [&](std::size_t i, const Centre& at) {
    const double way_px = std::hypot(kStepsAlike * alike_px, std::sqrt(chance_px2));
    sums[i].x.add(at.x_px, std::hypot(told.x_sd_px, way_px));
    sums[i].y.add(at.y_px, std::hypot(told.y_sd_px, way_px));
  };
  const auto step = [&](std::size_t i) {
    alike_px += steps.sd_px(i);
    chance_px2 += steps.sd_px(i) * steps.sd_px(i);
  };
  add(told.frame, from);
  Centre at = from;
  for (std::size_t i = told.frame; steps.leads_on(i); ++i) {
    step(i);
    add(i + 1, at = steps.on(i, at));
  }
  alike_px = chance_px2 = 0;
  at = from;
  for (std::size_t i = told.frame; i > 0 && steps.leads_on(i - 1); --i) {
    step(i - 1);
    add(i - 1, at = steps.back(i - 1, at));
  }
}

}  // namespace

void place_by_turns(std::span<TrackRow> rows, std::span<motion::PairMotion> pairs,
                    std::span<const motion::TurnedCentre> told,
                    const motion::EstimatorOptions& options) {
  if (told.empty()) return;
  const Steps steps(rows, pairs.first(rows.size() - 1), options);
  std::vector<ToldOfRow> sums(rows.size());
  for (const motion::TurnedCentre& centre : told) {
    if (std::max(centre.x_sd_px, centre.y_sd_px) < kMostSd_px) spread(centre, rows, steps, sums);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackRow& row = rows[i];
    const Told &x = sums[i].x, &y = sums[i].y;
    if (!x.is_told() || !y.is_told() || row.by_hand != ByHand::kNo) continue;
    if (!(row.cx_sd_px > 0) || !(row.cy_sd_px > 0)) continue;
    if (x.contradicts(row.cx_px, row.cx_sd_px) || y.contradicts(row.cy_px, row.cy_sd_px)) {
      row.status = TrackStatus::kInconsistent;
      continue;
    }
    Centre at{row.cx_px, row.cy_px};
    double x_sd_px = row.cx_sd_px, y_sd_px = row.cy_sd_px;
    x.place(at.x_px, x_sd_px);
    y.place(at.y_px, y_sd_px);
    if (steps.leads_on(i)) steps.correct(i, at, pairs[i].motion);
    row.rim_off_x_px = row.cx_px - at.x_px;
    row.rim_off_y_px = row.cy_px - at.y_px;
    row.rim_x_sd_px = row.cx_sd_px;
    row.rim_y_sd_px = row.cy_sd_px;
    row.cx_px = at.x_px;
    row.cy_px = at.y_px;
    row.cx_sd_px = x_sd_px;
    row.cy_sd_px = y_sd_px;
  }
}

}  // namespace impactdic::pipeline
