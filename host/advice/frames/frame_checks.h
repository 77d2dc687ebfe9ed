// What may be wrong with frames: over-exposed, blurred, interlaced, turning too fast.
#pragma once

#include <optional>

#include "host/circle/circle.h"
#include "host/clip/roi.h"

namespace impactdic::advice {

// Share of the pixels of the rectangle, or of the ball where one is given, at the highest grey
// level that the file can hold.
double saturated_share(const Frame& frame, const Roi& region, const std::optional<Circle>& ball);

// Of the whole picture: rms, grey levels of 255.
double contrast_of(const Frame& frame);

// How many pixels the ball's edge takes from 10 to 90 % of its step, along the axis where it is
// widest: the lower quartile of rays on which neither ink nor anything behind disturbs it plainly.
// A sharp lens gives about 2. nullopt where there are too few such rays.
std::optional<double> edge_width_px(const Frame& frame, const Circle& ball);

// Whether the frame is woven from two fields of different times: what moves lies elsewhere in odd
// rows than in even ones.
bool is_interlaced(const Frame& frame, const Roi& region);

// Whether it was enlarged by showing pixels twice: columns differ from those beside as rows do.
bool repeats_pixels(const Frame& frame, const Roi& region);

// How far the ball turned between two frames, either way, to about half a degree: rings about the
// centres, compared along the angle. nullopt where they do not resemble each other.
std::optional<double> turn_between_deg(const Frame& first, const Circle& first_ball,
                                       const Frame& second, const Circle& second_ball);

// How far the rectangle's content moved between two frames, px, to about one, by the phase of the
// spectra; nullopt where nothing stands out.
std::optional<double> shift_between_px(const Frame& first, const Frame& second, const Roi& region);

}  // namespace impactdic::advice
