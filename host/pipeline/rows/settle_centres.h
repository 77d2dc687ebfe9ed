// What the centres of frames that follow each other state, once they are compared.
#pragma once

#include <span>
#include <vector>

#include "host/clip/centre_on_body.h"
#include "host/clip/track_row.h"
#include "host/motion/motion_estimator.h"

namespace impactdic::pipeline {

// By what circles and motions say of each other (compare_rows.h, place_by_path.h), and circles of
// each other. `pairs[i]` leads from row i to the next; `placed`: motions are so well known that
// they may place a centre; `centre`: where circles before these rows have it on the body. Returns
// which rows' centres, or what they state, are others now: what their motions state is yet to
// follow.
std::vector<bool> settle_centres(std::span<TrackRow> rows, std::span<motion::PairMotion> pairs,
                                 bool placed, const CentreOnBody& centre);

}  // namespace impactdic::pipeline
