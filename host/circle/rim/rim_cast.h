// Grey levels along lines across a rim. Internal to host/circle; rim_lines makes shares of the
// contrast of them.
#pragma once

#include <vector>

#include "host/circle/rim/rim_lines.h"

namespace impactdic::circle {

inline constexpr int kDeep = 8;  // further samples of a deep line, 4, 5 … 11 steps inside

// The lines that lie in the picture, in the order of the angle from −45° on. Grey levels have the
// sign that makes every ball bright.
struct CastLines {
  int cast = 0;  // in the picture or not
  // One a line, with room for a few more.
  std::vector<float> cos, sin;  // direction of a line's point on the rim
  std::vector<float> turn;      // 0 … 4 − ε around the rim in that order, one a quarter
  std::vector<Eight> level;     // kSamples of them
  // Some of the lines reach deep.
  std::vector<int> deep_line;
  std::vector<float> deep_x, deep_y;  // place of the middle, in radii from the centre
  std::vector<Eight> deep_level;

  int size() const { return static_cast<int>(level.size()); }
  void resize(int lines);  // but for the deep ones
  // Which of `of` equal sectors a line lies in.
  int sector(int line, int of) const {
    return static_cast<int>(turn[line] * (0.25f * static_cast<float>(of)));
  }
};

struct Casting {
  Polarity polarity;
  double step_px;
  int most_lines;
  int deep_every;  // lines from one that reaches deep to the next; 0: none does
};
// `lines` keeps its memory from call to call.
void cast_lines(const Frame& frame, const Rim& rim, const Casting& how, CastLines& lines);

}  // namespace impactdic::circle
