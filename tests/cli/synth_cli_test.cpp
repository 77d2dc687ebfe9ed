// `impactdic synth` from outside: what it writes is the stated scene at the stated truth.
#include <gtest/gtest.h>
#include <impactdic/units.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "host/video/frame_source.h"
#include "sim/speckle/render.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

namespace fs = std::filesystem;

class SynthCommand : public ::testing::Test {
 protected:
  // Exit status of `impactdic synth -o dir_/name options`; stderr in dir_/errors.
  int synth(const std::string& name, const std::string& options) const {
    const std::string command = std::string(IMPACTDIC_PROGRAM) + " synth -o " +
                                (dir_ / name).string() + " " + options + " >" +
                                (dir_ / "out").string() + " 2>" + (dir_ / "errors").string();
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string text(const fs::path& file) const {
    std::ifstream in(dir_ / file.string(), std::ios::binary);
    std::stringstream all;
    all << in.rdbuf();
    return all.str();
  }
  testing::ScratchFolder dir_;
};

struct Format {
  const char* option;
  const char* file;
  int bits;
};

// The clip read back, frame by frame, against the renderer at the poses of truth.csv.
TEST_F(SynthCommand, EveryFormatHoldsTheScenesPicturesAtTheTruthsPoses) {
  for (const Format& format : {Format{"tiff", "video.tif", 8}, Format{"tiff", "video.tif", 12},
                               Format{"raw", "video.raw", 16}, Format{"cine", "video.cine", 8},
                               Format{"cine12", "video.cine", 12}, Format{"mraw", "video.mraw", 10},
                               Format{"mraw12", "video.mraw", 12}}) {
    const std::string name = std::string(format.option) + std::to_string(format.bits);
    SCOPED_TRACE(name);
    ASSERT_EQ(synth(name,
                    "--pattern b1 --radius-px 30 --size 90x84 --frames 3 --noise 1.5"
                    " --velocity-px 0.37,-0.61 --rotation-deg 3 --shading 0.3 --format " +
                        std::string(format.option) + " --bits " + std::to_string(format.bits)),
              0);
    SynthScene scene;
    scene.width = 90;
    scene.height = 84;
    scene.noise_sigma = 1.5;
    scene.shading = 0.3;
    scene.bits = format.bits;
    const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("b1", 1, 30), scene);
    const auto poses = sim::speckle::read_motion_csv(dir_ / name / "truth.csv").poses;
    OpenOptions options;
    if (name == "raw16") options.raw = RawLayout{90, 84, 16};
    const auto clip = video::open_video({(dir_ / name / format.file).string()}, options);
    ASSERT_EQ(clip->info().frame_count, 3);
    ASSERT_EQ(poses.size(), 3u);
    EXPECT_NEAR(poses[1].cx_px - poses[0].cx_px, 0.37, 1e-12);
    EXPECT_NEAR(poses[1].cy_px, (84 - 1) / 2.0, 1e-12);  // the path lies in the middle
    for (int k = 0; k < 3; ++k) {
      Frame stored, expected;
      clip->read(k, stored);
      renderer.render(poses[static_cast<std::size_t>(k)], k, expected);
      ASSERT_EQ(stored.width(), expected.width());
      const Image<float> a = stored.to_float(), b = expected.to_float();
      for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a.data()[i], b.data()[i]) << i;
    }
  }
}

TEST_F(SynthCommand, TheJobFileRemakesTheClipOnAnyNumberOfThreads) {
  ASSERT_EQ(synth("a",
                  "--pattern f1 --radius-px 40 --size 128x128 --frames 6 --noise 2 -j 1"
                  " --exposure 0.4 --occlude 0.3 --compression 0.01"),
            0);
  ASSERT_EQ(synth("b", "--job " + (dir_ / "a/job.toml").string() + " -j 3"), 0);
  EXPECT_EQ(text("a/video.tif"), text("b/video.tif"));
  EXPECT_EQ(text("a/truth.csv"), text("b/truth.csv"));
  EXPECT_EQ(text("a/compression.csv"), text("b/compression.csv"));
  EXPECT_NE(text("a/compression.csv").find("\n5,0.05,90\n"), std::string::npos);
}

