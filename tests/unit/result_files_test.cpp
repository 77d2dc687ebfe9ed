// track.csv, fields.h5 and the conversion to SI units.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <thread>

#include "host/report/csv.h"
#include "host/report/fields_file.h"
#include "host/report/pose_csv.h"
#include "host/run/results/kept_points.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

using testing::ScratchFolder;

TrackRow example_row(std::int64_t frame) {
  TrackRow row;
  row.frame = frame;
  row.time_s = static_cast<double>(frame) / 3;
  row.status = TrackStatus::kOk;
  row.circle_ok = row.motion_ok = true;
  row.cx_px = 100.123456789;
  row.cy_px = 50;
  row.r_px = 115;
  row.cx_sd_px = row.cy_sd_px = row.r_sd_px = 1e-3;
  row.dx_px = 1;
  row.dy_px = -2;
  row.rot_deg = 0.05 * kDegPerRad;
  row.dx_sd_px = row.dy_sd_px = 2e-4;
  row.rot_sd_deg = 1e-6 * kDegPerRad;
  row.windows = 57;
  return row;
}

TEST(ToSi, TurnsImageAxesIntoWorldAndLocalOnes) {
  SiScale scale{2e-4, 1e4, M_PI / 2, 512};
  const SiRow si = to_si(example_row(0), scale);
  EXPECT_NEAR(si.x_m, 100.123456789 * 2e-4, 1e-15);
  EXPECT_NEAR(si.y_m, (511 - 50) * 2e-4, 1e-15);
  EXPECT_NEAR(si.vx_m_s, 2, 1e-12);
  EXPECT_NEAR(si.vy_m_s, 4, 1e-12);  // up, where the image's y is down
  // A surface standing upright: its tangent points up, its normal to the left.
  EXPECT_NEAR(si.vt_m_s, 4, 1e-12);
  EXPECT_NEAR(si.vn_m_s, -2, 1e-12);
  EXPECT_NEAR(si.omega_rad_s, 500, 1e-9);
  EXPECT_NEAR(si.omega_sd_rad_s, 1e-2, 1e-12);
}

TEST(ToSi, UnknownScaleOrRateGivesNothing) {
  const SiRow no_scale = to_si(example_row(0), {0, 1e4, 0, 512});
  EXPECT_TRUE(std::isnan(no_scale.x_m) && std::isnan(no_scale.vx_m_s));
  EXPECT_NEAR(no_scale.omega_rad_s, 500, 1e-9);
  const SiRow no_rate = to_si(example_row(0), {2e-4, 0, 0, 512});
  EXPECT_FALSE(std::isnan(no_rate.x_m));
  EXPECT_TRUE(std::isnan(no_rate.vx_m_s) && std::isnan(no_rate.omega_rad_s));
}

TEST(TrackCsv, ReadsBackToTheLastBit) {
  const ScratchFolder folder;
  TrackRow lost;
  lost.frame = 1;
  lost.time_s = 0.1;
  TrackRow oval = example_row(0);
  oval.e1_px = 1.25, oval.e2_px = -0.5, oval.e1_sd_px = 0.01, oval.e2_sd_px = 0.02;
  oval.by_hand = ByHand::kGuided;
  oval.rim_off_x_px = 0.1 / 3, oval.rim_off_y_px = -0.07, oval.rim_x_sd_px = 0.02,
  oval.rim_y_sd_px = 0.03;
  report::TrackCsv csv(folder / "track.csv", {}, 0);
  csv.add(std::vector{example_row(0), lost});
  TrackResult result;
  result.rows = {example_row(0), lost, oval};
  result.scale = {2e-4, 1e4, 0, 512};
  csv.finish(result.rows, result);
  const auto rows = report::read_track_csv(folder / "track.csv");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[2].e1_px, 1.25);
  EXPECT_EQ(rows[2].e2_px, -0.5);
  EXPECT_EQ(rows[2].e1_sd_px, 0.01);
  EXPECT_EQ(rows[2].e2_sd_px, 0.02);
  EXPECT_EQ(rows[2].by_hand, ByHand::kGuided);
  EXPECT_EQ(rows[2].rim_off_x_px, 0.1 / 3);
  EXPECT_EQ(rows[2].rim_off_y_px, -0.07);
  EXPECT_EQ(rows[2].rim_x_sd_px, 0.02);
  EXPECT_EQ(rows[2].rim_y_sd_px, 0.03);
  EXPECT_TRUE(std::isnan(rows[0].e1_px));
  EXPECT_EQ(rows[0].by_hand, ByHand::kNo);
  EXPECT_EQ(rows[0].cx_px, 100.123456789);
  EXPECT_EQ(rows[0].time_s, 0);
  EXPECT_EQ(rows[0].rot_deg, example_row(0).rot_deg);
  EXPECT_EQ(rows[0].windows, 57);
  EXPECT_FALSE(rows[1].circle_ok || rows[1].motion_ok);
  EXPECT_EQ(rows[1].status, TrackStatus::kNoBall);
  EXPECT_TRUE(std::isnan(rows[1].cx_px));
}

