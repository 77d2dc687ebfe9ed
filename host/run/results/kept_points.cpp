#include "host/run/results/kept_points.h"

#include <impactdic/error.h>

#include <algorithm>
#include <string>

#include "host/base/parse.h"
#include "host/report/csv.h"
#include "host/report/resume_file.h"

namespace impactdic::run {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMost = 16;
constexpr char kFolder[] = "resume";

fs::path file_of(const fs::path& folder, std::int64_t row) {
  return folder / kFolder / (std::to_string(row) + ".json");
}

// The rows of the points that are kept, in order. Files of other names are none.
std::vector<std::int64_t> rows_in(const fs::path& folder) {
  std::vector<std::int64_t> rows;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder / kFolder, none)) {
    const std::string name = entry.path().stem().string();
    const bool number = !name.empty() && name.size() < 16 &&
                        name.find_first_not_of("0123456789") == std::string::npos;
    if (!number || entry.path().extension() != ".json") continue;
    rows.push_back(parse_int(name, entry.path().string()));
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

// One that is damaged, or that another version wrote, is as good as none.
std::optional<pipeline::ResumePoint> read_if_good(const fs::path& path) {
  try {
    return report::read_resume_point(path);
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

KeptPoints::KeptPoints(const fs::path& folder, std::int64_t last_row) : folder_(folder) {
  std::error_code gone;
  for (const std::int64_t row : rows_in(folder)) {
    if (row <= last_row) {
      rows_.push_back(row);
    } else {
      fs::remove(file_of(folder, row), gone);
    }
  }
}

void KeptPoints::add(const pipeline::ResumePoint& point) {
  if (!rows_.empty() && point.next_row <= rows_.back()) return;
  std::error_code error;
  fs::create_directories(folder_ / kFolder, error);
  if (error) {
    throw FileError("cannot make the folder: " + error.message(), (folder_ / kFolder).string());
  }
  report::write_resume_point(file_of(folder_, point.next_row), point);
  rows_.push_back(point.next_row);
  if (rows_.size() <= kMost) return;
  // The one whose neighbours lie closest together is missed least.
  std::size_t least = 1;
  for (std::size_t k = 2; k + 1 < rows_.size(); ++k) {
    if (rows_[k + 1] - rows_[k - 1] < rows_[least + 1] - rows_[least - 1]) least = k;
  }
  fs::remove(file_of(folder_, rows_[least]), error);
  rows_.erase(rows_.begin() + static_cast<std::ptrdiff_t>(least));
}

std::optional<pipeline::ResumePoint> KeptPoints::before(const fs::path& folder, std::int64_t row) {
  if (auto last = read_if_good(folder / "resume.json"); last && last->next_row < row) return last;
  const std::vector<std::int64_t> rows = rows_in(folder);
  for (auto kept = rows.rbegin(); kept != rows.rend(); ++kept) {
    if (*kept >= row) continue;
    auto point = read_if_good(file_of(folder, *kept));
    if (point && point->next_row == *kept) return point;
  }
  return std::nullopt;
}

std::optional<std::int64_t> KeptPoints::go_back(const fs::path& folder, std::int64_t row) {
  const fs::path table = folder / "track.csv";
  const auto point = before(folder, row);
  if (!point || static_cast<std::int64_t>(report::read_track_csv(table).size()) < point->next_row) {
    return std::nullopt;
  }
  // A run that is killed anywhere in between leaves a folder that the old job can go on with.
  report::write_resume_point(folder / "resume.json", *point);
  report::TrackCsv(table, SiScale{}, point->next_row).flush();
  KeptPoints(folder, point->next_row);
  return point->next_row;
}

}  // namespace impactdic::run