TEST_F(SynthCommand, MotionFilesAreFollowed) {
  std::ofstream(dir_ / "motion.csv") << "cx_px,cy_px,angle_deg\n50,51,0\n50.25,51.5,-4\n";
  ASSERT_EQ(synth("clip", "--pattern none --radius-px 30 --size 100x100 --motion " +
                              (dir_ / "motion.csv").string()),
            0);
  EXPECT_EQ(text("clip/truth.csv"),
            "frame,time_s,cx_px,cy_px,r_px,dx_px,dy_px,rot_deg\n"
            "0,0,50,51,30,0.25,0.5,-4\n1,1e-04,50.25,51.5,30,,,\n");
}

// Free flight before the touch at the job's speed, compression after it, and the way back.
TEST_F(SynthCommand, TheBallFollowsASimulatedImpact) {
  std::ofstream(dir_ / "job.toml")
      << "normal = \"linear_spring_damper\"\nfriction = \"coulomb\"\n"
         "[body]\nshape = \"hollow_sphere\"\nmass_kg = 0.0567\ndiameter_m = 0.067\n"
         "[contact]\nstiffness_n_per_m = 13385.0\ndamping_n_s_per_m = 5.36\n"
         "friction_kinetic = 0.2\n[surface]\nangle_deg = 0.0\n"
         "[initial]\nvt_m_s = 0.5\nvn_m_s = -2.0\nomega_rad_s = 10.0\n"
         "[environment]\ngravity_m_s2 = 0.0\n";
  ASSERT_EQ(synth("clip", "--pattern none --radius-px 60 --size 200x200 --frames 110 --simulate " +
                              (dir_ / "job.toml").string() + " --touch-frame 20"),
            0);
  const auto poses = sim::speckle::read_motion_csv(dir_ / "clip/truth.csv").poses;
  EXPECT_NE(text("clip/compression.csv").find("\n20,0,90\n"), std::string::npos);
  EXPECT_EQ(text("clip/compression.csv").find("\n30,0,90\n"), std::string::npos);
  ASSERT_EQ(poses.size(), 110u);
  const double px_per_m = 120 / 0.067, tolerance = 1e-9;
  for (std::size_t k = 0; k < 20; ++k) {
    EXPECT_NEAR(poses[k + 1].cx_px - poses[k].cx_px, 0.5 * px_per_m / 10000, tolerance);
    EXPECT_NEAR(poses[k + 1].cy_px - poses[k].cy_px, 2.0 * px_per_m / 10000, tolerance);  // down
    EXPECT_NEAR(poses[k + 1].angle_deg - poses[k].angle_deg, 10 * 180 / kPi / 10000, tolerance);
  }
  EXPECT_LT(poses[109].cy_px, poses[108].cy_px);  // rebounds upward
  EXPECT_LT(poses[109].angle_deg - poses[108].angle_deg,
            poses[1].angle_deg - poses[0].angle_deg);  // friction turns it clockwise
}

