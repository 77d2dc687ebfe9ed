#include "host/video/levels/linear_light.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/base/parse.h"

namespace impactdic::video {
namespace {

constexpr int kBits = 16;
constexpr double kFull = (1 << kBits) - 1;

template <typename T>
void turn(const Image<T>& coded, const std::vector<std::uint16_t>& light,
          Image<std::uint16_t>& to) {
  const std::size_t last = light.size() - 1;
  std::transform(coded.data(), coded.data() + coded.size(), to.data(),
                 [&](T level) { return light[std::min<std::size_t>(level, last)]; });
}

class LinearLight : public FrameSource {
 public:
  LinearLight(std::unique_ptr<FrameSource> source, double gamma)
      : source_(std::move(source)), info_(source_->info()) {
    const double most = static_cast<double>((1u << info_.bits) - 1);
    for (double level = 0; level <= most; ++level) {
      light_.push_back(
          static_cast<std::uint16_t>(std::lround(kFull * std::pow(level / most, gamma))));
    }
    info_.bits = kBits;
    info_.extra.emplace_back("grey levels", "turned back to light, gamma " + shortest(gamma));
  }

  const ClipInfo& info() const override { return info_; }
  void read(std::int64_t index, Frame& frame) override {
    thread_local Frame coded;  // memory only
    source_->read(index, coded);
    frame.reset(coded.width(), coded.height(), kBits);
    if (coded.type == PixelType::kU8) {
      turn(coded.u8, light_, frame.u16);
    } else {
      turn(coded.u16, light_, frame.u16);
    }
  }
  std::optional<double> frame_time_s(std::int64_t index) override {
    return source_->frame_time_s(index);
  }
  std::optional<double> frame_exposure_s(std::int64_t index) override {
    return source_->frame_exposure_s(index);
  }

 private:
  std::unique_ptr<FrameSource> source_;
  ClipInfo info_;
  std::vector<std::uint16_t> light_;  // of each grey level
};

}  // namespace

std::unique_ptr<FrameSource> in_linear_light(std::unique_ptr<FrameSource> source, double gamma) {
  constexpr double kLeast = 0.2, kMost = 5;
  if (!(gamma >= kLeast && gamma <= kMost)) {
    throw InvalidArgument("must lie within 0.2 and 5, not " + shortest(gamma), "--gamma",
                          "2.2 is usual for film, 1 for high-speed cameras");
  }
  return std::make_unique<LinearLight>(std::move(source), gamma);
}

}  // namespace impactdic::video
