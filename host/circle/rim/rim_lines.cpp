// From lines across the rim to profiles: shares of the local contrast.
#include "host/circle/rim/rim_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/circle/rim/rim_cast.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/rim/rim_model.h"

namespace impactdic::circle {
namespace {

constexpr int kSectors = LineTrace::Levels::kSectors;
constexpr int kDeepEvery = 4;  // lines from one that reaches deep to the next, where many are cast
constexpr int kBeside = 3;     // lines beside one with an obstacle that the obstacle's blur reaches
constexpr float kLeastContrast = 0.2f;  // of the usual contrast

// The background at lines from their outermost samples: linear between the middles of the sectors,
// or where an obstacle ends between them the nearer of the two.
void grounds_at(const CastLines& lines, const std::array<float, kSectors>& levels, float contrast,
                std::vector<float>& out) {
  const int n = lines.size();
  out.resize(static_cast<std::size_t>(n));
  for (int b = -1, i = 0; i < n; ++b) {
    const float a = levels[b < 0 ? kSectors - 1 : b], c = levels[b + 1 < kSectors ? b + 1 : 0];
    const bool alike = std::abs(a - c) < kGroundTolerance * contrast;
    const float from = static_cast<float>(b) + 0.5f, to = from + 1;
    for (; i < n && lines.turn[i] * (kSectors / 4) < to; ++i) {
      const float seen = lines.level[i].v[kSamples - 1];
      out[i] = alike ? a + (lines.turn[i] * (kSectors / 4) - from) * (c - a)
               : std::abs(seen - a) < std::abs(seen - c) ? a
                                                         : c;
    }
  }
}

}  // namespace

void RimLines::make_room(std::size_t lines) {
  const std::size_t room = lines + kLanes;
  profile.resize(room);
  cos.resize(room);
  sin.resize(room);
  weight.resize(room);
  sector.resize(room);
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

IMPACTDIC_WIDE void trace_lines(const Frame& frame, const Rim& rim, bool bright, double step_px,
                                int most_lines, const LineWants& wants, LineTrace& trace) {
  thread_local CastLines lines;  // memory only
  // A texture wants all that it can get, the light a hundred lines or two.
  const int deep_every = wants.texture ? 1 : !wants.levels ? 0 : most_lines > 400 ? kDeepEvery : 1;
  cast_lines(frame, rim, bright, {step_px, most_lines, deep_every}, lines);
  trace.cast = lines.cast;
  trace.in_view = lines.size();
  trace.step_px = step_px;
  if (lines.size() < 16 || (wants.levels && !find_levels(lines, trace.levels))) {
    trace.lines.keep(0);
    return;
  }
  const float noise = trace.levels.noise;
  const auto& light = trace.levels.light;
  const float usual = trace.levels.usual;
  trace.noise = std::max(noise / usual, 0.003f);

  const int n = lines.size();
  thread_local std::vector<float> ground;  // memory only
  thread_local std::vector<int> kept;      // number of each line kept
  grounds_at(lines, trace.levels.ground, usual, ground);
  kept.resize(static_cast<std::size_t>(n));
  RimLines& out = trace.lines;
  out.make_room(static_cast<std::size_t>(n));
  int count = 0;
  int blocked = -kBeside - 1;  // the last line with something else outside
  std::size_t next_deep = 0;
  for (int i = 0; i < n; ++i) {
    const Profile& level = lines.level[i].v;
    const float seen = level[kSamples - 1];
    const float ball = light_at(light, lines.cos[i], lines.sin[i]);
    const float outside = ground[i], contrast = ball - outside;
    const bool clear = contrast > kLeastContrast * usual && contrast > 6 * noise &&
                       std::abs(seen - outside) < kGroundTolerance * contrast + 4 * noise;
    if (!clear) {
      blocked = i;
      while (count > 0 && kept[count - 1] >= i - kBeside) --count;
      continue;
    }
    if (i - blocked <= kBeside) continue;
    // Ink, or an obstacle across the rim.
    const float inside = std::max({level[0], level[1], level[2]}) - outside;
    if (inside < std::max(kNothing * contrast, 5 * noise)) continue;
    out.profile[count].v = (level - outside) * (1 / contrast);
    out.profile[count].v[kSamples] = 0;
    const float relative = contrast / usual;
    out.cos[count] = lines.cos[i];
    out.sin[count] = lines.sin[i];
    out.weight[count] = relative * relative;
    out.sector[count] = lines.sector(i, kRimSectors);
    kept[count++] = i;
    if (!wants.texture) continue;
    const std::size_t deeps = lines.deep_line.size();
    while (next_deep < deeps && lines.deep_line[next_deep] < i) ++next_deep;
    if (next_deep < deeps && lines.deep_line[next_deep] == i) {
      // From the innermost of the deep samples to the innermost of the profile.
      const Lanes& deep = lines.deep_level[next_deep].v;
      const float per =
          1 / (light_at(light, lines.deep_x[next_deep], lines.deep_y[next_deep]) - outside);
      float b[kDeep];
      for (int k = 0; k < kDeep; ++k) b[k] = (deep[kDeep - 1 - k] - outside) * per;
      for (int k = 0; k + kTexture <= kDeep; ++k) {
        wants.texture->add(b + k, static_cast<float>(trace.noise) / relative);
      }
    }
  }
  out.keep(static_cast<std::size_t>(count));
}

}  // namespace impactdic::circle
