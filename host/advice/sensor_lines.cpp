#include "host/advice/sensor_lines.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "host/base/parallel/parallel_for.h"
#include "host/base/statistics.h"
#include "host/circle/rays/frame_level.h"

namespace impactdic::advice {
namespace {

constexpr double kInside = 0.85;            // of the radius: beyond, the rim's edge is seen [hand]
constexpr double kLeastInside = 0.4;        // [hand]
constexpr int kFrames = 64;                 // looked at, where the first ones show a pattern [hand]
constexpr double kFirstPx = 250000;         // looked at first, in fewer frames [hand]
constexpr std::size_t kLeastSightings = 6;  // [hand]
constexpr double kLeastMovedPx = 8;         // along the axis: a speckle or more [hand]
constexpr std::size_t kLeastSteps = 40;     // of a line, in one of four parts [hand]
constexpr int kLeastLines = 40;             // [hand]
constexpr int kNextTo = 6;                  // lines so far apart share no step [hand]
// Parts that share no texture are alike by so many of the deviations that chance lets them be, in
// the first frames and in all, and lines differ by so much, grey levels of 255.
constexpr double kWorthALook = 3, kPlain = 5;  // [hand]
constexpr double kLeastRms = 0.5;              // [hand]
constexpr double kTukey = 6;                   // scales beyond which a step is the texture's [hand]
constexpr int kRefits = 6;
constexpr int kSmooth = 12;  // lines on either side: what varies more slowly is light [hand]
constexpr double kGainPrior = 0.05;  // deviation of a line's gain, beforehand [hand]
constexpr int kParts = 4;            // half of the ball, every other frame

// From one line to the next: the mean grey level of both pixels, and the step.
struct Step {
  float level, step;
};

// The steps of one axis, by line and part.
class Steps {
 public:
  explicit Steps(int lines) : of_(static_cast<std::size_t>(lines)) {}
  void add(int line, int part, Step step) {
    of_[static_cast<std::size_t>(line)][part].push_back(step);
  }
  const std::vector<Step>& of(std::size_t line, int part) const {
    return of_[line][static_cast<std::size_t>(part)];
  }
  std::size_t lines() const { return of_.size(); }

