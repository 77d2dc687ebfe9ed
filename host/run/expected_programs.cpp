#include "host/run/expected_programs.h"

#include <utility>

#include "host/motion/expected_programs.h"

namespace impactdic::run {

Session::Impl::Expects expected_programs(const TrackRequest& request,
                                         std::shared_future<ClipInfo> clip) {
  if (!request.with_field) return nullptr;
  motion::EstimatorOptions options;
  options.estimator = request.estimator;
  options.field = request.field;
  options.sphere = request.body == Body::kSphere;
  const bool any_body = request.body != Body::kDisc;
  return [options, any_body, clip = std::move(clip)](const opencl::Engine& engine) {
    const ClipInfo& info = clip.get();
    const PixelType type = info.bits > 8 ? PixelType::kU16 : PixelType::kU8;
    return motion::expected_programs(engine, options, {type, info.frame_count, any_body});
  };
}

Session::Impl::Expects expected_programs(const TrackRequest& request) {
  std::promise<ClipInfo> usual;
  usual.set_value({});
  return expected_programs(request, usual.get_future().share());
}

}  // namespace impactdic::run
