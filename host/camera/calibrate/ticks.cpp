#include "host/camera/calibrate/ticks.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "host/base/statistics.h"

namespace impactdic::camera {

using Eigen::Vector2d;

namespace {

constexpr int kFewestTicks = 8;
constexpr int kStrip_px = 6, kStripStep_px = 3;  // rows that are looked at together
constexpr int kFewestStrips = 3;                 // in which a tick is seen: 12 px of length
constexpr double kLeastPitch_px = 4;
constexpr double kOffPlace = 0.15;   // of the pitch: what is no tick of the row any more
constexpr double kSeenShare = 0.75;  // of the ticks of a row that must be seen
constexpr double kBetween = 0.25;    // lines between the ticks, over ticks: the pitch is finer
constexpr std::array kHalfWidths_px = {1.5, 3.0, 6.0};  // of a tick
constexpr int kDirections = 180;

struct Peak {
  double x, height;
};

// Directions along which the picture changes most, rad, best first.
std::vector<double> main_directions(const cv::Mat& picture) {
  cv::Mat smooth, dx, dy;
  cv::GaussianBlur(picture, smooth, {0, 0}, 1.0);
  cv::Sobel(smooth, dx, CV_32F, 1, 0);
  cv::Sobel(smooth, dy, CV_32F, 0, 1);
  std::vector<double> weight(kDirections, 0.0);
  for (int y = 1; y + 1 < picture.rows; ++y) {
    for (int x = 1; x + 1 < picture.cols; ++x) {
      const double gx = dx.at<float>(y, x), gy = dy.at<float>(y, x);
      const double angle = std::atan2(gy, gx) / std::numbers::pi * kDirections;
      const int bin = (static_cast<int>(std::lround(angle)) + kDirections) % kDirections;
      weight[static_cast<std::size_t>(bin)] += gx * gx + gy * gy;
    }
  }
  std::vector<double> directions;
  constexpr int kMost = 4, kApart = 8;
  for (int k = 0; k < kMost; ++k) {
    const auto best =
        static_cast<int>(std::max_element(weight.begin(), weight.end()) - weight.begin());
    directions.push_back(best * std::numbers::pi / kDirections);
    for (int off = -kApart; off <= kApart; ++off) {
      weight[static_cast<std::size_t>((best + off + kDirections) % kDirections)] = 0;
    }
  }
  return directions;
}

// The picture turned so that a direction lies along its rows, and the way back.
struct Turned {
  cv::Mat grey, known;  // 32F; known: 1 where the picture is
  cv::Matx23d back;
  Vector2d in_picture(double x, double y) const {
    return {back(0, 0) * x + back(0, 1) * y + back(0, 2),
            back(1, 0) * x + back(1, 1) * y + back(1, 2)};
  }
};

Turned turn(const cv::Mat& picture, double direction) {
  const double c = std::cos(direction), s = std::sin(direction);
  const int side = static_cast<int>(std::ceil(std::hypot(picture.cols, picture.rows))) + 2;
  const double mx = (picture.cols - 1) / 2.0, my = (picture.rows - 1) / 2.0, m = (side - 1) / 2.0;
  Turned turned;
  turned.back = {c, -s, mx - c * m + s * m, s, c, my - s * m - c * m};
  cv::Mat grey;
  picture.convertTo(grey, CV_32F);
  const int flags = cv::INTER_LINEAR | cv::WARP_INVERSE_MAP;
  cv::warpAffine(grey, turned.grey, turned.back, {side, side}, flags);
  const cv::Mat all(picture.size(), CV_32F, cv::Scalar(1));
  cv::warpAffine(all, turned.known, turned.back, {side, side}, flags);
  return turned;
}

// Mean of a strip's rows, NaN where the picture is not.
std::vector<double> profile_of(const Turned& turned, int y0) {
  const auto width = static_cast<std::size_t>(turned.grey.cols);
  std::vector<double> sum(width, 0.0), known(width, 0.0);
  for (int y = y0; y < y0 + kStrip_px; ++y) {
    const float* grey = turned.grey.ptr<float>(y);
    const float* there = turned.known.ptr<float>(y);
    for (std::size_t x = 0; x < width; ++x) sum[x] += grey[x], known[x] += there[x];
  }
  constexpr double kAll = 0.999;
  for (std::size_t x = 0; x < width; ++x) {
    sum[x] = known[x] > kAll * kStrip_px ? sum[x] / kStrip_px : std::nan("");
  }
  return sum;
}

// How much darker (sign 1) or brighter (-1) each place is than those beside it, each a mean over
// `half` px to both sides.
std::vector<double> line_strength(const std::vector<double>& profile, double half, double sign) {
  const auto count = static_cast<std::ptrdiff_t>(profile.size());
  std::vector<double> sums(profile.size() + 1, 0.0);
  std::vector<int> gaps(profile.size() + 1, 0);
  for (std::size_t i = 0; i < profile.size(); ++i) {
    sums[i + 1] = sums[i] + (std::isnan(profile[i]) ? 0 : profile[i]);
    gaps[i + 1] = gaps[i] + (std::isnan(profile[i]) ? 1 : 0);
  }
  const auto reach = static_cast<std::ptrdiff_t>(std::lround(2 * half));
  const std::ptrdiff_t inner = reach / 2;
  std::vector<double> strength(profile.size(), 0.0);
  for (std::ptrdiff_t i = reach + inner; i + reach + inner < count; ++i) {
    const auto mean = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
      return (sums[static_cast<std::size_t>(to)] - sums[static_cast<std::size_t>(from)]) /
             static_cast<double>(to - from);
    };
    const std::ptrdiff_t first = i - inner - reach, last = i + inner + reach + 1;
    if (gaps[static_cast<std::size_t>(last)] != gaps[static_cast<std::size_t>(first)]) continue;
    const double side = std::min(sign * mean(first, i - inner), sign * mean(i + inner + 1, last));
    strength[static_cast<std::size_t>(i)] = side - sign * mean(i - inner, i + inner + 1);
  }
  return strength;
}

// Where lines stand out, at the centre of gravity of what is stronger than half of the peak.
std::vector<Peak> peaks_of(const std::vector<double>& strength) {
  std::vector<double> sorted;
  for (const double s : strength) {
    if (s > 0) sorted.push_back(s);
  }
  if (sorted.size() < 2 * kFewestTicks) return {};
  constexpr double kHigh = 0.95, kLow = 0.3, kLeastContrast = 4;  // grey levels
  const auto rank = static_cast<std::size_t>(kHigh * (static_cast<double>(sorted.size()) - 1));
  const double least = std::max(kLow * ranked(std::move(sorted), rank), kLeastContrast);
  std::vector<Peak> peaks;
  for (std::size_t i = 1; i + 1 < strength.size(); ++i) {
    if (strength[i] < least || strength[i] < strength[i - 1] || strength[i] <= strength[i + 1]) {
      continue;
    }
    std::size_t from = i, to = i;
    while (from > 0 && strength[from - 1] > strength[i] / 2) --from;
    while (to + 1 < strength.size() && strength[to + 1] > strength[i] / 2) ++to;
    double weight = 0, moment = 0;
    for (std::size_t k = from; k <= to; ++k) {
      const double w = strength[k] - strength[i] / 2;
      weight += w, moment += w * (static_cast<double>(k) - static_cast<double>(i));
    }
    peaks.push_back({static_cast<double>(i) + moment / weight, strength[i]});
  }
  return peaks;
}

// An even row among the peaks of one strip.
struct Run {
  std::vector<std::pair<int, double>> ticks;  // number and place
  double pitch = 0;
};

// Goes on from two peaks as long as there are more where they must be; one in a row may lack.
Run follow(const std::vector<Peak>& peaks, std::size_t first, std::size_t second) {
  Run run;
  run.pitch = peaks[second].x - peaks[first].x;
  run.ticks = {{0, peaks[first].x}, {1, peaks[second].x}};
  std::size_t at = second;
  for (int number = 2; number - run.ticks.back().first <= 2; ++number) {
    const auto& [seen, place] = run.ticks.back();
    const double expected = place + run.pitch * (number - seen);
    while (at < peaks.size() && peaks[at].x < expected - kOffPlace * run.pitch) ++at;
    if (at == peaks.size()) break;
    if (peaks[at].x > expected + kOffPlace * run.pitch) continue;
    run.ticks.emplace_back(number, peaks[at].x);
    // The mean over the last ones follows a ruler that leans.
    constexpr std::size_t kLast = 8;
    const auto& from = run.ticks[run.ticks.size() > kLast ? run.ticks.size() - kLast - 1 : 0];
    run.pitch = (peaks[at].x - from.second) / (number - from.first);
  }
  const int span = run.ticks.back().first - run.ticks.front().first;
  run.pitch = (run.ticks.back().second - run.ticks.front().second) / span;
  return run;
}

// Lines between the ticks that are as strong as half of them: the pitch is a multiple.
bool is_finest(const Run& run, const std::vector<Peak>& peaks) {
  std::vector<double> heights;
  int between = 0;
  std::size_t next = 0;
  for (const Peak& peak : peaks) {
    if (peak.x < run.ticks.front().second || peak.x > run.ticks.back().second) continue;
    while (next + 1 < run.ticks.size() && run.ticks[next].second < peak.x - 1e-9) ++next;
    if (std::abs(run.ticks[next].second - peak.x) < 1e-9) {
      heights.push_back(peak.height);
    }
  }
  if (heights.empty()) return false;
  const double usual = upper_median(std::move(heights));
  for (const Peak& peak : peaks) {
    const bool inside = peak.x > run.ticks.front().second && peak.x < run.ticks.back().second;
    between += inside && peak.height > usual / 2;
  }
  between -= static_cast<int>(run.ticks.size());
  return between <= kBetween * static_cast<double>(run.ticks.size());
}

Run longest_run(const std::vector<Peak>& peaks) {
  Run best;
  for (std::size_t i = 0; i + 1 < peaks.size(); ++i) {
    constexpr std::size_t kNext = 3;
    for (std::size_t k = i + 1; k <= std::min(i + kNext, peaks.size() - 1); ++k) {
      if (peaks[k].x - peaks[i].x < kLeastPitch_px) continue;
      Run run = follow(peaks, i, k);
      const double share = static_cast<double>(run.ticks.size()) / (run.ticks.back().first + 1);
      if (run.ticks.size() <= best.ticks.size() || share < kSeenShare) continue;
      if (is_finest(run, peaks)) best = std::move(run);
    }
  }
  return best;
}

// A strip's row, with what found it.
struct StripRun {
  int y0 = 0;
  double half = 0, sign = 0;
  Run run;
};

// The peaks of a strip as the same lines see it.
std::vector<Peak> peaks_at(const Turned& turned, int y0, double half, double sign) {
  if (y0 < 0 || y0 + kStrip_px > turned.grey.rows) return {};
  return peaks_of(line_strength(profile_of(turned, y0), half, sign));
}

// The strips with the most ticks, of every kind of line.
StripRun best_strip(const Turned& turned) {
  StripRun best;
  for (int y0 = 0; y0 + kStrip_px <= turned.grey.rows; y0 += kStripStep_px) {
    const std::vector<double> profile = profile_of(turned, y0);
    for (const double half : kHalfWidths_px) {
      for (const double sign : {1.0, -1.0}) {
        const std::vector<Peak> peaks = peaks_of(line_strength(profile, half, sign));
        if (peaks.size() < best.run.ticks.size() || peaks.size() < kFewestTicks) continue;
        Run run = longest_run(peaks);
        if (run.ticks.size() > best.run.ticks.size()) best = {y0, half, sign, std::move(run)};
      }
    }
  }
  return best;
}

// Places of the ticks in the strips above and below, as far as most of them are seen.
struct Places {
  std::map<int, std::vector<Vector2d>> of_tick;  // x and the strip's middle
  int strips = 0;
};

// Adds the strip at y0 where it shows the ticks, which then lie where it says: ticks may lean.
bool add_strip(const Turned& turned, const StripRun& found, int y0, std::map<int, double>& expected,
               Places& places) {
  const std::vector<Peak> peaks = peaks_at(turned, y0, found.half, found.sign);
  std::map<int, double> seen;
  double drift = 0;
  for (const auto& [number, x] : expected) {
    const Peak* nearest = nullptr;
    for (const Peak& peak : peaks) {
      if (nearest == nullptr || std::abs(peak.x - x) < std::abs(nearest->x - x)) nearest = &peak;
    }
    if (nearest == nullptr || std::abs(nearest->x - x) > kOffPlace * found.run.pitch) continue;
    seen[number] = nearest->x;
    drift += nearest->x - x;
  }
  if (static_cast<double>(seen.size()) < kSeenShare * static_cast<double>(expected.size())) {
    return false;
  }
  drift /= static_cast<double>(seen.size());
  for (auto& [number, x] : expected) x += drift;
  for (const auto& [number, x] : seen) {
    places.of_tick[number].emplace_back(x, y0 + (kStrip_px - 1) / 2.0);
  }
  ++places.strips;
  return true;
}

Places all_places(const Turned& turned, const StripRun& found) {
  std::map<int, double> start;
  for (const auto& [number, x] : found.run.ticks) start[number] = x;
  Places places;
  for (const int way : {-1, 1}) {
    std::map<int, double> expected = start;
    for (int y0 = way > 0 ? found.y0 : found.y0 - kStripStep_px;
         add_strip(turned, found, y0, expected, places); y0 += way * kStripStep_px) {
    }
  }
  return places;
}

struct Line {
  Eigen::VectorXd unknowns;
  Eigen::MatrixXd inverse;  // of the normal equations
  double variance = 0;      // of what is left
};

// Least squares of `values` over the columns of `slopes`.
Line fit(const Eigen::MatrixXd& slopes, const Eigen::VectorXd& values) {
  const Eigen::MatrixXd normal = slopes.transpose() * slopes;
  Line line;
  line.inverse = normal.ldlt().solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
  line.unknowns = line.inverse * (slopes.transpose() * values);
  const double left = static_cast<double>(values.size() - slopes.cols());
  line.variance = (values - slopes * line.unknowns).squaredNorm() / std::max(left, 1.0);
  return line;
}

// How the ticks lean: dx over dy, the mean over them.
double lean_of(const Places& places) {
  double along = 0, squares = 0;
  for (const auto& [number, points] : places.of_tick) {
    Vector2d middle = Vector2d::Zero();
    for (const Vector2d& at : points) middle += at / static_cast<double>(points.size());
    for (const Vector2d& at : points) {
      along += (at.x() - middle.x()) * (at.y() - middle.y());
      squares += (at.y() - middle.y()) * (at.y() - middle.y());
    }
  }
  return squares > 0 ? along / squares : 0;
}

// From the places to an even scale: one place a tick, since a tick errs alike in all its strips.
std::optional<TickRow> conclude(const Turned& turned, const Places& places) {
  const double lean = lean_of(places);
  double y_mean = 0;
  std::size_t count = 0;
  for (const auto& [number, points] : places.of_tick) {
    for (const Vector2d& at : points) y_mean += at.y(), ++count;
  }
  y_mean /= static_cast<double>(count);
  std::vector<int> numbers;
  std::vector<double> at;
  for (const auto& [number, points] : places.of_tick) {
    if (static_cast<int>(points.size()) < kFewestStrips) continue;
    double x = 0;
    for (const Vector2d& one : points) {
      x += (one.x() - lean * (one.y() - y_mean)) / static_cast<double>(points.size());
    }
    numbers.push_back(number), at.push_back(x);
  }
  const auto size = static_cast<Eigen::Index>(at.size());
  if (size < kFewestTicks) return std::nullopt;
  const double middle = (numbers.front() + numbers.back()) / 2.0;
  const double half = (numbers.back() - numbers.front()) / 2.0;
  Eigen::MatrixXd slopes(size, 3);
  for (Eigen::Index i = 0; i < size; ++i) {
    const double n = numbers[static_cast<std::size_t>(i)] - middle;
    slopes.row(i) << 1, n, n * n;
  }
  const Eigen::VectorXd values = Eigen::Map<const Eigen::VectorXd>(at.data(), size);
  const Line curve = fit(slopes, values), even = fit(slopes.leftCols<2>(), values);
  // Across leaning ticks the ruler is shorter than along the rows.
  const double across = 1 / std::hypot(1, lean);
  TickRow row;
  row.pitch_px = even.unknowns[1] * across;
  row.scatter_px = std::sqrt(curve.variance);
  row.pitch_sd_px = std::sqrt(curve.variance * even.inverse(1, 1)) * across;
  row.growth = 4 * half * curve.unknowns[2] / even.unknowns[1];
  row.growth_sd =
      4 * half * std::sqrt(curve.variance * curve.inverse(2, 2)) / std::abs(even.unknowns[1]);
  const Eigen::VectorXd off = values - slopes.leftCols<2>() * even.unknowns;
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto k = static_cast<std::size_t>(i);
    row.ticks.push_back({numbers[k] - numbers.front(), turned.in_picture(at[k], y_mean), off[i]});
  }
  return row;
}

}  // namespace

std::optional<TickRow> find_ticks(const cv::Mat& picture) {
  std::optional<TickRow> best;
  for (const double direction : main_directions(picture)) {
    const Turned turned = turn(picture, direction);
    const StripRun found = best_strip(turned);
    if (static_cast<int>(found.run.ticks.size()) < kFewestTicks) continue;
    const Places places = all_places(turned, found);
    if (places.strips < kFewestStrips) continue;
    std::optional<TickRow> row = conclude(turned, places);
    if (row && (!best || row->ticks.size() > best->ticks.size())) best = std::move(row);
  }
  return best;
}

}  // namespace impactdic::camera
