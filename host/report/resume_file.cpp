#include "host/report/resume_file.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "host/base/sha256.h"
#include "host/circle/rim/rim_model.h"
#include "host/report/resume/keyframes_json.h"
#include "host/report/resume/numbers.h"
#include "host/report/summary.h"

namespace impactdic::report {
namespace {

using nlohmann::json;
using namespace resume;
using resume::check, resume::describe;

template <typename Field, typename T>
void each_of_fit(Field field, T& fit) {
  each_of_circle(field, fit.circle);
  field("status", fit.status);
  field("cx_sd_px", fit.cx_sd_px);
  field("cy_sd_px", fit.cy_sd_px);
  field("r_sd_px", fit.r_sd_px);
  field("ellipse", fit.ellipse);
  field("e1_px", fit.e1_px);
  field("e2_px", fit.e2_px);
  field("e1_sd_px", fit.e1_sd_px);
  field("e2_sd_px", fit.e2_sd_px);
  field("own_r_px", fit.own_r_px);
  field("own_r_sd_px", fit.own_r_sd_px);
  field("bright", fit.bright);
  field("inked", fit.inked);
  field("residual_px", fit.residual_px);
  field("rim_points", fit.rim_points);
  field("rim_fraction", fit.rim_fraction);
  field("by_hand", fit.by_hand);
}

template <typename Field, typename T>
void each_of_centre(Field field, T& centre) {
  field("origin", centre.origin);
  field("circles", centre.circles);
  field("x_px", centre.x_px);
  field("y_px", centre.y_px);
  field("variance_px2", centre.variance_px2);
  field("untold_px", centre.untold_px);
}

template <typename Field, typename T>
void each_of_correlate(Field field, T& point) {
  field("next_row", point.next_row);
  field("dx_px", point.dx_px);
  field("dy_px", point.dy_px);
  field("rot_rad", point.rot_rad);
  field("vain_searches", point.vain_searches);
}

template <typename T, typename Use>
void each_of_radii(T& tracker, const Use& use) {
  use("radii_px", tracker.radii_px);
  use("own_radii_px", tracker.own_radii_px);
  use("own_radii_sd_px", tracker.own_radii_sd_px);
}

json describe(const circle::BallTracker::Memory& tracker) {
  json described = {{"seen", json::array()},
                    {"radii_px", json::array()},
                    {"own_radii_px", json::array()},
                    {"own_radii_sd_px", json::array()},
                    {"next_learning", tracker.next_learning}};
  for (const circle::BallTracker::Seen& seen : tracker.seen) {
    json& item = described["seen"].emplace_back(json{{"index", seen.index}});
    each_of_fit(Writer{item}, seen.fit);
    // The key of older versions, which this one reads too.
    if (seen.fit.rim_model) item["look"] = seen.fit.rim_model->numbers();
  }
  each_of_radii(tracker, [&](const char* name, const std::deque<double>& radii) {
    for (const double radius : radii) described[name].push_back(exact_number(radius));
  });
  if (tracker.rim_bias) described["rim_bias"] = tracker.rim_bias->numbers();
  return described;
}

circle::BallTracker::Memory tracker_of(const json& described) {
  circle::BallTracker::Memory tracker;
  for (const json& item : described.at("seen")) {
    auto& seen = tracker.seen.emplace_back();
    seen.index = whole_number(item.at("index"));
    each_of_fit(Reader{item}, seen.fit);
    if (item.contains("look")) {
      const auto numbers = item.at("look").get<std::vector<double>>();
      // A width or a step of nothing has no rim.
      if (numbers.size() < 4 || numbers[1] <= 0 || numbers[2] <= 0 ||
          !std::all_of(numbers.begin(), numbers.end(), is_usual)) {
        throw std::runtime_error("this is no rim model");
      }
      seen.fit.rim_model = std::make_shared<circle::RimModel>(numbers);
    }
  }
  tracker.next_learning = whole_number(described.at("next_learning"));
  each_of_radii(tracker, [&](const char* name, std::deque<double>& radii) {
    if (!described.contains(name)) return;  // of an older version
    for (const json& radius : described.at(name)) radii.push_back(number_of(radius));
  });
  if (described.contains("rim_bias")) {
    tracker.rim_bias.emplace(described.at("rim_bias").get<std::array<double, 4>>());
  }
  return tracker;
}

pipeline::ResumePoint point_of(const json& described) {
  pipeline::ResumePoint point;
  point.next_row = whole_number(described.at("next_row"));
  each_of_fit(Reader{described.at("circle")}, point.circle);
  point.tracker = tracker_of(described.at("tracker"));
  if (described.contains("grid_radius_px")) {
    point.grid_radius_px = number_of(described.at("grid_radius_px"));
  }
  if (described.contains("keyframes")) point.keyframes = keyframes_of(described.at("keyframes"));
  // Not of an older version.
  if (described.contains("centre")) each_of_centre(Reader{described.at("centre")}, point.centre);
  if (described.contains("repeated")) point.repeated = described.at("repeated").get<bool>();
  return point;
}

constexpr std::int64_t kMostFrames = std::int64_t{1} << 48;

void check(const circle::CircleFit& fit) {
  demand(static_cast<unsigned>(fit.status) <=
         static_cast<unsigned>(circle::CircleStatus::kOutOfView));
  demand(static_cast<unsigned>(fit.by_hand) <= static_cast<unsigned>(ByHand::kAbsent));
  if (fit.status != circle::CircleStatus::kOk) return;
  check(fit.circle);
  for (const double value : {fit.e1_px, fit.e2_px}) demand(is_usual(value));
}

void check(const pipeline::ResumePoint& point) {
  const std::int64_t row = point.next_row;
  demand(row >= 0 && row < kMostFrames);
  check(point.circle);
  for (const circle::BallTracker::Seen& seen : point.tracker.seen) {
    demand(seen.index >= 0 && seen.index <= row);
    check(seen.fit);
  }
  for (const double radius : point.tracker.radii_px) demand(is_usual(radius) && radius > 0);
  each_of_radii(point.tracker, [](const char*, const std::deque<double>& radii) {
    for (const double radius : radii) demand(is_usual(radius));
  });
  demand(!point.grid_radius_px || (is_usual(*point.grid_radius_px) && *point.grid_radius_px > 0));
  if (point.keyframes) check_keyframes(*point.keyframes, row);
  demand(point.centre.origin >= -1 && point.centre.origin <= row && point.centre.circles >= 0);
  demand(is_usual(point.centre.x_px) && is_usual(point.centre.y_px));
  demand(is_usual(point.centre.variance_px2) && point.centre.variance_px2 >= 0);
  demand(is_usual(point.centre.untold_px) && point.centre.untold_px >= 0);
}

// Throws where the file is damaged or `of` refuses what it says.
template <typename Of>
auto read_point(const std::filesystem::path& path, const char* command, Of of) {
  std::ifstream file(path);
  if (!file) throw FileError("cannot read the file", path.string());
  try {
    json described = json::parse(file);
    // Files of older versions have no digest.
    if (described.contains("sha256")) {
      const std::string digest = described.at("sha256").get<std::string>();
      described.erase("sha256");
      if (sha256_of_text(described.dump()) != digest) throw std::runtime_error("it was changed");
    }
    return of(described);
  } catch (const json::out_of_range&) {  // whole, but without what this version needs
    throw FormatError(path.string(), -1, "another version of impactdic wrote where its run ended",
                      "go on with that version, or start anew with --force without --resume");
  } catch (const std::exception&) {
    throw FormatError(path.string(), -1,
                      std::string("this is not where a run of impactdic ") + command + " ended",
                      "--force without --resume starts anew");
  }
}

void write_point(const std::filesystem::path& path, json described) {
  described["sha256"] = sha256_of_text(described.dump());
  write_json(path, described);
}

}  // namespace

void write_resume_point(const std::filesystem::path& path, const pipeline::ResumePoint& point) {
  json described = {{"next_row", point.next_row}, {"circle", json::object()}};
  each_of_fit(Writer{described["circle"]}, point.circle);
  described["tracker"] = describe(point.tracker);
  if (point.grid_radius_px) described["grid_radius_px"] = exact_number(*point.grid_radius_px);
  if (point.keyframes) described["keyframes"] = describe(*point.keyframes);
  described["centre"] = json::object();
  each_of_centre(Writer{described["centre"]}, point.centre);
  if (point.repeated) described["repeated"] = true;
  write_point(path, std::move(described));
}

void write_resume_point(const std::filesystem::path& path, const pipeline::CorrelatePoint& point) {
  json described;
  each_of_correlate(Writer{described}, point);
  write_point(path, std::move(described));
}

pipeline::ResumePoint read_resume_point(const std::filesystem::path& path) {
  return read_point(path, "track", [](const json& described) {
    pipeline::ResumePoint point = point_of(described);
    check(point);
    return point;
  });
}

pipeline::CorrelatePoint read_correlate_point(const std::filesystem::path& path) {
  return read_point(path, "correlate", [](const json& described) {
    pipeline::CorrelatePoint point;
    each_of_correlate(Reader{described}, point);
    for (const double value : {point.dx_px, point.dy_px, point.rot_rad}) demand(is_usual(value));
    demand(point.next_row >= 0 && point.next_row < kMostFrames && point.vain_searches >= 0);
    return point;
  });
}

}  // namespace impactdic::report