TEST(PoseCsv, ReadsARegistrationBackToTheLastBit) {
  const ScratchFolder scratch;
  std::vector<TrackRow> rows = {example_row(0), example_row(1), example_row(2)};
  for (std::size_t i = 0; i < 2; ++i) {  // the last row has none
    BodyPose& pose = rows[i].pose;
    pose.ok = true;
    pose.origin = 0;
    pose.keyframe = static_cast<std::int64_t>(i);
    pose.x_px = 1.0 / 3, pose.y_px = 2.0 / 7, pose.x_sd_px = 1e-3, pose.y_sd_px = 2e-3;
    pose.qw = 0.6, pose.qx = 0.1 / 3, pose.qy = -0.8, pose.qz = 1e-17;
    pose.key_dx_px = 10.0 / 3, pose.key_dy_px = -1e-9;
    pose.key_rot_x_deg = 2.0 / 3, pose.key_rot_y_deg = -5.0 / 3, pose.key_rot_deg = 1e-5 / 3;
  }
  {
    report::PoseCsv table(scratch / "pose.csv", 0);
    for (const TrackRow& row : rows) table.add(row);
    table.flush();
  }
  std::vector<TrackRow> read = {example_row(0), example_row(1), example_row(2)};
  report::read_pose_csv(scratch / "pose.csv", read);
  for (std::size_t i = 0; i < 2; ++i) {
    const BodyPose &a = read[i].pose, &b = rows[i].pose;
    EXPECT_TRUE(a.ok);
    EXPECT_EQ(a.origin, b.origin);
    EXPECT_EQ(a.keyframe, b.keyframe);
    for (const auto member :
         {&BodyPose::x_px, &BodyPose::y_px, &BodyPose::x_sd_px, &BodyPose::qw, &BodyPose::qx,
          &BodyPose::qy, &BodyPose::qz, &BodyPose::key_dx_px, &BodyPose::key_dy_px,
          &BodyPose::key_rot_x_deg, &BodyPose::key_rot_y_deg, &BodyPose::key_rot_deg}) {
      EXPECT_EQ(a.*member, b.*member);
    }
  }
  EXPECT_FALSE(read[2].pose.ok);
  std::ofstream(scratch / "other.csv") << "frame,x\n";
  EXPECT_THROW(report::read_pose_csv(scratch / "other.csv", read), FormatError);
}

TEST(ToSi, AFlightsDepthIsThatOfItsRows) {
  TrackResult result;
  for (std::int64_t i = 0; i < 4; ++i) result.rows.push_back(example_row(i));
  result.scale = {2e-4, 1e4, 0, 512};
  result.impact_si.in_si = true;
  result.impact_si.after.known = true;
  result.impact_si.after.first_frame = 2, result.impact_si.after.last_frame = 3;
  result.impact_si.after.vz = {1.5, 0.2};
  EXPECT_TRUE(std::isnan(to_si(result, 1).vz_m_s));
  EXPECT_EQ(to_si(result, 2).vz_m_s, 1.5);
  EXPECT_EQ(to_si(result, 3).vz_sd_m_s, 0.2);
}

TEST(TrackCsv, DropsALineThatWasCutOffAndRefusesDamage) {
  const ScratchFolder folder;
  const auto write = [&](const std::string& text) {
    std::ofstream(folder / "t.csv") << report::kTrackCsvHeader << "\n" << text;
  };
  const std::string good = report::track_csv_line(example_row(0), {});
  write(good + "\n" + good.substr(0, 40));
  EXPECT_EQ(report::read_track_csv(folder / "t.csv").size(), 1u);
  // A number cut short still looks like one: without its newline it does not count.
  write(good + "\n" + good);
  EXPECT_EQ(report::read_track_csv(folder / "t.csv").size(), 1u);
  write(good.substr(0, 40) + "\n" + good + "\n");
  EXPECT_THROW(report::read_track_csv(folder / "t.csv"), FormatError);
  write("0,0,splendid" + good.substr(6) + "\n");
  EXPECT_THROW(report::read_track_csv(folder / "t.csv"), Error);
  std::ofstream(folder / "t.csv") << "frame,x\n1,2\n";
  EXPECT_THROW(report::read_track_csv(folder / "t.csv"), FormatError);
  EXPECT_THROW(report::read_track_csv(folder / "none.csv"), FileError);
}

class FieldsFileTest : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Compression, FieldsFileTest, ::testing::Values(0, 4));

