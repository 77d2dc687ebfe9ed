#include "host/pipeline/rows/compare_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/base/statistics.h"
#include "host/pipeline/rows/path.h"

namespace impactdic::pipeline {
namespace {

bool is_ellipse(const TrackRow& row) { return std::isfinite(row.e1_px); }

// A figure of frames that follow each other, less what the motions between them add to it: the same
// in all of them, but for errors.
struct Figure {
  std::vector<double> frame, off_px, sd_px;
  std::vector<double> moved_px2;  // variance of the motions up to here
  double steepest_px = 0;         // what may go on alike from frame to frame is no scatter
};

// Nothing to look at more closely: the figures `begin` to `end` scatter by what they state, about a
// straight line.
bool is_quiet(const Figure& figure, std::size_t begin, std::size_t end) {
  constexpr double kUsual = 1.2, kMost = 3;
  const double middle_px2 = figure.moved_px2[(begin + end) / 2];
  const double from = figure.off_px[begin];
  std::vector<double> weights;
  double w = 0, t = 0, x = 0, tt = 0, tx = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const double moved_px2 = std::abs(figure.moved_px2[i] - middle_px2);
    const double weight = 1 / (figure.sd_px[i] * figure.sd_px[i] + moved_px2);
    const double step = figure.frame[i] - figure.frame[begin], off = figure.off_px[i] - from;
    weights.push_back(weight);
    w += weight;
    t += weight * step;
    x += weight * off;
    tt += weight * step * step;
    tx += weight * step * off;
  }
  const double steepest = figure.steepest_px;
  const double slope = std::clamp((tx - t * x / w) / (tt - t * t / w), -steepest, steepest);
  double sum = 0, most = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const double step = figure.frame[i] - figure.frame[begin];
    const double off = figure.off_px[i] - from - x / w - slope * (step - t / w);
    const double size = weights[i - begin] * off * off;
    sum += size;
    most = std::max(most, size);
  }
  return sum < kUsual * static_cast<double>(end - begin) && most < kMost * kMost;
}

// Which figures are to be looked at more closely.
std::vector<bool> not_quiet(const Figure& figure) {
  const std::size_t count = figure.off_px.size();
  std::vector<bool> wanted(count);
  for (std::size_t begin = 0; begin < count; begin += kBeside) {
    const std::size_t end = std::min(begin + kBeside, count);
    const std::size_t from = begin > kBeside ? begin - kBeside : 0;
    if (is_quiet(figure, from, std::min(end + kBeside, count))) continue;
    std::fill(wanted.begin() + static_cast<std::ptrdiff_t>(begin),
              wanted.begin() + static_cast<std::ptrdiff_t>(end), true);
  }
  return wanted;
}

// What they tell, of it and of each other.
class Scatter {
 public:
  Scatter(const Figure& figure, std::size_t of) : own_px_(figure.off_px[of]) {
    const std::size_t end = std::min(of + kBeside + 1, figure.off_px.size());
    for (std::size_t i = of > kBeside ? of - kBeside : 0; i < end; ++i) {
      const double moved_px2 = std::abs(figure.moved_px2[i] - figure.moved_px2[of]);
      if (i == of) own_ = count_;
      steps_[count_] = figure.frame[i] - figure.frame[of];
      off_px_[count_] = figure.off_px[i];
      weight_[count_] = 1 / (figure.sd_px[i] * figure.sd_px[i] + moved_px2);
      ++count_;
    }
    steepest_px_ = figure.steepest_px;
  }
  // To be called before those below.
  void find_middle() {
    if (steepest_px_ > 0) {
      const double slope = std::clamp(median_slope(), -steepest_px_, steepest_px_);
      for (std::size_t i = 0; i < count_; ++i) off_px_[i] -= slope * steps_[i];
    }
    middle_px_ = middle_of_others();
  }
  void add_sizes(std::vector<double>& sizes) const {
    for (std::size_t i = 0; i < count_; ++i) {
      sizes.push_back(std::abs(off_px_[i] - middle_px_) * std::sqrt(weight_[i]));
    }
  }
  // What the frame has to state where all state `times` as much.
  double stated(double times) const {
    // What a median scatters by more than a mean, and at the end of a line.
    const double of_mean = steepest_px_ > 0 ? 2 : 1.25;
    constexpr double kAlone = 3;
    double weight = -weight_[own_];
    for (std::size_t i = 0; i < count_; ++i) weight += weight_[i];
    const double own = times / std::sqrt(weight_[own_]), off = std::abs(own_px_ - middle_px_);
    return off > kAlone * std::hypot(own, of_mean * times / std::sqrt(weight)) ? off : own;
  }

