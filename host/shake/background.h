// Where the still background lies in a picture, against a picture of reference.
#pragma once

#include <impactdic/image.h>
#include <impactdic/track.h>

#include <cstddef>
#include <memory>

namespace impactdic::shake {

// What of a picture is not background: the ball. r_px 0: none is seen.
struct Disc {
  double x_px = 0, y_px = 0, r_px = 0;
};

// Squares of the reference that show texture. A picture is registered on them: two translations
// and a roll, by inverse-compositional Gauss-Newton (Baker and Matthews, 2004) on smoothed grey
// levels, each square with a level and a contrast of its own. What moves by itself, as a hand
// does, is left out by Tukey's weights of whole squares.
class Background {
 public:
  // `ball`: where the reference shows it.
  Background(const Frame& reference, const Disc& ball);
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  // Whether it has texture enough for anything to be told.
  bool shows_texture() const;

  // Where the background lies in `frame`, looked for about `guess` and then everywhere. Not `known`
  // where fewer than half of the squares agree. May be called from several threads at once.
  PictureShift locate(const Frame& frame, const Disc& ball, const PictureShift& guess) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace impactdic::shake
