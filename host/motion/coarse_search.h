// The rigid motion of a region between two pictures without any guess: for what moved or turned
// farther than windows are searched.
#pragma once

#include <memory>
#include <vector>

#include "host/clip/roi.h"
#include "host/dic/correlator.h"
#include "host/dic/rigid_fit.h"

namespace impactdic::motion {

// Whether two motions of a region are not the same one, found to about so much as above: they carry
// a point `reach_px` from its centre to places far apart.
bool are_apart(const dic::RigidMotion& a, const dic::RigidMotion& b, double reach_px);

class CoarseSearch {
 public:
  // `engine` must outlive the search. Compiles nothing before the first `find`.
  CoarseSearch(opencl::Engine& engine, const FieldOptions& options);

  // Motion of the region's centre: every angle, displacements up to 32 px (or the search distance
  // of the options, where that is larger). A few large windows about the centre are turned in steps
  // that leave them recognisable and looked for by ZNCC; the angle at which most of them are found
  // and agree is the best one. To about 0.1 px and 1°; none where nothing stands out. Parts that
  // look alike fit at several angles: up to three motions, the best first. The caller refines.
  std::vector<dic::RigidMotion> find(const Frame& first, const Frame& second, const Roi& region);

 private:
  opencl::Engine& engine_;
  FieldOptions options_;
  std::unique_ptr<dic::Correlator> correlator_;
  int window_px_ = 0;
};

}  // namespace impactdic::motion
