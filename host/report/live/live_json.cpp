#include "host/report/live/live_json.h"

#include <cstdio>
#include <vector>

#include "host/base/parse.h"
#include "host/report/csv.h"

namespace impactdic::report {

std::string live_json_line(const LiveRow& row) {
  static const std::vector<std::string> names = split(kTrackCsvHeader, ',');
  const std::vector<std::string> cells = split(track_csv_line(row.row, row.scale), ',');
  std::string line = "{";
  for (std::size_t i = 0; i < names.size(); ++i) {
    line += "\"" + names[i] + "\":";
    if (names[i] == "status") {
      line += "\"" + (row.dropped ? "dropped" : cells[i]) + "\",";
    } else {
      line += (cells[i].empty() ? "null" : cells[i]) + ",";
    }
  }
  return line + "\"delay_s\":" + (row.dropped ? "null" : shortest(row.delay_s)) + "}";
}

std::string in_words(const LiveResult& result) {
  char delay[32];
  std::snprintf(delay, sizeof delay, "%.1f ms", 1e3 * result.longest_delay_s);
  return std::to_string(result.frames) + " frames, " + std::to_string(result.ok) + " ok, " +
         std::to_string(result.dropped) + " dropped, " + std::to_string(result.short_batches) +
         " batches not full; longest delay " + delay;
}

}  // namespace impactdic::report
