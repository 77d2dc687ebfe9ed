#include "host/report/csv.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/base/csv_table.h"
#include "host/base/parallel/parallel_for.h"
#include "host/base/parse.h"

namespace impactdic::report {

const char* const kTrackCsvHeader =
    "frame,time_s,status,cx_px,cy_px,r_px,cx_sd_px,cy_sd_px,r_sd_px,dx_px,dy_px,rot_deg,dx_sd_px,"
    "dy_sd_px,rot_sd_deg,windows,x_m,y_m,vx_m_s,vy_m_s,vt_m_s,vn_m_s,omega_rad_s,vx_sd_m_s,"
    "vy_sd_m_s,omega_sd_rad_s,rot_x_deg,rot_y_deg,rot_x_sd_deg,rot_y_sd_deg,dx_rot_y_corr,"
    "dy_rot_x_corr,omega_t_rad_s,omega_n_rad_s,omega_t_sd_rad_s,omega_n_sd_rad_s,vz_m_s,vz_sd_m_s,"
    "e1_px,e2_px,e1_sd_px,e2_sd_px,by_hand,rim_off_x_px,rim_off_y_px,rim_x_sd_px,rim_y_sd_px";
const char* const kMotionCsvHeader =
    "frame,time_s,status,dx_px,dy_px,rot_deg,dx_sd_px,dy_sd_px,rot_sd_deg,windows,dx_m,dy_m,"
    "plane_rot_deg,dx_sd_m,dy_sd_m,plane_rot_sd_deg";

namespace {

// Of a table that is written anew.
constexpr std::size_t kRowsAtOnce = 16384;

// Appends ",value"; an empty cell for NaN.
class Line {
 public:
  explicit Line(std::string text) : text_(std::move(text)) {}
  template <typename... Values>
  Line& add(Values... values) {
    ((text_ += "," + shortest(values)), ...);
    return *this;
  }
  Line& add_text(const std::string& word) {
    text_ += "," + word;
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::ofstream open_for_writing(const std::filesystem::path& path, std::ios::openmode mode) {
  std::ofstream file(path, mode);
  if (!file) throw FileError("cannot write the file", path.string());
  return file;
}

void check(const std::ofstream& file, const std::filesystem::path& path) {
  if (!file) throw FileError("cannot write the file", path.string(), "is the disk full?");
}

ByHand parse_by_hand(const std::string& cell, const std::string& where) {
  const std::int64_t number = cell.empty() ? 0 : parse_int(cell, where);
  if (number < 0 || number > static_cast<int>(ByHand::kAbsent)) {
    throw FormatError(where, -1, "by_hand is 0 to 3, not " + cell);
  }
  return static_cast<ByHand>(number);
}

TrackRow parse_row(const std::vector<std::string>& cells, const std::string& where) {
  const auto number = [&](std::size_t i) {
    return cells[i].empty() ? kNotMeasured : parse_double(cells[i], where);
  };
  TrackRow row;
  row.frame = parse_int(cells[0], where);
  row.time_s = number(1);
  row.status = parse_track_status(cells[2]);
  row.cx_px = number(3);
  row.cy_px = number(4);
  row.r_px = number(5);
  row.cx_sd_px = number(6);
  row.cy_sd_px = number(7);
  row.r_sd_px = number(8);
  row.dx_px = number(9);
  row.dy_px = number(10);
  row.rot_deg = number(11);
  row.dx_sd_px = number(12);
  row.dy_sd_px = number(13);
  row.rot_sd_deg = number(14);
  row.windows = cells[15].empty() ? 0 : static_cast<int>(parse_int(cells[15], where));
  row.rot_x_deg = number(26);
  row.rot_y_deg = number(27);
  row.rot_x_sd_deg = number(28);
  row.rot_y_sd_deg = number(29);
  row.dx_rot_y_corr = number(30);
  row.dy_rot_x_corr = number(31);
  row.e1_px = number(38);
  row.e2_px = number(39);
  row.e1_sd_px = number(40);
  row.e2_sd_px = number(41);
  row.by_hand = parse_by_hand(cells[42], where);
  row.rim_off_x_px = number(43);
  row.rim_off_y_px = number(44);
  row.rim_x_sd_px = number(45);
  row.rim_y_sd_px = number(46);
  row.circle_ok = !std::isnan(row.cx_px);
  row.motion_ok = !std::isnan(row.dx_px);
  return row;
}

MotionRow parse_motion_row(const std::vector<std::string>& cells, const std::string& where) {
  MotionRow row;
  row.frame = parse_int(cells[0], where);
  row.time_s = cells[1].empty() ? kNotMeasured : parse_double(cells[1], where);
  row.is_reference = cells[2] == "reference";
  if (!row.is_reference) row.status = parse_track_status(cells[2]);
  const auto number = [&](std::size_t i) {
    return cells[i].empty() ? kNotMeasured : parse_double(cells[i], where);
  };
  row.dx_px = number(3), row.dy_px = number(4), row.rot_deg = number(5);
  row.dx_sd_px = number(6), row.dy_sd_px = number(7), row.rot_sd_deg = number(8);
  row.windows = static_cast<int>(parse_int(cells[9], where));
  row.dx_m = number(10), row.dy_m = number(11), row.plane_rot_deg = number(12);
  row.dx_sd_m = number(13), row.dy_sd_m = number(14), row.plane_rot_sd_deg = number(15);
  row.motion_ok = !std::isnan(row.dx_px);
  return row;
}

// The whole rows of a table; a last line that was cut off is dropped.
template <typename Row>
std::vector<Row> read_rows(const std::filesystem::path& path, const std::string& header,
                           Row (*parse)(const std::vector<std::string>&, const std::string&)) {
  std::ifstream file(path);
  if (!file) throw FileError("cannot read the file", path.string());
  const std::string name = path.filename().string();
  std::string line;
  if (!std::getline(file, line) || !is_header_of(trim(line), header)) {
    throw FormatError(path.string(), 0, "this is not a " + name + ": its header differs");
  }
  const std::size_t columns = split(trim(line), ',').size(), all = split(header, ',').size();
  std::vector<Row> rows;
  for (int number = 2; std::getline(file, line); ++number) {
    const bool whole = !file.eof();  // the line ended with a newline
    auto cells = split(trim(line), ',');
    if (cells.size() != columns) {
      if (!whole) break;
      throw FormatError(path.string(), -1,
                        "line " + std::to_string(number) + " has " + std::to_string(cells.size()) +
                            " cells, not " + std::to_string(columns));
    }
    cells.resize(all);  // of an older version: not measured
    if (whole) rows.push_back(parse(cells, path.string() + ", line " + std::to_string(number)));
  }
  return rows;
}

}  // namespace

namespace {

std::string line_of(const TrackRow& row, const SiRow& si) {
  Line line(std::to_string(row.frame));
  line.add(row.time_s).add_text(to_string(row.status));
  line.add(row.cx_px, row.cy_px, row.r_px, row.cx_sd_px, row.cy_sd_px, row.r_sd_px);
  line.add(row.dx_px, row.dy_px, row.rot_deg, row.dx_sd_px, row.dy_sd_px, row.rot_sd_deg);
  line.add_text(std::to_string(row.windows));
  line.add(si.x_m, si.y_m, si.vx_m_s, si.vy_m_s, si.vt_m_s, si.vn_m_s, si.omega_rad_s);
  line.add(si.vx_sd_m_s, si.vy_sd_m_s, si.omega_sd_rad_s);
  line.add(row.rot_x_deg, row.rot_y_deg, row.rot_x_sd_deg, row.rot_y_sd_deg, row.dx_rot_y_corr,
           row.dy_rot_x_corr);
  line.add(si.omega_t_rad_s, si.omega_n_rad_s, si.omega_t_sd_rad_s, si.omega_n_sd_rad_s);
  line.add(si.vz_m_s, si.vz_sd_m_s);
  line.add(row.e1_px, row.e2_px, row.e1_sd_px, row.e2_sd_px);
  line.add_text(std::to_string(static_cast<int>(row.by_hand)));
  line.add(row.rim_off_x_px, row.rim_off_y_px, row.rim_x_sd_px, row.rim_y_sd_px);
  return line.text();
}

// Lines are made on several threads, since numbers as text take longer than all else here.
void write_lines(std::ofstream& file, std::size_t count,
                 const std::function<std::string(std::size_t)>& line) {
  std::vector<std::string> lines(count);
  parallel_for(count, 0, [&](std::size_t i) { lines[i] = line(i) + "\n"; });
  for (const std::string& made : lines) file << made;
}

}  // namespace

std::string track_csv_line(const TrackRow& row, const SiScale& scale) {
  return line_of(row, to_si(row, scale));
}

TrackCsv::TrackCsv(std::filesystem::path path, const SiScale& scale, std::int64_t keep)
    : path_(std::move(path)), scale_(scale), file_(continue_table(path_, kTrackCsvHeader, keep)) {}

void TrackCsv::add(std::span<const TrackRow> rows) {
  write_lines(file_, rows.size(), [&](std::size_t i) { return track_csv_line(rows[i], scale_); });
}

void TrackCsv::flush() {
  file_.flush();
  check(file_, path_);
}

void TrackCsv::finish(const TrackRows& rows, const TrackResult& result) {
  flush();
  const std::filesystem::path temporary = path_.string() + ".part";
  {
    std::ofstream file = open_for_writing(temporary, std::ios::trunc);
    file << kTrackCsvHeader << "\n";
    std::vector<TrackRow> some;
    for (std::size_t first = 0; first < rows.size(); first += some.size()) {
      some.clear();
      const std::size_t end = std::min(rows.size(), first + kRowsAtOnce);
      for (std::size_t i = first; i < end; ++i) some.push_back(rows[i]);
      write_lines(file, some.size(), [&](std::size_t i) {
        return line_of(some[i], to_si(result, some[i], first + i));
      });
    }
    file.flush();
    check(file, temporary);
  }
  std::error_code error;
  std::filesystem::rename(temporary, path_, error);
  if (error) throw FileError("cannot replace the file: " + error.message(), path_.string());
}

void write_camera_motion_csv(const std::filesystem::path& path, const TrackRows& rows,
                             const CameraMotion& motion) {
  std::ofstream file = open_for_writing(path, std::ios::trunc);
  file << "frame,time_s,x_px,y_px,roll_deg,x_sd_px,y_sd_px,roll_sd_deg\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const TrackRow row = rows[i];
    const PictureShift& at = motion.of_rows[i];
    Line line(std::to_string(row.frame));
    line.add(row.time_s);
    if (at.known) {
      line.add(at.x_px, at.y_px, at.roll_rad * kDegPerRad, at.x_sd_px, at.y_sd_px,
               at.roll_sd_rad * kDegPerRad);
    } else {
      line.add(kNotMeasured, kNotMeasured, kNotMeasured, kNotMeasured, kNotMeasured, kNotMeasured);
    }
    file << line.text() << '\n';
  }
  file.flush();
  check(file, path);
}

std::vector<TrackRow> read_track_csv(const std::filesystem::path& path) {
  return read_rows<TrackRow>(path, kTrackCsvHeader, parse_row);
}

MotionCsv::MotionCsv(std::filesystem::path path, std::int64_t keep)
    : path_(std::move(path)), file_(continue_table(path_, kMotionCsvHeader, keep)) {}

void MotionCsv::add(const MotionRow& row) {
  Line line(std::to_string(row.frame));
  line.add(row.time_s).add_text(row.is_reference ? "reference" : to_string(row.status));
  line.add(row.dx_px, row.dy_px, row.rot_deg, row.dx_sd_px, row.dy_sd_px, row.rot_sd_deg);
  line.add_text(std::to_string(row.windows));
  line.add(row.dx_m, row.dy_m, row.plane_rot_deg, row.dx_sd_m, row.dy_sd_m, row.plane_rot_sd_deg);
  file_ << line.text() << '\n';
}

void MotionCsv::flush() {
  file_.flush();
  check(file_, path_);
}

std::vector<MotionRow> read_motion_csv(const std::filesystem::path& path) {
  return read_rows<MotionRow>(path, kMotionCsvHeader, parse_motion_row);
}

}  // namespace impactdic::report
