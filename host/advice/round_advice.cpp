#include "host/advice/round_advice.h"

#include <impactdic/error.h>

#include <cstdio>

#include "host/advice/clip_advice.h"
#include "host/motion/round/round_turn.h"

namespace impactdic::advice {
namespace {

// The outline of a ball does not change by as much, share of its radius, nor is it as much longer
// than broad where it is compressed or blurred by its motion. [hand]
constexpr double kChange = 0.02, kStretch = 1.05;
constexpr std::int64_t kPairs = 3;

Frame read_frame(FrameSource& source, const FrameRange& frames, const Roi& roi,
                 std::int64_t index) {
  Frame whole, frame;
  try {
    source.read(frames.at(index), whole);
  } catch (const Error&) {
    return {};  // the run itself will say so
  }
  crop(whole, roi, frame);
  return frame;
}

// A look at three frames, before many are read.
bool may_show_silhouette(const motion::RoundBody::ReadFrame& read, std::int64_t count) {
  int shown = 0;
  for (const std::int64_t index : {std::int64_t{0}, count / 2, count - 1}) {
    shown += circle::find_silhouette(read(index)).has_value();
  }
  return shown >= 2;
}

// Whether the turn of most of some pairs of neighbouring frames is told.
bool turns_are_told(opencl::Engine& engine, const motion::RoundBody& body,
                    const motion::RoundBody::ReadFrame& read, std::int64_t count) {
  motion::RoundTurn turn(engine, body.round());
  std::int64_t told = 0, tried = 0;
  for (std::int64_t k = 0; k < kPairs; ++k) {
    const std::int64_t index = k * (count - 2) / (kPairs - 1);
    const Frame first = read(index), second = read(index + 1);
    const auto before = circle::find_silhouette(first), after = circle::find_silhouette(second);
    ++tried;
    if (!before || !after) continue;
    const motion::RoundView one = motion::round_view(first, *before, body.round());
    const motion::RoundView other = motion::round_view(second, *after, body.round());
    const motion::RoundView light = body.light_beside(index, index + 1);
    told += turn.measure(one, other, light, {}).ok || turn.measure(one, other, {}, {}).ok;
  }
  return 2 * told > tried;
}

}  // namespace

std::optional<motion::RoundBody> find_round_body(opencl::Engine& engine, FrameSource& source,
                                                 const FrameRange& frames, const Roi& roi) {
  const std::int64_t count = last_looked_at(source, frames) + 1;
  if (count < 2) return std::nullopt;
  const auto read = [&](std::int64_t index) { return read_frame(source, frames, roi, index); };
  if (!may_show_silhouette(read, count)) return std::nullopt;
  auto body = motion::RoundBody::learn(read, count);
  if (!body || body->change() < kChange || body->stretch() < kStretch) return std::nullopt;
  if (!turns_are_told(engine, *body, read, count)) return std::nullopt;
  return body;
}

std::string round_body_in_words(const motion::RoundBody& body) {
  char text[200];
  std::snprintf(text, sizeof text,
                "no sphere: its outlines are ellipses, their semi-axes up to %.2f times each "
                "other; turns out of the picture's plane are known to %.0f %%",
                body.stretch(), 100 * body.depth_sd());
  return text;
}

}  // namespace impactdic::advice
