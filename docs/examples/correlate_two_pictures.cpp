// The displacement field between two pictures of a speckled surface.
//
//     correlate_two_pictures before.tif after.tif
#include <impactdic/impactdic.h>

#include <cstdio>

namespace idic = impactdic;

int main(int count, char** arguments) try {
  if (count != 3) {
    std::fprintf(stderr, "usage: correlate_two_pictures FIRST SECOND\n");
    return 2;
  }
  idic::CorrelateRequest request;
  request.clip.paths = {arguments[1], arguments[2]};
  request.field.window_px = 15;
  request.spacing_px = 16;

  // Windows come frame by frame and are gone after the call: take what you need.
  const auto print_windows = [](const idic::CorrelatedFrame& frame) {
    if (frame.field.empty()) return;  // the first picture is the reference
    std::printf("x_px y_px u_px u_sd_px v_px v_sd_px\n");
    for (const idic::WindowResult& window : frame.field.windows()) {
      if (window.status != idic::WindowStatus::kOk) continue;
      std::printf("%g %g %.9g %.9g %.9g %.9g\n", window.x_px, window.y_px, window.u_px,
                  window.u_sd_px, window.v_px, window.v_sd_px);
    }
  };

  idic::Session session;
  const idic::CorrelateResult result = idic::correlate(request, session, {}, print_windows);

  const idic::MotionRow& motion = result.rows.back();
  if (!motion.motion_ok) {
    std::printf("no motion: %s\n", idic::to_string(motion.status));
    return 1;
  }
  std::printf("motion: dx_px %.9g sd %.9g dy_px %.9g sd %.9g rot_deg %.9g sd %.9g\n", motion.dx_px,
              motion.dx_sd_px, motion.dy_px, motion.dy_sd_px, motion.rot_deg, motion.rot_sd_deg);
} catch (const idic::Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());  // WHAT (WHERE): HINT
  return 1;
}
