#include "sim/sweep/sweep_job.h"

#include <impactdic/error.h>

#include "sim/job/job_toml.h"
#include "sim/job/rebound_job.h"
#include "sim/job/strict_toml.h"
#include "sim/job/toml_text.h"
#include "sim/rod/rod_job.h"

namespace impactdic::sim::sweep {
namespace {

constexpr SweepAxis kLast = SweepAxis::kTangentialRestitution;

SweepModel read_model(const std::filesystem::path& file, job::StrictTable& root) {
  const std::string model = job::model_of_job(file);
  if (is_rebound_model(model)) return job::read_rebound_tables(root);
  if (model == "rigid_rod" || model == "flexible_rod") return rod::read_rod_model(root);
  return job::read_simulate_tables(root).impact;
}

// Of any model at all, so that a misspelt key is found before what it leaves out.
void require_known(const std::string& key, const job::StrictTable& table) {
  std::string list;
  for (int i = 0; i <= static_cast<int>(kLast); ++i) {
    const auto axis = static_cast<SweepAxis>(i);
    for (int law = 0; law <= static_cast<int>(NormalModel::kJkr); ++law) {
      ImpactJob job;
      job.normal = static_cast<NormalModel>(law);
      if (key_of(axis, job) == key) return;
    }
    list += (list.empty() ? "" : ", ") + key_of(axis, ImpactJob{});
  }
  throw InvalidArgument("nothing of this name can be swept", table.place(key), "one of " + list);
}

SweepAxis axis_of(const std::string& key, const SweepModel& model, const job::StrictTable& table) {
  std::string list;
  for (int i = 0; i <= static_cast<int>(kLast); ++i) {
    const auto axis = static_cast<SweepAxis>(i);
    if (!has_axis(model, axis)) continue;
    if (key_of(axis, model) == key) return axis;
    list += (list.empty() ? "" : ", ") + key_of(axis, model);
  }
  throw InvalidArgument("the model does not have it", table.place(key), "one of " + list);
}

// Where the model's own tables have what a key of [sweep] gives, so that they may leave it out.
void fill_in(job::StrictTable& root, const std::string& key, double value) {
  if (key == "speed_m_s") {
    root.fill("initial", "vn_m_s", -1);  // along the normal, unless the file says otherwise
  } else if (key == "rod_angle_deg") {
    root.fill("initial", "angle_deg", value);
  } else if (key == "surface_angle_deg" || key == "drop_angle_deg" || key == "incidence_deg" ||
             key == "omega_rad_s" || key == "spin_ratio") {
    return;
  } else {
    root.fill("contact", key, value);
  }
}

void validate_first_shot(const SweepRequest& request) {
  std::visit(
      [](const auto& job) {
        if constexpr (requires { job.rod; }) {
          job.rod.validate();
        } else {
          job.validate();
        }
      },
      request.shot(0));
}

}  // namespace

bool is_sweep_job(const std::filesystem::path& file) { return job::StrictTable(file).has("sweep"); }

SweepRequest read_sweep_job(const std::filesystem::path& file) {
  job::StrictTable root(file);
  job::StrictTable& table = root.table("sweep");
  const std::vector<std::string> keys = table.keys();
  for (const std::string& key : keys) {
    require_known(key, table);
    const std::vector<double> values = table.numbers(key);
    if (!values.empty()) fill_in(root, key, values[0]);
  }
  SweepRequest request;
  request.model = read_model(file, root);
  for (const std::string& key : keys) {
    request.axes.push_back({axis_of(key, request.model, table), table.numbers(key)});
  }
  root.finish();
  job::validate_in_file(request, root);
  try {
    validate_first_shot(request);
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), root.place(error.where()), error.hint());
  }
  return request;
}

std::string to_toml(const SweepRequest& request) {
  std::string base;
  if (const auto* impact = std::get_if<ImpactJob>(&request.model)) {
    base = job::to_toml(SimulateRequest{.impact = *impact});
  } else if (const auto* formula = std::get_if<ReboundJob>(&request.model)) {
    base = job::to_toml(*formula);
  } else {
    base = rod::to_toml(std::get<RodModel>(request.model));
  }
  job::TomlText text;
  text.table("sweep");
  for (const SweepValues& axis : request.axes) {
    text.numbers(key_of(axis.axis, request.model), axis.values);
  }
  return base + text.str();
}

}  // namespace impactdic::sim::sweep
