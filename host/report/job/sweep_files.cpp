#include "host/report/job/sweep_files.h"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "host/report/job/table_file.h"

namespace impactdic::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 3> kStatuses{"ok", "held", "failed"};

// The formulas' own restitutions stand in columns of that name already.
std::string column_of(SweepAxis axis, const SweepModel& model) {
  const bool outcome = axis == SweepAxis::kRestitution || axis == SweepAxis::kTangentialRestitution;
  return (outcome ? "given_" : "") + key_of(axis, model);
}

std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

bool leaves_plane(const SweepModel& model) {
  const auto* impact = std::get_if<ImpactJob>(&model);
  return impact != nullptr && !impact->initial.plane();
}

void write_rows(const std::filesystem::path& file, const SweepRequest& request,
                const SweepResult& result) {
  const bool rod = std::holds_alternative<RodModel>(request.model);
  const bool space = leaves_plane(request.model);
  std::string header;
  for (const SweepValues& axis : request.axes) header += column_of(axis.axis, request.model) + ",";
  header +=
      "status,vt_before_m_s,vn_before_m_s,omega_before_rad_s,vt_after_m_s,vn_after_m_s,"
      "omega_after_rad_s,";
  if (space) header += "vb_after_m_s,omega_t_after_rad_s,omega_n_after_rad_s,";
  header +=
      "restitution,tangential_restitution,friction,rolling_cap,contact_s,max_deflection_m,"
      "max_force_n,kinetic_before_j,lost,";
  if (rod) header += "dent_m,micro_impacts,";
  TableFile table(file, header + "phases,reason");
  for (std::size_t i = 0; i < result.shots.size(); ++i) {
    const SweepShot& s = result.shots[i];
    for (const double value : request.values_of(i)) table << value;
    table << std::string(kStatuses[static_cast<std::size_t>(s.status)]) << s.before.vt_m_s
          << s.before.vn_m_s << s.before.omega_rad_s << s.after.vt_m_s << s.after.vn_m_s
          << s.after.omega_rad_s;
    if (space) table << s.after.vb_m_s << s.after.omega_t_rad_s << s.after.omega_n_rad_s;
    table << s.restitution << s.tangential_restitution << s.friction << s.rolling_cap << s.contact_s
          << s.max_deflection_m << s.max_force_n << s.kinetic_before_j << s.lost;
    if (rod) table << s.dent_m << s.micro_impacts;
    table << s.phases << cell(s.reason);
    table.end_row();
  }
  table.close();
}

std::array<long, 3> counts(const SweepResult& result) {
  std::array<long, 3> count{};
  for (const SweepShot& shot : result.shots) ++count[static_cast<std::size_t>(shot.status)];
  return count;
}

}  // namespace

void write_sweep(const std::filesystem::path& folder, const SweepRequest& request,
                 const SweepResult& result) {
  write_rows(folder / "sweep.csv", request, result);
  Json axes = Json::array();
  for (const SweepValues& axis : request.axes) {
    axes.push_back({{"key", key_of(axis.axis, request.model)},
                    {"column", column_of(axis.axis, request.model)},
                    {"values", axis.values}});
  }
  const std::array<long, 3> count = counts(result);
  Json by_status = Json::object();
  for (std::size_t i = 0; i < count.size(); ++i) by_status[kStatuses[i]] = count[i];
  write_ordered_json(folder / "summary.json", {{"shots", result.shots.size()},
                                               {"axes", axes},
                                               {"shots_by_status", by_status},
                                               {"warnings", sweep_warnings(result)},
                                               {"version", IMPACTDIC_VERSION}});
}

std::string sweep_words(const SweepResult& result) {
  const auto [ok, held, failed] = counts(result);
  std::string words = std::to_string(result.shots.size()) + " shots";
  if (held > 0) words += ", " + std::to_string(held) + " held by their weight";
  if (failed > 0) words += ", " + std::to_string(failed) + " failed (sweep.csv says why)";
  return words + "\n";
}

std::vector<std::string> sweep_warnings(const SweepResult& result) {
  std::map<std::string, long> found;
  for (const SweepShot& shot : result.shots) {
    for (const std::string& warning : shot.warnings) {
      // Numbers differ from shot to shot: the words before the first one tell the kind.
      ++found[warning.substr(0, warning.find_first_of("0123456789"))];
    }
  }
  std::vector<std::string> warnings;
  for (const auto& kind_and_count : found) {
    const auto& kind = kind_and_count.first;
    const auto first = std::find_if(result.shots.begin(), result.shots.end(), [&](const auto& s) {
      return std::any_of(s.warnings.begin(), s.warnings.end(),
                         [&](const std::string& w) { return w.starts_with(kind); });
    });
    const auto& texts = first->warnings;
    const auto text = std::find_if(texts.begin(), texts.end(),
                                   [&](const std::string& w) { return w.starts_with(kind); });
    warnings.push_back(std::to_string(kind_and_count.second) + " of " +
                       std::to_string(result.shots.size()) + " shots, such as the one in row " +
                       std::to_string(first - result.shots.begin() + 1) + ": " + *text);
  }
  const std::array<long, 3> count = counts(result);
  if (count[2] > 0) {
    warnings.push_back(std::to_string(count[2]) + " of " + std::to_string(result.shots.size()) +
                       " shots failed; sweep.csv says why");
  }
  return warnings;
}

}  // namespace impactdic::report
