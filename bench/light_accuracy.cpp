// How exact and how honest `track` is on balls as cameras show them: lamps, backgrounds, obstacles,
// blur, compression, small and large balls; clips with exactly known poses, through the library.
//   light_accuracy [CONDITIONS [FIRST LAST [FRAMES [circles|motion|rows [KEEP]]]]]
// CONDITIONS is a list with commas, or "all", each with the pattern and the radius of its ball
// where they are not to be the usual ones: "disc_bar:a2", "all:b3", "sphere:a3:40"; FIRST and LAST
// are seeds. "random" draws a condition of its own from each seed and leaves it to the program what
// the body is: discs and spheres are told apart in its table, and each seed is described on stderr.
// Rows that are lost, or wrong with status ok, are listed on stderr. With "circles" the motion is
// not measured, and no device is needed; "rows" is "motion" with the errors of every row on stdout,
// so that runs side by side can be put together. Pictures are kept in the folder KEEP and read from
// there the next time (painting takes longer than all the rest).
#include <impactdic/device.h>
#include <impactdic/error.h>
#include <impactdic/track.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/light_scenes.h"
#include "tests/support/motion_truth.h"
#include "tests/support/random_scene.h"

namespace impactdic::bench {
namespace {

using testing::Backdrop;
using testing::Errors;
using testing::LightClip;
using testing::LightScene;

constexpr LightScene kScenes[] = {
    {.name = "disc"},
    {.name = "disc_shade", .shading = 0.4},
    {.name = "disc_wood", .backdrop = Backdrop::kWood},
    {.name = "disc_tiles", .backdrop = Backdrop::kTiles},
    {.name = "disc_slope", .backdrop = Backdrop::kSlope},
    {.name = "disc_bar", .hidden = 0.3},
    {.name = "disc_upright", .hidden = 0.3, .bar_angle_deg = 90},
    {.name = "disc_unseen", .hidden = 0.3, .bar_level = 30},
    {.name = "disc_unseen_60", .radius_px = 60, .hidden = 0.3, .bar_level = 30},
    {.name = "disc_over", .gain = 1.5},
    {.name = "disc_blur", .exposure = 0.8, .dx_px = 5.2, .dy_px = -1.3},
    {.name = "disc_dim", .gain = 0.3},
    {.name = "disc_noise", .noise = 8},
    {.name = "disc_squash", .compression = 0.1},
    {.name = "contact", .compression = 0.1, .contact = true},
    {.name = "contact_wood", .compression = 0.1, .contact = true, .backdrop = Backdrop::kWood},
    {.name = "contact_bar", .hidden = 0.3, .compression = 0.1, .contact = true},
    {.name = "disc_small", .radius_px = 30},
    {.name = "disc_large", .radius_px = 230},
    {.name = "disc_enters", .enters = true},
    {.name = "sphere", .sphere = true},
    {.name = "sphere_plain", .sphere = true, .pattern = "a1"},
    {.name = "sphere_mild", .sphere = true, .lamp_share = 0.4, .lamp_elevation_deg = 30},
    {.name = "sphere_half", .sphere = true, .lamp_share = 0.5},
    {.name = "sphere_front",
     .sphere = true,
     .lamp_share = 0.7,
     .lamp_elevation_deg = 60,
     .limb_darkening = 0.3},
    {.name = "sphere_hard",
     .sphere = true,
     .lamp_share = 0.9,
     .lamp_elevation_deg = 20,
     .limb_darkening = 0.3},
    {.name = "sphere_limb", .sphere = true, .limb_darkening = 0.5},
    {.name = "sphere_half_a1", .sphere = true, .pattern = "a1", .lamp_share = 0.5},
    {.name = "sphere_wood", .sphere = true, .lamp_share = 0.3, .backdrop = Backdrop::kWood},
    {.name = "sphere_wood_far",
     .sphere = true,
     .lamp_share = 0.3,
     .backdrop = Backdrop::kWood,
     .dx_px = 2.9,
     .dy_px = -1.6},
    {.name = "sphere_wood_small",
     .sphere = true,
     .radius_px = 60,
     .lamp_share = 0.3,
     .backdrop = Backdrop::kWood,
     .dx_px = 2.9,
     .dy_px = -1.6},
    {.name = "sphere_tiles_small",
     .sphere = true,
     .radius_px = 60,
     .lamp_share = 0.3,
     .backdrop = Backdrop::kTiles,
     .dx_px = 2.9,
     .dy_px = -1.6},
    {.name = "sphere_slope", .sphere = true, .lamp_share = 0.3, .backdrop = Backdrop::kSlope},
    {.name = "sphere_slope_small",
     .sphere = true,
     .radius_px = 60,
     .lamp_share = 0.3,
     .backdrop = Backdrop::kSlope,
     .dx_px = 2.9,
     .dy_px = -1.6},
    {.name = "sphere_bar", .sphere = true, .hidden = 0.3},
    {.name = "sphere_over", .sphere = true, .lamp_share = 0.5, .gain = 1.5},
    {.name = "sphere_small", .sphere = true, .radius_px = 40, .lamp_share = 0.5},
    {.name = "sphere_enters", .sphere = true, .lamp_share = 0.3, .enters = true},
};

// One figure of a row against the truth. Wrong: beyond five deviations, and by so much that it
// matters.
constexpr double kBeyond = 5, kMatters_px = 0.02;

struct Table {
  Errors centre, radius, shift, turn, angle;
  int rows = 0, lost = 0, wrong = 0, wrong_motion = 0, flagged = 0;

