// Whether flights bend as a lens bends them.
#pragma once

#include <impactdic/track.h>

#include <optional>

#include "host/clip/track_rows.h"

namespace impactdic::run {

struct LensBend {
  Measured corner;         // share by which the lens moves the picture's corners outwards
  double largest_px = 0;   // of what it does to a centre in the flights
  double speed_share = 0;  // largest change of the speed within the flights, of the speed
};

// Gravity as the picture shows it, px/frame^2, y down.
struct FallInPicture {
  double x = 0, y = 0;
};

// From the motions of the flights, or their centres where there are none, in `rows` (as
// ImpactAnalysis counts them): a straight path of steady acceleration, through a lens whose
// distortion grows with the square of the distance from the picture's middle (the first term of
// Brown 1971). nullopt where the flights do not tell: where no lens bends like that, or where the
// path may turn by itself, as a ball on a string does. A path that falls as `gravity` says is free.
std::optional<LensBend> bend_of_flights(const TrackRows& rows, const ImpactAnalysis& analysis,
                                        int width, int height,
                                        const std::optional<FallInPicture>& gravity = {});

// A warning where a bend is there beyond chance and matters; "" elsewhere. `corrected`: the rows
// went through a calibrated camera.
std::string lens_warning(const std::optional<LensBend>& bend, bool corrected);

// By the ball's outline: the share by which the lens moves the picture's corners, where the radius
// changes with the place in the picture; away from the middle a lens of share k makes it larger by
// 2k times the square of the distance. 1/r of a ball that comes nearer is straight in time. nullopt
// where there is no flight, or too little of it.
std::optional<Measured> corner_by_outline(const TrackRows& rows, const ImpactAnalysis& analysis,
                                          int width, int height);

// A warning where the outline shows a lens beyond chance; "" elsewhere, and where a sphere that is
// seen from as near as three picture widths looks like that, too: larger away from the axis.
std::string outline_warning(const std::optional<Measured>& corner, int width, int height,
                            bool corrected);

}  // namespace impactdic::run
