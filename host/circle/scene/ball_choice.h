// Which of several balls is followed. Internal to host/circle.
#pragma once

#include <impactdic/circle.h>

#include <cstdint>
#include <map>
#include <vector>

namespace impactdic::circle {

// Where each ball was seen, in some frames spread over the clip.
class BallChoice {
 public:
  using Places = std::map<std::int64_t, Circle>;  // by the frame among those of the range
  // Neither is empty.
  BallChoice(Places own, std::vector<Places> others)
      : own_(std::move(own)), others_(std::move(others)) {}

  // Whether a circle of frame `index` is another ball: nearer to where that was about this frame
  // than to where the chosen one was, the radius counted like a distance.
  bool is_another(std::int64_t index, const Circle& circle) const;

 private:
  Places own_;
  std::vector<Places> others_;
};

}  // namespace impactdic::circle
