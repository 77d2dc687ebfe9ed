// The rigid motion of a region between two pictures without any guess: for what moved or turned
// farther than windows are searched.
#pragma once

#include <memory>

#include "host/clip/roi.h"
#include "host/dic/correlator.h"
#include "host/dic/rigid_fit.h"

namespace impactdic::motion {

class CoarseSearch {
 public:
  // `engine` must outlive the search. Compiles nothing before the first `find`.
  CoarseSearch(opencl::Engine& engine, const FieldOptions& options);

  // Motion of the region's centre: every angle, displacements up to 32 px (or the search distance
  // of the options, where that is larger). A few large windows about the centre are turned in steps
  // that leave them recognisable and looked for by ZNCC; the angle at which most of them are found
  // and agree is the one. To about 0.1 px and 1°; not ok where none stands out. The caller refines.
  dic::RigidMotion find(const Frame& first, const Frame& second, const Roi& region);

 private:
  opencl::Engine& engine_;
  FieldOptions options_;
  std::unique_ptr<dic::Correlator> correlator_;
  int window_px_ = 0;
};

}  // namespace impactdic::motion
