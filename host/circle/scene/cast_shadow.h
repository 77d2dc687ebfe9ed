// A ball's shadow on a wall behind it: as round and as large as the ball, and it moves along.
// Internal to host/circle.
#pragma once

#include <impactdic/circle.h>

#include <optional>

#include "host/video/frame_source.h"

namespace impactdic::circle {

// The circle of the thing that lies before a round shadow, by the edge of what the thing leaves of
// it: a belt under the shadow's rim that is flat and darker than what is about it. nullopt where
// the circle is no such shadow.
std::optional<Circle> what_casts(const Frame& frame, const Circle& shadow);

// Whether one circle may be the shadow and the other what casts it, by place and size.
bool may_cast(const Circle& thing, const Circle& shadow);

// Whether a disc is darker than what is about it and has one level but at its rim, as a shadow has
// and no speckled ball, where a thing does not lie before it. nullptr: it may be covered in part.
bool is_flat_dark(const Frame& frame, const Circle& disc, const Circle* before);

// Whether the thing's rim is plain where it lies beside the shadow: what is a part of another ball
// (its unlit side, dark paint) has none there.
bool shows_beside(const Frame& frame, const Circle& thing, const Circle& shadow);

}  // namespace impactdic::circle
