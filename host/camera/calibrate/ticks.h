// The ticks of a ruler in one picture.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace impactdic::camera {

struct Tick {
  int number = 0;  // from the first one on; those that are not seen are left out
  Eigen::Vector2d at_px;
  double off_px = 0;  // along the ruler, from an even scale
};

// An even row of ticks: straight lines across the ruler, dark on bright or bright on dark, all of
// one pitch; longer ones among them do not matter.
struct TickRow {
  std::vector<Tick> ticks;
  double pitch_px = 0;     // along the ruler
  double pitch_sd_px = 0;  // by the ticks' scatter
  double scatter_px = 0;   // of a tick about the even scale
  // By how much the pitch at one end exceeds that at the other, with its deviation: a ruler that
  // leans, or a lens that bends.
  double growth = 0, growth_sd = 0;
};

// The row with the most ticks; nullopt where none has eight. `picture`: 8 bits.
std::optional<TickRow> find_ticks(const cv::Mat& picture);

}  // namespace impactdic::camera
