// What a sphere's rim lies beside its centre, through a lens and back.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "host/camera/correct_rows.h"
#include "host/dic/rim_margin.h"
#include "tests/support/camera/through_lens.h"

namespace impactdic::testing {
namespace {

// A rim beside the centre is where a circle there would be.
TEST(RimCorrection, TheRimBesideACentreGoesWithIt) {
  const Camera camera = bent_camera(512, 3e-4);
  TrackRow row;
  row.circle_ok = true;
  row.cx_px = 90, row.cy_px = 70, row.r_px = 55;
  row.cx_sd_px = row.cy_sd_px = row.r_sd_px = 0.01;
  row.rim_off_x_px = 0.3, row.rim_off_y_px = -0.2;
  row.rim_x_sd_px = row.rim_y_sd_px = 0.05;
  TrackRow rim = row;
  rim.frame = 1;
  rim.cx_px += row.rim_off_x_px;
  rim.cy_px += row.rim_off_y_px;
  rim.rim_off_x_px = rim.rim_off_y_px = kNotMeasured;
  // Of half the pixels, so that all is twice as long.
  const std::vector<TrackRow> back =
      camera::RowCorrection(camera, false, 1.5e-4, dic::kRimMarginPx).correct({row, rim});
  EXPECT_NEAR(back[0].rim_off_x_px, back[1].cx_px - back[0].cx_px, 2e-3);
  EXPECT_NEAR(back[0].rim_off_y_px, back[1].cy_px - back[0].cy_px, 2e-3);
  EXPECT_GT(back[0].rim_off_x_px, 0.55);
  EXPECT_NEAR(back[0].rim_x_sd_px, 0.1, 0.01);
  EXPECT_TRUE(std::isnan(back[1].rim_off_x_px));
}

}  // namespace
}  // namespace impactdic::testing
