// Rows as a camera that stands still would have them.
#pragma once

#include <impactdic/track.h>

#include <cstddef>

#include "host/clip/track_rows.h"

namespace impactdic {

// The row `i`, `seen` in the picture: circle, motion and pose against the background, and
// deviations with those of where it lies. Where that is not known the row has no circle and no
// motion.
TrackRow steadied(const TrackRow& seen, std::size_t i, const CameraMotion& motion);

// All rows so. What `rows` were made from, and `motion`, must outlive the object.
class SteadyRows final : public RowSource {
 public:
  SteadyRows(const TrackRows& rows, const CameraMotion& motion) : rows_(rows), motion_(motion) {}
  std::size_t size() const override { return rows_.size(); }
  TrackRow row(std::size_t i) const override { return steadied(rows_[i], i, motion_); }

 private:
  TrackRows rows_;
  const CameraMotion& motion_;
};

}  // namespace impactdic
