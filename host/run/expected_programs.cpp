#include "host/run/expected_programs.h"

#include <utility>

#include "host/motion/expected_programs.h"

namespace impactdic::run {

Session::Impl::Expects expected_programs(const TrackRequest& request,
                                         std::shared_future<PixelType> depth) {
  if (!request.with_field) return nullptr;
  motion::EstimatorOptions options;
  options.estimator = request.estimator;
  options.field = request.field;
  options.sphere = request.body == Body::kSphere;
  const bool any_body = request.body != Body::kDisc;
  return [options, any_body, depth = std::move(depth)](const opencl::Engine& engine) {
    return motion::expected_programs(engine, options, depth.get(), any_body);
  };
}

Session::Impl::Expects expected_programs(const TrackRequest& request) {
  std::promise<PixelType> usual;
  usual.set_value(PixelType::kU8);
  return expected_programs(request, usual.get_future().share());
}

}  // namespace impactdic::run