 private:
  // Between the medians of both halves (Brown and Mood 1951).
  double median_slope() const {
    const std::size_t half = count_ / 2, rest = count_ - half;
    const auto of = [&](const auto& figures, std::size_t begin) {
      return median({figures.begin() + begin, figures.begin() + begin + half});
    };
    return (of(off_px_, rest) - of(off_px_, 0)) / (of(steps_, rest) - of(steps_, 0));
  }
  // The median of the others, each by as much as it is exact.
  double middle_of_others() const {
    std::vector<std::pair<double, double>> others;
    double all = 0, up_to = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      if (i == own_) continue;
      others.emplace_back(off_px_[i], std::sqrt(weight_[i]));
      all += others.back().second;
    }
    std::sort(others.begin(), others.end());
    for (const auto& [off, weight] : others) {
      up_to += weight;
      if (2 * up_to >= all) return off;
    }
    return others.back().first;
  }

  std::array<double, 2 * kBeside + 1> steps_, off_px_, weight_;
  std::size_t count_ = 0, own_ = 0;
  double own_px_ = 0, steepest_px_ = 0, middle_px_ = 0;
};

// How many times more than they state figures scatter: 1 where that may be chance. `sizes`: of
// their distances from the middle, in stated deviations.
double times_stated(std::vector<double> sizes) {
  constexpr double kChance = 3;
  const double most = 1 + kChance / std::sqrt(static_cast<double>(sizes.size()));
  const double times = kSdOfMad * median(std::move(sizes));
  return times > most ? times : 1;
}

// The centres of rows that follow each other, along one axis.
Figure centres(std::span<const TrackRow> run, double TrackRow::*place, double TrackRow::*sd,
               double TrackRow::*move, double TrackRow::*move_sd) {
  Figure figure;
  double moved_px = 0, moved_px2 = 0;
  for (const TrackRow& row : run) {
    figure.frame.push_back(static_cast<double>(&row - run.data()));
    figure.off_px.push_back(row.*place - moved_px);
    figure.sd_px.push_back(std::max(row.*sd, kExact_px));
    figure.moved_px2.push_back(moved_px2);
    if (&row == &run.back()) break;
    moved_px += row.*move;
    moved_px2 += row.*move_sd * (row.*move_sd);
  }
  const bool sphere = turns_in_space(run.front());
  const double steps = static_cast<double>(run.size());
  figure.steepest_px = sphere ? kAboutCentre * std::abs(moved_px) / steps : 0;
  return figure;
}

// `rows`: which of the run show a circle. Compression changes a radius.
Figure radii(std::span<const TrackRow> run, std::vector<std::size_t>& rows) {
  // A ball comes nearer or goes away by no more of its distance a frame.
  constexpr double kNearer = 0.01;
  Figure figure;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (is_ellipse(run[i])) continue;
    rows.push_back(i);
    figure.frame.push_back(static_cast<double>(i));
    figure.off_px.push_back(run[i].r_px);
    figure.sd_px.push_back(std::max(run[i].r_sd_px, kExact_px));
  }
  figure.moved_px2.resize(rows.size());
  figure.steepest_px = kNearer * run.front().r_px;
  return figure;
}