 private:
  std::vector<std::array<std::vector<Step>, kParts>> of_;
};

// A line's step at the mean level, and what it gains by a grey level; both without the texture's.
struct LineStep {
  double step = 0, slope = 0;
};

LineStep fit(const std::vector<Step>& steps, double level) {
  LineStep line;
  if (steps.empty()) return line;
  std::vector<double> values;
  for (const Step& s : steps) values.push_back(s.step);
  line.step = upper_median(values);
  double scale = 0;
  for (int k = 0; k < kRefits; ++k) {
    if (k < 3) {  // the scale settles
      values.clear();
      for (const Step& s : steps) {
        values.push_back(std::abs(s.step - line.step - line.slope * (s.level - level)));
      }
      scale = std::max(0.5, kTukey * 1.4826 * upper_median(values));
    }
    double n = 0, x = 0, xx = 0, y = 0, xy = 0;
    for (const Step& s : steps) {
      const double at = s.level - level;
      const double u = (s.step - line.step - line.slope * at) / scale;
      if (std::abs(u) >= 1) continue;
      const double w = (1 - u * u) * (1 - u * u);
      n += w, x += w * at, xx += w * at * at, y += w * s.step, xy += w * at * s.step;
    }
    const double variance = scale * scale / (kTukey * kTukey);
    xx += variance / (2 * kGainPrior * kGainPrior);
    const double det = n * xx - x * x;
    if (!(det > 0)) break;
    line.step = (xx * y - x * xy) / det;
    line.slope = (n * xy - x * y) / det;
  }
  return line;
}

// Less what varies over many lines, NaN where a line has no value.
void take_off_slow(std::vector<double>& values) {
  std::vector<double> slow(values.size());
  const int n = static_cast<int>(values.size());
  for (int k = 0; k < n; ++k) {
    double sum = 0, count = 0;
    for (int j = std::max(0, k - kSmooth); j <= std::min(n - 1, k + kSmooth); ++j) {
      if (!std::isnan(values[static_cast<std::size_t>(j)])) {
        sum += values[static_cast<std::size_t>(j)], ++count;
      }
    }
    slow[static_cast<std::size_t>(k)] = count > 0 ? sum / count : 0;
  }
  for (std::size_t k = 0; k < values.size(); ++k) values[k] -= slow[k];
}

// A correlation of two lists, of where both have values, and what it is by chance; values beyond
// six times the usual count as that: a bar's edge is no pattern.
struct Alike {
  double covariance = 0, correlation = 0, chance = 1;
  int lines = 0;
  double deviations() const { return correlation / chance; }
};

// `shift`: by so many lines they are compared beside where they belong.
Alike compare(const std::vector<double>& a, const std::vector<double>& b, int shift) {
  std::vector<std::array<double, 2>> pairs;
  std::vector<double> sizes_a, sizes_b;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const auto other = static_cast<std::size_t>(static_cast<int>(k) + shift);  // large below 0
    if (other >= b.size() || std::isnan(a[k]) || std::isnan(b[other])) continue;
    pairs.push_back({a[k], b[other]});
    sizes_a.push_back(std::abs(a[k])), sizes_b.push_back(std::abs(b[other]));
  }
  Alike alike;
  alike.lines = static_cast<int>(pairs.size());
  if (pairs.empty()) return alike;
  const double most_a = 6 * upper_median(sizes_a), most_b = 6 * upper_median(sizes_b);
  double aa = 0, ab = 0, bb = 0;
  for (const auto& [own, other] : pairs) {
    const double x = std::clamp(own, -most_a, most_a), y = std::clamp(other, -most_b, most_b);
    aa += x * x, ab += x * y, bb += y * y;
  }
  if (aa > 0 && bb > 0) {
    alike.covariance = ab / alike.lines;
    alike.correlation = ab / std::sqrt(aa * bb);
  }
  return alike;
}

// The likeness of parts that share neither rows nor frames. Chance is what lines that do not belong
// together show, for a texture's steps are alike over some lines; and no less than of independent
// ones.
Alike likeness(const std::array<std::vector<double>, kParts>& parts) {
  const Alike one = compare(parts[0], parts[3], 0), other = compare(parts[1], parts[2], 0);
  Alike both;
  both.covariance = (one.covariance + other.covariance) / 2;
  both.correlation = (one.correlation + other.correlation) / 2;
  both.lines = std::min(one.lines, other.lines);
  if (both.lines < kLeastLines) return both;
  double squares = 0, count = 0;
  for (int shift = kNextTo; shift < both.lines / 2; ++shift) {
    for (const int by : {-shift, shift}) {
      squares += std::pow(compare(parts[0], parts[3], by).correlation, 2);
      squares += std::pow(compare(parts[1], parts[2], by).correlation, 2);
      count += 2;
    }
  }
  both.chance = std::sqrt(std::max(squares / count, 1.0 / both.lines) / 2);
  return both;
}

// The lines' own values by the steps between them, each with this variance, where lines have that
// variance: the least squares of both (a tridiagonal system).
std::vector<float> summed(const std::vector<double>& steps, double step_variance, double variance) {
  const std::size_t n = steps.size() + 1;
  const double own = step_variance / variance;
  std::vector<double> diagonal(n, own), right(n, 0.0), beside(n, 0.0);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    if (std::isnan(steps[k])) continue;
    diagonal[k] += 1, diagonal[k + 1] += 1, beside[k] = -1;
    right[k] -= steps[k], right[k + 1] += steps[k];
  }
  for (std::size_t k = 1; k < n; ++k) {
    const double by = beside[k - 1] / diagonal[k - 1];
    diagonal[k] -= by * beside[k - 1];
    right[k] -= by * right[k - 1];
  }
  std::vector<float> values(n);
  double next = 0;
  for (std::size_t k = n; k-- > 0;) {
    next = (right[k] - beside[k] * next) / diagonal[k];
    values[k] = static_cast<float>(next);
  }
  return values;
}

