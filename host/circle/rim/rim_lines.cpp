// From lines across the rim to profiles: shares of the local contrast.
#include "host/circle/rim/rim_lines.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/circle/rim/rim_cast.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/rim/rim_texture.h"
#include "host/circle/settings/levels.h"
#include "host/circle/sphere/sphere_lines.h"

namespace impactdic::circle {
namespace {

// Windows of the ball's inside at one line, from the innermost of its deep samples to the innermost
// of its profile.
void add_texture(const CastLines& lines, std::size_t deep_line, float ground, float noise,
                 const LineTrace::Levels& levels, TextureSums& texture) {
  const Lanes& deep = lines.deep_level[deep_line].v;
  const float paint = light_at(levels.light, lines.deep_x[deep_line], lines.deep_y[deep_line]);
  const float per = 1 / (paint - ground);
  float b[kDeep];
  for (int k = 0; k < kDeep; ++k) b[k] = (deep[kDeep - 1 - k] - ground) * per;
  for (int k = 0; k + kTexture <= kDeep; ++k) texture.add(b + k, noise);
}

// Keeps the lines that show background outside and ball inside, as shares of their contrast.
// `grounds`: the background at each line.
IMPACTDIC_WIDE void keep_clear_lines(const CastLines& lines, const std::vector<float>& grounds,
                                     TextureSums* texture, LineTrace& trace) {
  const LineTrace::Levels& levels = trace.levels;
  const float noise = levels.noise, usual = levels.usual;
  const int n = lines.size();
  constexpr int kBeside = kClear.beside;
  thread_local std::vector<int> kept;  // number of each line kept; memory only
  kept.resize(static_cast<std::size_t>(n));
  RimLines& out = trace.lines;
  out.make_room(static_cast<std::size_t>(n));
  int count = 0;
  int blocked = -kBeside - 1;  // the last line with something else outside
  const int gap = static_cast<int>(kClear.gap_of_rim * static_cast<float>(lines.cast));
  int shown = -1;  // the last line with ball inside, or something else outside
  std::size_t next_deep = 0;
  for (int i = 0; i < n; ++i) {
    const Profile& level = lines.level[i].v;
    const float ground = grounds[i];
    const float contrast = light_at(levels.light, lines.cos[i], lines.sin[i]) - ground;
    if (!is_clear(contrast, usual, level[kSamples - 1], ground, noise)) {
      trace.breaks += i - blocked > kBeside;
      blocked = shown = i;
      while (count > 0 && kept[count - 1] >= i - kBeside) --count;
      continue;
    }
    if (i - blocked <= kBeside) continue;
    // Ink, or an obstacle across the rim.
    const float inside = std::max({level[0], level[1], level[2]}) - ground;
    if (inside < std::max(kClear.nothing * contrast, kClear.nothing_noise * noise)) continue;
    // Longer than ink makes: an obstacle as bright as the background, whose blurred edge, and the
    // ball's, is no rim.
    const bool hidden = shown >= 0 && i - shown > gap;
    if (hidden) {
      while (count > 0 && kept[count - 1] > shown - kClear.beside_hidden) --count;
      blocked = i + kClear.beside_hidden - kBeside - 1;
    }
    shown = i;
    if (hidden) continue;
    const float relative = contrast / usual;
    out.profile[count].v = (level - ground) * (1 / contrast);
    out.profile[count].v[kSamples] = 0;
    out.cos[count] = lines.cos[i];
    out.sin[count] = lines.sin[i];
    out.weight[count] = relative * relative;
    out.sector[count] = lines.sector(i, kRimSectors);
    kept[count++] = i;
    if (texture == nullptr) continue;
    out.log_scale[count - 1] = static_cast<float>(kSamples) * std::log(contrast);
    const std::size_t deeps = lines.deep_line.size();
    while (next_deep < deeps && lines.deep_line[next_deep] < i) ++next_deep;
    if (next_deep < deeps && lines.deep_line[next_deep] == i) {
      const float line_noise = static_cast<float>(trace.noise) / relative;
      add_texture(lines, next_deep, ground, line_noise, levels, *texture);
    }
  }
  out.keep(static_cast<std::size_t>(count));
}

}  // namespace

void grounds_at(const CastLines& lines, const std::array<float, kLevelSectors>& levels,
                float contrast, std::vector<float>& out) {
  constexpr int kQuarter = kLevelSectors / 4;
  const int n = lines.size();
  out.resize(static_cast<std::size_t>(n));
  for (int b = -1, i = 0; i < n; ++b) {
    const float a = levels[b < 0 ? kLevelSectors - 1 : b];
    const float c = levels[b + 1 < kLevelSectors ? b + 1 : 0];
    const float from = static_cast<float>(b) + 0.5f, to = from + 1;
    for (; i < n && lines.turn[i] * kQuarter < to; ++i) {
      const float t = lines.turn[i] * kQuarter - from;
      out[i] = ground_between(a, c, t, lines.level[i].v[kSamples - 1], contrast);
    }
  }
}

void RimLines::make_room(std::size_t lines) {
  const std::size_t room = lines + kLanes;
  profile.resize(room);
  cos.resize(room);
  sin.resize(room);
  weight.resize(room);
  sector.resize(room);
  log_scale.resize(room);
}

void RimLines::keep(std::size_t lines) {
  size_ = lines;
  for (std::size_t i = lines; lines > 0 && i % kLanes != 0; ++i) {
    profile[i] = profile[lines - 1];
    cos[i] = cos[lines - 1];
    sin[i] = sin[lines - 1];
    weight[i] = weight[lines - 1];
    sector[i] = sector[lines - 1];
  }
}

void trace_lines(const Frame& frame, const Rim& rim, const LineRequest& request, LineTrace& trace) {
  thread_local CastLines lines;            // memory only
  thread_local std::vector<float> ground;  // memory only
  const bool anew = request.levels == LineRequest::Levels::kFoundAnew;
  // A texture wants all that it can get, the light a hundred lines or two.
  const bool many = request.most_lines > kLine.deep_all_up_to;
  const bool sphere = request.surface != Surface::kFlat;
  const int deep_every = sphere ? 0 : request.texture ? 1 : !anew ? 0 : many ? kLine.deep_every : 1;
  cast_lines(frame, rim, {request.polarity, request.step_px, request.most_lines, deep_every},
             lines);
  trace.cast = lines.cast;
  trace.breaks = 0;
  trace.in_view = lines.size();
  trace.step_px = request.step_px;
  const auto find = [&] {
    return sphere ? find_sphere_levels(frame, rim, request, lines, trace.levels)
                  : find_levels(lines, trace.levels);
  };
  if (lines.size() < kLine.least_lines || (anew && !find())) {
    trace.lines.keep(0);
    return;
  }
  const LineTrace::Levels& levels = trace.levels;
  trace.noise = std::max(levels.noise / levels.usual, kLine.least_noise);
  grounds_at(lines, levels.ground, levels.usual, ground);
  if (!sphere) {
    keep_clear_lines(lines, ground, request.texture, trace);
    return;
  }
  if (request.surface == Surface::kOutline) {
    keep_outline_lines(lines, ground, trace);
  } else {
    keep_clear_sphere_lines(lines, ground, rim, request, trace);
  }
  if (request.texture) add_sphere_texture(frame, rim, request, trace);
}

// The sum over a line is what the ball's mean level makes of its length inside the rim, wherever
// the ink is.
Rim rim_by_area(const LineTrace& trace, const Rim& rim) {
  const RimLines& lines = trace.lines;
  double inside = 0;
  for (std::size_t i = 0; i < lines.size(); ++i)
    inside += lines.profile[i].v[0] + lines.profile[i].v[1];
  const double per_level = 2.0 * static_cast<double>(lines.size()) / std::max(inside, 1e-3);
  Eigen::Matrix3d a = Eigen::Matrix3d::Identity() * 1e-6;
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    double sum = 0;
    for (int k = 0; k < kSamples; ++k) sum += lines.profile[i].v[k];
    const Eigen::Vector3d j{lines.cos[i], lines.sin[i], 1};
    a.noalias() += j * j.transpose();
    b.noalias() += (sum * per_level - kInside - 0.5) * trace.step_px * j;
  }
  const Eigen::Vector3d move = a.ldlt().solve(b);
  return {rim.cx + move[0], rim.cy + move[1], rim.r + move[2], rim.e1, rim.e2};
}

}  // namespace impactdic::circle