  static bool is_wrong(double error, double sd, double matters) {
    return !(std::abs(error) <= kBeyond * sd || std::abs(error) <= matters);
  }
  // Whether it is wrong.
  bool add_circle(const TrackRow& row, const BallPose& pose, double radius_px) {
    const double x = row.cx_px - pose.cx_px, y = row.cy_px - pose.cy_px;
    const double r = row.r_px - radius_px * (1 - pose.compression / 2);
    centre.add(x, row.cx_sd_px);
    centre.add(y, row.cy_sd_px);
    radius.add(r, row.r_sd_px);
    if (row.status != TrackStatus::kOk && row.status != TrackStatus::kLastFrame) return false;
    const bool off = is_wrong(x, row.cx_sd_px, kMatters_px) ||
                     is_wrong(y, row.cy_sd_px, kMatters_px) ||
                     is_wrong(r, row.r_sd_px, kMatters_px);
    wrong += off;
    return off;
  }
  // Whether it is wrong.
  bool add_motion(const TrackRow& row, const LightScene& scene, const BallPose& pose,
                  const BallPose& next) {
    if (!row.motion_ok || row.status != TrackStatus::kOk) return false;
    const double x = row.dx_px - (next.cx_px - pose.cx_px);
    const double y = row.dy_px - (next.cy_px - pose.cy_px);
    const double z = row.rot_deg - scene.rotation_deg;
    const double matters_deg = kMatters_px / scene.radius_px * kDegPerRad;
    shift.add(x, row.dx_sd_px);
    shift.add(y, row.dy_sd_px);
    turn.add(z, row.rot_sd_deg);
    bool off = is_wrong(x, row.dx_sd_px, kMatters_px) || is_wrong(y, row.dy_sd_px, kMatters_px) ||
               is_wrong(z, row.rot_sd_deg, matters_deg);
    if (std::isfinite(row.rot_x_deg)) {
      const double about_x = row.rot_x_deg - scene.spin_x_deg;
      const double about_y = row.rot_y_deg - scene.spin_y_deg;
      turn.add(about_x, row.rot_x_sd_deg);
      turn.add(about_y, row.rot_y_sd_deg);
      off = off || is_wrong(about_x, row.rot_x_sd_deg, matters_deg) ||
            is_wrong(about_y, row.rot_y_sd_deg, matters_deg);
    }
    wrong_motion += off;
    return off;
  }
  void add_pose(const BodyPose& pose, double angle_deg) {
    if (std::isnan(pose.angle_rad)) return;  // a sphere's
    angle.add(pose.angle_rad * kDegPerRad - angle_deg, pose.angle_sd_rad * kDegPerRad);
  }
  void print(const char* name) const {
    const auto two = [](const Errors& e) { std::printf("  %8.4f %6.2f", e.rms(), e.over_sd()); };
    std::printf("%-14s %5d %4d %4d %5d %5d", name, rows, lost, flagged, wrong, wrong_motion);
    two(centre);
    std::printf(" %8.4f", centre.largest);
    two(radius);
    std::printf(" %+8.4f", radius.mean());
    two(shift);
    two(turn);
    if (angle.count > 0) two(angle);
    std::printf("\n");
    std::fflush(stdout);
  }
};

bool all_in_view(const BallPose& pose, const LightScene& scene, const LightClip& clip) {
  const double r = scene.radius_px + 4;
  return pose.cx_px > r && pose.cy_px > r && pose.cx_px < clip.width() - 1 - r &&
         pose.cy_px < clip.height() - 1 - r;
}

// 8-bit pictures of a clip, from the folder `keep` where they are there.
std::vector<Frame> pictures_of(const LightScene& scene, LightClip& clip, std::uint64_t seed,
                               const std::string& keep) {
  std::vector<Frame> pictures(clip.poses().size());
  const std::string name = keep + '/' + scene.name + '-' + scene.pattern + '-' +
                           std::to_string(seed) + '-' + std::to_string(pictures.size()) + '-' +
                           std::to_string(scene.radius_px);
  const auto bytes = static_cast<std::streamsize>(clip.width()) * clip.height();
  if (!keep.empty() && std::filesystem::exists(name)) {
    std::ifstream file(name, std::ios::binary);
    for (Frame& picture : pictures) {
      picture.reset(clip.width(), clip.height(), 8);
      file.read(reinterpret_cast<char*>(picture.u8.data()), bytes);
    }
    return pictures;
  }
  for (std::size_t k = 0; k < pictures.size(); ++k) clip.render(k, pictures[k]);
  if (!keep.empty()) {
    std::ofstream file(name, std::ios::binary);
    for (const Frame& picture : pictures) {
      file.write(reinterpret_cast<const char*>(picture.u8.data()), bytes);
    }
  }
  return pictures;
}

struct Way {
  int first = 1, last = 3, frames = 12;
  bool circles = false, rows = false;
  bool told = true;  // what the body is
  std::string keep;
};

// "ROW condition ball frame status", then each error beside its deviation: centre x, y and radius
// (px), and of a motion that was measured dx, dy (px), turns about x, y and z (degrees).
void print_row(const LightScene& scene, std::uint64_t seed, const TrackRow& row,
               const BallPose& shown, const BallPose* next) {
  std::printf("ROW %s %llu %lld %d", scene.name, static_cast<unsigned long long>(seed),
              static_cast<long long>(row.frame), static_cast<int>(row.status));
  const auto figure = [](double error, double sd) { std::printf(" %.6f %.6f", error, sd); };
  figure(row.cx_px - shown.cx_px, row.cx_sd_px);
  figure(row.cy_px - shown.cy_px, row.cy_sd_px);
  figure(row.r_px - scene.radius_px * (1 - shown.compression / 2), row.r_sd_px);
  if (next != nullptr && row.motion_ok && row.status == TrackStatus::kOk) {
    figure(row.dx_px - (next->cx_px - shown.cx_px), row.dx_sd_px);
    figure(row.dy_px - (next->cy_px - shown.cy_px), row.dy_sd_px);
    figure(row.rot_x_deg - scene.spin_x_deg, row.rot_x_sd_deg);
    figure(row.rot_y_deg - scene.spin_y_deg, row.rot_y_sd_deg);
    figure(row.rot_deg - scene.rotation_deg, row.rot_sd_deg);
  }
  std::printf("\n");
}

Body body_of(const LightScene& scene) { return scene.sphere ? Body::kSphere : Body::kDisc; }

// Returns what the body was measured as, and why.
struct Judged {
  Body body = Body::kAuto;
  std::string reason;
};
Judged measure(const LightScene& scene, std::uint64_t seed, const Way& way, Session& session,
               Table& table) {
  LightClip clip(scene, seed, way.frames);
  const std::vector<Frame> pictures = pictures_of(scene, clip, seed, way.keep);
  ClipInfo info;
  info.width = clip.width();
  info.height = clip.height();
  info.bits = 8;
  info.frame_count = way.frames;
  TrackRequest request;
  request.clip.source = clip_from_callback(
      info, [&](std::int64_t k, Frame& frame) { frame = pictures[static_cast<std::size_t>(k)]; });
  request.clip.fps = 10000;
  request.with_field = !way.circles;
  if (way.told) request.body = body_of(scene);
  const TrackResult result = track(request, session);
  const std::vector<BallPose>& poses = clip.poses();
  for (std::size_t k = 0; k < result.rows.size(); ++k) {
    const TrackRow& row = result.rows[k];
    ++table.rows;
    const bool good = row.status == TrackStatus::kOk || row.status == TrackStatus::kLastFrame;
    table.flagged += row.status == TrackStatus::kInconsistent;
    const bool lost = !row.circle_ok || (!good && row.status != TrackStatus::kInconsistent);
    if (lost && all_in_view(poses[k], scene, clip)) {
      ++table.lost;
      std::fprintf(stderr, "%s %s seed %llu frame %zu: lost\n", scene.name, scene.pattern,
                   static_cast<unsigned long long>(seed), k);
    }
    if (!row.circle_ok) continue;
    const BallPose shown = clip.exposed(k);
    if (way.rows) {
      print_row(scene, seed, row, shown, k + 1 < poses.size() ? &poses[k + 1] : nullptr);
    }
    if (table.add_circle(row, shown, scene.radius_px)) {
      std::fprintf(stderr,
                   "%s %s seed %llu frame %zu: off %+.3f (sd %.3f), %+.3f (%.3f), radius %+.3f "
                   "(%.3f) px\n",
                   scene.name, scene.pattern, static_cast<unsigned long long>(seed), k,
                   row.cx_px - poses[k].cx_px, row.cx_sd_px, row.cy_px - poses[k].cy_px,
                   row.cy_sd_px, row.r_px - scene.radius_px * (1 - shown.compression / 2),
                   row.r_sd_px);
    }
    if (row.pose.ok && row.pose.origin < row.frame) {
      const BallPose& origin = poses[static_cast<std::size_t>(row.pose.origin)];
      table.add_pose(row.pose, poses[k].angle_deg - origin.angle_deg);
    }
    if (k + 1 == poses.size() || !table.add_motion(row, scene, poses[k], poses[k + 1])) continue;
    std::fprintf(stderr,
                 "%s %s seed %llu frame %zu: motion off %+.3f (%.3f), %+.3f (%.3f) px, turn %+.3f "
                 "(%.3f), %+.3f (%.3f), %+.3f (%.3f) deg\n",
                 scene.name, scene.pattern, static_cast<unsigned long long>(seed), k,
                 row.dx_px - (poses[k + 1].cx_px - poses[k].cx_px), row.dx_sd_px,
                 row.dy_px - (poses[k + 1].cy_px - poses[k].cy_px), row.dy_sd_px,
                 row.rot_x_deg - scene.spin_x_deg, row.rot_x_sd_deg,
                 row.rot_y_deg - scene.spin_y_deg, row.rot_y_sd_deg,
                 row.rot_deg - scene.rotation_deg, row.rot_sd_deg);
  }
  return {result.body, result.body_reason};
}

void measure_random(Way way, Session& session) {
  way.told = false;
  Table discs, spheres;
  for (int seed = way.first; seed <= way.last; ++seed) {
    const LightScene scene = testing::random_scene(static_cast<std::uint64_t>(seed));
    Table& table = scene.sphere ? spheres : discs;
    const Table before = table;
    Judged judged;
    try {
      judged = measure(scene, static_cast<std::uint64_t>(seed), way, session, table);
    } catch (const Error& error) {
      std::fprintf(stderr, "seed %d: %s\n", seed, error.what());
    }
    std::fprintf(
        stderr, "seed %d: %d lost, %d inconsistent, %d circles and %d motions wrong%s: %s\n", seed,
        table.lost - before.lost, table.flagged - before.flagged, table.wrong - before.wrong,
        table.wrong_motion - before.wrong_motion,
        judged.body == body_of(scene) ? "" : ", another body", testing::described(scene).c_str());
    if (judged.body != body_of(scene)) std::fprintf(stderr, "  %s\n", judged.reason.c_str());
  }
  discs.print("random discs");
  spheres.print("random spheres");
}

bool is_condition(const std::string& name) {
  return name == "all" || name == "random" ||
         std::any_of(std::begin(kScenes), std::end(kScenes),
                     [&](const LightScene& scene) { return name == scene.name; });
}

int run(int argc, char** argv) {
  const auto argument = [&](int i, const char* usual) {
    return std::string(argc > i ? argv[i] : usual);
  };
  struct Wanted {
    std::string condition, pattern, radius_px;
  };
  std::vector<Wanted> wanted;
  std::istringstream names(argument(1, "all"));
  for (std::string name; std::getline(names, name, ',');) {
    std::istringstream parts(name);
    Wanted& one = wanted.emplace_back();
    std::getline(parts, one.condition, ':');
    std::getline(parts, one.pattern, ':');
    std::getline(parts, one.radius_px);
    if (is_condition(one.condition)) continue;
    std::fprintf(stderr, "light_accuracy: no condition is called '%s'\n", one.condition.c_str());
    return 2;
  }
  Way way;
  way.first = std::atoi(argument(2, "1").c_str());
  way.last = std::atoi(argument(3, "3").c_str());
  way.frames = std::atoi(argument(4, "12").c_str());
  const std::string what = argument(5, "motion");
  way.circles = what == "circles";
  way.rows = what == "rows";
  if (!way.circles && !way.rows && what != "motion") {
    std::fprintf(stderr, "light_accuracy: '%s' is none of circles, motion and rows\n",
                 what.c_str());
    return 2;
  }
  way.keep = argument(6, "");
  if (!way.keep.empty()) std::filesystem::create_directories(way.keep);
  Session session;
  std::printf(
      "condition: rows, lost, inconsistent, wrong circle and motion with status ok; centre rms, "
      "over sd, largest; radius rms, over sd, mean; dx, dy rms, over sd; turn rms, over sd; of a "
      "disc the pose's angle rms, over sd (px, deg)\n");
  if (argument(1, "all") == "random") {
    measure_random(way, session);
    return 0;
  }
  for (const LightScene& usual : kScenes) {
    const auto asked = std::find_if(wanted.begin(), wanted.end(), [&](const auto& one) {
      return one.condition == "all" || one.condition == usual.name;
    });
    if (asked == wanted.end()) continue;
    LightScene scene = usual;
    if (!asked->pattern.empty()) scene.pattern = asked->pattern.c_str();
    if (!asked->radius_px.empty()) scene.radius_px = std::stod(asked->radius_px);
    Table table;
    for (int seed = way.first; seed <= way.last; ++seed) {
      measure(scene, static_cast<std::uint64_t>(seed), way, session, table);
    }
    table.print(scene.name);
  }
  return 0;
}

}  // namespace
}  // namespace impactdic::bench

int main(int argc, char** argv) { return impactdic::bench::run(argc, argv); }