double rms(const std::vector<float>& values) {
  double sum = 0, count = 0;
  for (const float v : values) {
    if (v != 0) sum += v * v, ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

// The pattern of one axis; nullopt where there is none that is so plain.
std::optional<video::LinePattern> pattern_of(const Steps& steps, double plain, double least_rms) {
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < steps.lines(); ++k) {
    for (int part = 0; part < kParts; ++part) {
      for (const Step& s : steps.of(k, part)) sum += s.level, ++count;
    }
  }
  video::LinePattern pattern;
  pattern.level = count > 0 ? sum / count : 0;
  const double nan = std::nan("");
  const std::vector<double> none(steps.lines(), nan);
  std::array<std::vector<double>, kParts> of_part{none, none, none, none}, slopes = of_part;
  std::vector<double> all = none, all_slopes = none;
  parallel_for(steps.lines(), [&](std::size_t k) {
    std::vector<Step> whole;
    bool enough = true;
    for (int part = 0; part < kParts; ++part) {
      const std::vector<Step>& own = steps.of(k, part);
      whole.insert(whole.end(), own.begin(), own.end());
      if (own.size() < kLeastSteps) {
        enough = false;
        continue;
      }
      const LineStep line = fit(own, pattern.level);
      of_part[static_cast<std::size_t>(part)][k] = line.step;
      slopes[static_cast<std::size_t>(part)][k] = line.slope;
    }
    if (!enough) return;
    const LineStep line = fit(whole, pattern.level);
    all[k] = line.step, all_slopes[k] = line.slope;
  });
  for (auto* list : {&of_part, &slopes}) {
    for (std::vector<double>& values : *list) take_off_slow(values);
  }
  const Alike alike = likeness(of_part);
  const double of_a_line = std::sqrt(std::max(0.0, alike.covariance / 2));
  if (alike.deviations() < plain || of_a_line < least_rms) return std::nullopt;
  take_off_slow(all);
  take_off_slow(all_slopes);
  // A part's covariance with another is the pattern's own: twice a line's variance.
  const auto lines_by = [&](const std::vector<double>& values, const Alike& shared) {
    double squares = 0, n = 0;
    for (const double v : values) {
      if (!std::isnan(v)) squares += v * v, ++n;
    }
    const double noise = std::max(0.01 * squares / n, squares / n - shared.covariance);
    return summed(values, noise, std::max(shared.covariance / 2, 1e-12));
  };
  pattern.offset = lines_by(all, alike);
  const Alike alike_slopes = likeness(slopes);
  pattern.gain = alike_slopes.deviations() > kWorthALook
                     ? lines_by(all_slopes, alike_slopes)
                     : std::vector<float>(pattern.offset.size(), 0.0f);
  return pattern;
}

// A disc on the ball in a frame.
struct DiscIn {
  std::int64_t index;
  Circle disc;
};

// Where the ball is seen, and on the way between, less surely, where that is short.
std::vector<DiscIn> discs_on(const circle::BallCandidate& ball, int wanted) {
  std::vector<DiscIn> places;
  const auto& seen = ball.sightings;
  const int between = std::max<int>(1, wanted / std::max<int>(1, static_cast<int>(seen.size())));
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const Circle& a = seen[k].ball.circle;
    places.push_back({seen[k].index, {a.cx_px, a.cy_px, kInside * ball.radius_px}});
    if (k + 1 == seen.size()) break;
    const Circle& b = seen[k + 1].ball.circle;
    const double way_px = std::hypot(b.cx_px - a.cx_px, b.cy_px - a.cy_px);
    const double r_px = kInside * ball.radius_px - way_px / 2;
    const std::int64_t frames = seen[k + 1].index - seen[k].index;
    for (int i = 1; i < between && r_px > kLeastInside * ball.radius_px; ++i) {
      const std::int64_t index = seen[k].index + frames * i / between;
      if (index == places.back().index) continue;
      const double t = static_cast<double>(index - seen[k].index) / static_cast<double>(frames);
      places.push_back(
          {index, {std::lerp(a.cx_px, b.cx_px, t), std::lerp(a.cy_px, b.cy_px, t), r_px}});
    }
  }
  return places;
}