void state_centres(std::span<TrackRow> run, std::vector<bool>& changed) {
  const Figure along_x =
      centres(run, &TrackRow::cx_px, &TrackRow::cx_sd_px, &TrackRow::dx_px, &TrackRow::dx_sd_px);
  const Figure along_y =
      centres(run, &TrackRow::cy_px, &TrackRow::cy_sd_px, &TrackRow::dy_px, &TrackRow::dy_sd_px);
  const std::vector<bool> x_wanted = not_quiet(along_x), y_wanted = not_quiet(along_y);
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (!x_wanted[i] && !y_wanted[i]) continue;
    Scatter x(along_x, i), y(along_y, i);
    std::vector<double> sizes;
    for (Scatter* axis : {&x, &y}) {
      axis->find_middle();
      axis->add_sizes(sizes);
    }
    const double times = times_stated(std::move(sizes));
    const double x_sd = x.stated(times), y_sd = y.stated(times);
    changed[i] = x_sd > run[i].cx_sd_px || y_sd > run[i].cy_sd_px;
    run[i].cx_sd_px = std::max(run[i].cx_sd_px, x_sd);
    run[i].cy_sd_px = std::max(run[i].cy_sd_px, y_sd);
  }
}

void state_radii(std::span<TrackRow> run) {
  std::vector<std::size_t> rows;
  const Figure figure = radii(run, rows);
  if (rows.size() <= kFewestOthers) return;
  const std::vector<bool> wanted = not_quiet(figure);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!wanted[k]) continue;
    Scatter r(figure, k);
    std::vector<double> sizes;
    r.find_middle();
    r.add_sizes(sizes);
    double& sd_px = run[rows[k]].r_sd_px;
    sd_px = std::max(sd_px, r.stated(times_stated(std::move(sizes))));
  }
}

}  // namespace

void compare_with_circles(TrackRow& row, const TrackRow& next) {
  constexpr double kChance = 6;
  if (row.status != TrackStatus::kOk || !row.motion_ok || !next.circle_ok) return;
  const auto differ = [](double motion, double motion_sd, double step, double sd, double next_sd) {
    const double off = std::abs(motion - step);
    return off > kContradiction_px && off > kChance * std::hypot(motion_sd, sd, next_sd);
  };
  if (differ(row.dx_px, row.dx_sd_px, next.cx_px - row.cx_px, row.cx_sd_px, next.cx_sd_px) ||
      differ(row.dy_px, row.dy_sd_px, next.cy_px - row.cy_px, row.cy_sd_px, next.cy_sd_px)) {
    row.status = TrackStatus::kInconsistent;
  }
}

std::vector<bool> state_scatter(std::span<TrackRow> rows) {
  std::vector<bool> changed(rows.size());
  for (std::size_t first = 0, end = 0; first < rows.size(); first = end) {
    end = first + 1;
    while (end < rows.size() && leads_on(rows[end - 1]) && rows[end].circle_ok) ++end;
    if (!rows[first].circle_ok || end - first <= kFewestOthers) continue;
    std::vector<bool> of_run(end - first);
    const std::span<TrackRow> run = rows.subspan(first, end - first);
    state_centres(run, of_run);
    state_radii(run);
    std::copy(of_run.begin(), of_run.end(), changed.begin() + static_cast<std::ptrdiff_t>(first));
  }
  return changed;
}

void compare_with_poses(std::span<TrackRow> rows, CentreOnBody& centre,
                        std::vector<bool>& changed) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackRow& row = rows[i];
    const CentreOnBody::Beside beside = centre.compare(row);
    if (beside.elsewhere) {
      if (row.status == TrackStatus::kOk) row.status = TrackStatus::kInconsistent;
      continue;
    }
    const double x_sd_px = std::max(row.cx_sd_px, std::abs(beside.x_px));
    const double y_sd_px = std::max(row.cy_sd_px, std::abs(beside.y_px));
    changed[i] = changed[i] || x_sd_px > row.cx_sd_px || y_sd_px > row.cy_sd_px;
    row.cx_sd_px = x_sd_px;
    row.cy_sd_px = y_sd_px;
  }
}

}  // namespace impactdic::pipeline
