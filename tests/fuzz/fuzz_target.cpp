#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <cstring>

#include "host/camera/calibrate/calibrate_points.h"
#include "host/camera/calibrate/find_target.h"

namespace impactdic::fuzz {

constexpr int kWidth = 48, kHeight = 36;

void find_target(const std::string& text) {
  if (text.empty()) return;
  CalibrateRequest request;
  const auto kind = static_cast<unsigned char>(text[0]);
  constexpr CalibrationTarget kTargets[] = {CalibrationTarget::kCheckerboard,
                                            CalibrationTarget::kCharuco, CalibrationTarget::kDots,
                                            CalibrationTarget::kRuler};
  request.pictures = {"a"};
  request.target = kTargets[kind % 4];
  request.columns = 3 + kind / 4 % 4;
  request.rows = 4;
  request.pitch_mm = 10;
  request.validate();
  Frame frame;
  frame.reset(kWidth, kHeight, 8);
  std::memcpy(frame.u8.data(), text.data() + 1,
              std::min(text.size() - 1, static_cast<std::size_t>(kWidth * kHeight)));
  if (request.target == CalibrationTarget::kRuler) {
    camera::calibrate_ticks(request, "a", camera::to_grey(frame));
  } else {
    camera::find_target(camera::to_grey(frame), request);
  }
}

}  // namespace impactdic::fuzz