TEST_P(FieldsFileTest, GrowsIsReadByH5pyAndResumes) {
  const ScratchFolder folder;
  const auto path = folder / "fields.h5";
  std::vector<Window> windows(3);
  std::vector<WindowMotion> field(3);
  for (int i = 0; i < 3; ++i) {
    windows[i].x0 = 10 * i;
    field[i].u = 0.5f + static_cast<float>(i);
    field[i].status = i == 1 ? 3 : 0;
  }
  {
    auto file = report::FieldsFile::create(
        path, 3, 15, {{"grid_radius_px", 42.5}, {"axes", "x right"}}, GetParam());
    for (int k = 0; k < 4; ++k) file.add(k, 0.1 * k, windows, field, nullptr);
    file.add(4, 0.4, {}, {}, nullptr);
  }
  {
    auto file = report::FieldsFile::resume(path, 15, 4);
    EXPECT_EQ(file.rows(), 4u);
    EXPECT_THROW(file.add(4, 0.4, windows, std::vector<WindowMotion>(2), nullptr), InvalidArgument);
    file.add(4, 0.4, windows, field, nullptr);
    file.set_scale(2.5e-4, 0, 30, "");
  }
  EXPECT_THROW(report::FieldsFile::resume(path, 15, 6), FormatError);
  std::ofstream(folder / "check.py") << R"(
import h5py, numpy, sys
f = h5py.File(sys.argv[1])
assert f['u_px'].shape == (5, 3), f['u_px'].shape
assert list(f['x_px'][4]) == [7, 17, 27]
assert numpy.isnan(f['u_px'][4][1]) and f['u_px'][4][2] == 2.5
assert list(f['status'][2]) == [0, 3, 0]
assert f['u_px'].dims[0].keys() == ['time'] and f['u_px'].dims[1].keys() == ['window']
assert f['u_px'].attrs['units'] == b'px' and f.attrs['axes'] == b'x right'
assert f.attrs['grid_radius_px'] == 42.5 and f.attrs['schema_version'] == 1
assert f.attrs['scale_m_per_px'] == 2.5e-4 and f.attrs['surface_angle_deg'] == 30
assert 'analysed_fps' not in f.attrs
words = f['status'].attrs['flag_meanings'].decode().split()
assert words[3] == 'low_correlation' and list(f['status'].attrs['flag_values']) == list(range(7))
shown = f[f.attrs['default'].decode()]
assert shown.attrs['NX_class'] == b'NXdata' and list(shown.attrs['axes']) == [b'time', b'window']
signal = shown.attrs['signal'].decode()
assert shown[signal] == f['u_px'] and shown[signal + '_errors'] == f['u_sd_px']
assert list(shown.attrs['auxiliary_signals']) == [b'v_px'] and shown['time'] == f['time']
level = int(sys.argv[2])
assert f['u_px'].compression_opts == (level or None) and f['u_px'].shuffle == (level > 0)
)";
  const std::string command = "/usr/bin/python3 " + testing::quoted(folder / "check.py") + " " +
                              testing::quoted(path) + " " + std::to_string(GetParam());
  EXPECT_EQ(std::system(command.c_str()), 0);
}

// Nothing in the file says when it was made (HDF5 keeps seconds).
TEST_P(FieldsFileTest, SameResultsAreTheSameBytes) {
  const ScratchFolder folder;
  const auto bytes = [&](const std::string& name) {
    {
      auto file =
          report::FieldsFile::create(folder / name, 2, 15, {{"axes", "x right"}}, GetParam());
      const std::vector<Window> windows(2);
      for (int k = 0; k < 4; ++k) {
        file.add(k, 0.1 * k, windows, std::vector<WindowMotion>(2), nullptr);
      }
    }
    std::ifstream file(folder / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string first = bytes("first.h5");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  EXPECT_TRUE(bytes("later.h5") == first);
}

// Points to go back to: few, spread over the whole run, and damage costs no more than one of them.
TEST(KeptPoints, AreSpreadOverTheRowsPassed) {
  const testing::ScratchFolder folder;
  const std::filesystem::path made(folder.string());
  const auto count = [&] {
    return std::distance(std::filesystem::directory_iterator(made / "resume"),
                         std::filesystem::directory_iterator());
  };
  constexpr std::int64_t kBatch = 64, kBatches = 300;
  {
    run::KeptPoints points(made, 0);
    for (std::int64_t k = 1; k <= kBatches; ++k) {
      pipeline::ResumePoint point;
      point.next_row = k * kBatch - 1;
      points.add(point);
      points.add(point);  // flushed twice
      ASSERT_LE(count(), 16);
    }
  }
  EXPECT_EQ(run::KeptPoints::before(made, kBatch - 1), std::nullopt);
  const auto row_before = [&](std::int64_t row) {
    return run::KeptPoints::before(made, row).value_or(pipeline::ResumePoint{}).next_row;
  };
  for (std::int64_t row = kBatch; row <= kBatch * kBatches; row += 100) {
    const std::int64_t found = row_before(row);
    ASSERT_LT(found, row);
    ASSERT_LE(row - found, kBatch * kBatches / 7) << row;
  }
  const std::int64_t last = row_before(kBatch * kBatches);
  std::ofstream(made / "resume" / (std::to_string(last) + ".json")) << "{";
  std::ofstream(made / "resume" / "x.json") << "{";
  EXPECT_LT(row_before(kBatch * kBatches), last);
  EXPECT_GT(row_before(kBatch * kBatches), kBatch * kBatches / 2);
  run::KeptPoints(made, 5000);
  EXPECT_LE(row_before(kBatch * kBatches), 5000);
  EXPECT_GT(row_before(kBatch * kBatches), 0);
}

}  // namespace
}  // namespace impactdic
