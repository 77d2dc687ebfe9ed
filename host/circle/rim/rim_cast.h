// Grey levels along lines across a rim. Internal to host/circle; rim_lines makes shares of the
// contrast of them.
#pragma once

#include <array>
#include <vector>

#include "host/circle/rim/rim_lines.h"
#include "kernels/rim/rim.h"

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
struct PictureSize {
  int width, height;
  int pitch;  // elements from a row to the next one
};
// The lines of a rim, a quarter after the other. `cast` gets how many there are, in the picture or
// not; a quarter holds those that begin in it.
std::array<RimQuarter, 4> quarters_of(const PictureSize& picture, const Rim& rim,
                                      const Casting& how, int& cast);
// From a deep sample to the next one.
float deep_step_px(const Rim& rim, const Casting& how);
// `lines` keeps its memory from call to call.
void cast_lines(const Frame& frame, const Rim& rim, const Casting& how, CastLines& lines);

}  // namespace impactdic::circle