// The steps along x (columns) or y (rows) on a disc; the part is that half of it and `odd`.
void collect(const Frame& frame, const Circle& disc, bool columns, int odd, Steps& steps) {
  const double full = frame.full_scale();
  const int last_x = frame.width() - 1 - columns, last_y = frame.height() - 1 - !columns;
  const int top = std::max(0, static_cast<int>(std::ceil(disc.cy_px - disc.r_px)));
  const int bottom = std::min(last_y, static_cast<int>(std::floor(disc.cy_px + disc.r_px)));
  for (int y = top; y <= bottom; ++y) {
    const double half =
        std::sqrt(std::max(0.0, disc.r_px * disc.r_px - (y - disc.cy_px) * (y - disc.cy_px)));
    const int left = std::max(0, static_cast<int>(std::ceil(disc.cx_px - half)));
    const int right = std::min(last_x, static_cast<int>(std::floor(disc.cx_px + half)));
    for (int x = left; x <= right; ++x) {
      const double a = circle::level_at(frame, x, y),
                   b = circle::level_at(frame, x + columns, y + !columns);
      if (std::min(a, b) <= 0 || std::max(a, b) >= full) continue;
      const int beyond = columns ? y > disc.cy_px : x > disc.cx_px;
      steps.add(columns ? x : y, 2 * beyond + odd,
                {static_cast<float>((a + b) / 2), static_cast<float>(b - a)});
    }
  }
}

struct BothAxes {
  std::optional<video::LinePattern> columns, rows;
};

// Of the frames that can be read.
BothAxes look_at(FrameSource& source, const FrameRange& frames, const Roi& roi,
                 const std::vector<DiscIn>& places, double plain, bool columns, bool rows) {
  const ClipInfo& info = source.info();
  std::vector<Frame> pictures(places.size());
  parallel_for(places.size(), [&](std::size_t k) {
    try {
      source.read(frames.at(places[k].index), pictures[k]);
    } catch (const Error&) {
      pictures[k].reset(0, 0, 8);
    }
  });
  BothAxes both;
  const auto along = [&](bool x) {
    Steps steps((x ? info.width : info.height) - 1);
    for (std::size_t k = 0; k < places.size(); ++k) {
      Circle disc = places[k].disc;
      disc.cx_px += roi.x, disc.cy_px += roi.y;
      if (pictures[k].width() > 0) collect(pictures[k], disc, x, static_cast<int>(k % 2), steps);
    }
    return pattern_of(steps, plain, kLeastRms / 255 * static_cast<double>((1u << info.bits) - 1));
  };
  if (columns) both.columns = along(true);
  if (rows) both.rows = along(false);
  return both;
}

double extent(const circle::BallCandidate& ball, double Circle::*centre) {
  const auto at = [&](const circle::BallCandidate::Sighting& one) {
    return one.ball.circle.*centre;
  };
  const auto [least, most] = std::ranges::minmax_element(ball.sightings, {}, at);
  return at(*most) - at(*least);
}

}  // namespace

std::optional<SensorLines> sensor_lines(FrameSource& source, const FrameRange& frames,
                                        const Roi& roi, const circle::BallCandidate& ball) {
  if (ball.sightings.size() < kLeastSightings) return std::nullopt;
  const bool across = extent(ball, &Circle::cx_px) > kLeastMovedPx;
  const bool down = extent(ball, &Circle::cy_px) > kLeastMovedPx;
  if (!across && !down) return std::nullopt;
  const double disc_px = kPi * kInside * kInside * ball.radius_px * ball.radius_px;
  const int few = static_cast<int>(std::min<double>(kFrames, kFirstPx / disc_px));
  const BothAxes first =
      look_at(source, frames, roi, discs_on(ball, few), kWorthALook, across, down);
  if (!first.columns && !first.rows) return std::nullopt;
  BothAxes more = look_at(source, frames, roi, discs_on(ball, kFrames), kPlain,
                          first.columns.has_value(), first.rows.has_value());
  SensorLines lines;
  const double by = 255.0 / static_cast<double>((1u << source.info().bits) - 1);
  if (more.columns) {
    lines.columns_rms = by * rms(more.columns->offset);
    lines.pattern.columns = std::move(*more.columns);
  }
  if (more.rows) {
    lines.rows_rms = by * rms(more.rows->offset);
    lines.pattern.rows = std::move(*more.rows);
  }
  if (lines.columns_rms == 0 && lines.rows_rms == 0) return std::nullopt;
  return lines;
}

}  // namespace impactdic::advice