// With velocity and spin out of the picture's plane: the ball comes nearer, and its axis turns.
TEST_F(SynthCommand, ASphereFollowsAnImpactInSpace) {
  std::ofstream(dir_ / "job.toml")
      << "normal = \"hertz_damper\"\nfriction = \"coulomb\"\n"
         "[body]\ndiameter_m = 0.06\nmass_kg = 0.1\n"
         "[contact]\nstiffness_n_per_m1p5 = 1e6\nfriction_kinetic = 0.3\n"
         "[initial]\nvt_m_s = 0.5\nvn_m_s = -2.0\nvb_m_s = 0.6\nomega_rad_s = 10.0\n"
         "omega_t_rad_s = -50.0\nomega_n_rad_s = 30.0\n"
         "[environment]\ngravity_m_s2 = 0.0\n";
  const std::string job = " --pattern none --radius-px 40 --size 200x200 --simulate " +
                          (dir_ / "job.toml").string() + " --touch-frame 20";
  EXPECT_EQ(synth("disc", job), 2);
  EXPECT_NE(text("errors").find("--body sphere"), std::string::npos);
  ASSERT_EQ(synth("clip", job + " --body sphere"), 0);
  const auto poses = sim::speckle::read_motion_csv(dir_ / "clip/truth.csv").poses;
  const double per_frame = 80 / 0.06 / 10000;
  EXPECT_NEAR(poses[1].z_px - poses[0].z_px, 0.6 * per_frame, 1e-9);
  EXPECT_NEAR(poses[15].rx_deg, -50 * 15 / 10000.0 * 180 / kPi, 1e-9);
  EXPECT_NEAR(poses[15].ry_deg, 30 * 15 / 10000.0 * 180 / kPi, 1e-9);
  EXPECT_NEAR(poses[15].angle_deg, 10 * 15 / 10000.0 * 180 / kPi, 1e-9);
  // The contact point came towards the camera, at 0.6 + 0.03 * 50 m/s: friction takes from it.
  EXPECT_LT(poses[109].z_px - poses[108].z_px, 0.5 * per_frame);
}

// The clip of a sphere holds the renderer's pictures, and its truth makes the same clip again.
TEST_F(SynthCommand, ASphereTurnsAboutThreeAxesAndItsTruthIsAMotionFile) {
  const std::string scene =
      " --body sphere --pattern b2 --radius-px 30 --size 96x90 --noise 1 --limb-darkening 0.4"
      " --lamp 0.5 --distance 12 ";
  ASSERT_EQ(synth("a", scene + "--frames 4 --spin-deg 8,-5,3 --velocity-px 0.3,-0.2,1"), 0);
  const auto poses = sim::speckle::read_motion_csv(dir_ / "a/truth.csv").poses;
  ASSERT_EQ(poses.size(), 4u);
  EXPECT_NEAR(poses[3].rx_deg, 24, 1e-9);
  EXPECT_NEAR(poses[3].ry_deg, -15, 1e-9);
  EXPECT_NEAR(poses[3].angle_deg, 9, 1e-9);
  EXPECT_NEAR(poses[3].z_px, 3, 1e-12);
  ASSERT_EQ(synth("b", scene + "--poses " + (dir_ / "a/truth.csv").string()), 0);
  EXPECT_EQ(text("a/video.tif"), text("b/video.tif"));
  EXPECT_EQ(text("a/truth.csv"), text("b/truth.csv"));
  ASSERT_EQ(synth("c", "--job " + (dir_ / "a/job.toml").string()), 0);
  EXPECT_EQ(text("a/video.tif"), text("c/video.tif"));
  // About the line of sight only, the one number is that of --rotation-deg.
  ASSERT_EQ(synth("d", scene + "--frames 2 --spin-deg 3"), 0);
  ASSERT_EQ(synth("e", scene + "--frames 2 --rotation-deg 3"), 0);
  EXPECT_EQ(text("d/video.tif"), text("e/video.tif"));
}

TEST_F(SynthCommand, WrongRequestsAreOneLineAndStatus2) {
  for (const char* options :
       {"--pattern z9", "--size 12", "--bits 20", "--velocity-px 1", "--blur 0.1", "--format xyz",
        "--radius-px -3", "--unknown 1", "--body cube", "--spin-deg 1,2,3",
        "--body sphere --spin-deg 1,2", "--spin-deg 1 --rotation-deg 2", "--lamp 0.5",
        "--body sphere --distance 1.1", "--motion /nowhere.csv --rotation-deg 2"}) {
    EXPECT_EQ(synth("none", options), 2) << options;
    const std::string line = text("errors");
    EXPECT_EQ(line.rfind("impactdic: error: ", 0), 0u) << line;
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
    EXPECT_FALSE(fs::exists(dir_ / "none")) << options;
  }
  EXPECT_EQ(synth("none", "--motion /nowhere.csv"), 1);
  fs::create_directories(dir_ / "full/x");
  EXPECT_EQ(synth("full", "--frames 1 --radius-px 30"), 2);
}

}  // namespace
}  // namespace impactdic
