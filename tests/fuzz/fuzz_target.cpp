#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <cstring>

#include "host/camera/calibrate/find_target.h"

namespace impactdic::fuzz {

constexpr int kWidth = 48, kHeight = 36;

void find_target(const std::string& text) {
  if (text.empty()) return;
  CalibrateRequest request;
  const auto kind = static_cast<unsigned char>(text[0]);
  request.target = kind % 3 == 0   ? CalibrationTarget::kCheckerboard
                   : kind % 3 == 1 ? CalibrationTarget::kCharuco
                                   : CalibrationTarget::kDots;
  request.columns = 3 + kind / 3 % 4;
  request.rows = 4;
  request.pitch_mm = 10;
  Frame frame;
  frame.reset(kWidth, kHeight, 8);
  std::memcpy(frame.u8.data(), text.data() + 1,
              std::min(text.size() - 1, static_cast<std::size_t>(kWidth * kHeight)));
  camera::find_target(camera::to_grey(frame), request);
}

}  // namespace impactdic::fuzz
